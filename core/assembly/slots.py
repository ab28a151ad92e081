"""Memory for structures: a few places, each for one, which compiled code fills (`building.py`).

How many there are, and what was in them before, changes no bit: a structure, its partition and its pivots follow from
the state alone. Where places turn out to be too small, compiled code says so, and `grow` gives larger ones, to which
all that is there moves with its addresses.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, begin_of, twin
from ..compiled.records import Record
from ..linalg import LU
from ..linalg.memory import Scratch
from ..linalg.record import INDEX, SCRATCH, VALUES
from ..state.workspace_records import NEEDS, OF_D, OF_KKT, PARTITION, REALS, STRUCTURE, WORDS

Array = NDArray[Any]
MOST_STRUCTURES = 32
"""Kept, where they are small."""
SLACK = 1.5
"""How much more is given than is asked for."""
MATRICES = ("kkt", "kkt_query", "lu_d", "lu_p")
"""Factorisations of a workspace. The last one is there in models with velocity-level rows only."""
_OF = (OF_KKT, OF_KKT, OF_D, OF_D)
"""Where in `needs` the sizes of each of them begin."""
_RECORDS = {"structures": (STRUCTURE, 1), "partitions": (PARTITION, 1), "lus": (LU, len(MATRICES))}
"""Records of each place: their type, and how many."""


class Slots:
    """The places for structures of a run.

    Parameters
    ----------
    count : of places. functions : what `functions` of LU points to. program_limit : see LU.
    batches : number of batches, each with three tables of slots and one of its elements' lines in them.

    Attributes
    ----------
    words : the records of all places by name, as numbers, (count, fields).
    tables : (count, 4 batches), the addresses of these tables.
    pool : all their other memory; as numbers of 4 bytes, so that nobody takes its content for addresses.
    rooms : (NEEDS,) sizes that each place has room for, by kind as in `needs`.
    """

    def __init__(self, count: int, functions: NDArray[np.int64], program_limit: int, batches: int) -> None:
        self.scratch, self.needs = Scratch(), np.zeros(NEEDS, dtype=np.int64)
        self.rooms = np.zeros(NEEDS, dtype=np.int64)
        self._functions = functions
        self.words = {
            name: np.zeros((count, each * kind.itemsize // 8), dtype=np.int64)
            for name, (kind, each) in _RECORDS.items()
        }
        self._records: dict[str, Array] = {}
        self.tables, self.addresses = np.zeros((count, 4 * batches), dtype=np.int64), np.zeros(count, dtype=np.int64)
        self._use(np.zeros(0, dtype=np.uint32))
        self.lus["program_limit"] = program_limit
        self._connect()
        self._place()

    def _use(self, pool: NDArray[np.uint32]) -> None:
        self.pool, self._pool_begin = pool, begin_of(pool)

    def _table(self, name: str) -> Array:
        if name not in self._records:
            found = self.words[name].view(_RECORDS[name][0])
            self._records[name] = found if found.shape[1] > 1 else found[:, 0]
        return self._records[name]

    @property
    def structures(self) -> Array:
        """(count,) records."""
        return self._table("structures")

    @property
    def partitions(self) -> Array:
        """(count,) records."""
        return self._table("partitions")

    @property
    def lus(self) -> Array:
        """(count, 4) records, in the order of MATRICES."""
        return self._table("lus")

    def record(self, name: str, number: int) -> Record:
        """That of the place with this number among "structures" or "partitions"."""
        return Record(self.words[name][number], _RECORDS[name][0])

    def _connect(self) -> None:
        """Write down where records and what they share are."""
        count = len(self.structures)
        self.addresses[:] = begin_of(self.structures) + STRUCTURE.itemsize * np.arange(count)
        self.structures["partition"] = begin_of(self.partitions) + PARTITION.itemsize * np.arange(count)
        self.structures["slots"] = begin_of(self.tables) + 8 * self.tables.shape[1] * np.arange(count)
        positions = self.partitions["used_p"].copy()
        of_both = positions == self.partitions["lu_d"]
        matrices = begin_of(self.lus) + LU.itemsize * np.arange(self.lus.size).reshape(self.lus.shape)
        for k, name in enumerate(MATRICES):
            (self.structures if k < 2 else self.partitions)[name] = matrices[:, k]
            self.lus["needs"][:, k] = begin_of(self.needs) + 8 * _OF[k]
        # built ones know which of their two matrices serves for positions
        follows = np.where(of_both, self.partitions["lu_d"], self.partitions["lu_p"])
        self.partitions["used_p"] = np.where(positions == 0, 0, follows)
        self.lus["functions"], self.lus["scratch"] = begin_of(self._functions), begin_of(self.scratch.cell)

    def _sizes(self) -> NDArray[np.int64]:
        """Bytes of each part of a place: one word more than is used, since addresses may be those of its end."""
        rooms = self.rooms
        parts = [8 * int(rooms[WORDS]), 8 * int(rooms[REALS])]
        for of in _OF:
            parts += [8 * (-(-int(rooms[of + INDEX]) // 2)), 8 * int(rooms[of + VALUES])]
        return np.array(parts, dtype=np.int64) + 8

    def _place(self) -> None:
        """Write down where each place has its memory, and how much."""
        sizes = self._sizes()
        starts = np.cumsum(sizes) - sizes
        begin = begin_of(self.pool) + int(sizes.sum()) * np.arange(len(self.structures))
        for k, (name, of) in enumerate((("words", WORDS), ("reals", REALS))):
            self.structures[name], self.structures[f"{name}_room"] = begin + starts[k], self.rooms[of]
        for k, of in enumerate(_OF):
            self.lus["index"][:, k], self.lus["index_room"][:, k] = begin + starts[2 + 2 * k], self.rooms[of + INDEX]
            self.lus["values"][:, k], self.lus["room"][:, k] = begin + starts[3 + 2 * k], self.rooms[of + VALUES]

    def __len__(self) -> int:
        return int(np.sum(self.structures["built"] != 0))

    def index(self, address: int) -> int:
        """Number of the place whose structure has its record at `address`."""
        return (address - self.addresses.item(0)) // STRUCTURE.itemsize

    def view(self, address: int, count: int, dtype: Any) -> Array:
        """`count` numbers at an address within the pool."""
        at = address - self._pool_begin
        if not count or not 0 <= at < self.pool.nbytes:
            return np.zeros(0, dtype)
        return np.ndarray(count, dtype, self.pool, at)

    def keep(self, count: int, present: int) -> None:
        """Have so few places from now on, of which the first is that of the structure at the address `present`. Whoever
        knows addresses has to be told `where` it is."""
        chosen = [self.index(present), *(k for k in range(len(self.structures)) if k != self.index(present))][:count]
        old, stride = begin_of(self.pool), int(self._sizes().sum())
        pool = np.concatenate([self.pool[k * stride // 4 : (k + 1) * stride // 4] for k in chosen])
        self.words, self._records = {name: x[chosen] for name, x in self.words.items()}, {}
        self._use(pool)
        self.tables, self.addresses = self.tables[chosen], np.zeros(count, dtype=np.int64)
        for number, place in enumerate(chosen):
            offset = begin_of(pool) + number * stride - old - place * stride
            for words in self._words(number):
                inside = (words >= old + place * stride) & (words < old + (place + 1) * stride)
                words[inside] += offset
        self._connect()
        self._place()
        self.structures["built"][1:] = 0

    def _words(self, number: int) -> list[NDArray[np.int64]]:
        """The records of a place as words, and its table of addresses."""
        return [*(x[number] for x in self.words.values()), self.tables[number]]

    def ask(self, times: float) -> None:
        """Need so many times what there is."""
        self.needs[:] = np.maximum(self.needs, (times / SLACK * self.rooms).astype(np.int64))
        self.needs[OF_KKT + SCRATCH] = int(times / SLACK * len(self.scratch.numbers))

    def ask_for_as_much_as(self, other: "Slots") -> None:
        """Need what another run of the same model has."""
        self.needs[:] = np.maximum(self.needs, (other.rooms / SLACK).astype(np.int64) + 1)
        self.needs[OF_KKT + SCRATCH] = len(other.scratch.numbers) / SLACK + 1

    def grow(self, others: list[NDArray[np.int64]]) -> bool:
        """Give what is needed; True if places have moved. `others` are the words of records that know addresses of
        what is in them: these are moved along."""
        needs = (SLACK * self.needs).astype(np.int64)
        self.needs[:] = 0
        self.scratch.give(int(max(needs[OF_KKT + SCRATCH], needs[OF_D + SCRATCH])))
        needs[[OF_KKT + SCRATCH, OF_D + SCRATCH]] = 0
        if np.all(needs <= self.rooms):
            return False
        old, sizes, count = self.pool, self._sizes(), len(self.structures)
        self.rooms[:] = np.maximum(self.rooms, needs)
        new_sizes = self._sizes()
        stride, new_stride = int(sizes.sum()), int(new_sizes.sum())
        starts, new_starts = np.cumsum(sizes) - sizes, np.cumsum(new_sizes) - new_sizes
        self._use(np.zeros(count * new_stride // 4, dtype=np.uint32))
        if len(old):
            # memory that is not touched costs nothing: there is something in the places of structures only
            built = np.flatnonzero(self.structures["built"])
            rows, new_rows = old.reshape(count, -1), self.pool.reshape(count, -1)
            for start, new_start, size in zip(starts // 4, new_starts // 4, sizes // 4, strict=True):
                for number in built.tolist():
                    new_rows[number, new_start : new_start + size] = rows[number, start : start + size]
            begin, new_begin = begin_of(old), begin_of(self.pool)
            for x in (*(x for k in range(count) for x in self._words(k)), *others):
                inside = np.flatnonzero((x >= begin) & (x < begin + old.nbytes))
                if len(inside):
                    place, within = np.divmod(x[inside] - begin, stride)
                    part = np.searchsorted(starts, within, side="right") - 1
                    x[inside] = new_begin + place * new_stride + new_starts[part] + within - starts[part]
        self._place()
        return True

    def memory(self) -> tuple[list[Array], list[Array], list[Array]]:
        """Arrays, records and addresses, and what of it need not be copied."""
        tables = [*self.words.values(), self.tables, self.addresses, self.scratch.cell]
        return [self.needs, self.pool], tables, [self.scratch.numbers]

    def moved(self, take: Take) -> "Slots":
        """The same in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        new.scratch, new.needs = self.scratch.moved(take), take(self.needs)
        new.words, new._records = {name: take(x) for name, x in self.words.items()}, {}
        new._use(take(self.pool))
        new.tables, new.addresses, new.rooms = take(self.tables), take(self.addresses), self.rooms.copy()
        return new
