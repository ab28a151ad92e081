"""What tlismni keeps in the user's cache folder."""

import os
import re
import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from ..core.compiled.cache import cache_folder, user_cache
from ..core.compiled.reach import present_digests

DIGEST = re.compile(r"[0-9a-f]{16}")
"""What a folder of compiled code is called."""
KINDS = {"binaries": "binaries of FMUs", "packages": "packages of FMUs", "own": "own code of FMUs"}


@dataclass(frozen=True)
class Entry:
    """A folder that is kept: what it holds, its size in bytes, and whether these sources do not use it."""

    path: Path
    kind: str
    size: int
    old: bool


def entries() -> list[Entry]:
    """Everything that is kept, in the cache folder and in NUMBA_CACHE_DIR if that is set; nothing else is looked at."""
    users, place, present = user_cache(), cache_folder(), present_digests()
    found = []
    if users is not None and (users / "tlismni").is_dir():
        for path in sorted((users / "tlismni").iterdir()):
            if path.name in KINDS:
                found.append(Entry(path, KINDS[path.name], _size(path), False))
            elif DIGEST.fullmatch(path.name):
                found.append(Entry(path, "compiled code", _size(path), path.name not in present))
    # in a folder of numba's own only the present code is surely ours
    if place is not None and place.is_dir() and (users is None or place != users / "tlismni"):
        ours = [path for path in sorted(place.iterdir()) if path.name in present]
        found.extend(Entry(path, "compiled code", _size(path), False) for path in ours)
    return found


def remove(chosen: Iterable[Entry]) -> tuple[list[Entry], list[Entry]]:
    """Remove entries; those that are gone, and those that could not be removed."""
    gone: list[Entry] = []
    kept: list[Entry] = []
    for entry in chosen:
        shutil.rmtree(entry.path, ignore_errors=True)
        (kept if entry.path.exists() else gone).append(entry)
    return gone, kept


def _size(folder: Path) -> int:
    total = 0
    for root, _, names in os.walk(folder):
        for name in names:
            try:
                total += os.lstat(os.path.join(root, name)).st_size
            except OSError:  # another process has just removed it
                continue
    return total
