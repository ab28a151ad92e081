"""Compiling ahead of time: a slave is made of a scenario, a model or an FMU, which compiles all that it needs."""

import json
import sys
import tempfile
import time
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..core.compiled.cache import cache_folder
from ..core.compiled.notices import Compiled, compiled_so_far
from ..fmu_wrapper import Slave, boot
from ..models import Scenario
from .errors import Failure
from .screen import say


@dataclass(frozen=True)
class Warmed:
    """What was compiled for `name` (functions asked for), how long all took (s), and where compiled code is kept."""

    name: str
    functions: int
    seconds: float
    folder: str | None


def warm_scenario(scenario: Scenario) -> Warmed:
    """Compile what a run and an FMU of `scenario` need."""
    began, before = time.perf_counter(), compiled_so_far()
    Slave(scenario).prepare()
    return _warmed(scenario.name, began, before, compiled_so_far(), cache_folder())


def warm_fmu(path: Path) -> Warmed:
    """Compile what the FMU needs in this Python, with the package that it carries along if it does.

    Raises
    ------
    Failure : if it is no FMU of this package.
    """
    with tempfile.TemporaryDirectory() as folder:
        try:
            with zipfile.ZipFile(path) as archive:
                archive.extractall(folder)
            resources = Path(folder, "resources")
            if (resources / "model.image").is_file():
                raise Failure(f"'{path}' has nothing to compile: it carries its machine code, and runs without Python")
            python = json.loads((resources / "python.json").read_text(encoding="utf-8"))
            settings = json.loads((resources / "settings.json").read_text(encoding="utf-8"))
        except (zipfile.BadZipFile, OSError, ValueError) as error:
            raise Failure(f"'{path}' is no FMU made by tlismni: {error}") from None
        root = f"tlismni_{python['bundle']}" if python.get("bundle") else "tlismni"
        began, before = time.perf_counter(), _compiled_by(root)
        calls = boot.create(
            2, path.stem, settings["token"], str(resources), False, _to_screen, False, False, False, None, None
        )
        # an older package compiles here
        calls.slave.enter_initialization()
        calls.slave.exit_initialization()
        cache = sys.modules.get(f"{root}.core.compiled.cache")
        return _warmed(path.name, began, before, _compiled_by(root), None if cache is None else cache.cache_folder())


def _compiled_by(root: str) -> Compiled:
    """What the package `root` has compiled, which may be another one than this."""
    notices: Any = sys.modules.get(f"{root}.core.compiled.notices")
    return Compiled() if notices is None else notices.compiled_so_far()


def _to_screen(status: int, category: str, message: str) -> None:
    say(message)


def _warmed(name: str, began: float, before: Compiled, now: Compiled, folder: Path | None) -> Warmed:
    seconds = time.perf_counter() - began
    return Warmed(name, now.functions - before.functions, seconds, None if folder is None else str(folder))
