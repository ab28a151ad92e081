"""A shared library from an object file, by zig's linker, or by the machine's own."""

import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from ..errors import TlismniError
from .module import Target

LINKERS = ("cc", "gcc", "clang")


class LinkError(TlismniError):
    """No linker was found, or it failed."""


def _command(target: Target, native: bool) -> list[str]:
    """A compiler that links for a target; zig's if it is there, since that links with an old C library (glibc 2.17), so
    that the result runs on older systems than this one. Raises LinkError."""
    if find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc", "-target", target.linker, "-shared", "-s"]
    found = next(filter(None, map(shutil.which, LINKERS)), None) if native else None
    if found is None:
        raise LinkError(
            f"nothing links a library for {target.name} here: install ziglang (pip install ziglang)"
            + (f", or one of {', '.join(LINKERS)}" if native else "")
        )
    return [found, "-shared", "-s"]


def link_shared(machine_code: bytes, target: Target, path: Path, native: bool) -> None:
    """Write the shared library `path` of one object. Raises LinkError."""
    libraries = [] if target.suffix == ".dll" else ["-lm"]
    with tempfile.TemporaryDirectory() as folder:
        part, whole = Path(folder, "core.o"), Path(folder, path.name)
        part.write_bytes(machine_code)
        command = [*_command(target, native), "-o", str(whole), str(part), *libraries]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise LinkError(f"{' '.join(command)} failed: {done.stderr.strip()}")
        path.parent.mkdir(parents=True, exist_ok=True)
        # a process that has the old one open keeps it
        path.unlink(missing_ok=True)
        shutil.copyfile(whole, path)
