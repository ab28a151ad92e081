"""Structure: sparsity, slots, partition and factorisations for one set of engaged contacts.

An engaged contact is one whose entries belong to the matrix: closed (its row is a constraint) or acting as a
force (its stiffness is in K).
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, twin
from ..compiled.records import ArrayRecord, words_of
from ..linalg import Factorization
from ..state.workspace_records import STRUCTURE
from .assembly import Assembly, Batch
from .partitions import MOST_PARTITIONS, Partition, build_partition
from .switch import codes_of

_PARTITION = words_of(STRUCTURE)["partition"]


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
    codes: NDArray[np.int64]
    """What each contact is here (`switch.py`), (contacts,)."""
    values: NDArray[np.float64] = field(init=False)
    """The numbers in the slots, (n_values,)."""
    probe: NDArray[np.float64] = field(init=False)
    """Right-hand side (m_act,) with which the condition of the constraints is measured."""
    known: dict[bytes, Partition] = field(default_factory=dict)
    """Partitions by their dependent coordinates."""
    shared: dict[bytes, Partition] | None = None
    """The same of all runs that share this pattern, unused."""
    units: NDArray[np.float64] | None = None
    """What brings coordinates and all rows of Phi to one unit; `use_units` changes it."""
    record: ArrayRecord = field(init=False)
    """For compiled code, which chooses the present partition too."""

    _latest: Partition | None = None

    def __post_init__(self) -> None:
        self.values, self.probe = np.zeros(self.n_values), np.zeros(len(self.active))
        tables = [x for k in range(len(self.slot_s)) for x in (self.slot_s[k], self.slot_j[k], self.slot_jt[k])]
        start = np.searchsorted(self.jacobian_row, np.arange(len(self.active) + 1))
        names = (
            "values", "active", "redundant", "probe", "gradient_start", "gradient_col", "gradient_slot", "mass_slot",
            "codes", "jacobian_col", "jacobian_slot",
        )  # fmt: skip
        self.record = ArrayRecord(
            STRUCTURE,
            {
                **{name: getattr(self, name) for name in names},
                "entry_row": self.rows, "entry_col": self.cols, "jacobian_start": start,
                "slots": np.array([x.ctypes.data for x in tables], dtype=np.int64),
                "partitions": np.zeros(MOST_PARTITIONS, dtype=np.int64),
            },
            {
                "n_values": self.n_values, "m_act": len(self.active), "n_redundant": len(self.redundant),
                "n_mass": len(self.mass_slot), "n_jacobian": len(self.jacobian_slot),
                "kkt": self.kkt.address, "kkt_query": self.kkt_query.address, "partition": 0, "n_partitions": 0,
            },
        )  # fmt: skip

    @property
    def present(self) -> Partition | None:
        """The present partition."""
        address = self.record.record.word(_PARTITION)
        if self._latest is None or self._latest.record.address != address:
            self._latest = next((x for x in self.known.values() if x.record.address == address), None)
        return self._latest

    @property
    def dependent(self) -> NDArray[np.int64] | None:
        """Dependent coordinates (m_act,) of the present partition."""
        return None if self.present is None else self.present.dependent

    @property
    def lu_d(self) -> Factorization | None:
        """Factorisation of Phi_qd of the present partition."""
        return None if self.present is None else self.present.lu_d

    def use_units(self, units: NDArray[np.float64], n: int) -> None:
        """Let pivots be chosen with rows and columns in one unit: `units` (n + m + 1,) of coordinates and rows."""
        self.units = units
        both = np.concatenate([units[:n], units[n + self.active]])
        for factorization in (self.kkt, self.kkt_query):
            factorization.use_units(both, both)
        for partition in self.known.values():
            self._units_of(partition, n)

    def _units_of(self, partition: Partition, n: int) -> None:
        if self.units is not None:
            partition.lu_d.use_units(self.units[n + self.active], self.units[partition.dependent])

    def memory(self) -> tuple[list[NDArray[Any]], list[NDArray[Any]]]:
        """Own arrays and records: numbers, factorisations, and the present partition. All others never change."""
        parts = [part.memory() for part in (self.kkt, self.kkt_query, self.present) if part is not None]
        own = [self.values, self.probe, *(x for arrays, _ in parts for x in arrays)]
        return own, [self.record.table, self.record.arrays["partitions"], *(x for _, tables in parts for x in tables)]

    def moved(self, take: Take) -> "Structure":
        """The same structure in a copy of its memory (`compiled/image.py`), with its present partition alone."""
        new = twin(self)
        new.values, new.probe, new.record = take(self.values), take(self.probe), self.record.moved(take)
        new.kkt, new.kkt_query = self.kkt.moved(take), self.kkt_query.moved(take)
        new.kkt_query.known = new.kkt.known
        present = None if self.present is None else self.present.moved(take)
        new.known = {} if present is None else {present.dependent.tobytes(): present}
        new._list_partitions()
        new._choose(present)
        return new

    def _list_partitions(self) -> None:
        addresses = [partition.record.address for partition in self.known.values()]
        self.record.arrays["partitions"][: len(addresses)] = addresses
        self.record.set_size("n_partitions", len(addresses))

    def _choose(self, partition: Partition | None) -> None:
        self.record.set_size("partition", 0 if partition is None else partition.record.address)

    @property
    def nnz(self) -> int:
        """Number of entries of the matrix."""
        return len(self.rows)

    @property
    def n_values(self) -> int:
        """Number of values: those of the matrix, the gradients of contacts, and one for what belongs nowhere."""
        return len(self.rows) + len(self.gradient_slot) + 1

    def partition(self, dependent: NDArray[np.int64]) -> None:
        """Choose the dependent coordinates (m_act,): builds the factorisation of Phi_qd where it is not known yet."""
        if self.dependent is not None and np.array_equal(self.dependent, dependent):
            return  # most impacts come back to the same partition
        self._choose(self.known.get(dependent.tobytes()) or self._new_partition(dependent))

    def order_columns(self) -> None:
        """Have ready what compiled code needs first to choose pivots."""
        self.kkt.order_columns()
        self.kkt_query.order_columns(self.kkt)

    def know_partition(self, dependent: NDArray[np.int64]) -> None:
        """Have the partition with these dependent coordinates (m_act,) ready for compiled code."""
        if dependent.tobytes() not in self.known:
            self._new_partition(dependent).lu_d.order_columns()

    def _new_partition(self, dependent: NDArray[np.int64]) -> Partition:
        n, key = int(self.kkt.n) - len(self.active), dependent.tobytes()
        new = None if self.shared is None else self.shared.get(key)
        if new is None:
            jacobian = self.jacobian_row, self.jacobian_col, self.jacobian_slot
            new = build_partition(dependent, jacobian, n, self.n_values)
            if self.shared is not None and len(self.shared) < MOST_PARTITIONS:
                self.shared[key] = new
        if self.shared is not None:
            new = new.fresh()
        present = self.present
        while len(self.known) >= MOST_PARTITIONS:
            del self.known[next(key for key, x in self.known.items() if x is not present)]
        self.known[key] = new
        self._units_of(new, n)
        self._list_partitions()
        return new

    def make_wanted(self) -> None:
        """Make what compiled code has asked for to choose pivots."""
        self.kkt_query.order_columns(self.kkt)
        factorizations = [self.kkt, self.kkt_query, *(partition.lu_d for partition in self.known.values())]
        wanting = [factorization for factorization in factorizations if factorization.wants]
        for factorization in wanting:
            factorization.make_wanted()
        # what one gets to know its siblings may take
        for factorization in factorizations if wanting else ():
            factorization.have_room()

    def share(self) -> None:
        """Let structures made of this one by `fresh` and `moved` share their analyses from now on."""
        self.shared = {}

    def fresh(self) -> "Structure":
        """One of the same pattern with memory of its own, without a partition."""
        new = twin(self)
        new.kkt = self.kkt.fresh()
        new.kkt_query = new.kkt.sibling()
        new.known = {}
        new.__post_init__()
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
    kkt = Factorization(size, rows, cols, everything, source_size=len(unique) + 1)
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
        kkt_query=kkt.sibling(),
        codes=codes_of(len(assembly.contacts), closed, engaged, sticking),
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
