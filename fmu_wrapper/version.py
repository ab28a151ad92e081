"""Version of the installed package."""

from functools import cache
from importlib.metadata import PackageNotFoundError, version


@cache
def package_version() -> str:
    """Version of the installed `tlismni`, or "unknown" in a source tree that was never installed."""
    try:
        return version("tlismni")
    except PackageNotFoundError:
        return "unknown"
