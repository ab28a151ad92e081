"""Random FMI calls on FMUs without Python, with address and undefined-behaviour sanitizers."""

import os
import shutil
import subprocess
from pathlib import Path

import fmpy
import pytest
from tlismni.core.aot.shared import symbol_table
from tlismni.core.compiled.library import LIBRARY
from tlismni.core.source_digests import c_sources
from tlismni.fmu_wrapper import export_fmu
from tlismni.models import load

HERE = Path(__file__).parent
CC = shutil.which("cc")
SEQUENCES = int(os.environ.get("TLISMNI_FUZZ", "600"))
SANITIZED = ["-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer"]
pytestmark = pytest.mark.skipif(
    CC is None or LIBRARY is None, reason="needs a C compiler and the library of machine code"
)


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """The C sources as they are, with sanitizers; compiled functions come from the library."""
    folder = tmp_path_factory.mktemp("fuzz")
    (folder / "symbols.c").write_text(symbol_table(LIBRARY.entries.values()))
    sources = c_sources()
    include = sorted({f"-I{source.parent}" for source in sources} | {f"-I{Path(fmpy.__file__).parent / 'c-code'}"})
    made = folder / "fuzz"
    warnings = ["-Wall", "-Wextra", "-Wshadow", "-Werror"]
    library = LIBRARY.path.resolve()
    files = [HERE / "fuzz_native.c", folder / "symbols.c", *sources, library, f"-Wl,-rpath,{library.parent}", "-lm"]
    command = [CC, "-std=c11", *SANITIZED, *warnings, "-ffp-contract=off", *include, "-o", made, *files]
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True)
    if "cannot find" in done.stderr and "san" in done.stderr:
        pytest.skip("the compiler has no sanitizers")
    assert done.returncode == 0, done.stderr
    return made


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["slider_crank_stop", "woodpecker", "chain"])
def test_random_calls(program, name, tmp_path):
    path = export_fmu(load(name), tmp_path / "x.fmu", "3.0", native=True)
    unzipped = Path(fmpy.extract(str(path), unzipdir=str(tmp_path / "x")))
    description = fmpy.read_model_description(str(unzipped))
    arguments = [(unzipped / "resources").as_uri(), description.instantiationToken, 7, SEQUENCES,
                 len(description.modelVariables)]  # fmt: skip
    done = subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stderr[-3000:]
    calls, _, refused, _ = done.stdout.replace(",", "").split()
    assert int(calls) > 5 * SEQUENCES and 0.1 < int(refused) / int(calls) < 0.9
