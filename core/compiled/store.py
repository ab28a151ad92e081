"""Files of compiled code: written whole or not at all, and read only if they are what was written.

Each entry is one file that starts with a digest of its key and its content. What was cut short by a full disk or a
power failure, or was changed since, is removed, and compiled anew. Where nothing can be read or written, the process
goes on with what it has in memory, and says so once.
"""

import hashlib
import logging
import os
import uuid
from pathlib import Path

from .notices import tell

_MARK = b"tlismni compiled code 1\n"
_told: set[str] = set()


def load(path: Path, key: bytes) -> bytes | None:
    """The content that was saved under `key`; None if there is none, or it was damaged and has been removed."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        _tell_once(
            "read", f"compiled code cannot be read from '{path}' ({error.strerror or error}): it is compiled anew"
        )
        return None
    head, content = data[: len(_MARK) + 32], data[len(_MARK) + 32 :]
    if head != _MARK + _digest(key, content):
        discard(path, "it is not what was written there")
        return None
    return content


def save(path: Path, key: bytes, content: bytes) -> None:
    """Keep `content` under `key`. What is in the way is told once, and is no error: the code is in memory."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = path.with_name(f"{path.name}.{uuid.uuid4().hex[:16]}.tmp")
        try:
            temporary.write_bytes(_MARK + _digest(key, content) + content)
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        _tell_once(
            "keep",
            f"compiled code cannot be kept in '{path.parent}' ({error.strerror or error}): this process goes on with "
            "what it has in memory, and the next one compiles again; make room there, or set NUMBA_CACHE_DIR to a "
            "folder that can be written",
        )


def discard(path: Path, reason: str) -> None:
    """Remove a damaged entry, and say so."""
    tell(logging.WARNING, f"the compiled code in '{path}' is damaged ({reason}): it is removed and compiled anew")
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        _tell_once("remove", f"'{path}' cannot be removed ({error.strerror or error})")


def no_place() -> None:
    """Say once that there is no folder to keep anything in."""
    _tell_once(
        "keep",
        "compiled code is not kept, as there is neither a home nor a cache folder: this process goes on with what it "
        "has in memory, and the next one compiles again; set NUMBA_CACHE_DIR to a folder that can be written",
    )


def _digest(key: bytes, content: bytes) -> bytes:
    return hashlib.sha256(hashlib.sha256(key).digest() + content).digest()


def _tell_once(reason: str, text: str) -> None:
    """Say `text` unless something was said for this `reason`, which holds for hundreds of functions alike."""
    if reason not in _told:
        _told.add(reason)
        tell(logging.WARNING, text)
