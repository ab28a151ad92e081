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


def _user_cache() -> Path:
    """The user's cache folder by the custom of the platform."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))


@cache
def cache_folder() -> Path:
    """Folder of the compiled code of exactly these sources."""
    digest = hashlib.sha256()
    for path in sorted(_PACKAGE.rglob("*.py")):
        text = path.read_bytes()
        if any(mark in text for mark in _MARKS) or path.parent.name == "compiled" or path.name == "records.py":
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + b"\0" + text)
    given = os.environ.get("NUMBA_CACHE_DIR")
    return (Path(given) if given else _user_cache() / "tlismni") / digest.hexdigest()[:16]
