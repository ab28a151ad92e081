"""Snapshot: what decides the future of a run, copied as it lies in memory and put in normal form (`normal_form.py`).

Its bulk is the state's buffer (`assembly/state_fields.py`). The rest are the factors of the matrices, whose size
changes with the structure, and what Python keeps. Beside it goes what has been counted and noted so far, which decides
nothing."""

import math
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..assembly.slots import MATRICES
from ..assembly.state_fields import STATE_ARRAYS
from ..assembly.structure_switch import Key
from .normal_form import normalise_buffer

if TYPE_CHECKING:
    from .simulation import Simulation

OF_QUERY = 1
"""Whose factors are computed anew whenever they are used: what decides of them are pivots and limits."""
_OF_METHOD = ("history", "times", "ring", "parameters", "weights", "error", "choice")

Whole: TypeAlias = NDArray[np.int64]
Real: TypeAlias = NDArray[np.float64]


class Factors(NamedTuple):
    """Of one factorisation: place of rows and columns in the pivot sequence, values, pivots of a dense one."""

    perm_r: NDArray[np.int64]
    perm_c: NDArray[np.int64]
    values: NDArray[np.float64]
    pivots: NDArray[np.int64]


class Snapshot(NamedTuple):
    """The parts of a `State`."""

    buffer: NDArray[np.uint8]
    """The bytes of `Workspace.state`."""
    layout: np.dtype
    """Its type."""
    factors: tuple[Factors, ...]
    """In the order of MATRICES."""
    dependent: NDArray[np.int64]
    probe: NDArray[np.float64]
    compatibility: NDArray[np.float64]
    key: Key
    """Contacts closed, engaged and sticking, and rows that others imply."""
    dropped: frozenset[int]
    t: float
    pending: tuple[int, ...]
    handled: tuple[float, int]
    outer: str
    start_open: bool
    input_times: tuple[float, float]
    initial_energy: float
    counters: NDArray[np.int64]
    """Beside the state."""
    fallbacks: tuple[Any, ...]
    """Beside the state."""
    """Beside the state."""

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays by name."""
        names = (*STATE_ARRAYS, *(f"method_{name}" for name in _OF_METHOD), "clock", "watch", "guard")
        state = self.buffer.view(self.layout)
        arrays: dict[str, NDArray[Any]] = {name: state[name][0] for name in names}
        arrays["dependent"], arrays["probe"] = self.dependent, self.probe
        arrays["compatibility"] = self.compatibility
        for name, factors in zip(MATRICES, self.factors, strict=False):
            arrays |= {f"{name}_{part}": x for part, x in factors._asdict().items()}
        return arrays

    def facts(self) -> dict[str, Any]:
        """What is no array, as JSON data."""
        closed, engaged, sticking, implied = self.key
        return {
            "t": self.t,
            "closed": sorted(closed),
            "dropped": sorted(self.dropped),
            "engaged": sorted(engaged),
            "sticking": sorted(sticking),
            "implied": sorted(implied),
            "pending": list(self.pending),
            "handled": [repr(self.handled[0]), self.handled[1]],
            "outer": self.outer,
            "start_open": self.start_open,
            "input_times": [repr(x) for x in self.input_times],
            "initial_energy": repr(self.initial_energy),
        }

    def past(self) -> dict[str, Any]:
        """What goes beside, as JSON data."""
        return {
            "counters": self.counters.tolist(),
            "fallbacks": [[f.t, f.outer, f.reason] for f in self.fallbacks],
        }


def _copied(rows: Whole, columns: Whole, values: Real, pivots: Whole) -> Factors:
    return Factors(rows.copy(), columns, values.copy(), pivots.copy())


def _for_queries(rows: Whole, columns: Whole, values: Real, pivots: Whole) -> Factors:
    """Of the matrix for queries, whose factors are computed anew whenever they are used: of a sparse one pivots and
    limits decide, of a dense one nothing."""
    if len(pivots):
        return Factors(rows, columns, *_nothing(len(pivots)))
    limits = values.copy()
    limits[: -len(rows)] = 0.0
    return Factors(rows.copy(), columns, limits, pivots)


@cache
def _nothing(n: int) -> tuple[Real, Whole]:
    """Values and pivots of a dense matrix of size n that has never been factored."""
    values, pivots = np.zeros(n * (n + 1)), np.arange(n)
    values.flags.writeable = pivots.flags.writeable = False
    return values, pivots


def take_snapshot(sim: "Simulation") -> Snapshot:
    """Copy everything that decides the future."""
    workspace, structure, drive = sim.workspace, sim.workspace.structure, sim.drive
    partition = structure.present
    if partition is None:
        raise RuntimeError("a simulation always has a partition once it is built")
    buffer = workspace.state_bytes.copy()
    normalise_buffer(drive.record.record, buffer.__array_interface__["data"][0])
    factors = [_copied(*lu.parts()) for lu in (structure.kkt, *partition.factorizations)]
    factors.insert(OF_QUERY, _for_queries(*structure.kkt_query.parts()))
    now, handled_at = sim.t_internal, drive.goals.handled_at
    return Snapshot(
        buffer,
        workspace.state.dtype,
        tuple(factors),
        partition.dependent,
        structure.arrays["probe"].copy(),
        structure.compatibility.copy(),
        workspace.key,
        workspace.dropped,
        sim.t,
        tuple(sim.pending),
        (handled_at, drive.counts.here) if handled_at == now else (math.nan, 0),
        sim.outer,
        sim.start_open,
        sim.input_times,
        sim.table.initial_energy,
        workspace.arrays["counters"].copy(),
        tuple(sim.fallbacks),
    )  # fmt: skip


def snapshot_of(
    arrays: dict[str, NDArray[Any]], facts: dict[str, Any], past: dict[str, Any], layout: np.dtype, fallback: Any
) -> Snapshot:
    """The parts from arrays, facts and `past` that have been read; `fallback` makes one of those.

    Raises
    ------
    ValueError : for an array of another shape.
    """
    state = np.zeros(1, layout)
    for name in layout.names or ():
        state[name][0][...] = arrays[name]
    return Snapshot(
        state.view(np.uint8),
        layout,
        tuple(
            [
                Factors(*(arrays[f"{name}_{part}"] for part in Factors._fields))
                for name in MATRICES
                if f"{name}_perm_r" in arrays
            ]
        ),
        arrays["dependent"],
        np.ascontiguousarray(arrays["probe"]),
        np.ascontiguousarray(arrays["compatibility"]),
        (
            frozenset(facts["closed"]),
            frozenset(facts["engaged"]),
            frozenset(facts["sticking"]),
            frozenset(facts["implied"]),
        ),
        frozenset(facts["dropped"]),
        float(facts["t"]),
        tuple(int(k) for k in facts["pending"]),
        (float(facts["handled"][0]), int(facts["handled"][1])),
        facts["outer"],
        bool(facts["start_open"]),
        (float(facts["input_times"][0]), float(facts["input_times"][1])),
        float(facts["initial_energy"]),
        np.array(past["counters"], dtype=np.int64),
        tuple(fallback(*entry) for entry in past["fallbacks"]),
    )
