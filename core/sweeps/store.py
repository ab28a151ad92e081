"""The folder of a sweep: what was asked, and the answers in parts, so that a sweep can go on where it ended.

sweep.json           identity of problem and points, number of runs, size of a part
points.npz           the points
parts/000000.parquet answers of one part each, written whole or not at all
table.parquet        all answers, once there are all
"""

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from ..extras import require
from .problem import Outcomes, Problem

FORMAT = "tlismni-sweep-1"
Points = Mapping[str, NDArray[np.float64]]


class Store:
    """Answers of a sweep, part by part.

    Attributes
    ----------
    folder : where they are. units : of columns, as far as they are known.
    parts : number of parts; part k holds runs k size to (k + 1) size.
    """

    def __init__(self, folder: Path, points: Points, size: int, units: Mapping[str, str]) -> None:
        require("a sweep's table", "sweep", pyarrow="")
        self.folder, self.points, self.size, self.units = folder, points, size, dict(units)
        self.count = len(next(iter(points.values())))
        self.parts = -(-self.count // size)

    @classmethod
    def open(cls, folder: Path, problem: Problem, points: Points, size: int) -> "Store":
        """The folder of this problem at these points, made if there is none; the size of parts is that it began with.

        Raises
        ------
        ModelError : if the folder holds another sweep, or other files.
        """
        digest = _digest(problem, points)
        header = folder / "sweep.json"
        if header.exists():
            found = _header(header)
            if found.get("identity") != digest:
                raise ModelError(
                    f"'{folder}' holds another sweep (of {found.get('names')}, {found.get('runs')} runs): what is "
                    "swept, the model or its settings differ. Name another folder, or remove this one"
                )
            store = cls(folder, points, int(found["part"]), found.get("units", {}))
        else:
            if folder.exists() and any(folder.iterdir()):
                raise ModelError(f"'{folder}' is not empty and no sweep: name another folder")
            (folder / "parts").mkdir(parents=True, exist_ok=True)
            store = cls(folder, points, size, getattr(problem, "units", dict)())
            _whole(folder / "points.npz", lambda path: _save_points(path, points))
            content = {
                "format": FORMAT, "identity": digest, "names": list(points), "runs": store.count, "part": size,
                "units": store.units,
            }  # fmt: skip
            # last of all: a folder with a header is complete
            _whole(header, lambda path: path.write_text(json.dumps(content, indent=2), encoding="utf-8"))
        return store

    @classmethod
    def found(cls, folder: Path) -> "Store":
        """A folder that there is. Raises ModelError if it is none."""
        header = folder / "sweep.json"
        if not header.exists():
            raise ModelError(f"'{folder}' is no folder of a sweep: it has no sweep.json")
        with np.load(folder / "points.npz") as kept:
            points = {name: kept[name] for name in kept.files}
        said = _header(header)
        return cls(folder, points, int(said["part"]), said.get("units", {}))

    def part(self, k: int) -> Path:
        """File of part k."""
        return self.folder / "parts" / f"{k:06d}.parquet"

    def missing(self) -> list[int]:
        """Parts without answers."""
        return [k for k in range(self.parts) if not self.part(k).exists()]

    def points_of(self, k: int) -> dict[str, NDArray[np.float64]]:
        """Points of part k."""
        return {name: x[k * self.size : (k + 1) * self.size] for name, x in self.points.items()}

    def put(self, k: int, found: Outcomes) -> None:
        """Keep the answers of part k; their runs are numbered on from those of the parts before it."""
        import pyarrow
        from pyarrow import parquet

        columns = {**found.columns, "run": found.columns["run"] + k * self.size}
        table = pyarrow.table({name: pyarrow.array(x) for name, x in columns.items()})
        _whole(self.part(k), lambda path: parquet.write_table(table, path))

    def table(self) -> Any:
        """All answers that there are, as a table of pyarrow sorted by run and time, units in the metadata of fields."""
        import pyarrow
        from pyarrow import parquet

        parts = [parquet.read_table(self.part(k)) for k in range(self.parts) if self.part(k).exists()]
        if not parts:
            return pyarrow.table({"run": pyarrow.array([], pyarrow.int64())})
        table = pyarrow.concat_tables(parts)
        fields = [
            field.with_metadata({"unit": self.units[field.name]}) if field.name in self.units else field
            for field in table.schema
        ]
        return table.cast(pyarrow.schema(fields))

    def write_table(self) -> Path:
        """All answers in one file."""
        from pyarrow import parquet

        path = self.folder / "table.parquet"
        table = self.table()
        _whole(path, lambda name: parquet.write_table(table, name))
        return path


def _header(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ModelError(f"'{path}' cannot be read as the header of a sweep: {error}") from None
    if found.get("format") != FORMAT:
        raise ModelError(f"'{path}' has the format {found.get('format')!r}; {FORMAT!r} is known")
    return dict(found)


def _digest(problem: Problem, points: Points) -> str:
    digest = hashlib.sha256(problem.identity().encode())
    for name, x in points.items():
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(x).tobytes())
    return digest.hexdigest()


def _save_points(path: Path, points: Points) -> None:
    with open(path, "wb") as file:
        np.savez(file, allow_pickle=False, **dict(points))


def _whole(path: Path, write: Any) -> None:
    """Write a file beside `path` and put it in its place: a killed process leaves no half of it."""
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        write(beside)
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)
