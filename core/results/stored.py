"""Results that come from a file."""

import json
import logging
import zipfile
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.redundancy import RedundantRow
from ..errors import ModelError
from ..events import Event, Fallback
from ..model.channels import Channel, Enumeration
from ..multibody_model import Model
from ..tolerances import OfScales
from .files import COLUMNS_ENTRY, EVENTS_ENTRY, FORMAT, HEADER_ENTRY, PARTS, STEPS_ENTRY
from .result import Result

logger = logging.getLogger(__name__)


class StoredTable:
    """The channels of a stored result: each is a column."""

    def __init__(self, channels: tuple[Channel, ...], plain: set[str], places: dict[str, list[Any]]) -> None:
        self.channels = channels
        self.index = {channel.name: k for k, channel in enumerate(channels)}
        first = 1 + len(channels)
        self.parts = {
            part: np.array([first + x if isinstance(x, int) else 1 + self.index[x] for x in found], dtype=np.intp)
            for part, found in places.items()
        }
        self._plain = plain

    def column(self, samples: NDArray[np.float64], name: str) -> NDArray[np.float64]:
        """One channel over all samples (N,). Raises KeyError for an unknown name."""
        values: NDArray[np.float64] = samples[:, 1 + self.index[name]]
        return values

    def plain_columns(self) -> dict[str, int]:
        """Channels that are columns of the run's own samples, with their columns here."""
        return {name: 1 + self.index[name] for name in self._plain}

    def contact_table(self, sample: NDArray[np.float64], group: str) -> NDArray[Any]:
        """Raises ModelError: files hold channels alone."""
        raise ModelError(
            f"this result comes from a file, which has the channels of group '{group}' and no table of its contacts: "
            "take it from the result of the run"
        )


def load_result(path: str | Path, *, allow_imports: bool | Collection[str] = False) -> Result:
    """A result that `Result.save` has stored, bit for bit.

    Parameters
    ----------
    allow_imports : modules that may be imported for own classes of its model, as in `Model.from_json`. Where they may
        not, the result comes without its model (`system` is None), which a warning in the log says.

    Raises
    ------
    ModelError : if the file cannot be read, or holds no result.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            if not hasattr(archive, "files") or HEADER_ENTRY not in archive.files:
                raise ModelError(f"'{path}' holds no whole result: write one with result.save(...) or `run --output`")
            entries = {name: archive[name] for name in archive.files}
    except (OSError, ValueError, zipfile.BadZipFile, EOFError) as error:
        if isinstance(error, ModelError):
            raise
        raise ModelError(f"result file '{path}' cannot be read: {getattr(error, 'strerror', None) or error}") from None
    try:
        return _result(entries, allow_imports)
    except (KeyError, TypeError, json.JSONDecodeError) as error:
        raise ModelError(f"result file '{path}' is damaged: {error!r}") from None


def _result(entries: dict[str, NDArray[Any]], allow_imports: bool | Collection[str]) -> Result:
    header = json.loads(str(entries[HEADER_ENTRY][()]))
    if header["format"] != FORMAT:
        raise ModelError(f"it has the format '{header['format']}', this version reads '{FORMAT}'")
    channels = tuple(_channel(**record) for record in header["channels"])
    table = StoredTable(channels, set(header["plain"]), {part: header["places"][part] for part in PARTS})
    samples = np.column_stack([entries["time"], *(entries[c.name] for c in channels), entries[COLUMNS_ENTRY]])
    return Result(
        samples,
        table,
        [Event(**event) for event in json.loads(str(entries[EVENTS_ENTRY][()]))],
        header["stats"],
        [Fallback(**record) for record in header["fallbacks"]],
        entries.get(STEPS_ENTRY),
        [
            RedundantRow(r["constraint"], r["row"], tuple(r["repeats"]), bool(r.get("of_body", False)))
            for r in header["redundant"]
        ],
        _model(header["model"], allow_imports),
        {name: _setting(x) for name, x in header["settings"].items()},
    )


def _channel(name: str, unit: str, description: str, kind: Any, enumeration: dict[str, Any] | None) -> Channel:
    meaning = None if enumeration is None else Enumeration(enumeration["name"], tuple(enumeration["items"]))
    return Channel(name, unit, description, kind, meaning)


def _setting(value: Any) -> Any:
    return OfScales(value["OfScales"]) if isinstance(value, dict) and set(value) == {"OfScales"} else value


def _model(text: str | None, allow_imports: bool | Collection[str]) -> Model | None:
    if text is None:
        return None
    if allow_imports is False and json.loads(text).get("imports"):
        logger.warning("the result comes without its model, whose own classes may not be imported: allow_imports")
        return None
    return Model.from_json(text, allow_imports=allow_imports)
