"""A result as a file, written whole or not at all."""

import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ..core import Result
from ..core.results.files import export, write_arrays, write_csv
from .errors import Failure
from .screen import plain


def write_result(result: Any, path: Path, channels: list[str] | None = None) -> Path:
    """Write a result, or what has columns and events as a result has; the kind of file follows from the suffix.

    channels : of a table; None: all.
    """
    if path.suffix.lower() != ".npz":
        return replace_whole(path, lambda name: export(result, name, channels))
    if isinstance(result, Result):
        return replace_whole(path, result.save)
    # the events as JSON text: an archive without pickled objects opens everywhere
    events = np.array(json.dumps(plain([event.to_dict() for event in result.events])))
    arrays = {"time": result.t, **{name: result[name] for name in result.channels}, "events": events}
    return replace_whole(path, lambda name: write_arrays(Path(name), arrays))


def write_table(path: Path, columns: dict[str, Any]) -> Path:
    """Columns of equal length as CSV, with a line of names."""
    return replace_whole(path, lambda name: write_csv(Path(name), columns))


def replace_whole(path: Path, write: Callable[[str], Any]) -> Path:
    """Let `write` fill a file beside `path`, then put it in its place. Missing folders are made.

    Raises
    ------
    Failure : if it cannot be written; names `path`.
    """
    try:
        return _replace_whole(path, write)
    except OSError as error:
        # the system speaks of the temporary file, of which the user knows nothing
        raise Failure(f"'{path}' cannot be written: {error.strerror or error}") from error


def _replace_whole(path: Path, write: Callable[[str], Any]) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(suffix=path.suffix, dir=path.parent)
    os.close(handle)
    try:
        write(temporary)
        # mkstemp gives a file that only its owner may read
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    return path
