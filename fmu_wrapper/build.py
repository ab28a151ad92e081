"""Builds the FMU's binary for other platforms: python -m tlismni.fmu_wrapper.build [--output DIR] [PLATFORM ...]

They are cross-compiled with Zig's C compiler (`pip install ziglang`) from the C sources in the package, which need
nothing of Python, and kept in the user's cache folder by the content of the sources.
"""

import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from .boot import user_cache
from .errors import ExportError
from .platforms import PLATFORMS, Platform, choose

FOLDERS = (Path(__file__).parent / "fmi", Path(__file__).parent / "shim")
FLAGS = ("-std=c11", "-O2", "-s", "-shared", "-fvisibility=hidden", "-Wall", "-Wextra", "-DTLISMNI_SHIM")


def shim_sources(pattern: str = "*.c") -> list[Path]:
    """The C sources of the binary: the functions of FMI, and what drives Python."""
    return [path for folder in FOLDERS for path in sorted(folder.glob(pattern))]


def binary(name: str) -> Path:
    """The binary for the platform `name`, built now if there is none yet for these sources.

    Raises
    ------
    ExportError : without ziglang, or if it fails.
    """
    users = user_cache()
    if users is None:
        raise ExportError(
            f"the binary for {name} is built once and kept, and there is neither a home nor a cache folder for it: set "
            f"{'LOCALAPPDATA' if os.name == 'nt' else 'XDG_CACHE_HOME'} to a folder that can be written"
        )
    folder = Path(users, "tlismni", "binaries", _digest())
    path = folder / name / f"tlismni_shim{PLATFORMS[name].suffix}"
    if not path.is_file():
        if importlib.util.find_spec("ziglang") is None:
            raise ExportError(
                f"the binary for {name} is not built yet, which needs Zig's C compiler: python -m pip install ziglang"
            )
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            compile_shim(PLATFORMS[name], path)
        except OSError as error:
            raise ExportError(f"the binary for {name} cannot be kept in '{path.parent}': {error.strerror}") from error
    return path


def compile_shim(target: Platform, path: Path) -> None:
    """Compile the shim for `target` into `path`, whole or not at all. Raises ExportError with what went wrong."""
    if not all(any(folder.glob("*.c")) for folder in FOLDERS):
        missing = "' or '".join(map(str, FOLDERS))
        raise ExportError(f"the C sources of the FMU's binary are missing in '{missing}': install tlismni again")
    sources = map(str, shim_sources())
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        made = Path(folder, path.name)
        compiler = [sys.executable, "-m", "ziglang", "cc", "-target", target.target]
        command = [*compiler, *FLAGS, "-o", str(made), *sources, *target.flags]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise ExportError(f"the binary for {target.fmi3} cannot be built: {' '.join(done.stderr.split())[-2000:]}")
        os.replace(made, path)


def _digest() -> str:
    """Of sources and flags."""
    digest = hashlib.sha256(repr((FLAGS, sorted(PLATFORMS.items()))).encode())
    for path in shim_sources("*.[ch]"):
        digest.update(f"{path.parent.name}/{path.name}".encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def build(names: Sequence[str], output: Path | None = None) -> Iterator[tuple[str, Path]]:
    """Names and binaries of some platforms, one by one, as `binary` gives them or copied to `output`/PLATFORM."""
    for name in choose(names or ["all"]):
        path = binary(name)
        if output is not None:
            copy = output / name / path.name
            copy.parent.mkdir(parents=True, exist_ok=True)
            path = Path(shutil.copy(path, copy))
        yield name, path


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    import argparse

    parser = argparse.ArgumentParser(
        prog="python -m tlismni.fmu_wrapper.build", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("platforms", nargs="*", metavar="PLATFORM", help=f"all (default), {', '.join(PLATFORMS)}")
    parser.add_argument("--output", type=Path, metavar="DIR", help="copy the binaries to DIR/PLATFORM")
    given = parser.parse_args(arguments)
    try:
        for name, path in build(given.platforms, given.output):
            sys.stdout.write(f"{name}: {path}\n")
    except ExportError as error:
        sys.stderr.write(f"error: {error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
