"""The snippets of docs/embedding.md run as they stand."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tlismni.core.compiled.library import LIBRARY

CC = shutil.which("cc")
PAGE = Path(__file__).parents[2] / "docs" / "embedding.md"


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.skipif(LIBRARY is None or CC is None, reason="needs the library of machine code, and a C compiler")
def test_the_image_is_written_and_the_program_goes_on_from_it(tmp_path):
    (prepare,), (program,) = blocks("python"), blocks("c")
    subprocess.run([sys.executable, "-c", prepare], cwd=tmp_path, check=True)
    include, _, body = program.partition("\n")
    lines = ["#include <stdio.h>", include, "int main(void) {", body, 'printf("%d %.17g", status, speed);']
    (tmp_path / "control.c").write_text("\n".join([*lines, "return model && run ? 0 : 1; }"]))
    flags = subprocess.run(
        [sys.executable, "-m", "tlismni.core.native"], check=True, capture_output=True, text=True
    ).stdout
    compile_it = [CC, "-Wall", "-Werror", "-o", "control", "control.c", *shlex.split(flags)]
    subprocess.run(compile_it, cwd=tmp_path, check=True)
    done = subprocess.run(["./control"], cwd=tmp_path, check=True, capture_output=True, text=True)
    status, speed = done.stdout.split()
    assert status == "0" and abs(float(speed)) < 1e3
