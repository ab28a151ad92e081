"""A result as a file: CSV, JSON or NPZ. Each is written whole or not at all."""

import csv
import json
import os
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..core import Result
from .errors import Failure
from .screen import plain


def write_result(result: Result, path: Path) -> Path:
    """Write all channels of `result`; the kind of file follows from the suffix."""
    columns = {"time": result.t, **{name: result[name] for name in result.channels}}
    if path.suffix.lower() == ".csv":
        return write_csv(path, columns)
    events = [event.to_dict() for event in result.events]
    if path.suffix.lower() == ".npz":
        # the events as JSON text: an archive without pickled objects opens everywhere
        texts = {"events": np.array(json.dumps(plain(events)))}
        return replace_whole(path, lambda name: np.savez(name, allow_pickle=False, **columns, **texts))
    units = {"time": "s", **{channel.name: channel.unit for channel in result.channel_records}}
    data = plain({"units": units, "columns": columns, "events": events, "statistics": result.stats})
    return replace_whole(path, lambda name: Path(name).write_text(json.dumps(data), encoding="utf-8"))


def write_csv(path: Path, columns: dict[str, Any]) -> Path:
    """Columns of equal length, with a line of names. Numbers read back as the same doubles."""

    def write(name: str) -> None:
        with open(name, "w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(columns)
            writer.writerows(_rows(list(columns.values())))

    return replace_whole(path, write)


def _rows(columns: Sequence[Any]) -> Iterable[Sequence[Any]]:
    # tolist gives Python floats, whose text is the shortest that reads back as the same number
    return zip(*(np.asarray(column).tolist() for column in columns), strict=True)


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
