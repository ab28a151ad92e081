"""The Python side of the linear solver: memory, analysis, and what restores a solver's state."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled.records import Record
from ..compiled.records import words_of as words_of_record
from .analyze import analyze, follow, lay_out_now, use_pivots, words_of
from .check_pattern import LARGEST_INDEX, check_pattern
from .errors import SingularMatrixError
from .memory import Scratch, addresses
from .record import DENSE, INDEX, LU, MATRIX_KINDS, OK, PROGRAM_LIMIT, SCRATCH, VALUES, WANT_ROOM
from .singular import singular_place
from .solve import factor, solve

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
View = Callable[[int, int, type], NDArray]
Grow = Callable[[], None]

# Largest n that is factored densely. Measured (benchmarks/linalg_timing.py): from n = 5 on the sparse refactorisation
# is faster, but at these sizes by a tenth of a microsecond only, and small models save the seconds in which numba
# compiles the symbolic analysis on a first run.
DENSE_LIMIT = 8
_PLACES = words_of_record(LU)
_NO_PIVOTS, _NO_FACTORS = np.empty(0, np.int64), np.empty(0)


class Matrix:
    """A factorisation whose record stands at a place of memory that its owner keeps.

    Parameters
    ----------
    table : (1,) LU, the record.
    view : gives the words at an address: view(address, count, dtype).
    grow : gives what `needs` of the record says.
    like : another of the same pattern, which this one has followed if its own columns have no order yet.

    Attributes
    ----------
    record : the LU record for `factor` and `solve`.
    """

    def __init__(self, table: NDArray, view: View, grow: Grow, like: "Matrix | None" = None) -> None:
        self._table, self._view, self._grow, self._like = table, view, grow, like
        self._seen: dict[str, tuple[int, int, NDArray]] = {}
        self._known, self._parts = b"", (_NO_PIVOTS, _NO_PIVOTS, _NO_FACTORS, _NO_PIVOTS)
        self.record = Record(table.view(np.int64).reshape(-1), table.dtype)
        """What to hand to a compiled function."""

    def _at(self, field: str, count: int, dtype: type = np.int64) -> NDArray:
        address = self._word(field)
        seen = self._seen.get(field)
        if seen is None or seen[0] != address or seen[1] != count:
            seen = self._seen[field] = address, count, self._view(address, count, dtype)
        return seen[2]

    def _word(self, field: str) -> int:
        return self.record.word(_PLACES[field])

    @property
    def n(self) -> int:
        """Size of the matrix."""
        return self._word("n")

    @property
    def dense(self) -> bool:
        """Whether it is factored densely."""
        return self._word("kind") == DENSE

    @property
    def kind(self) -> str:
        """Of the refactorisation: "dense", "program" or "columns"; "unready" before the first analysis."""
        return MATRIX_KINDS[self.record["kind"]]

    @property
    def address(self) -> int:
        """Address of the record, to be stored in another record."""
        return self.record.address

    def parts(self) -> tuple[Ints, Ints, Floats, Ints]:
        """What decides its solutions, for who copies it: place of each row and each column in the pivot sequence,
        factors with the limits on the growth of L, pivots of a dense one. Views until the next analysis."""
        facts = self.record.data.tobytes()  # one comparison in place of a dozen questions
        if facts != self._known:
            self._known, self._parts = facts, self._find_parts()
        return self._parts

    def _find_parts(self) -> tuple[Ints, Ints, Floats, Ints]:
        n = self.n
        if self.dense:
            return _NO_PIVOTS, _NO_PIVOTS, self._at("values", n * (n + 1), np.float64), self._at("pivots", n)
        if not self._word("ready"):
            return _NO_PIVOTS, _NO_PIVOTS, _NO_FACTORS, _NO_PIVOTS
        ordered = self if self._word("ordered") or self._like is None else self._like
        perm_c = np.argsort(ordered._at("order", n))
        perm_c.flags.writeable = False
        size = self._word("nl") + self._word("nu") + 2 * n
        return self._at("perm_r", n), perm_c, self._at("values", size, np.float64), _NO_PIVOTS

    @property
    def lu_values(self) -> Floats:
        """The numeric factors and the limits on the growth of L as one array, to be copied out and back."""
        return self.parts()[2]

    @property
    def pivots(self) -> Ints:
        """Dense: (n,) row of the matrix at each pivot; belongs to the numeric state. Sparse: empty."""
        return self.parts()[3]

    @property
    def fill(self) -> int:
        """Number of stored entries of L and U, diagonal included."""
        return self.n * self.n if self.dense else self.record["nl"] + self.record["nu"] + self.n

    def analysis(self) -> tuple[Ints, Ints]:
        """Place of each row and each column in the pivot sequence: perm_r, perm_c (n,); empty if dense, or before the
        first analysis."""
        perm_r, perm_c, _, _ = self.parts()
        return perm_r.copy(), perm_c

    def analyze(self, values: Floats) -> None:
        """Choose pivots that fit the source array `values`, and factor with them.

        Raises
        ------
        SingularMatrixError : if there are no pivots, or a value is not finite.
        """
        while (status := int(analyze(self.record, values.ctypes.data))) == WANT_ROOM:
            self._grow()
        if status != OK:
            nnz = self.record["nnz"]
            rows, cols, slots = (self._at(name, nnz) for name in ("row", "col", "slot"))
            entries = values[slots]
            bad = np.flatnonzero(~np.isfinite(entries))
            if len(bad):
                e = bad[0]
                raise SingularMatrixError(
                    f"entry ({rows[e]}, {cols[e]}) of the {self.n} x {self.n} matrix is {entries[e]}"
                )
            row_unit, col_unit = (self._at(name, self.n, np.float64) for name in ("row_unit", "col_unit"))
            place = singular_place(self.n, rows, cols, entries * row_unit[rows] * col_unit[cols])
            raise SingularMatrixError(f"the {self.n} x {self.n} matrix is singular: {place}")

    def follow(self, other: "Matrix") -> None:
        """Take analysis and factors of `other`, which has the same entries, slots and units."""
        while int(follow(self.record, other.record)) == WANT_ROOM:
            self._grow()

    def analyze_with(self, perm_r: ArrayLike, perm_c: ArrayLike) -> None:
        """Take the analysis with the permutations of an earlier `analysis()`, without values.

        The limits on the growth of L are part of `lu_values`: until that is copied back, `factor` does not return 2.

        Raises
        ------
        ValueError : for what is no permutation, or not the order of the columns that this pattern has.
        """
        perm_r, perm_c = (np.array(p, dtype=np.int64, ndmin=1) for p in (perm_r, perm_c))
        if self.dense:
            if len(perm_r) or len(perm_c):
                raise ValueError("a dense factorisation has no permutations: analyze_with needs empty arrays")
            return
        for name, p in (("perm_r", perm_r), ("perm_c", perm_c)):
            if not np.array_equal(np.sort(p), np.arange(self.n)):
                raise ValueError(f"{name} must be a permutation of 0..{self.n - 1}")
        if self.n == 0:
            return
        while True:
            self._at("wanted", self.n)[:] = perm_r
            if int(use_pivots(self.record)) != WANT_ROOM:
                break
            self._grow()
        if not np.array_equal(perm_c, np.argsort(self._at("order", self.n))):
            raise ValueError("perm_c is not the order of the columns that this pattern has")

    def solve(self, b: ArrayLike) -> Floats:
        """Solution of A x = b as a new (n,) array, from Python."""
        x = np.array(b, dtype=np.float64, ndmin=1)
        if x.shape != (self.n,):
            raise ValueError(f"b has shape {x.shape}, the matrix needs ({self.n},)")
        solve(self.record, x.ctypes.data)
        return x


class Factorization(Matrix):
    """LU factorisation, with its own memory, of a square matrix whose pattern stays and whose values change.

    Parameters
    ----------
    n : size of the matrix.
    rows, cols : (nnz,) int64, place of each entry; no place twice.
    slots : (nnz,) int64, index of each entry in the caller's source array of float64.
    dense : factor densely; by default for n <= DENSE_LIMIT.
    source_size : length of the source array; by default what `slots` needs.

    Raises
    ------
    ValueError : for arrays of different lengths, indices out of range, or an entry given twice.
    """

    def __init__(
        self,
        n: int,
        rows: ArrayLike,
        cols: ArrayLike,
        slots: ArrayLike,
        dense: bool | None = None,
        source_size: int | None = None,
    ) -> None:
        self.rows, self.cols, self.slots = (np.array(a, dtype=np.int64, ndmin=1) for a in (rows, cols, slots))
        if source_size is None:
            source_size = int(self.slots.max(initial=-1)) + 1
        self.source_size, nnz = int(source_size), len(self.rows)
        dense = n <= DENSE_LIMIT if dense is None else bool(dense)
        check_pattern(n, self.rows, self.cols, self.slots, self.source_size)
        super().__init__(np.zeros(1, LU), self._find, self._more)
        self.scratch, self.needs = Scratch(), np.zeros(3, dtype=np.int64)
        self._functions = addresses(not dense)
        self._words, self._reals = np.zeros(words_of.py_func(n, nnz), dtype=np.int64), np.ones(3 * n)
        self._index, self._values = np.zeros(2 * nnz, dtype=np.uint32), np.zeros(n * (n + 1) if dense else 0)
        for name, x in (("scratch", self.scratch.cell), ("needs", self.needs), ("functions", self._functions)):
            self._table[name] = x.ctypes.data
        self._table["program_limit"] = PROGRAM_LIMIT
        self._point()
        lay_out_now(
            self.record, int(n), nnz, self.rows.ctypes.data, self.cols.ctypes.data, self.slots.ctypes.data, dense,
            self._words.ctypes.data, self._reals.ctypes.data,
        )  # fmt: skip

    def _point(self) -> None:
        self._table["index"], self._table["index_room"] = self._index.ctypes.data, len(self._index)
        self._table["values"], self._table["room"] = self._values.ctypes.data, len(self._values)

    def _find(self, address: int, count: int, dtype: type) -> NDArray:
        own = (self.rows, self.cols, self.slots, self._words, self._reals, self._index, self._values)
        for x in own:
            at = address - x.ctypes.data
            if count and 0 <= at < x.nbytes:
                return x[at // x.itemsize :][:count]
        return np.empty(0, dtype)

    def _more(self) -> None:
        index, values, scratch = (int(self.needs[k]) for k in (INDEX, VALUES, SCRATCH))
        if max(index, values) > LARGEST_INDEX:
            raise ValueError(f"{values} stored values are more than 32-bit indices can reach")
        self.scratch.give(scratch)
        if index > len(self._index) or values > len(self._values):
            # what stands in there is written anew
            self._table["ready"] = 0
            self._index = np.zeros(max(index, len(self._index)), dtype=np.uint32)
            self._values = np.zeros(max(values, len(self._values)))
            self._point()
        self.needs[:] = 0

    def analyze(self, values: Floats) -> None:
        """See `Matrix.analyze`."""
        super().analyze(self._source(values))

    def factor(self, values: Floats) -> int:
        """`factor` on the source array, from Python."""
        return int(factor(self.record, self._source(values).ctypes.data))

    def _source(self, values: Floats) -> Floats:
        values = np.ascontiguousarray(values, dtype=np.float64)
        if values.ndim != 1 or len(values) < self.source_size:
            raise ValueError(f"the source array has shape {values.shape}, it needs {self.source_size} values")
        return values
