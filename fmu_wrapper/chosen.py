"""Which variables an FMU shows: chosen outputs, and no numbers of a protected model."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from difflib import get_close_matches
from fnmatch import fnmatchcase

from .errors import ExportError
from .variables import Variable, VariableTable

SECRET = ("solver", "scenario", "parameter", "law")
"""Blocks of variables that tell what a model is made of, and how it is solved."""


def with_outputs(table: VariableTable, wanted: Sequence[str]) -> VariableTable:
    """The table with those channels only whose names match one of `wanted` ("rod.angle", "stop.*"); none given: all.

    Raises
    ------
    ExportError : for a pattern that no channel matches.
    """
    if not wanted:
        return table
    names = [v.name for v in table.block("channel")]
    for pattern in wanted:
        if not any(fnmatchcase(name, pattern) for name in names):
            near = get_close_matches(pattern, names, 3)
            hint = f"did you mean {near}?" if near else f"there are {names}"
            raise ExportError(f"outputs: no channel is called '{pattern}'; {hint}")
    return _kept(table, lambda v: v.block != "channel" or any(fnmatchcase(v.name, pattern) for pattern in wanted))


def without_secrets(table: VariableTable) -> VariableTable:
    """The table without parameters, contact laws and solver settings, and without words about outputs."""
    kept = _kept(table, lambda v: v.block not in SECRET)
    return VariableTable(replace(v, description="") if v.block == "channel" else v for v in kept.variables)


def _kept(table: VariableTable, keep: Callable[[Variable], bool]) -> VariableTable:
    """The variables that are kept, with new value references: these are 1, 2, 3, ..."""
    return VariableTable(replace(v, reference=k) for k, v in enumerate(filter(keep, table.variables), start=1))
