"""Inputs on the command line: numbers, and columns of CSV files."""

from collections.abc import Collection, Iterable
from pathlib import Path

import numpy as np
import typer

from ..core import Courses, Model
from .errors import Failure

TIME = ("time", "t", "time_s")
"""What the column of times may be called."""


def read_inputs(
    given: Iterable[str], model: Model, between: str = "linear", parameters: Collection[str] = ()
) -> Courses | None:
    """What `--input` says: NAME=VALUE, or a CSV file with a line of names, times in its column `time`.

    parameters : names that are no inputs, but set by `--set`.

    Raises
    ------
    BadParameter : for what is neither. Failure : for a file that cannot be read. ModelError : for unknown names.
    """
    constant: dict[str, float] = {}
    course: Courses | None = None
    names = [record.name for record in model.inputs]
    for text in given:
        name, separator, value = (part.strip() for part in text.partition("="))
        if separator and name in parameters and name not in names:
            raise Failure(f"'{name}' is a parameter, not an input: give it by --set {name}={value}; inputs are {names}")
        if separator and not Path(text).exists():
            try:
                constant[name] = float(value)
            except ValueError:
                raise typer.BadParameter(f"'{value}' is not a number", param_hint="--input") from None
        elif course is not None:
            raise typer.BadParameter("only one file of inputs can be read", param_hint="--input")
        else:
            course = _read_file(Path(text), between)
    if course is None and not constant:
        return None
    if course is None:
        found = Courses([0.0], {name: [x] for name, x in constant.items()})
    else:
        both = sorted(set(constant) & set(course.values))
        if both:
            raise typer.BadParameter(f"{both} are given as numbers and in the file", param_hint="--input")
        more = {name: np.full(len(course.times), x) for name, x in constant.items()}
        found = Courses(course.times, {**course.values, **more}, course.between)
    found.check(names)
    return found


def _read_file(path: Path, between: str) -> Courses:
    import csv

    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    except OSError as error:
        raise Failure(f"'{path}' cannot be read: {error.strerror or error}") from None
    if len(rows) < 2:
        raise Failure(f"'{path}' needs a line of names and at least one of numbers below it")
    names = [name.strip() for name in rows[0]]
    places = [k for k, name in enumerate(names) if name.lower() in TIME]
    if len(places) != 1:
        raise Failure(f"'{path}' needs one column called 'time', in s; its columns are {names}")
    table = []
    for line, row in enumerate(rows[1:], start=2):
        try:
            table.append([float(x) for x in row])
        except ValueError:
            raise Failure(f"'{path}', row {line}: {row} are not numbers (commas part columns)") from None
        if len(row) != len(names):
            raise Failure(f"'{path}', row {line} has {len(row)} columns, the line of names {len(names)}")
    columns = np.array(table).T
    values = {name: columns[k] for k, name in enumerate(names) if k != places[0]}
    return Courses(columns[places[0]], values, between)  # type: ignore[arg-type]
