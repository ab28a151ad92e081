"""The Python side of the linear solver: analysis, storage, and what restores a solver's state."""

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled.image import Take, twin
from ..compiled.records import Record, words_of
from .analysis import Analysis, Known
from .analyze import analyze, follow, use_analysis
from .check_pattern import check_pattern
from .choice import work_size
from .errors import SingularMatrixError
from .ordering import order_columns
from .record import LU, OK, WANT_ANALYSIS, WANT_ROOM
from .singular import singular_place
from .solve import factor, functions_of, solve

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Largest n that is factored densely. Measured (benchmarks/linalg_timing.py): from n = 5 on the sparse refactorisation
# is faster, but at these sizes by a tenth of a microsecond only, and small models save the seconds in which numba
# compiles the symbolic analysis on a first run.
DENSE_LIMIT = 8
_OWN = (
    "work",
    "row_unit",
    "col_unit",
    "values",
    "pivots",
    "wanted",
    "choice_work",
)  # arrays that are not of the pattern
_ANALYSIS = words_of(LU)["analysis"]
_NO_VALUES, _NO_PIVOTS = np.empty(0), np.empty(0, np.int64)


@cache
def make_sparse_ready() -> None:
    """Compile all that sparse factorisations of any pattern call."""
    for kind in ("program", "columns"):
        functions_of(kind)
    one = Factorization(1, [0], [0], [0], dense=False)
    one.analyze(np.ones(1))


