"""Which memory of a run decides nothing: it may hold anything between two calls (`tests/core/test_state_memory.py`)."""

from typing import Any

from numpy.typing import NDArray

_OF_WORKSPACE = (
    "r", "q_star", "v_star", "base_q", "base_v", "base_a", "weight_q", "weight_v", "offset", "phi", "phid", "phidd",
    "coef", "energy", "monitor", "stage_v", "stage_a", "stage_rows", "rhs", "scratch",
    "query_kept", "basis", "counters", "spin", "spinning", "turned",
)  # fmt: skip
_OF_LOOP = (
    *(f"probe_{name}" for name in ("q", "v", "a", "r", "lam", "phi", "phid", "phidd", "monitor")),
    "travel", "brackets", "samples", "log",
)  # fmt: skip
_OF_DRIVE = ("found", "events", "nearest", "last_trial")
OF_EXCHANGE = ("before", "sample", "channels")
"""Scratch of the record `exchange` works with."""


def scratch_of(sim: Any) -> list[NDArray[Any]]:
    """The scratch arrays of a simulation."""
    found = []
    for arrays, names in (
        (sim.workspace.arrays, _OF_WORKSPACE),
        (sim._loop.arrays, _OF_LOOP),
        (sim.drive.record.arrays, _OF_DRIVE),
        (sim.crossing._record.arrays, OF_EXCHANGE),
    ):
        found += [arrays[name] for name in names]
    found += [*sim.drive.instant.scratch(), *sim.beginning.scratch]
    found.append(sim.workspace.slots.scratch.numbers)
    return found


def own_of(sim: Any) -> list[NDArray[Any]]:
    """All memory that a run writes into, scratch included."""
    arrays, tables = sim.workspace.memory()
    own = [*arrays, *tables, *sim.drive.instant.tables(), *sim.drive.instant.scratch()]
    for record in (sim._method, sim._loop, sim.drive.record, sim.crossing._record):
        own += [record.table, *(x for name, x in record.arrays.items() if name not in _CONSTANT)]
    own += [*sim.workspace.blank(), *_of_beginning(sim)]
    return own


def _of_beginning(sim: Any) -> list[NDArray[Any]]:
    """Of the start: `numbers` is set where runs begin at another time; all else are numbers of the model."""
    arrays = sim.beginning.record.arrays
    return [sim.beginning.record.table, sim.beginning.numbers, arrays["turned"], *sim.beginning.scratch]


_CONSTANT = (
    "near", "leap", "breakpoints", "law", "restitution", "rest_ratio", "friction", "places", "summed", "number",
    "column", "signs", "flags", "flag_columns", "force_law", "force_numbers", "least_approach", "ends_early",
    "by_approach", "impulse_account", "dissipation_account", "bristles", "bristle_stiffness", "marker_columns",
    "marker_offsets", "marker_angles", "marker_channels", "kinds", "forced",
)  # fmt: skip
"""Arrays of the records that a run never writes into."""
