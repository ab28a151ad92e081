"""Memory for structures: a few places, each for one, which compiled code fills (`building.py`).

How many there are, and what was in them before, changes no bit: a structure, its partition and its pivots follow from
the state alone. Where a place turns out to be too small, compiled code says so, and `grow` gives more to all of them.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, twin
from ..compiled.records import Record, words_of
from ..linalg import LU, Matrix
from ..linalg.memory import Scratch
from ..linalg.record import DENSE, IN_INDEX, INDEX, SCRATCH, VALUES
from ..state.workspace_records import NEEDS, OF_D, OF_KKT, PARTITION, REALS, STRUCTURE, WORDS

Array = NDArray[Any]
MOST_STRUCTURES = 8
"""Kept, of models with many contacts."""
SLACK = 1.5
"""How much more is given than is asked for."""
_LUS = ("kkt", "kkt_query", "lu_d")
_STAYS = (
    "partition", "kkt", "kkt_query", "lu_d", "words_room", "reals_room", "words", "reals",
    "functions", "scratch", "needs", "program_limit", "index", "index_room", "values", "room",
)  # fmt: skip
"""Fields of the records that are the place's own."""
_READY, _SERIAL = words_of(PARTITION)["ready"], words_of(PARTITION)["serial"]


class Slot:
    """Memory for one structure.

    Attributes
    ----------
    structure, partition : (1,) records. lus : the three records of factorisations, in the order of _LUS.
    words, reals, index, values : what they point to; the last two for each factorisation.
    """

    def __init__(self) -> None:
        self.structure, self.partition = np.zeros(1, STRUCTURE), np.zeros(1, PARTITION)
        self.lus = [np.zeros(1, LU) for _ in _LUS]
        self.words, self.reals = np.zeros(0, dtype=np.int64), np.zeros(0)
        self.index: list[Array] = [np.zeros(0, dtype=np.uint32) for _ in _LUS]
        self.values: list[Array] = [np.zeros(0) for _ in _LUS]
        self.structure["partition"] = _begin(self.partition)
        for name, table in zip(_LUS, self.lus, strict=True):
            (self.partition if name == "lu_d" else self.structure)[name] = _begin(table)
        self.record = Record(self.structure)

    @property
    def address(self) -> int:
        """Of the structure's record."""
        return self.record.address

    def tables(self) -> list[Array]:
        """The records."""
        return [self.structure, self.partition, *self.lus]

    def arrays(self) -> list[Array]:
        """All other memory."""
        return [self.words, self.reals, *self.index, *self.values]

    def give(self, words: int, reals: int) -> None:
        """Memory for a structure; what was in it is lost."""
        self.words, self.reals = np.zeros(words, dtype=np.int64), np.zeros(reals)
        for name, x in (("words", self.words), ("reals", self.reals)):
            self.structure[name], self.structure[f"{name}_room"] = _begin(x), len(x)
        # addresses of what is gone must not stay
        for table in self.tables():
            for field in table.dtype.names or ():
                if field not in _STAYS:
                    table[field] = 0
        self.structure["values"] = self.partition["words"] = self.partition["reals"] = 0

    def give_matrix(self, k: int, index: int, values: int) -> None:
        """Memory for its k-th factorisation, which goes on as it was."""
        table, old = self.lus[k], int(self.lus[k]["index"][0])
        in_use = bool(table["ready"][0]) or (int(table["kind"][0]) == DENSE and int(table["n"][0]) > 0)
        new_index, new_values = np.zeros(index, dtype=np.uint32), np.zeros(values)
        new_index[: len(self.index[k])], new_values[: len(self.values[k])] = self.index[k], self.values[k]
        self.index[k], self.values[k] = new_index, new_values
        for name in IN_INDEX:
            table[name] = int(table[name][0]) + _begin(new_index) - old if in_use else 0
        table["index"], table["index_room"] = _begin(new_index), index
        table["values"], table["room"] = _begin(new_values), values

    def moved(self, take: Take, present: bool) -> "Slot":
        """The same in a copy of its memory (`compiled/image.py`); empty unless it is the present one."""
        new = twin(self)
        new.structure, new.partition = take(self.structure), take(self.partition)
        new.lus = [take(x) for x in self.lus]
        new.words, new.reals = take(self.words), take(self.reals)
        new.index, new.values = [take(x) for x in self.index], [take(x) for x in self.values]
        new.record = Record(new.structure)
        if not present:
            new.structure["built"] = 0
        return new


def _begin(x: Array) -> int:
    return int(x.__array_interface__["data"][0])