class Factorization:
    """LU factorisation of a square matrix whose pattern stays and whose values change.

    Parameters
    ----------
    n : size of the matrix.
    rows, cols : (nnz,) int64, place of each entry; no place twice.
    slots : (nnz,) int64, index of each entry in the caller's source array of float64.
    dense : factor densely; by default for n <= DENSE_LIMIT.
    source_size : length of the source array; by default what `slots` needs.

    Attributes
    ----------
    record : the LU record for `factor` and `solve`. Its memory stays; `analyze` changes its content.
    address : of the record, for `lu_at`.
    arrays : what the addresses in the record point to.
    analyses : analyses that others of the same pattern have made, to be shared; None: each makes its own.

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
        self.n = int(n)
        self.rows, self.cols, self.slots = (np.array(a, dtype=np.int64, ndmin=1) for a in (rows, cols, slots))
        if source_size is None:
            source_size = int(self.slots.max(initial=-1)) + 1
        self.source_size = int(source_size)
        self.dense = self.n <= DENSE_LIMIT if dense is None else bool(dense)
        check_pattern(self.n, self.rows, self.cols, self.slots, self.source_size)
        self._table = np.zeros(1, LU)
        self.record = Record(self._table)
        """What to hand to a compiled function."""
        self.arrays: dict[str, NDArray] = {}
        self.built: dict[bytes, Analysis] = {}
        self.known = Known(self.built)
        self._latest: Analysis | None = None
        self._perm_c: Ints = _NO_PIVOTS  # until the columns are ordered
        self._set(
            n=self.n,
            nnz=len(self.rows),
            **self._functions("unready"),
            entry_from=self.slots.astype(np.uint32),
            work=np.zeros(self.n),
            row_unit=np.ones(self.n),
            col_unit=np.ones(self.n),
            order=-1,  # not chosen yet
        )
        if self.dense:
            self._set(
                **self._functions("dense"),
                entry_to=(self.rows * self.n + self.cols).astype(np.uint32),
                values=np.zeros(self.n * (self.n + 1)),
                pivots=np.arange(self.n),
                order=0,
            )

    def sibling(self) -> "Factorization":
        """One of the same pattern and entries, which shares tables and analyses with this one in one run."""
        new = self.fresh()
        new.known = self.known
        new._point_to_known()
        return new

    def _point_to_known(self) -> None:
        self._table["known"] = self.known.addresses.ctypes.data
        self._table["n_known"] = self.known.count.ctypes.data

    def memory(self) -> tuple[list[NDArray], list[NDArray]]:
        """Own arrays and records; all others never change, and factorisations of the same pattern share them."""
        arrays = [self.arrays[name] for name in _OWN if name in self.arrays]
        return [*arrays, self.known.addresses, self.known.count], [self._table]

    def fresh(self) -> "Factorization":
        """One of the same pattern, in the same state, with memory of its own."""
        new = twin(self)
        new._table = self._table.view(np.uint8).copy().view(LU)  # not field by field
        new.record = Record(new._table)
        new.arrays = self.arrays.copy()
        new._set(**{name: self.arrays[name].copy() for name in _OWN if name in self.arrays})
        new.known = self.known.fresh()
        if not self.dense:
            new._point_to_known()
            present = self._present()
            if present is not None:
                new.known.add(present)
        return new

    def moved(self, take: Take) -> "Factorization":
        """The same factorisation in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        new._table = take(self._table)
        new.record = Record(new._table)
        new.arrays = self.arrays.copy()
        for name in _OWN:
            if name in new.arrays:
                new.arrays[name] = take(new.arrays[name])
        new.known = self.known.moved(take)
        return new

    def _present(self) -> Analysis | None:
        """The present analysis, which compiled code may have chosen; none if dense, or before the first."""
        address = self.record.word(_ANALYSIS)
        if self._latest is None or self._latest.address != address:
            self._latest = self.known.at(address) if address else None
        return self._latest

    @property
    def address(self) -> int:
        """Address of the record, to be stored in another record."""
        return int(self._table.ctypes.data)

    @property
    def lu_values(self) -> Floats:
        """The numeric factors and the limits on the growth of L as one array, to be copied out and back."""
        values, present = self.arrays.get("values", _NO_VALUES), self._present()
        return values if present is None else values[: present.size]

    @property
    def pivots(self) -> Ints:
        """Dense: (n,) row of the matrix at each pivot; belongs to the numeric state. Sparse: empty."""
        return self.arrays.get("pivots", _NO_PIVOTS)

    @property
    def fill(self) -> int:
        """Number of stored entries of L and U, diagonal included."""
        return self.n * self.n if self.dense else self.record["nl"] + self.record["nu"] + self.n

    def use_units(self, rows: Floats, columns: Floats) -> None:
        """Choose pivots as if the rows were multiplied by `rows` (n,) and the columns by `columns` (n,)."""
        self.arrays["row_unit"][:] = rows
        self.arrays["col_unit"][:] = columns

    def analysis(self) -> tuple[Ints, Ints]:
        """Place of each row and each column in the pivot sequence: perm_r, perm_c (n,); empty if dense."""
        present = self._present()
        return (_NO_PIVOTS, _NO_PIVOTS) if present is None else (present.perm_r, present.perm_c)

    def analyze(self, values: Floats) -> None:
        """Choose pivots that fit the source array `values`, and factor with them.

        Raises
        ------
        SingularMatrixError : if there are no pivots, or a value is not finite.
        """
        values = self._source(values)
        while (status := int(analyze(self.record, values.ctypes.data))) in (WANT_ANALYSIS, WANT_ROOM):
            self.make_wanted()
        if status != OK:
            entries = values[self.slots]
            bad = np.flatnonzero(~np.isfinite(entries))
            if len(bad):
                e = bad[0]
                raise SingularMatrixError(
                    f"entry ({self.rows[e]}, {self.cols[e]}) of the {self.n} x {self.n} matrix is {entries[e]}"
                )
            entries = entries * self.arrays["row_unit"][self.rows] * self.arrays["col_unit"][self.cols]
            place = singular_place(self.n, self.rows, self.cols, entries)
            raise SingularMatrixError(f"the {self.n} x {self.n} matrix is singular: {place}")

    @property
    def wants(self) -> bool:
        """True if compiled code has asked for something that `make_wanted` makes."""
        return bool(self._table["wants"][0])

    def make_wanted(self) -> None:
        """What compiled `analyze` has asked for: the order of the columns, room, or the analysis of chosen pivots."""
        wants = int(self._table["wants"][0])
        self._table["wants"] = 0
        if "order" not in self.arrays:
            self._order_columns()
        elif wants == WANT_ROOM:
            self._make_room(4 * self.record["choice_room"])
        elif wants == WANT_ANALYSIS:
            self._know(self.arrays["wanted"].copy(), self._perm_c)
        else:
            self.have_room()

    def order_columns(self, other: "Factorization | None" = None) -> None:
        """Have the order of the columns, which compiled code would ask for first: chosen now, or taken from `other`,
        of the same pattern, if that has one."""
        if self.dense or "order" in self.arrays:
            return
        if other is None:
            self._order_columns()
            return
        if "order" not in other.arrays:
            return
        self._perm_c = other._perm_c
        shared = ("order", "column_start", "column_row", "column_of", "column_slot")
        self._set(**{name: other.arrays[name] for name in shared}, wanted=np.zeros(self.n, dtype=np.int64))
        self._point_to_known()
        self._make_room(2 * len(self.rows) + 2 * self.n + 16)

    def _order_columns(self) -> None:
        perm_c = order_columns(self.n, self.rows, self.cols)
        col_at = np.argsort(perm_c)
        entries = np.lexsort((self.rows, perm_c[self.cols]))
        start = np.concatenate(([0], np.cumsum(np.bincount(perm_c[self.cols], minlength=self.n))))
        self._perm_c = perm_c
        self._set(
            order=col_at,
            column_start=start,
            column_row=self.rows[entries],
            column_of=self.cols[entries],
            column_slot=self.slots[entries],
            wanted=np.zeros(self.n, dtype=np.int64),
        )
        self._point_to_known()
        self._make_room(2 * len(self.rows) + 2 * self.n + 16)

    def _make_room(self, room: int) -> None:
        self._set(choice_work=np.zeros(work_size(self.n, len(self.rows), room)), choice_room=room)

    def _know(self, perm_r: Ints, perm_c: Ints) -> Analysis:
        found = self.known.get(self.n, self.rows, self.cols, self.slots, perm_r, perm_c)
        self.known.add(found)
        self.have_room()
        return found

    def have_room(self) -> None:
        """Room for the factors of every analysis that is known."""
        size = self.known.largest
        values = self.arrays.get("values", _NO_VALUES)
        if len(values) < size:
            self._set(values=np.concatenate([values, np.zeros(size - len(values))]), room=size)

    def follow(self, other: "Factorization") -> None:
        """Take analysis and factors of `other`, which has the same entries, slots and units."""
        while not follow(self.record, other.record):
            self.make_wanted()

    def analyze_with(self, perm_r: ArrayLike, perm_c: ArrayLike) -> None:
        """Take the analysis with the permutations of an earlier `analysis()`, without values.

        The limits on the growth of L are part of `lu_values`: until that is copied back, `factor` does not return 2.
        """
        perm_r, perm_c = (np.array(p, dtype=np.int64, ndmin=1) for p in (perm_r, perm_c))
        if self.dense:
            if len(perm_r) or len(perm_c):
                raise ValueError("a dense factorisation has no permutations: analyze_with needs empty arrays")
            return
        for name, p in (("perm_r", perm_r), ("perm_c", perm_c)):
            if not np.array_equal(np.sort(p), np.arange(self.n)):
                raise ValueError(f"{name} must be a permutation of 0..{self.n - 1}")
        if "order" not in self.arrays:
            self._order_columns()
        if not np.array_equal(perm_c, self._perm_c):
            raise ValueError("perm_c is not the order of the columns that this pattern has")
        use_analysis(self.record, self._know(perm_r, perm_c).address)

    @property
    def kind(self) -> str:
        """Of the refactorisation: "dense", "program" or "columns"; "unready" before the first analysis."""
        if self.dense:
            return "dense"
        present = self._present()
        return "unready" if present is None else present.kind

    def _functions(self, kind: str) -> dict[str, int]:
        factor_function, solve_function = functions_of(kind)
        return {"factor_function": factor_function, "solve_function": solve_function}

    def factor(self, values: Floats) -> int:
        """`factor` on the source array, from Python."""
        return int(factor(self.record, self._source(values).ctypes.data))

    def solve(self, b: ArrayLike) -> Floats:
        """Solution of A x = b as a new (n,) array, from Python."""
        x = np.array(b, dtype=np.float64, ndmin=1)
        if x.shape != (self.n,):
            raise ValueError(f"b has shape {x.shape}, the matrix needs ({self.n},)")
        solve(self.record, x.ctypes.data)
        return x

    def _source(self, values: Floats) -> Floats:
        values = np.ascontiguousarray(values, dtype=np.float64)
        if values.ndim != 1 or len(values) < self.source_size:
            raise ValueError(f"the source array has shape {values.shape}, it needs {self.source_size} values")
        return values

    def _set(self, **fields: int | NDArray) -> None:
        for name, value in fields.items():
            if isinstance(value, np.ndarray):
                self.arrays[name] = value = np.ascontiguousarray(value)
                self._table[name] = value.__array_interface__["data"][0]
            else:
                self._table[name] = value
