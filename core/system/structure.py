"""Structure: sparsity, slots, partition and factorisations for one set of engaged contacts.

An engaged contact is one whose entries belong to the matrix: closed (its row is a constraint) or acting as a
force (its stiffness is in K).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, twin
from ..linalg import Factorization
from .assembly import Assembly, Batch

MOST_PARTITIONS = 32
"""Kept for runs that share a pattern."""


@dataclass
class Structure:
    """The matrix [S, Phi_q^T; Phi_q, 0] as slots, for one set of active rows and engaged contacts."""

    active: NDArray[np.int64]
    """Rows of Phi that are constraints now, (m_act,)."""
    redundant: NDArray[np.int64]
    """Rows of joints that repeat active ones: not solved for, but checked."""
    rows: NDArray[np.int64]
    cols: NDArray[np.int64]
    """Coordinates of the entries of the matrix by slot, (nnz,)."""
    slot_s: list[NDArray[np.int64]]
    slot_j: list[NDArray[np.int64]]
    slot_jt: list[NDArray[np.int64]]
    """Slot tables of the batches; `n_values - 1` is the slot of what belongs nowhere."""
    gradient_start: NDArray[np.int64]
    gradient_col: NDArray[np.int64]
    gradient_slot: NDArray[np.int64]
    """Entries of Phi_q in rows of contacts that are no constraints now, row by row of Phi: their places in `values`
    come after those of the matrix. An impact needs them, and changes no pattern for it."""
    mass_slot: NDArray[np.int64]
    """Slots of the block S."""
    jacobian_row: NDArray[np.int64]
    jacobian_col: NDArray[np.int64]
    jacobian_slot: NDArray[np.int64]
    """Entries of Phi_q: rows of the active constraints in ascending order, columns ascending within each, and slots."""
    kkt: Factorization
    kkt_query: Factorization
    lu_d: Factorization | None = None
    dependent: NDArray[np.int64] | None = None
    probe: NDArray[np.float64] | None = None
    """Right-hand side (m_act,) with which the condition of the constraints is measured."""
    free: tuple[NDArray[np.int64], ...] = ()
    """Row, column and slot of the entries of Phi_q in independent columns."""

    partitions: dict[bytes, tuple[Any, Factorization]] | None = None
    """Of runs that share this pattern: `free` and an unused factorisation for each choice of dependent coordinates."""

    units: NDArray[np.float64] | None = None
    """What brings coordinates and all rows of Phi to one unit; `use_units` changes it."""

    def use_units(self, units: NDArray[np.float64], n: int) -> None:
        """Let pivots be chosen with rows and columns in one unit: `units` (n + m + 1,) of coordinates and rows."""
        self.units = units
        both = np.concatenate([units[:n], units[n + self.active]])
        for factorization in (self.kkt, self.kkt_query):
            factorization.use_units(both, both)
        self._units_of_partition(n)

    def _units_of_partition(self, n: int) -> None:
        if self.units is not None and self.lu_d is not None and self.dependent is not None:
            self.lu_d.use_units(self.units[n + self.active], self.units[self.dependent])

    def _factorizations(self) -> dict[str, Factorization]:
        found = {"kkt": self.kkt, "kkt_query": self.kkt_query, "lu_d": self.lu_d}
        return {name: factorization for name, factorization in found.items() if factorization is not None}

    def memory(self) -> tuple[list[NDArray[Any]], list[NDArray[Any]]]:
        """Own arrays and records: those of the factorisations. All others never change."""
        parts = [factorization.memory() for factorization in self._factorizations().values()]
        return [x for arrays, _ in parts for x in arrays], [x for _, tables in parts for x in tables]

    def moved(self, take: Take) -> "Structure":
        """The same structure in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        for name, factorization in self._factorizations().items():
            setattr(new, name, factorization.moved(take))
        return new

    @property
    def nnz(self) -> int:
        """Number of entries of the matrix."""
        return len(self.rows)

    @property
    def n_values(self) -> int:
        """Number of values: those of the matrix, the gradients of contacts, and one for what belongs nowhere."""
        return len(self.rows) + len(self.gradient_slot) + 1

    def partition(self, dependent: NDArray[np.int64]) -> None:
        """Choose the dependent coordinates (m_act,): builds the factorisations of Phi_qd."""
        if self.dependent is not None and np.array_equal(self.dependent, dependent):
            return  # most impacts come back to the same partition
        n = int(self.kkt.n) - len(self.active)
        key = dependent.tobytes()
        known = None if self.partitions is None else self.partitions.get(key)
        if known is None:
            known = self._partition_of(n, dependent)
            if self.partitions is not None and len(self.partitions) < MOST_PARTITIONS:
                known[1].analyses = {}
                self.partitions[key] = known
        self.dependent = np.ascontiguousarray(dependent, dtype=np.int64)
        self.free, self.lu_d = known[0], known[1] if self.partitions is None else known[1].fresh()
        self._units_of_partition(n)

    def _partition_of(self, n: int, dependent: NDArray[np.int64]) -> tuple[Any, Factorization]:
        position = np.full(n, -1, dtype=np.int64)
        position[dependent] = np.arange(len(dependent))
        is_dependent = position[self.jacobian_col] >= 0
        free, bound = np.flatnonzero(~is_dependent), np.flatnonzero(is_dependent)
        parts = tuple(np.ascontiguousarray(x[free]) for x in (self.jacobian_row, self.jacobian_col, self.jacobian_slot))
        rows, cols = self.jacobian_row[bound], position[self.jacobian_col[bound]]
        slots = self.jacobian_slot[bound]
        return parts, Factorization(len(self.active), rows, cols, slots, source_size=self.n_values)

    def share(self) -> None:
        """Let structures made of this one by `fresh` and `moved` share their analyses from now on."""
        self.partitions = {}
        self.kkt.analyses = self.kkt_query.analyses = {}

    def fresh(self) -> "Structure":
        """One of the same pattern with memory of its own."""
        new = twin(self)
        for name, factorization in self._factorizations().items():
            setattr(new, name, factorization.fresh())
        return new


def build_structure(
    assembly: Assembly,
    closed: frozenset[int],
    engaged: frozenset[int],
    sticking: frozenset[int] = frozenset(),
    dropped: frozenset[int] = frozenset(),
) -> Structure:
    """Structure with contacts `closed` as constraints, along the tangent too for those `sticking`, and `engaged`
    (closed or acting) in the pattern of S, without the redundant rows `dropped`."""
    n, ground = assembly.n, assembly.ground
    closed_rows = {assembly.contacts[k].row for k in closed} | {assembly.contacts[k].slide_row for k in sticking}
    left_out = dropped | {row for row, contacts in assembly.replaced_rows.items() if contacts & closed}
    active = np.array(
        [row for row in range(assembly.m) if (row < assembly.m_joints and row not in left_out) or row in closed_rows],
        dtype=np.int64,
    )
    size = n + len(active)
    contact_rows = np.array([r for c in assembly.contacts for r in (c.row, c.slide_row) if r >= 0], dtype=np.int64)
    # rows of the matrix, and below it those that are watched only
    matrix_row = np.full(assembly.m + 1, -1, dtype=np.int64)
    watched = np.setdiff1d(contact_rows, active)
    matrix_row[watched] = size + watched
    matrix_row[active] = n + np.arange(len(active))
    entries: list[tuple[NDArray[np.int64], NDArray[np.int64]]] = [(np.arange(n), np.arange(n))]
    placed: list[list[tuple[NDArray[np.int64], Any]]] = []
    for batch in assembly.batches:
        placed.append(_places(batch, ground, matrix_row, size, engaged))
        for places in placed[-1]:
            keep = places[0] >= 0
            entries.append((places[0][keep], places[1][keep]))
    keys = np.concatenate([row * size + col for row, col in entries])
    unique = np.unique(keys)
    count = int(np.searchsorted(unique, size * size))
    rows, cols = unique[:count] // size, unique[:count] % size
    gradient_row, gradient_col = unique[count:] // size - size, unique[count:] % size

    def slots(places: Any) -> NDArray[np.int64]:
        row, col = places
        found = np.searchsorted(unique, row * size + col)
        return np.ascontiguousarray(np.where(row >= 0, found, len(unique)))

    tables = [[slots(places) for places in batch] for batch in placed]
    everything = np.arange(count)
    jacobian = np.flatnonzero((rows >= n) & (cols < n))
    kkt, kkt_query = (Factorization(size, rows, cols, everything, source_size=len(unique) + 1) for _ in range(2))
    return Structure(
        active,
        redundant=np.array(sorted(dropped), dtype=np.int64),
        rows=rows,
        cols=cols,
        slot_s=[t[0] for t in tables],
        slot_j=[t[1] for t in tables],
        slot_jt=[t[2] for t in tables],
        gradient_start=np.searchsorted(gradient_row, np.arange(assembly.m + 1)),
        gradient_col=np.ascontiguousarray(gradient_col),
        gradient_slot=np.arange(count, len(unique)),
        mass_slot=np.flatnonzero((rows < n) & (cols < n)),
        jacobian_row=rows[jacobian] - n,
        jacobian_col=cols[jacobian],
        jacobian_slot=jacobian,
        kkt=kkt,
        kkt_query=kkt_query,
    )


def _places(batch: Batch, ground: int, matrix_row: NDArray[np.int64], size: int, engaged: frozenset[int]) -> Any:
    """(row, col) of every local entry of S, Phi_q and Phi_q^T, each (count, entries); -1: belongs nowhere."""
    count, width = batch.coord.shape
    rows = batch.row.shape[1] if batch.row.size else 0
    takes_part = np.array([c < 0 or c in engaged for c in batch.contact])[:, None]

    s_row = np.full((count, width * width), -1, dtype=np.int64)
    s_col = s_row.copy()
    for i, j in batch.tangent_pattern:
        here = takes_part[:, 0] & (batch.coord[:, i] < ground) & (batch.coord[:, j] < ground)
        s_row[here, i * width + j] = batch.coord[here, i]
        s_col[here, i * width + j] = batch.coord[here, j]
    j_row = np.full((count, max(rows, 1) * width), -1, dtype=np.int64)
    j_col = j_row.copy()
    for k, j in batch.jacobian_pattern:
        where = matrix_row[batch.row[:, k]]
        here = (where >= 0) & (batch.coord[:, j] < ground)
        j_row[here, k * width + j] = where[here]
        j_col[here, k * width + j] = batch.coord[here, j]
    # of rows below the matrix there is no transpose
    above = np.where(j_row < size, j_col, -1)
    return (s_row, s_col), (j_row, j_col), (above, j_row)
