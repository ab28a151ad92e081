"""A partition of the coordinates: which are dependent, and the factorisation of Phi_qd that goes with it.

With velocity-level rows W v = w there are two: dependent velocities, one for each row, from [Phi_q; W], and dependent
positions from Phi_q alone, the pivots of its rows, which come first. All other positions are integrated.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take
from ..compiled.records import ArrayRecord
from ..linalg import Factorization
from ..state.workspace_records import PARTITION

MOST_PARTITIONS = 32
"""Kept for one pattern."""


class Partition(NamedTuple):
    """One choice of dependent coordinates."""

    dependent: NDArray[np.int64]
    """(m_act,)."""
    free: tuple[NDArray[np.int64], ...]
    """Row, column and slot of the entries of Phi_q in independent columns."""
    lu_d: Factorization
    lu_p: Factorization | None
    """Of Phi_qd for dependent positions alone, in models with velocity-level rows."""
    record: ArrayRecord
    """For compiled code."""

    @property
    def factorizations(self) -> tuple[Factorization, ...]:
        """Its one or two."""
        return (self.lu_d,) if self.lu_p is None else (self.lu_d, self.lu_p)

    def fresh(self) -> "Partition":
        """The same with factorisations of its own."""
        return _partition(self.dependent, self.free, *(lu.fresh() for lu in self.factorizations))

    def moved(self, take: Take) -> "Partition":
        """The same partition in a copy of its memory (`compiled/image.py`)."""
        lu_p = None if self.lu_p is None else self.lu_p.moved(take)
        return Partition(self.dependent, self.free, self.lu_d.moved(take), lu_p, self.record.moved(take))

    def memory(self) -> tuple[list[NDArray[Any]], list[NDArray[Any]]]:
        """Own arrays and records."""
        parts = [lu.memory() for lu in self.factorizations]
        return [x for arrays, _ in parts for x in arrays], [
            *(x for _, tables in parts for x in tables),
            self.record.table,
        ]


def build_partition(
    dependent: NDArray[np.int64],
    jacobian: tuple[NDArray[np.int64], ...],
    n: int,
    source_size: int,
    m_held: int | None = None,
) -> Partition:
    """The partition with the coordinates `dependent` (m_act,) of n; `jacobian`: rows, columns and slots of the entries
    of Phi_q in an array of `source_size`; `m_held`: the first of them depend at position level too, None: all do."""
    rows, cols, slots = jacobian
    position = np.full(n, -1, dtype=np.int64)
    position[dependent] = np.arange(len(dependent))
    place = position[cols]
    free, bound = np.flatnonzero(place < 0), np.flatnonzero(place >= 0)
    parts = tuple(np.ascontiguousarray(x[free]) for x in jacobian)

    def square(size: int, entries: NDArray[np.int64]) -> Factorization:
        return Factorization(size, rows[entries], place[entries], slots[entries], source_size=source_size)

    lu_p = None if m_held is None else square(m_held, bound[(rows[bound] < m_held) & (place[bound] < m_held)])
    return _partition(np.ascontiguousarray(dependent, dtype=np.int64), parts, square(len(dependent), bound), lu_p)


def _partition(
    dependent: NDArray[np.int64],
    free: tuple[NDArray[np.int64], ...],
    lu_d: Factorization,
    lu_p: Factorization | None = None,
) -> Partition:
    names = ("free_row", "free_col", "free_slot")
    arrays: Mapping[str, NDArray[Any]] = {"dependent": dependent, **dict(zip(names, free, strict=True))}
    # where all rows have a position form, one does for both
    of_positions = lu_d if lu_p is None or lu_p.n == lu_d.n else lu_p
    record = ArrayRecord(
        PARTITION, arrays, {"n_free": len(free[0]), "lu_d": lu_d.address, "lu_p": of_positions.address}
    )
    return Partition(dependent, free, lu_d, lu_p, record)
