r"""What runs programs of other processors, systems and C libraries here, and the libraries of machine code for them:

dpkg --add-architecture arm64; apt-get update
apt-get install qemu-user libc6-arm64-cross wine64 musl musl:arm64
python -m tlismni.core.aot --target linux-aarch64 --target musl-x86_64 --target musl-aarch64 --target windows-x86_64 \
    --output build
"""

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from tlismni.core.compiled.library import LIBRARY
from tlismni.core.source_digests import c_digest, core_digest

LIBRARIES = Path(os.environ.get("TLISMNI_LIBRARIES", "build")).resolve()
QEMU = shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static")
ARM = Path("/usr/aarch64-linux-gnu")
WINE = shutil.which("wine") or shutil.which("wine64")
TARGETS = {
    "linux-aarch64": ("aarch64-linux-gnu.2.17", [QEMU, "-L", ARM] if QEMU and ARM.is_dir() else None),
    "musl-x86_64": ("x86_64-linux-musl", [] if Path("/lib/ld-musl-x86_64.so.1").exists() else None),
    "musl-aarch64": ("aarch64-linux-musl", [QEMU] if QEMU and Path("/lib/ld-musl-aarch64.so.1").exists() else None),
    "windows-x86_64": ("x86_64-windows-gnu", [WINE] if WINE else None),
}
"""zig's name, and what programs are run with; None: nothing here runs them."""


def library_for(target):
    """The library for a target, None where it is not."""
    return next(LIBRARIES.glob(f"{target}/tlismni_core.*"), None)


def is_of_these_sources(library):
    """Of the core's, and of those in C."""
    content = library.read_bytes()
    return all(digest.encode() in content for digest in (core_digest(), c_digest()))


def missing(target):
    """What a test needs and has not."""
    if LIBRARY is None or shutil.which("cc") is None:
        return "a C compiler and the library of machine code"
    if TARGETS[target][1] is None:
        return "what runs programs for it"
    if find_spec("ziglang") is None:
        return "ziglang, which compiles for it"
    library = library_for(target)
    if library is None or not is_of_these_sources(library):
        return f"the library of these sources in {LIBRARIES}"
    return ""


def zig(*arguments):
    """Run zig."""
    subprocess.run([sys.executable, "-m", "ziglang", *map(str, arguments)], check=True)


def output(command):
    """What a program prints, whatever runs it."""
    environment = {**os.environ, "WINEDEBUG": "-all"}
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout
