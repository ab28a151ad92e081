"""Dense LU of small matrices, by rows with partial pivoting (Golub & Van Loan, Matrix Computations, 3.4).

Written out because LAPACK called from numba costs 1-2 us before it begins.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, uvec, vec
from ..rounding import PIVOT_NOISE
from .record import NO_PIVOT, OK

_LARGEST = np.finfo(np.float64).max


@internal
def dense_factor(lu: Any, values_address: int) -> int:
    """Factor the (n, n) matrix whose entries are in the source array at `values_address`.

    Returns OK or NO_PIVOT; the pivots are chosen anew each time, so that they never go stale.
    """
    n = lu.n
    nnz = lu.nnz
    a = vec(lu.values, n * n + n)
    inverse = n * n
    row_at, unit = ivec(lu.pivots, n), vec(lu.row_unit, n)
    source = vec(values_address, 1)
    entry_to = uvec(lu.entry_to, nnz)
    entry_from = uvec(lu.entry_from, nnz)
    if nnz < n * n:
        for i in range(n * n):
            a[i] = 0.0
    finite = True
    for e in range(nnz):
        x = source[entry_from[e]]
        finite &= abs(x) <= _LARGEST
        a[entry_to[e]] = x
    if not finite:
        return NO_PIVOT
    for i in range(n):
        row_at[i] = i
    for k in range(n):
        at = k
        largest = abs(a[k * n + k]) * unit[row_at[k]]
        for i in range(k + 1, n):
            size = abs(a[i * n + k]) * unit[row_at[i]]
            if size > largest:
                largest = size
                at = i
        if at != k:
            for j in range(n):
                a[k * n + j], a[at * n + j] = a[at * n + j], a[k * n + j]
            row_at[k], row_at[at] = row_at[at], row_at[k]
        top, largest = 0.0, abs(a[k * n + k])
        for m in range(k):
            top = max(top, abs(a[k * n + m] * a[m * n + k]))
        if not (largest > PIVOT_NOISE * top):
            return NO_PIVOT
        d = 1.0 / a[k * n + k]
        if not (abs(d) <= _LARGEST and d != 0.0):
            return NO_PIVOT
        a[inverse + k] = d
        for i in range(k + 1, n):
            factor = a[i * n + k] * d
            a[i * n + k] = factor
            for j in range(k + 1, n):
                a[i * n + j] -= factor * a[k * n + j]
    return OK


@internal
def dense_solve(lu: Any, b_address: int) -> None:
    """Overwrite the (n,) vector at `b_address` with the solution."""
    n = lu.n
    a = vec(lu.values, n * n + n)
    inverse = n * n
    row_at = ivec(lu.pivots, n)
    b = vec(b_address, n)
    y = vec(lu.work, n)
    for i in range(n):
        s = b[row_at[i]]
        for j in range(i):
            s -= a[i * n + j] * y[j]
        y[i] = s
    for i in range(n - 1, -1, -1):
        s = y[i]
        for j in range(i + 1, n):
            s -= a[i * n + j] * b[j]
        b[i] = s * a[inverse + i]


@internal
def dense_solve_transposed(lu: Any, b_address: int) -> None:
    """Overwrite the (n,) vector at `b_address` with the solution of A^T x = b."""
    n = lu.n
    a = vec(lu.values, n * n + n)
    inverse = n * n
    row_at = ivec(lu.pivots, n)
    b = vec(b_address, n)
    y = vec(lu.work, n)
    for i in range(n):
        s = b[i]
        for j in range(i):
            s -= a[j * n + i] * y[j]
        y[i] = s * a[inverse + i]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            y[i] -= a[j * n + i] * y[j]
    for i in range(n):
        b[row_at[i]] = y[i]
