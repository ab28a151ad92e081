"""The Python side of the linear solver: analysis, storage, and what restores a solver's state."""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled.image import Take, twin
from ..compiled.records import Record
from .check_pattern import LARGEST_INDEX, check_pattern
from .errors import SingularMatrixError
from .ordering import balancing_scales, choose_pivots, singular_place
from .record import GROWTH, LU, OK
from .solve import factor, functions_of, solve
from .symbolic import Operations, count_operations, fill_pattern, operation_list

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Largest n that is factored densely. Measured (benchmarks/linalg_timing.py): from n = 5 on the sparse refactorisation
# is faster, but at these sizes by a tenth of a microsecond only, and small models save the seconds in which numba
# compiles the symbolic analysis on a first run.
DENSE_LIMIT = 200
# The list of operations is written down while it is at most this many times the fill. Measured: 1.2-1.5 times
# faster than by columns for chains (1.1 operations an entry), 1.2-1.7 times slower for spring grids (10-30).
PROGRAM_LIMIT = 4
_OWN = ("work", "row_unit", "values", "pivots")  # arrays that are not of the pattern
Analyses = dict[bytes, tuple[str, int, dict[str, Any]]]  # by permutations
MOST_ANALYSES = 32  # kept for one pattern
_NO_VALUES, _NO_PIVOTS = np.empty(0), np.empty(0, np.int64)


@cache
def make_sparse_ready() -> None:
    """Compile all that sparse factorisations of any pattern call."""
    for kind in ("program", "columns"):
        functions_of(kind)
    Factorization(1, [0], [0], [0], dense=False).analyze_with([0], [0])


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
        self._permutations = (np.empty(0, np.int64), np.empty(0, np.int64))
        self.analyses: Analyses | None = None
        self.kind = "unready"
        self.col_unit = np.ones(self.n)
        self._set(
            n=self.n,
            nnz=len(self.rows),
            **self._functions("unready"),
            entry_from=self.slots.astype(np.uint32),
            work=np.zeros(self.n),
            row_unit=np.ones(self.n),
        )
        if self.dense:
            self._set(
                **self._functions("dense"),
                entry_to=(self.rows * self.n + self.cols).astype(np.uint32),
                values=np.zeros(self.n * (self.n + 1)),
                pivots=np.arange(self.n),
            )

    def memory(self) -> tuple[list[NDArray], list[NDArray]]:
        """Own arrays and records; all others never change, and factorisations of the same pattern share them."""
        return [self.arrays[name] for name in _OWN if name in self.arrays], [self._table]

    def fresh(self) -> "Factorization":
        """One of the same pattern, in the same state, with memory of its own."""
        new = twin(self)
        new._table = self._table.view(np.uint8).copy().view(LU)  # not field by field
        new.record = Record(new._table)
        new.arrays = self.arrays.copy()
        new._set(**{name: self.arrays[name].copy() for name in _OWN if name in self.arrays})
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
        return new

    @property
    def address(self) -> int:
        """Address of the record, to be stored in another record."""
        return int(self._table.ctypes.data)

    @property
    def lu_values(self) -> Floats:
        """The numeric factors and the limits on the growth of L as one array, to be copied out and back."""
        return self.arrays.get("values", _NO_VALUES)

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
        self.col_unit = columns

    def analysis(self) -> tuple[Ints, Ints]:
        """Place of each row and each column in the pivot sequence: perm_r, perm_c (n,); empty if dense."""
        return self._permutations

    def analyze(self, values: Floats) -> None:
        """Take ordering and pivots from the source array `values`, and factor with them.

        Raises
        ------
        SingularMatrixError : if there are no pivots, or a value is not finite.
        """
        values = self._source(values)
        entries = values[self.slots]
        bad = np.flatnonzero(~np.isfinite(entries))
        if len(bad):
            e = bad[0]
            raise SingularMatrixError(
                f"entry ({self.rows[e]}, {self.cols[e]}) of the {self.n} x {self.n} matrix is {entries[e]}"
            )
        if not self.dense:
            row_unit = self.arrays["row_unit"]
            entries = entries * row_unit[self.rows] * self.col_unit[self.cols]
            self.analyze_with(*choose_pivots(self.n, self.rows, self.cols, entries))
        if factor(self.record, values.ctypes.data) != OK:
            place = singular_place(self.n, self.rows, self.cols, entries)
            raise SingularMatrixError(f"the {self.n} x {self.n} matrix is singular: {place}")
        if not self.dense:
            nl, column, row = self.record["nl"], self.arrays["l_col"], self.arrays["l_row"]
            # an entry of L that is 1 once the rows are balanced: units of the rows do not count as growth
            balance = row_unit * balancing_scales(self.n, self.rows, self.cols, entries)[0]
            balance = balance[self.arrays["row_at"]]
            largest = np.zeros(self.n)
            np.maximum.at(largest, column, balance[column] / balance[row])
            np.maximum.at(largest, column, np.abs(self.lu_values[:nl]))
            self._growth_limits()[:] = GROWTH * largest

    def follow(self, other: "Factorization") -> None:
        """Take pattern and factors of `other`, which has the same entries, slots and units."""
        if self.dense:
            self.pivots[:] = other.pivots
            self.lu_values[:] = other.lu_values
            return
        own = {name: self.arrays[name] for name in ("work", "row_unit")}
        self._table.view(np.uint8)[:] = other._table.view(np.uint8)
        self.arrays, self.kind, self._permutations = other.arrays.copy(), other.kind, other._permutations
        self._set(values=other.lu_values.copy(), **own)

    def analyze_with(self, perm_r: ArrayLike, perm_c: ArrayLike) -> None:
        """Rebuild pattern and storage from the permutations of an earlier `analysis()`, without values.

        The structure is the same, entry for entry. The limits on the growth of L are part of `lu_values`:
        until that is copied back, `factor` does not return 2.
        """
        perm_r, perm_c = (np.array(p, dtype=np.int64, ndmin=1) for p in (perm_r, perm_c))
        if self.dense:
            if len(perm_r) or len(perm_c):
                raise ValueError("a dense factorisation has no permutations: analyze_with needs empty arrays")
            return
        for name, p in (("perm_r", perm_r), ("perm_c", perm_c)):
            if not np.array_equal(np.sort(p), np.arange(self.n)):
                raise ValueError(f"{name} must be a permutation of 0..{self.n - 1}")
        key = perm_r.tobytes() + perm_c.tobytes()
        known = None if self.analyses is None else self.analyses.get(key)
        if known is None:
            known = self._analysis_of(perm_r, perm_c)
            if self.analyses is not None and len(self.analyses) < MOST_ANALYSES:
                self.analyses[key] = known
        kind, count, fields = known
        self._set(**self._functions(kind), values=np.zeros(count), **fields)
        self._growth_limits()[:] = np.inf
        self._permutations = (perm_r, perm_c)

    def _analysis_of(self, perm_r: Ints, perm_c: Ints) -> tuple[str, int, dict[str, Any]]:
        """Kind of the factorisation, number of stored values, and the fields of its pattern."""
        n = self.n
        row, col = perm_r[self.rows], perm_c[self.cols]
        l, u = fill_pattern(n, row, col)
        nl, nu = len(l.row), len(u.row)
        if nl + nu + 2 * n > LARGEST_INDEX:
            raise ValueError(f"{nl + nu + 2 * n} stored values are more than 32-bit indices can reach")
        if count_operations(l, u) <= PROGRAM_LIMIT * (nl + nu + n):
            kind, operations = "program", operation_list(n, l, u)
        else:
            kind, operations = "columns", Operations(*(np.zeros((k, 0), np.uint32) for k in (1, 3, 1, 2)))
        entry_to = nl + nu + row
        below, above = row > col, row < col
        entry_to[below] = l.find(n, row[below], col[below])
        entry_to[above] = nl + u.find(n, row[above], col[above])
        order = np.argsort(entry_to)  # written in ascending order
        indices = {
            "entry_to": entry_to[order],
            "entry_from": self.slots[order],
            "row_at": np.argsort(perm_r),
            "col_at": np.argsort(perm_c),
            "step_start": operations.step_start,
            "sum_start": operations.sum_start,
            **dict(zip(("step_to", "step_left", "step_right"), operations.steps, strict=True)),
            **dict(zip(("sum_left", "sum_right"), operations.sums, strict=True)),
            **{f"{name}_{field}": value for name, t in (("l", l), ("u", u)) for field, value in t._asdict().items()},
        }
        fields: dict[str, Any] = {name: np.ascontiguousarray(x, dtype=np.uint32) for name, x in indices.items()}
        fields |= {"nl": nl, "nu": nu, "n_steps": operations.steps.shape[1], "n_sums": operations.sums.shape[1]}
        return kind, nl + nu + 2 * n, fields

    def _functions(self, kind: str) -> dict[str, int]:
        self.kind = kind
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

    def _growth_limits(self) -> Floats:
        return self.lu_values[len(self.lu_values) - self.n :]

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