class Slots:
    """The places for structures of a run.

    Parameters
    ----------
    count : of places. functions : what `functions` of LU points to. program_limit : see LU.
    """

    def __init__(self, count: int, functions: NDArray[np.int64], program_limit: int) -> None:
        self.scratch, self.needs = Scratch(), np.zeros(NEEDS, dtype=np.int64)
        self.all = [Slot() for _ in range(count)]
        self.addresses = np.array([slot.address for slot in self.all], dtype=np.int64)
        self._functions = functions
        for slot in self.all:
            for k, table in enumerate(slot.lus):
                table["functions"], table["scratch"] = _begin(functions), _begin(self.scratch.cell)
                table["needs"] = _begin(self.needs) + 8 * (OF_D if k == 2 else OF_KKT)
                table["program_limit"] = program_limit

    def __len__(self) -> int:
        return sum(int(slot.structure["built"][0]) for slot in self.all)

    def at(self, address: int) -> Slot:
        """The place whose structure has its record at `address`."""
        return next(slot for slot in self.all if slot.address == address)

    def keep(self, count: int, present: int) -> None:
        """Give up all places but so many, of which one is at the address `present`."""
        self.all.sort(key=lambda slot: slot.address != present)
        del self.all[count:]
        self.addresses[:] = 0
        self.addresses[: len(self.all)] = [slot.address for slot in self.all]

    def ask(self, times: float) -> None:
        """Need so many times what there is, in the largest of the places."""
        for slot in self.all:
            sizes = {WORDS: slot.words, REALS: slot.reals}
            for k in range(len(_LUS)):
                of = OF_D if k == 2 else OF_KKT
                sizes |= {of + INDEX: slot.index[k], of + VALUES: slot.values[k]}
            for place, x in sizes.items():
                self.needs[place] = max(self.needs[place], int(times / SLACK * len(x)))
        self.needs[OF_KKT + SCRATCH] = int(times / SLACK * len(self.scratch.numbers))

    def grow(self, present: int) -> None:
        """Give what is needed. The structure at the address `present` stays as it is; others that have to move are
        forgotten."""
        needs = [int(SLACK * x) for x in self.needs]
        self.needs[:] = 0
        self.scratch.give(max(needs[OF_KKT + SCRATCH], needs[OF_D + SCRATCH]))
        for slot in self.all:
            if slot.address != present and (needs[WORDS] > len(slot.words) or needs[REALS] > len(slot.reals)):
                slot.give(max(needs[WORDS], len(slot.words)), max(needs[REALS], len(slot.reals)))
            for k in range(len(_LUS)):
                of = OF_D if k == 2 else OF_KKT
                index, values = needs[of + INDEX], needs[of + VALUES]
                if index > len(slot.index[k]) or values > len(slot.values[k]):
                    slot.give_matrix(k, max(index, len(slot.index[k])), max(values, len(slot.values[k])))

    def memory(self, present: int) -> tuple[list[Array], list[Array], list[Array]]:
        """Arrays, records and addresses, and what of it need not be copied."""
        tables, blank = [self.addresses, self.scratch.cell], [self.scratch.numbers]
        arrays: list[Array] = [self.needs]
        for slot in self.all:
            tables += slot.tables()
            if slot.address == present:
                tables.append(slot.words)
                arrays += [slot.reals, *slot.index, *slot.values]
            else:
                blank += slot.arrays()
        return arrays, tables, blank

    def moved(self, take: Take, present: int) -> "Slots":
        """The same in a copy of its memory (`compiled/image.py`), with the present structure alone."""
        new = twin(self)
        new.scratch, new.needs, new.addresses = self.scratch.moved(take), take(self.needs), take(self.addresses)
        new.all = [slot.moved(take, slot.address == present) for slot in self.all]
        return new


Grow = Callable[[], None]


class Partition:
    """What Python wants to see of the partition of a structure: which coordinates are dependent."""

    def __init__(self, structure: "Structure") -> None:
        slot = structure.slot
        m, view = structure.m_act, structure.view
        record = Record(slot.partition)
        self.serial = record["serial"]
        self.dependent = view(record["dependent"], m, np.int64).copy()
        """(m_act,)."""
        self.free = tuple(
            view(record[name], record["n_free"], np.int64) for name in ("free_row", "free_col", "free_slot")
        )
        """Row, column and slot of the entries of Phi_q in independent columns."""
        self.lu_d = Matrix(slot.lus[2], view, structure.grow)


