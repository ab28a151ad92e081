"""Version of the installed package."""

from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

VERSION_FILE = "bundled_version.txt"
"""In a package that an FMU carries along: the version of what was installed where it was exported."""


@cache
def package_version() -> str:
    """Version of the installed `tlismni`, or "unknown" in a source tree that was never installed."""
    bundled = Path(__file__).with_name(VERSION_FILE)
    if bundled.is_file():
        return bundled.read_text(encoding="utf-8")
    try:
        return version("tlismni")
    except PackageNotFoundError:
        return "unknown"
