"""Small dense systems inside compiled code, of any rank: least solutions, LU. Nothing is allocated.

Rank is told by singular values. Columns are brought in order by a QR factorisation with column pivoting (Golub & Van
Loan, Matrix Computations, 5.4); what is left of the rows is rounding, or clearly independent, or, between the two, made
orthogonal by one-sided Jacobi rotations (Hestenes 1958; Drmac and Veselic 2008), whose lengths are the singular values.
Reflections from the right then give what is least (complete orthogonal decomposition, 5.4.7).
"""

from typing import Any

import numpy as np

from ..compiled import types
from ..compiled.jit import caller, internal
from ..compiled.views import ivec, vec

_MATRIX = types.Array(types.float64, 2, "C")
LEAST_NORM_SIGNATURE = types.int64(_MATRIX, _MATRIX, _MATRIX, types.float64, types.int64)
call_least_norm = caller(LEAST_NORM_SIGNATURE)
"""call_least_norm(address of `least_norm`, a, b, x, tolerance, work), so that its code is not part of each caller's."""

EPS = float(np.finfo(np.float64).eps)
NOISE = 4.0 * EPS
"""Times the number of columns, of the largest column: what is left of the rows is rounding."""
CLEAR = 1e-5
"""Of the largest pivot: with none below it, no singular value is near the smallest that counts."""
SWEEPS = 40
"""Of rotations; they converge quadratically, within ten."""


