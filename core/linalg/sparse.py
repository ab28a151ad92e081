"""Sparse refactorisation with fixed pattern and pivots, and the triangular solves.

Left-looking by columns (Gilbert & Peierls 1988; refactorisation as in KLU, Davis & Palamadai Natarajan
2010): column j of L and U is column j of the matrix minus the columns k < j of L times u_kj, k ascending.
`PROGRAM` runs this from a list of positions written down at analysis, without scatter and inner loops of
two or three turns: faster for the nearly empty factors of multibody systems. `COLUMNS` runs it with one
dense column as accumulator: faster where columns are longer. Both give the same bits.

U is stored divided by the pivot of its column. Both triangular solves are then flat loops over their
entries, with one division by the pivots at the end: A = L Ũ D, x = D⁻¹ Ũ⁻¹ L⁻¹ b.
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.views import uvec, vec
from ..rounding import PIVOT_NOISE
from .record import NO_PIVOT, OK, REANALYSE

_SMALLEST = float(1.0 / np.finfo(np.float64).max)
_LARGEST = float(np.finfo(np.float64).max)


@internal
def load_entries(lu: Any, values_address: int) -> bool:
    """Write the matrix entries where their factors will be, zero elsewhere; False if one is not finite."""
    size = lu.nl + lu.nu + lu.n
    v = vec(lu.values, size)
    source = vec(values_address, 1)
    entry_to = uvec(lu.entry_to, lu.nnz)
    entry_from = uvec(lu.entry_from, lu.nnz)
    for p in range(size):
        v[p] = 0.0
    finite = True
    for e in range(lu.nnz):
        x = source[entry_from[e]]
        finite &= abs(x) <= _LARGEST
        v[entry_to[e]] = x
    return finite


@inlined
def usable(pivot: float, top: float) -> bool:
    """Is a pivot, whose sum had partial results up to `top`, more than rounding, with finite inverse?"""
    size = abs(pivot)
    return size > PIVOT_NOISE * top and size > _SMALLEST and size <= _LARGEST


@internal
def finish(lu: Any) -> int:
    """Divide the columns of U by their pivots and compare L with its limits."""
    nl = lu.nl
    nu = lu.nu
    v = vec(lu.values, nl + nu + 2 * lu.n)
    l_col = uvec(lu.l_col, nl)
    u_col = uvec(lu.u_col, nu)
    inverse = np.uint64(nl + nu)
    limit = np.uint64(nl + nu + lu.n)
    for p in range(nu):
        v[np.uint64(nl + p)] *= v[inverse + u_col[p]]
    bounded = True
    for p in range(nl):
        bounded &= abs(v[p]) <= v[limit + l_col[p]]
    return OK if bounded else REANALYSE


@internal
def program_factor(lu: Any, values_address: int) -> int:
    """Refactor from the list of positions; OK, NO_PIVOT or REANALYSE."""
    if not load_entries(lu, values_address):
        return NO_PIVOT
    n = lu.n
    v = vec(lu.values, lu.nl + lu.nu + 2 * n)
    l_start = uvec(lu.l_start, n + 1)
    step_start = uvec(lu.step_start, n + 1)
    step_to = uvec(lu.step_to, lu.n_steps)
    step_left = uvec(lu.step_left, lu.n_steps)
    step_right = uvec(lu.step_right, lu.n_steps)
    sum_start = uvec(lu.sum_start, n + 1)
    sum_left = uvec(lu.sum_left, lu.n_sums)
    sum_right = uvec(lu.sum_right, lu.n_sums)
    diagonal = lu.nl + lu.nu
    for j in range(n):
        for q in range(np.uint64(step_start[j]), np.uint64(step_start[j + 1])):
            v[step_to[q]] -= v[step_left[q]] * v[step_right[q]]
        pivot = v[np.uint64(diagonal + j)]
        top = abs(pivot)
        for q in range(np.uint64(sum_start[j]), np.uint64(sum_start[j + 1])):
            pivot -= v[sum_left[q]] * v[sum_right[q]]
            top = max(top, abs(pivot))
        if not usable(pivot, top):
            return NO_PIVOT
        d = 1.0 / pivot
        v[np.uint64(diagonal + j)] = d
        for p in range(np.uint64(l_start[j]), np.uint64(l_start[j + 1])):
            v[p] *= d
    return finish(lu)


@internal
def columns_factor(lu: Any, values_address: int) -> int:
    """Refactor column by column with a dense accumulator; OK, NO_PIVOT or REANALYSE."""
    if not load_entries(lu, values_address):
        return NO_PIVOT
    n = lu.n
    v = vec(lu.values, lu.nl + lu.nu + 2 * n)
    x = vec(lu.work, n)
    l_start = uvec(lu.l_start, n + 1)
    u_start = uvec(lu.u_start, n + 1)
    l_row = uvec(lu.l_row, lu.nl)
    u_row = uvec(lu.u_row, lu.nu)
    u_first = np.uint64(lu.nl)
    diagonal = lu.nl + lu.nu
    for j in range(n):
        l_range = range(np.uint64(l_start[j]), np.uint64(l_start[j + 1]))
        u_range = range(np.uint64(u_start[j]), np.uint64(u_start[j + 1]))
        x[j] = v[np.uint64(diagonal + j)]
        top = abs(x[j])
        for p in u_range:
            x[u_row[p]] = v[u_first + p]
        for p in l_range:
            x[l_row[p]] = v[p]
        for p in u_range:
            k = u_row[p]
            u = x[k]
            v[u_first + p] = u
            for q in range(np.uint64(l_start[k]), np.uint64(l_start[k + 1])):
                x[l_row[q]] -= v[q] * u
            top = max(top, abs(x[j]))
        if not usable(x[j], top):
            return NO_PIVOT
        d = 1.0 / x[j]
        v[np.uint64(diagonal + j)] = d
        for p in l_range:
            v[p] = x[l_row[p]] * d
    return finish(lu)


@internal
def sparse_solve(lu: Any, b_address: int) -> None:
    """Overwrite the (n,) vector at `b_address` with the solution."""
    n = lu.n
    nl = lu.nl
    nu = lu.nu
    v = vec(lu.values, nl + nu + n)
    y = vec(lu.work, n)
    b = vec(b_address, n)
    l_row = uvec(lu.l_row, nl)
    l_col = uvec(lu.l_col, nl)
    u_row = uvec(lu.u_row, nu)
    u_col = uvec(lu.u_col, nu)
    row_at = uvec(lu.row_at, n)
    col_at = uvec(lu.col_at, n)
    for j in range(n):
        y[j] = b[row_at[j]]
    for p in range(nl):
        y[l_row[p]] -= v[p] * y[l_col[p]]
    for i in range(nu):
        k = np.uint64(nu - 1 - i)
        y[u_row[k]] -= v[np.uint64(nl) + k] * y[u_col[k]]
    for j in range(n):
        b[col_at[j]] = y[j] * v[nl + nu + j]


@internal
def sparse_solve_transposed(lu: Any, b_address: int) -> None:
    """Overwrite the (n,) vector at `b_address` with the solution of A^T x = b."""
    n = lu.n
    nl = lu.nl
    nu = lu.nu
    v = vec(lu.values, nl + nu + n)
    y = vec(lu.work, n)
    b = vec(b_address, n)
    l_row = uvec(lu.l_row, nl)
    l_col = uvec(lu.l_col, nl)
    u_row = uvec(lu.u_row, nu)
    u_col = uvec(lu.u_col, nu)
    row_at = uvec(lu.row_at, n)
    col_at = uvec(lu.col_at, n)
    for j in range(n):
        y[j] = b[col_at[j]] * v[nl + nu + j]
    for p in range(nu):
        y[u_col[p]] -= v[nl + p] * y[u_row[p]]
    for i in range(nl):
        k = np.uint64(nl - 1 - i)
        y[l_col[k]] -= v[k] * y[l_row[k]]
    for j in range(n):
        b[row_at[j]] = y[j]
