"""Linear complementarity problems: find z >= 0 with w = M z + q >= 0 and z . w = 0.

Lemke's complementary pivoting with a lexicographic ratio test (Cottle, Pang, Stone 1992, algorithm 4.4.5): ends for
every problem, degenerate ones (redundant contacts) included. For positive semidefinite and copositive-plus M it finds
a solution if one exists.
"""

import numpy as np
from numpy.typing import NDArray

PIVOT = 1e-11
"""An entry of a column below this, relative to the column's largest, is rounding."""
TIES = (1e-13, 1e-11, 1e-9)
"""Right-hand sides and ratios nearer than this (relative) are equal; where rounding leads pivoting astray with the
first, the next is tried."""
VIOLATION = 1e-9
"""Of the conditions, relative: beyond it a result is none."""


class NoComplementarySolution(ArithmeticError):
    """The pivoting ended on a ray: the problem has no solution, or M is of a class for which it cannot find one."""


def solve_lcp(m: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
    """z (n,) of the problem with matrix m (n, n) and vector q (n,).

    Raises
    ------
    NoComplementarySolution : if the pivoting ends on a ray.
    """
    n = len(q)
    size = float(np.max(np.abs(q), initial=0.0))
    if n == 0 or float(np.min(q)) >= -TIES[0] * size:
        return np.zeros(n)
    for tie in TIES:
        z = _lemke(m, q, size, tie)
        if z is not None and float(np.min(m @ z + q)) >= -VIOLATION * size:
            return z
    raise NoComplementarySolution("Lemke's pivoting ends on a ray: the complementarity problem has no solution")


def _lemke(m: NDArray[np.float64], q: NDArray[np.float64], size: float, tie: float) -> NDArray[np.float64] | None:
    """The solution, or None if the pivoting ends on a ray or does not end."""
    n = len(q)
    # columns: w (0 .. n-1), z (n .. 2n-1), the artificial variable (2n), the right-hand side
    table = np.hstack([np.eye(n), -m, -np.ones((n, 1)), q[:, None] / size])
    basis = np.arange(n)
    row = _first_row(table, tie)
    entering = 2 * n
    for _ in range(60 * n + 100):
        leaving = int(basis[row])
        _pivot(table, row, entering)
        basis[row] = entering
        if leaving == 2 * n:
            return _refined(m, q, basis)
        entering = leaving + n if leaving < n else leaving - n
        row = _ratio_row(table, entering, basis, tie)
        if row < 0:
            return None
    return None


def _first_row(table: NDArray[np.float64], tie: float) -> int:
    """Row of the most negative right-hand side; ties by the lexicographic order."""
    n = len(table)
    least = table[:, -1].min()
    candidates = np.flatnonzero(table[:, -1] <= least + tie)
    return _lexicographic(table[candidates][:, :n], candidates)


def _ratio_row(table: NDArray[np.float64], entering: int, basis: NDArray[np.int64], tie: float) -> int:
    """Row that leaves when column `entering` grows; -1 if nothing limits it."""
    n = len(table)
    column = table[:, entering]
    rows = np.flatnonzero(column > PIVOT * max(1.0, float(np.max(np.abs(column)))))
    if len(rows) == 0:
        return -1
    ratio = table[rows, -1] / column[rows]
    least = ratio.min()
    rows = rows[ratio <= least + tie * max(1.0, abs(least))]
    artificial = rows[basis[rows] == 2 * n]
    if len(artificial):
        return int(artificial[0])
    return _lexicographic(table[rows][:, :n] / column[rows][:, None], rows)


def _lexicographic(vectors: NDArray[np.float64], rows: NDArray[np.int64]) -> int:
    """The row whose vector is lexicographically least."""
    order = np.lexsort(vectors.T[::-1])
    return int(rows[order[0]])


def _pivot(table: NDArray[np.float64], row: int, column: int) -> None:
    table[row] /= table[row, column]
    factors = table[:, column].copy()
    factors[row] = 0.0
    table -= factors[:, None] * table[row]


def _refined(m: NDArray[np.float64], q: NDArray[np.float64], basis: NDArray[np.int64]) -> NDArray[np.float64]:
    """z of a complementary basis, solved anew from the given matrix: free of the pivoting's rounding."""
    n = len(q)
    basic = np.sort(basis[(basis >= n) & (basis < 2 * n)] - n)
    z = np.zeros(n)
    if len(basic):
        block = m[np.ix_(basic, basic)]
        z[basic] = np.linalg.lstsq(block, -q[basic], rcond=1e-13)[0]
    return np.maximum(z, 0.0)
