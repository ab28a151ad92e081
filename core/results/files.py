"""A result as a file: whole, to be read again, or its channels as a table for others."""

import csv
import io
import json
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from ..extras import require
from ..multibody_model import Model
from ..tolerances import OfScales
from .tables import columns, descriptions, to_xarray, units
from .text import name_of

if TYPE_CHECKING:
    from .result import Result

FORMAT = "tlismni-result-1"
HEADER_ENTRY, COLUMNS_ENTRY, STEPS_ENTRY, EVENTS_ENTRY = "tlismni.header", "tlismni.columns", "tlismni.steps", "events"
"""Entries of a stored result beside "time" and the channels."""
PARTS = ("q", "v", "a", "multipliers")
EPOCH = (1980, 1, 1, 0, 0, 0)


def save(result: "Result", path: str | Path) -> Path:
    """Store a whole result as .npz, which `load_result` gives back bit for bit and numpy reads too: "time" and a column
    a channel, "events" as JSON text, the model as JSON text in "tlismni.header".

    Raises
    ------
    ModelError : for a file of another kind.
    """
    target = Path(path)
    if target.suffix.lower() != ".npz":
        raise ModelError(f"'{path}' must end in .npz to hold a whole result; tables for others are written by `export`")
    plain, layout = result.plain_columns(), result.layout
    by_column = {column: name for name, column in plain.items()}
    places: dict[str, list[Any]] = {}
    rest: list[NDArray[np.float64]] = []
    for part in PARTS:
        places[part] = []
        for column in np.arange(result.samples.shape[1])[layout[part]].tolist():
            if column in by_column:
                places[part].append(by_column[column])
            else:
                places[part].append(len(rest))
                rest.append(result.samples[:, column])
    header = {
        "format": FORMAT,
        "model": result.system.to_json() if isinstance(result.system, Model) else None,
        "channels": [asdict(channel) for channel in result.channel_records],
        "plain": sorted(plain),
        "places": places,
        "stats": result.stats,
        "settings": _plain_settings(result.settings),
        "fallbacks": [asdict(f) for f in result.fallbacks],
        "redundant": [asdict(r) for r in result.redundant],
    }
    arrays: dict[str, NDArray[Any]] = {
        **columns(result),
        EVENTS_ENTRY: np.array(json.dumps([event.to_dict() for event in result.events])),
        HEADER_ENTRY: np.array(json.dumps(header)),
        COLUMNS_ENTRY: np.column_stack(rest) if rest else np.zeros((len(result), 0)),
    }
    if result.step_log is not None:
        arrays[STEPS_ENTRY] = result.step_log
    write_arrays(target, arrays)
    return target


def write_arrays(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """A .npz with entries of any name; equal arrays give equal bytes."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, values in arrays.items():
            stream = io.BytesIO()
            np.lib.format.write_array(stream, np.asanyarray(values), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy", EPOCH), stream.getvalue(), zipfile.ZIP_DEFLATED)


def _plain_settings(settings: Mapping[str, Any]) -> dict[str, Any]:
    return {name: {"OfScales": float(x)} if isinstance(x, OfScales) else x for name, x in settings.items()}


def export(result: "Result", path: str | Path, channels: Iterable[str] | None = None) -> Path:
    """Write channels as a table: .csv, .json, .parquet, .nc (NetCDF) or .h5 (HDF5), with units but for CSV.

    Raises
    ------
    ModelError : for a file of another kind.
    MissingExtraError : without the library that writes it. KeyError : for an unknown channel.
    """
    target = Path(path)
    writers = {".csv": _csv, ".json": _json, ".parquet": _parquet, ".nc": _netcdf, ".h5": _hdf5, ".hdf5": _hdf5}
    write = writers.get(target.suffix.lower())
    if write is None:
        raise ModelError(f"'{path}' must end in {', '.join(writers)}; .npz, the whole result, is written by `save`")
    write(result, target, None if channels is None else tuple(channels))
    return target


Channels = tuple[str, ...] | None


def _csv(result: "Result", path: Path, channels: Channels) -> None:
    write_csv(path, columns(result, channels))


def write_csv(path: Path, table: Mapping[str, Any]) -> None:
    """Columns of equal length, with a line of names. Numbers read back as the same doubles."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(table)
        # tolist gives Python floats, whose text is the shortest that reads back as the same number
        writer.writerows(zip(*(np.asarray(column).tolist() for column in table.values()), strict=True))


def _json(result: "Result", path: Path, channels: Channels) -> None:
    table, known = columns(result, channels), units(result)
    data = {
        "units": {name: known[name] for name in table},
        "columns": {name: _numbers(x) for name, x in table.items()},
        "events": [event.to_dict() for event in result.events],
        "statistics": result.stats,
    }
    path.write_text(json.dumps(data, allow_nan=False, default=float), encoding="utf-8")


def _numbers(values: NDArray[np.float64]) -> list[float | None]:
    """JSON has no word for numbers that are none."""
    return [x if ok else None for x, ok in zip(values.tolist(), np.isfinite(values).tolist(), strict=True)]


def _parquet(result: "Result", path: Path, channels: Channels) -> None:
    require(f"'{path.name}'", "data", pyarrow="")
    import pyarrow
    from pyarrow import parquet

    table, known, texts = columns(result, channels), units(result), descriptions(result)
    fields = [
        pyarrow.field(name, pyarrow.float64(), metadata={"unit": known[name], "description": texts[name]})
        for name in table
    ]
    schema = pyarrow.schema(fields, metadata={"model": name_of(result), "source": "tlismni"})
    parquet.write_table(pyarrow.table(dict(table), schema=schema), path)


def _netcdf(result: "Result", path: Path, channels: Channels) -> None:
    require(f"'{path.name}'", "data", xarray="", h5netcdf="")
    to_xarray(result, channels).to_netcdf(path, engine="h5netcdf")


def _hdf5(result: "Result", path: Path, channels: Channels) -> None:
    require(f"'{path.name}'", "data", h5py="")
    import h5py

    known, texts = units(result), descriptions(result)
    with h5py.File(path, "w") as file:
        file.attrs["model"], file.attrs["source"] = name_of(result), "tlismni"
        for name, values in columns(result, channels).items():
            data = file.create_dataset(name, data=values)
            data.attrs["units"], data.attrs["long_name"] = known[name], texts[name]
        file.attrs["events"] = json.dumps([event.to_dict() for event in result.events])
