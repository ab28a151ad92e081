"""Where compiled code is cached: one folder for each content of the compiled sources.

Numba looks only at the file of a function, not at the files of what it calls: after an edit or an upgrade in place it
could run old code. A folder that is named by the content of all compiled sources cannot be stale, and does not need
the package's own folder to be writable. `NUMBA_CACHE_DIR` is respected: the folder is then made inside it.
"""

import hashlib
import os
import sys
from functools import cache
from pathlib import Path

_MARKS = (b"@compiled", b"@internal", b"@inlined")
_PACKAGE = Path(__file__).resolve().parents[1]


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


@cache
def sources_digest() -> str:
    """Digest of all compiled sources of this package."""
    digest = hashlib.sha256()
    for path in sorted(_PACKAGE.rglob("*.py")):
        text = path.read_bytes()
        if any(mark in text for mark in _MARKS) or path.parent.name == "compiled" or path.name == "records.py":
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + b"\0" + text)
    return digest.hexdigest()[:16]


@cache
def cache_folder() -> Path | None:
    """Folder of the compiled code of exactly these sources; None if there is no place for one."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given:
        return Path(given).absolute() / sources_digest()
    user = user_cache()
    return None if user is None else user / "tlismni" / sources_digest()