def least_norm_size(m: int, n: int, p: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `least_norm` for an (m, n) matrix and p right-hand sides."""
    return 5 * max(m, n, p)


@internal
def dot(x: Any, y: Any) -> float:
    """x . y of two rows."""
    n = len(x)
    # four sums, since the compiler may not change the order of one
    s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0
    for k in range(n // 4):
        s0 += x[4 * k] * y[4 * k]
        s1 += x[4 * k + 1] * y[4 * k + 1]
        s2 += x[4 * k + 2] * y[4 * k + 2]
        s3 += x[4 * k + 3] * y[4 * k + 3]
    for k in range(4 * (n // 4), n):
        s0 += x[k] * y[k]
    return (s0 + s1) + (s2 + s3)


@internal
def add(x: Any, factor: float, y: Any) -> None:
    """x + factor y -> x, of two rows."""
    for k in range(len(x)):
        x[k] += factor * y[k]


@internal
def solve_square(a: Any, b: Any) -> int:
    """b (n,) -> x of a x = b with a (n, n), which is overwritten: LU with partial pivoting. Returns the sign of a's
    determinant, 0 if a is singular."""
    n, sign = len(b), 1
    for k in range(n):
        at = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[at, k]):
                at = i
        if a[at, k] == 0.0:
            return 0
        if a[at, k] < 0.0:
            sign = -sign
        if at != k:
            sign = -sign
            for j in range(k, n):
                a[k, j], a[at, j] = a[at, j], a[k, j]
            b[k], b[at] = b[at], b[k]
        for i in range(k + 1, n):
            factor = a[i, k] / a[k, k]
            if factor != 0.0:
                add(a[i, k + 1 :], -factor, a[k, k + 1 :])
                b[i] -= factor * b[k]
    for k in range(n - 1, -1, -1):
        b[k] = (b[k] - dot(a[k, k + 1 :], b[k + 1 :])) / a[k, k]
    return sign


@internal
def _from_left(a: Any, b: Any, noise: float, order: Any, work: int) -> int:
    """a (m, n), its columns in `order` (n,), to upper triangular rows by reflections, which b (m, p) undergoes too.
    Returns how many rows are more than `noise` of the largest column."""
    m, n = a.shape
    p = b.shape[1]
    v, of_a, of_b, left = (
        vec(work, m),
        vec(work + 8 * m, n),
        vec(work + 8 * (m + n), p),
        vec(work + 8 * (m + n + p), n),
    )
    largest = 0.0
    for j in range(n):
        order[j], left[j] = j, 0.0
    for i in range(m):
        for j in range(n):
            left[j] += a[i, j] * a[i, j]
    for k in range(min(m, n)):
        at, total = k, 0.0
        for j in range(k, n):
            total += left[j]
            if left[j] > left[at]:
                at = j
        if k == 0:
            largest = left[at]
        # (a comparison that is false for NaN too)
        if not total > noise * noise * largest:
            return k
        if at != k:
            for i in range(m):
                a[i, k], a[i, at] = a[i, at], a[i, k]
            order[k], order[at] = order[at], order[k]
            left[at] = left[k]
        size = 0.0
        for i in range(k, m):
            v[i] = a[i, k]
            size += v[i] * v[i]
        size = np.sqrt(size)
        top = -size if v[k] > 0.0 else size
        v[k] -= top
        unit = 0.0
        for i in range(k, m):
            unit += v[i] * v[i]
        unit = 2.0 / unit if unit > 0.0 else 0.0
        for j in range(k + 1, n):
            of_a[j], left[j] = 0.0, 0.0
        for j in range(p):
            of_b[j] = 0.0
        for i in range(k, m):
            add(of_a[k + 1 :], v[i], a[i, k + 1 :])
            add(of_b, v[i], b[i])
        for i in range(k, m):
            factor = unit * v[i]
            a[i, k] = top if i == k else 0.0
            add(a[i, k + 1 :], -factor, of_a[k + 1 :])
            add(b[i], -factor, of_b)
            if i > k:
                for j in range(k + 1, n):
                    left[j] += a[i, j] * a[i, j]
    return min(m, n)


@internal
def _rotate(x: Any, y: Any, c: float, s: float) -> None:
    for k in range(len(x)):
        x[k], y[k] = c * x[k] - s * y[k], s * x[k] + c * y[k]


@internal
def _orthogonal(a: Any, b: Any, rank: int, tolerance: float, work: int) -> int:
    """The first `rank` rows of a, rotated until they are orthogonal, and those of b with them. Returns how many are
    longer than `tolerance` of the longest; these come first."""
    squares, spread = vec(work, rank), EPS * max(a.shape[1], 8)
    for _ in range(SWEEPS):
        turned = False
        for i in range(rank):
            squares[i] = dot(a[i], a[i])
        for i in range(rank - 1):
            for j in range(i + 1, rank):
                product = dot(a[i], a[j])
                if abs(product) > spread * np.sqrt(squares[i] * squares[j]):
                    turned = True
                    slope = (squares[j] - squares[i]) / (2.0 * product)
                    t = 1.0 / (abs(slope) + np.sqrt(1.0 + slope * slope))
                    t = t if slope >= 0.0 else -t
                    c = 1.0 / np.sqrt(1.0 + t * t)
                    _rotate(a[i], a[j], c, c * t)
                    _rotate(b[i], b[j], c, c * t)
                    squares[i] = max(squares[i] - t * product, 0.0)
                    squares[j] = max(squares[j] + t * product, 0.0)
        if not turned:
            break
    longest, kept = 0.0, 0
    for i in range(rank):
        longest = max(longest, squares[i])
    for i in range(rank):
        if squares[i] > tolerance * tolerance * longest:
            if kept < i:
                for k in range(a.shape[1]):
                    a[kept, k] = a[i, k]
                for k in range(b.shape[1]):
                    b[kept, k] = b[i, k]
            kept += 1
    return kept


@internal
def _rows_that_count(a: Any, b: Any, tolerance: float, order: Any, work: int) -> int:
    """The rank of a; as many rows at the top of a, in columns of `order`, span all its rows, and go with those of b."""
    rank = _from_left(a, b, min(NOISE * a.shape[1], 0.5 * tolerance), order, work)
    if rank > 0 and not abs(a[rank - 1, rank - 1]) > CLEAR * abs(a[0, 0]):
        return _orthogonal(a, b, rank, tolerance, work)
    return rank


@internal
def _from_right(a: Any, rank: int, corner: Any) -> None:
    """The first `rank` rows of a to lower triangular ones: the reflections (1 - v v^T) take the place of what becomes
    zero, and `corner` (rank,) gets the diagonal."""
    n = a.shape[1]
    for i in range(rank):
        size = np.sqrt(dot(a[i, i:], a[i, i:]))
        corner[i] = -size if a[i, i] > 0.0 else size
        # v.v is 2
        a[i, i] -= corner[i]
        unit = 1.0 / np.sqrt(-corner[i] * a[i, i])
        for j in range(i, n):
            a[i, j] *= unit
        for k in range(i + 1, rank):
            add(a[k, i:], -dot(a[i, i:], a[k, i:]), a[i, i:])


@internal
def least_norm(a: Any, b: Any, x: Any, tolerance: float, work: int) -> int:
    """x (n, p), the least of those with the least |a x - b|, a (m, n), b (m, p): as numpy's `lstsq` with this `rcond`.

    Singular values below `tolerance` of the largest are zero. a and b are overwritten; `work` is the address of
    `least_norm_size` numbers. Returns the rank.
    """
    n, p = a.shape[1], b.shape[1]
    most = max(a.shape[0], n, p)
    order, corner, sums = ivec(work, n), vec(work + 8 * most, n), vec(work + 16 * most, p)
    # (`corner` is scratch until the rows are found)
    rank = _rows_that_count(a, b, tolerance, order, work + 8 * most)
    _from_right(a, rank, corner)
    for i in range(rank):
        for j in range(i):
            for k in range(p):
                b[i, k] -= a[i, j] * b[j, k]
        for k in range(p):
            b[i, k] /= corner[i]
    for j in range(n):
        for k in range(p):
            x[order[j], k] = b[j, k] if j < rank else 0.0
    for i in range(rank - 1, -1, -1):
        for k in range(p):
            sums[k] = 0.0
        for j in range(i, n):
            for k in range(p):
                sums[k] += a[i, j] * x[order[j], k]
        for j in range(i, n):
            for k in range(p):
                x[order[j], k] -= a[i, j] * sums[k]
    return rank
