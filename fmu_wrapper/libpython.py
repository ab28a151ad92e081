"""What an FMU records of the Python that exports it, so that a host without Python can start the same."""

import os
import sys
import sysconfig
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from .version import package_version

NEEDED = ("numpy", "scipy", "numba", "llvmlite", "pydantic")


def shared_library() -> Path | None:
    """The shared library of this Python, or None: some builds have none; then only Python hosts load FMUs."""
    for path in _candidates():
        if path.suffix != ".a" and path.is_file():
            return path.resolve()
    return None


def _candidates() -> Iterator[Path]:
    if os.name == "nt":
        yield Path(sys.base_prefix) / f"python{sys.version_info[0]}{sys.version_info[1]}.dll"
        return
    names = [sysconfig.get_config_var(key) for key in ("INSTSONAME", "LDLIBRARY")]
    libdir = sysconfig.get_config_var("LIBDIR") or ""
    multiarch = sysconfig.get_config_var("MULTIARCH") or ""
    framework = sysconfig.get_config_var("PYTHONFRAMEWORKPREFIX") or ""
    folders = [libdir, os.path.join(libdir, multiarch), os.path.join(sys.base_prefix, "lib"), framework]
    for name in filter(None, names):
        for folder in filter(None, folders):
            yield Path(folder) / name


def library_record() -> str:
    """`libpython.txt`, for the shim: shared library (or empty line), home, a file of the standard library."""
    library = shared_library()
    return f"{library or ''}\n{sys.base_prefix}\n{os.__file__}\n"


def python_record() -> dict[str, Any]:
    """`python.json`, for `boot.py`: version, prefix, and the folders of `tlismni` and what it needs."""
    folders = [sysconfig.get_path("purelib"), sysconfig.get_path("platlib")]
    for name in NEEDED:
        spec = find_spec(name)
        if spec is not None and spec.origin:
            folders.append(str(Path(spec.origin).parent.parent))
    return {
        "version": f"{sys.version_info[0]}.{sys.version_info[1]}",
        "prefix": sys.prefix,
        "folders": list(dict.fromkeys(folders)),
        "tlismni": package_version(),
    }
