"""Sparse elimination: independent columns for the rows of a matrix, and rows that repeat others.

Used to choose dependent coordinates (one pivot column for each constraint) and to report redundant
constraints. Row by row with an accumulator: earlier pivot rows are subtracted (up-looking), then the
largest scaled entry of the remainder becomes the pivot (Wehage & Haug 1982 do this with full pivoting on
a dense matrix).

Cost: that of the remainders. If the pivots along an open chain are positions, remainders grow with the
link number, as the true dependence on all earlier angles does: 30 ms for 2000 rows, quadratic in the
links. If they are angles (larger column_scale), remainders stay short: 4 ms.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled import types
from ..compiled.jit import compiled_unlocked, internal, interpreted
from ..rounding import EQUAL_PIVOTS, NOT_DEPENDENT

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

# Up to so many entries the elimination is interpreted: a millisecond at most, against a second of compiling.
FEW_ENTRIES = 60


@internal
def _insert(pending: Any, count: int, row: int) -> int:
    """Put a row into the first `count` pending ones, which descend; returns the new count."""
    at = count
    while at > 0 and pending[at - 1] < row:
        pending[at] = pending[at - 1]
        at -= 1
    pending[at] = row
    return count + 1


@compiled_unlocked
def eliminate(
    m: int,
    n: int,
    indptr: Any,
    indices: Any,
    data: Any,
    column_scale: Any,
    tol: float,
    pivot_column: Any,
    owner: Any,
    mark: Any,
    column: Any,
    pending: Any,
    x: Any,
    u_start: Any,
    u_column: Any,
    u: Any,
    f_start: Any,
    f_row: Any,
    f: Any,
) -> int:
    """Eliminate into the given arrays; returns the rank, or -1 if `u` or `f` is too short.

    Row i of `u` is the remainder of row i of the matrix, its pivot first; row i of `f` says how many times
    which earlier remainders were subtracted. The arrays come from Python because allocation here would
    cost as much compile time as the elimination.
    """
    rank = 0
    for i in range(m):
        end = u_start[i]
        f_end = f_start[i]
        if end + n > len(u) or f_end + rank > len(f):
            return -1
        count = 0
        n_pending = 0
        for p in range(indptr[i], indptr[i + 1]):
            c = indices[p]
            if mark[c] != i:
                mark[c] = i
                column[count] = c
                count += 1
                if owner[c] >= 0:
                    n_pending = _insert(pending, n_pending, owner[c])
            x[c] += data[p]
        top = 0.0
        for q in range(count):
            size = abs(x[column[q]]) * column_scale[column[q]]
            if size > top:
                top = size
        while n_pending > 0:
            n_pending -= 1
            k = pending[n_pending]
            times = x[pivot_column[k]] / u[u_start[k]]
            x[pivot_column[k]] = 0.0
            if times != 0.0:
                f_row[f_end] = k
                f[f_end] = times
                f_end += 1
                for p in range(u_start[k] + 1, u_start[k + 1]):
                    c = u_column[p]
                    if mark[c] != i:
                        mark[c] = i
                        column[count] = c
                        count += 1
                        if owner[c] >= 0:
                            n_pending = _insert(pending, n_pending, owner[c])
                    x[c] -= times * u[p]
        best = 0.0
        for q in range(count):
            size = abs(x[column[q]]) * column_scale[column[q]]
            if size > best:
                best = size
        best_column = -1
        for q in range(count):
            c = column[q]
            if abs(x[c]) * column_scale[c] >= EQUAL_PIVOTS * best and (best_column < 0 or c < best_column):
                best_column = c
        independent = best > 0.0 and best >= tol * top
        if independent:
            pivot_column[i] = best_column
            owner[best_column] = i
            rank += 1
            u_column[end] = best_column
            u[end] = x[best_column]
            end += 1
        for q in range(count):
            c = column[q]
            if independent and x[c] != 0.0 and c != best_column:
                u_column[end] = c
                u[end] = x[c]
                end += 1
            x[c] = 0.0
        u_start[i + 1] = end
        f_start[i + 1] = f_end
    return rank


_eliminate_interpreted = interpreted(eliminate, _insert)


def make_elimination_ready() -> None:
    """Compile the elimination."""
    whole, real = types.int64, types.float64
    wholes, reals = types.Array(whole, 1, "C"), types.Array(real, 1, "C")
    matrix, tables = (whole, whole, wholes, wholes, reals, reals, real), (wholes,) * 5
    eliminate.compile((*matrix, *tables, reals, wholes, wholes, reals, wholes, wholes, reals))


def eliminate_rows(
    m: int, n: int, indptr: Ints, indices: Ints, data: Floats, column_scale: Floats, tol: float
) -> tuple[Ints, int, Ints, Ints, Floats]:
    """As `independent_columns`, and the factors: (pivot_column, rank, f_start (m + 1,), f_row, f)."""
    space = 4 * len(indices) + 4 * n
    by_size = _eliminate_interpreted if len(indices) <= FEW_ENTRIES else eliminate
    while True:
        pivot_column = np.full(m, -1, np.int64)
        u_start, f_start = np.zeros(m + 1, np.int64), np.zeros(m + 1, np.int64)
        f_row, f = np.empty(space, np.int64), np.empty(space)
        rank = by_size(
            m, n, indptr, indices, data, column_scale, tol, pivot_column,
            np.full(n, -1, np.int64), np.full(n, -1, np.int64), np.empty(n, np.int64), np.empty(n, np.int64),
            np.zeros(n), u_start, np.empty(space, np.int64), np.empty(space), f_start, f_row, f,
        )  # fmt: skip
        if rank >= 0:
            return pivot_column, rank, f_start, f_row, f
        space *= 4


def independent_columns(
    m: int, n: int, indptr: Ints, indices: Ints, data: Floats, column_scale: Floats, tol: float
) -> tuple[Ints, int]:
    """One pivot column for each row of an (m, n) CSR matrix, -1 for a redundant row; and the rank. No checks.

    The pivot is the largest |remainder| * column_scale (n,) of the row, the lowest column of those that rounding may
    have told apart: where lengths that are equal tie, one rounding of the start would choose otherwise. A row is
    redundant if that is below `tol` times the largest |entry| * column_scale of the row itself, or zero.
    """
    return eliminate_rows(m, n, indptr, indices, data, column_scale, tol)[:2]


@dataclass(frozen=True)
class RowPivots:
    """Result of `pivot_rows`.

    Attributes
    ----------
    pivot_column : (m,) int64, -1 for a redundant row.
    rank : number of rows that are not redundant.
    redundant : (m - rank,) int64, the redundant rows.
    depends_on : for each of them, the earlier rows of which it is a combination (none for a zero row).
    """

    pivot_column: Ints
    rank: int
    redundant: Ints
    depends_on: list[Ints]


def pivot_rows(
    m: int,
    n: int,
    indptr: ArrayLike,
    indices: ArrayLike,
    data: ArrayLike,
    column_scale: ArrayLike | None = None,
    tol: float = 1e-10,
    check: bool = True,
) -> RowPivots:
    """`independent_columns` with checks (unless told not to), and the rows that each redundant row repeats.

    Raises
    ------
    ValueError : for arrays that are no (m, n) CSR matrix, scales that are not positive, values not finite.
    """
    start, index = (np.ascontiguousarray(a, dtype=np.int64) for a in (indptr, indices))
    value = np.ascontiguousarray(data, dtype=np.float64)
    scale = np.ones(n) if column_scale is None else np.ascontiguousarray(column_scale, dtype=np.float64)
    if check:
        _check_matrix(m, n, start, index, value, scale, tol)
    pivot_column, rank, f_start, f_row, f = eliminate_rows(m, n, start, index, value, scale, float(tol))
    redundant = np.flatnonzero(pivot_column < 0)
    if not len(redundant):
        return RowPivots(pivot_column, int(rank), redundant, [])
    norms = np.sqrt(np.bincount(np.repeat(np.arange(m), np.diff(start)), value**2, m))
    return RowPivots(
        pivot_column,
        int(rank),
        redundant,
        [_repeated_rows(int(row), norms, f_start, f_row, f) for row in redundant],
    )


def _check_matrix(m: int, n: int, start: Ints, index: Ints, value: Floats, scale: Floats, tol: float) -> None:
    if start.shape != (m + 1,) or start[0] != 0 or np.any(np.diff(start) < 0):
        raise ValueError(f"indptr must have {m + 1} ascending values from 0, it has shape {start.shape}")
    if index.shape != (start[-1],) or value.shape != (start[-1],):
        raise ValueError(f"indices {index.shape} and data {value.shape} must have {start[-1]} values")
    if len(index) and (index.min() < 0 or index.max() >= n):
        raise ValueError(f"indices must be in 0..{n - 1}, they range from {index.min()} to {index.max()}")
    if scale.shape != (n,) or not np.all((scale > 0) & np.isfinite(scale)):
        raise ValueError(f"column_scale must have {n} positive values, it is {scale}")
    if not np.all(np.isfinite(value)):
        row = int(np.searchsorted(start, np.flatnonzero(~np.isfinite(value))[0], side="right")) - 1
        raise ValueError(f"row {row} has a value that is not finite")
    if not 0 < tol < 1:
        raise ValueError(f"tol must be between 0 and 1, not {tol}")


def _repeated_rows(
    row: int,
    norms: Floats,
    start: Ints,
    factor_row: Ints,
    factor: Floats,
) -> Ints:
    """Earlier rows whose combination is `row`: the stored factors, substituted back to the given rows."""
    c = np.zeros(row + 1)
    c[row] = -1.0
    for k in range(row, -1, -1):
        if c[k] != 0.0:
            these = slice(start[k], start[k + 1])
            c[factor_row[these]] -= c[k] * factor[these]
    return np.flatnonzero(np.abs(c[:row]) * norms[:row] > NOT_DEPENDENT * norms[row])
