"""What Python sees of the structures and partitions that compiled code has built (`building.py`)."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Arrays
from ..compiled.records import words_of
from ..compiled.weakly import Weakly
from ..linalg import Matrix
from ..linalg.factorization import Grow
from ..state.workspace_records import PARTITION, STRUCTURE
from .slots import MATRICES, Slots
from .structure_switch import Key, key_of

Array = NDArray[Any]
_READY, _SERIAL = words_of(PARTITION)["ready"], words_of(PARTITION)["serial"]
_WORD = words_of(STRUCTURE)
OF_STRUCTURE = (
    "values", "probe", "active", "redundant", "gradient_start", "gradient_col", "gradient_slot", "mass_slot",
    "entry_row", "entry_col",
)  # fmt: skip
"""Arrays that the record of the workspace takes over."""
OF_PARTITION = ("dependent", "free_row", "free_col", "free_slot")
"""The same of its partition: dependent coordinates; row, column and slot of the entries of Phi_q in independent
columns."""
_NAMES = {"entry_row": "rows", "entry_col": "cols"}


def _matrix(slots: Slots, number: int, name: str, give_room: Grow, like: Matrix | None = None) -> Matrix:
    """One of the factorisations of the place with this number."""
    k = MATRICES.index(name)
    return Matrix(slots.lus[number, k : k + 1], slots.view, give_room, like)


class Partition:
    """The partition of a structure.

    With velocity-level rows W v = w there are two: dependent velocities, one for each row, from [Phi_q; W], and
    dependent positions from Phi_q alone, the pivots of its rows, which come first. All other positions are integrated.
    """

    def __init__(self, slots: Slots, number: int, m_act: int, two: bool, give_room: Grow) -> None:
        self._slots, self._number, self._two, self._give_room = slots, number, two, give_room
        self._record = slots.record("partitions", number)
        self.serial = self._record["serial"]
        self.dependent = slots.view(self._record["dependent"], m_act, np.int64).copy()
        """(m_act,)."""

    def array(self, name: str) -> NDArray[np.int64]:
        """One of OF_PARTITION."""
        return self.dependent if name == "dependent" else self._slots.view(
            self._record[name], self._record["n_free"], np.int64
        )  # fmt: skip

    @cached_property
    def lu_d(self) -> Matrix:
        """Factorisation of Phi_qd."""
        return _matrix(self._slots, self._number, "lu_d", self._give_room)

    @cached_property
    def lu_p(self) -> Matrix | None:
        """Of Phi_qd for dependent positions alone, in models with velocity-level rows."""
        return _matrix(self._slots, self._number, "lu_p", self._give_room) if self._two else None

    @property
    def factorizations(self) -> tuple[Matrix, ...]:
        """Its one or two."""
        return (self.lu_d,) if self.lu_p is None else (self.lu_d, self.lu_p)


class Structure:
    """The matrix [S, Phi_q^T; Phi_q, 0] as slots, for one set of active rows and engaged contacts: valid until compiled
    code puts another in its place.

    Attributes
    ----------
    active : rows of Phi that are constraints now, (m_act,): those with a position form first, `m_held` of them.
    multiplier_rows : rows of Phi that have multipliers: the active ones, and the implied ones behind them.
    two_partitions : whether dependent positions may be others than dependent velocities.
    redundant : rows of joints that repeat active ones: not solved for, but checked.
    n_implied : rows of joints and of closed contacts that others imply: not solved for, but with multipliers.

    Parameters
    ----------
    shapes : number of elements, of their coordinates and of their rows, of each batch.
    two : see `two_partitions`.
    give_room : gives the memory that `slots` say is needed.
    """

    def __init__(self, slots: Slots, address: int, shapes: list[tuple[int, ...]], two: bool, give_room: Grow) -> None:
        self.slots, self.two_partitions, self.address = slots, two, address
        self._shapes, self._give_room, self._number = shapes, give_room, slots.index(address)
        self.record = slots.record("structures", self._number)
        self.serial, self.m_act, self.m_held = self._word("serial"), self._word("m_act"), self._word("m_held")
        self.n_values, self.nnz = self._word("n_values"), self._word("nnz")
        # these are asked for while other structures may take the place of this one
        self.active = self._whole("active", self.m_act).copy()
        self.n_implied = self._word("n_implied")
        self.multiplier_rows = self._whole("active", self.m_act + self.n_implied).copy()
        self.redundant = self._whole("redundant", self._word("n_redundant")).copy()
        self._codes = self.codes.copy()
        self._partition = slots.words["partitions"][self._number]
        self._latest: Partition | None = None

    def _word(self, name: str) -> int:
        return self.record.word(_WORD[name])

    def view(self, address: int, count: int, dtype: Any) -> Array:
        """`count` numbers at an address within the place."""
        return self.slots.view(address, count, dtype)

    def _whole(self, name: str, count: int) -> NDArray[np.int64]:
        return self.view(self._word(name), count, np.int64)

    @cached_property
    def key(self) -> Key:
        """Contacts closed, engaged and sticking, and rows that others imply."""
        return key_of(self._codes)

    @cached_property
    def arrays(self) -> dict[str, Array]:
        """Its arrays under the names that they have in the record of the workspace, as long as they do not move."""
        return Arrays(OF_STRUCTURE, Weakly(self._array))

    def _array(self, name: str) -> Array:
        return np.asarray(getattr(self, _NAMES.get(name, name)))

    @property
    def codes(self) -> NDArray[np.int64]:
        """What each contact is here (`structure_switch.py`), (contacts,)."""
        return self._whole("codes", (self._word("active") - self._word("codes")) // 8)

    @property
    def rows(self) -> NDArray[np.int64]:
        """Rows of the entries of the matrix by slot, (nnz,)."""
        return self._whole("entry_row", self.nnz)

    @property
    def cols(self) -> NDArray[np.int64]:
        """Their columns."""
        return self._whole("entry_col", self.nnz)

    @property
    def gradient_start(self) -> NDArray[np.int64]:
        """(m_ext,): where each row of Phi begins among the gradients: entries of Phi_q in rows of contacts that are no
        constraints now, and cannot be evaluated alone."""
        return self._whole("gradient_start", (self._word("gradient_col") - self._word("gradient_start")) // 8)

    @property
    def gradient_col(self) -> NDArray[np.int64]:
        """Columns of the gradients."""
        return self._whole("gradient_col", self.n_values - 1 - self.nnz)

    @property
    def gradient_slot(self) -> NDArray[np.int64]:
        """Their places in `values`, behind the matrix."""
        return self._whole("gradient_slot", self.n_values - 1 - self.nnz)

    @property
    def mass_slot(self) -> NDArray[np.int64]:
        """Slots of the block S."""
        return self._whole("mass_slot", self._word("n_mass"))

    @property
    def jacobian_row(self) -> NDArray[np.int64]:
        """Rows of the entries of Phi_q: active rows ascending, columns ascending in each."""
        return self._whole("jacobian_row", self._word("n_jacobian"))

    @property
    def jacobian_col(self) -> NDArray[np.int64]:
        """Their columns."""
        return self._whole("jacobian_col", self._word("n_jacobian"))

    @property
    def jacobian_slot(self) -> NDArray[np.int64]:
        """Their slots."""
        return self._whole("jacobian_slot", self._word("n_jacobian"))

    @property
    def values(self) -> NDArray[np.float64]:
        """The numbers in the slots, (n_values,), the last of which belongs nowhere."""
        return self.view(self._word("values"), self.n_values, np.float64)

    @property
    def probe(self) -> NDArray[np.float64]:
        """Right-hand side (m_act,) with which the condition of the constraints is measured."""
        return self.view(self._word("probe"), self.m_act, np.float64)

    @property
    def compatibility(self) -> NDArray[np.float64]:
        """Numbers of the rows of compatibility, one row after another, (n_sharing,) (`redundant_reactions.py`)."""
        return self.view(self._word("compatibility"), self._word("n_sharing"), np.float64)

    @property
    def sharing(self) -> NDArray[np.int64]:
        """Places of the multipliers that these numbers are of, (n_sharing,)."""
        return self._whole("sharing", self._word("n_sharing"))

    @property
    def sharing_row(self) -> NDArray[np.int64]:
        """Row of compatibility that each of these numbers is in, (n_sharing,)."""
        return np.repeat(np.arange(self.n_implied), np.diff(self._whole("sharing_start", self.n_implied + 1)))

    def matrix(self, name: str, like: Matrix | None = None) -> Matrix:
        """One of the factorisations."""
        return _matrix(self.slots, self._number, name, self._give_room, like)

    @cached_property
    def kkt(self) -> Matrix:
        """Of the equations of stages."""
        return self.matrix("kkt")

    @cached_property
    def kkt_query(self) -> Matrix:
        """The same for accelerations between them."""
        return self.matrix("kkt_query", self.kkt)

    @property
    def present(self) -> Partition | None:
        """The present partition."""
        if not self._partition.item(_READY):
            return None
        if self._latest is None or self._latest.serial != self._partition.item(_SERIAL):
            self._latest = Partition(self.slots, self._number, self.m_act, self.two_partitions, self._give_room)
        return self._latest

    @property
    def dependent(self) -> NDArray[np.int64] | None:
        """Dependent coordinates (m_act,) of the present partition."""
        return None if self.present is None else self.present.dependent

    @property
    def lu_d(self) -> Matrix | None:
        """Factorisation of Phi_qd of the present partition."""
        return None if self.present is None else self.present.lu_d

    @property
    def lu_p(self) -> Matrix | None:
        """That for positions alone, where it is another one."""
        return None if self.present is None or self.m_held == self.m_act else self.present.lu_p

    def table_of(self, k: int) -> NDArray[np.int64]:
        """Table k of slots with a line for each element: three of each batch, for S, Phi_q and its transpose;
        `n_values - 1` is the slot of what belongs nowhere."""
        count, width, rows = self._shapes[k // 3]
        wide = width * (width if k % 3 == 0 else max(rows, 1))
        addresses = self.slots.tables[self._number, 4 * (k // 3) : 4 * (k // 3) + 4]
        own = self.view(int(addresses[3]), count, np.int64) if addresses[3] else np.arange(count)
        lines = int(own.max()) + 1
        return self.view(int(addresses[k % 3]), lines * wide, np.int64).reshape(lines, wide)[own]

    @property
    def slot_s(self) -> list[NDArray[np.int64]]:
        """Slot tables of the batches for S."""
        return [self.table_of(k) for k in range(0, 3 * len(self._shapes), 3)]

    @property
    def slot_j(self) -> list[NDArray[np.int64]]:
        """Those for Phi_q."""
        return [self.table_of(k) for k in range(1, 3 * len(self._shapes), 3)]

    @property
    def slot_jt(self) -> list[NDArray[np.int64]]:
        """Those for its transpose."""
        return [self.table_of(k) for k in range(2, 3 * len(self._shapes), 3)]
