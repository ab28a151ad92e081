"""What an FMU records of the Python that exports it, so that a host without Python can start the same."""

import re
import sys
import sysconfig
from importlib.metadata import PackageNotFoundError, requires
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from .version import package_version

NEEDED = ("numpy", "scipy", "numba", "llvmlite", "pydantic")


def python_record(bundle: str | None = None) -> dict[str, Any]:
    """`python.json`, for `boot.py`: version, prefix, the folders of `tlismni` and what it needs, what it needs by name
    and least version; `bundle` is the digest of the package in the FMU."""
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
        "requires": requirements(),
        "bundle": bundle,
    }


def requirements() -> list[tuple[str, str]]:
    """The third-party packages that `tlismni` needs, with their least versions."""
    try:
        given = requires("tlismni") or []
    except PackageNotFoundError:
        return [(name, "0") for name in NEEDED]
    plain = [text for text in given if "extra ==" not in text]
    found = [re.match(r"([\w.-]+)\s*(?:>=\s*([\d.]+))?", text) for text in plain]
    return [(match[1], match[2] or "0") for match in found if match]
