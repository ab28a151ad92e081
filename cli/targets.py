"""What commands work on and where results go: refused before any work is done if nothing can be written there."""

import tempfile
from pathlib import Path

from .errors import Failure


def check_file(path: Path | None) -> None:
    """Refuse a file that cannot be written. Raises Failure, which names it."""
    if path is None:
        return
    if path.is_dir():
        raise Failure(f"'{path}' cannot be written: it is a folder; name a file in it")
    _check_place(path, path.parent)


def check_folder(path: Path | None) -> None:
    """Refuse a folder in which no file can be made. Raises Failure, which names it."""
    if path is not None:
        _check_place(path, path)


def _check_place(target: Path, folder: Path) -> None:
    # a nameless file in the nearest folder that there is: permissions alone do not tell (root, read-only disks)
    there = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    try:
        with tempfile.TemporaryFile(dir=there):
            pass
    except OSError as error:
        raise Failure(f"'{target}' cannot be written: '{there}': {error.strerror or error}") from None


def is_system_file(source: str) -> bool:
    """True if `source` means a system file."""
    return source.lower().endswith(".toml")
