"""A partition of the coordinates: which are dependent, and the factorisation of Phi_qd that goes with it."""

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
    record: ArrayRecord
    """For compiled code."""

    def fresh(self) -> "Partition":
        """The same with a factorisation of its own."""
        return _partition(self.dependent, self.free, self.lu_d.fresh())

    def moved(self, take: Take) -> "Partition":
        """The same partition in a copy of its memory (`compiled/image.py`)."""
        return Partition(self.dependent, self.free, self.lu_d.moved(take), self.record.moved(take))

    def memory(self) -> tuple[list[NDArray[Any]], list[NDArray[Any]]]:
        """Own arrays and records."""
        arrays, tables = self.lu_d.memory()
        return arrays, [*tables, self.record.table]


def build_partition(
    dependent: NDArray[np.int64], jacobian: tuple[NDArray[np.int64], ...], n: int, source_size: int
) -> Partition:
    """The partition with the coordinates `dependent` (m_act,) of n; `jacobian`: rows, columns and slots of the entries
    of Phi_q in an array of `source_size`."""
    rows, cols, slots = jacobian
    position = np.full(n, -1, dtype=np.int64)
    position[dependent] = np.arange(len(dependent))
    is_dependent = position[cols] >= 0
    free, bound = np.flatnonzero(~is_dependent), np.flatnonzero(is_dependent)
    parts = tuple(np.ascontiguousarray(x[free]) for x in jacobian)
    lu_d = Factorization(len(dependent), rows[bound], position[cols[bound]], slots[bound], source_size=source_size)
    return _partition(np.ascontiguousarray(dependent, dtype=np.int64), parts, lu_d)


def _partition(dependent: NDArray[np.int64], free: tuple[NDArray[np.int64], ...], lu_d: Factorization) -> Partition:
    names = ("free_row", "free_col", "free_slot")
    arrays: Mapping[str, NDArray[Any]] = {"dependent": dependent, **dict(zip(names, free, strict=True))}
    record = ArrayRecord(PARTITION, arrays, {"n_free": len(free[0]), "lu_d": lu_d.address})
    return Partition(dependent, free, lu_d, record)