class Structure:
    """What Python wants to see of the structure that a place holds: the matrix [S, Phi_q^T; Phi_q, 0] as slots, for one
    set of active rows and engaged contacts. It is valid until compiled code puts another in its place.

    Attributes
    ----------
    active : rows of Phi that are constraints now, (m_act,).
    redundant : rows of joints that repeat active ones: not solved for, but checked.
    rows, cols : coordinates of the entries of the matrix by slot, (nnz,).
    gradient_start, gradient_col, gradient_slot : entries of Phi_q in rows of contacts that are no constraints now.
    mass_slot : slots of the block S.
    jacobian_row, jacobian_col, jacobian_slot : entries of Phi_q: active rows ascending, columns ascending in each.
    values : the numbers in the slots, (n_values,), the last of which belongs nowhere.
    probe : right-hand side (m_act,) with which the condition of the constraints is measured.
    """

    def __init__(self, slot: Slot, grow: Grow, shapes: list[tuple[int, int]]) -> None:
        self.slot, self.grow, self._shapes = slot, grow, shapes
        r = self.record = slot.record
        self._words, self._reals = slot.words, slot.reals
        self.serial, self.m_act, self.n_values, self.nnz = (r[x] for x in ("serial", "m_act", "n_values", "nnz"))
        more = self.n_values - 1 - self.nnz
        # these are asked for while other structures may take the place of this one
        self.active = self._whole("active", self.m_act).copy()
        self.redundant = self._whole("redundant", r["n_redundant"]).copy()
        self.rows, self.cols = self._whole("entry_row", self.nnz), self._whole("entry_col", self.nnz)
        self.gradient_col, self.gradient_slot = self._whole("gradient_col", more), self._whole("gradient_slot", more)
        self.mass_slot = self._whole("mass_slot", r["n_mass"])
        self.jacobian_row, self.jacobian_col, self.jacobian_slot = (
            self._whole(f"jacobian_{x}", r["n_jacobian"]) for x in ("row", "col", "slot")
        )
        self.values, self.probe = (
            self.view(r[x], count, np.float64) for x, count in (("values", self.n_values), ("probe", self.m_act))
        )
        self.kkt = Matrix(slot.lus[0], self.view, grow)
        self.kkt_query = Matrix(slot.lus[1], self.view, grow, self.kkt)
        self._partition = slot.partition.view(np.int64)
        self._latest: Partition | None = None

    def _whole(self, name: str, count: int) -> NDArray[np.int64]:
        return self.view(self.record[name], count, np.int64)

    def view(self, address: int, count: int, dtype: type) -> Array:
        """`count` numbers at an address within the place."""
        for x in (self._words, self._reals, *self.slot.index, *self.slot.values) if count else ():
            at = address - _begin(x)
            if 0 <= at < x.nbytes:
                found: Array = x[at // x.itemsize :][:count]
                return found
        return np.zeros(0, dtype)

    @property
    def gradient_start(self) -> NDArray[np.int64]:
        """(m_ext,): where each row of Phi begins among the gradients."""
        first = self.record["gradient_start"]
        return self.view(first, (self.record["gradient_col"] - first) // 8, np.int64)

    @property
    def present(self) -> Partition | None:
        """The present partition."""
        words = self._partition
        if not words.item(_READY):
            return None
        if self._latest is None or self._latest.serial != words.item(_SERIAL):
            self._latest = Partition(self)
        return self._latest

    @property
    def dependent(self) -> NDArray[np.int64] | None:
        """Dependent coordinates (m_act,) of the present partition."""
        return None if self.present is None else self.present.dependent

    @property
    def lu_d(self) -> Matrix | None:
        """Factorisation of Phi_qd of the present partition."""
        return None if self.present is None else self.present.lu_d

    def table_of(self, k: int) -> NDArray[np.int64]:
        count, width = self._shapes[k]
        slots = self.view(self.record["slots"], len(self._shapes), np.int64)
        return self.view(int(slots[k]), count * width, np.int64).reshape(count, width)

    @cached_property
    def slot_s(self) -> list[NDArray[np.int64]]:
        """Slot tables of the batches for S; `n_values - 1` is the slot of what belongs nowhere."""
        return [self.table_of(k) for k in range(0, len(self._shapes), 3)]

    @cached_property
    def slot_j(self) -> list[NDArray[np.int64]]:
        """Those for Phi_q."""
        return [self.table_of(k) for k in range(1, len(self._shapes), 3)]

    @cached_property
    def slot_jt(self) -> list[NDArray[np.int64]]:
        """Those for its transpose."""
        return [self.table_of(k) for k in range(2, len(self._shapes), 3)]
