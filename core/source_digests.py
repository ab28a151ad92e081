"""Digests of the sources that machine code is made of: a library fits the sources whose digests it holds.

It needs the standard library alone, since an installation asks for them before anything else is there (`setup.py`).
"""

import hashlib
import os
from functools import cache
from pathlib import Path

_CORE = Path(__file__).resolve().parent


@cache
def core_digest() -> str:
    """Digest of every source of the core but those that make the library, and what is laid before it: constants of any
    may be in the code."""
    digest, root = hashlib.sha256(), str(_CORE)
    for folder, folders, files in os.walk(root):
        folders[:] = sorted(set(folders) - {"__pycache__", "aot", "native"})
        for file in sorted(files):
            if file.endswith(".py"):
                with open(os.path.join(folder, file), "rb", buffering=0) as source:
                    name = os.path.join(folder[len(root) :], file).replace(os.sep, "/")
                    digest.update(name.encode() + b"\0" + source.read() + b"\0")
    return digest.hexdigest()[:32]


def c_sources(pattern: str = "*.c") -> list[Path]:
    """The C sources that belong in the library: those in a folder `native` of any part of the package, and the
    functions of FMI."""
    return sorted([*_CORE.parent.glob(f"*/native/{pattern}"), *_CORE.parent.glob(f"fmu_wrapper/fmi/{pattern}")])


def c_digest() -> str:
    """Digest of them and of their headers."""
    digest = hashlib.sha256()
    for path in c_sources("*.[ch]"):
        digest.update(f"{path.relative_to(_CORE.parent).as_posix()}\0".encode() + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]
