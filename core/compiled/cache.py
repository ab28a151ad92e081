"""Where compiled code is cached: one folder for each content of the sources that it depends on.

Numba looks only at the file of a function, not at the files of what it calls: after an edit or an upgrade in place it
could run old code. A folder that is named by the content of all that the function's module imports cannot be stale. It
serves every copy of these sources on the machine, stays when other sources change, and does not need the package's own
folder to be writable. A user's code may call any function of the core: its folder is named by all of them.
`NUMBA_CACHE_DIR` is respected: the folders are then made inside it.
"""

import hashlib
import os
import sys
from pathlib import Path

from .reach import reach_digest, whole_digest


def user_cache() -> Path | None:
    """The user's cache folder by the custom of the platform; None where there is neither one nor a home.

    Empty variables count as not set, and relative paths in XDG_CACHE_HOME are to be ignored (XDG Base Directory
    Specification): code would be kept in whatever folder a program is started from.
    """
    home = Path(os.path.expanduser("~"))
    if sys.platform == "win32":
        found = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif sys.platform == "darwin":
        found = home / "Library" / "Caches"
    else:
        found = Path(os.environ.get("XDG_CACHE_HOME", ""))
        found = found if found.is_absolute() else home / ".cache"
    return found if found.is_absolute() else None  # "~" stays as it is where there is no home


def cache_folder() -> Path | None:
    """The folder with all compiled code; None if there is no place for one."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given:
        return Path(given).absolute()
    user = user_cache()
    return None if user is None else user / "tlismni"


def folder_name(source: Path) -> Path:
    """Name of the folder, in `cache_folder()`, of code whose function stands in the file `source`."""
    reached = reach_digest(source)
    if reached is not None:
        return Path(reached)
    parent = source.parent
    return Path(whole_digest(), f"{parent.name}_{hashlib.sha256(str(parent).encode()).hexdigest()[:16]}")
