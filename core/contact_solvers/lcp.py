"""Linear complementarity problems: find z >= 0 with w = M z + q >= 0 and z . w = 0.

Lemke's complementary pivoting with a lexicographic ratio test (Cottle, Pang, Stone 1992, algorithm 4.4.5): ends for
every problem, degenerate ones (redundant contacts) included. For positive semidefinite and copositive-plus M it finds
a solution if one exists.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled import types
from ..compiled.jit import address_of, caller, compiled, internal
from ..compiled.views import ivec, mat
from ..linalg.small import LEAST_NORM_SIGNATURE, add, call_least_norm, dot, least_norm, least_norm_size
from ..rounding import LCP_PIVOT, LCP_RANK, LCP_TIES, LCP_VIOLATION

FIND_SIGNATURE = types.boolean(
    types.int64, types.Array(types.float64, 2, "C"), *(types.Array(types.float64, 1, "C"),) * 2, types.int64
)
call_find = caller(FIND_SIGNATURE)
"""call_find(address of `find_complementary`, that of `least_norm`, m, q, z, work)."""


class NoComplementarySolution(ArithmeticError):
    """The pivoting ended on a ray: the problem has no solution, or M is of a class for which it cannot find one."""


def lcp_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `find_complementary`."""
    return n * (2 * n + 2) + 4 * n + least_norm_size(n, n, 1)


def solve_lcp(m: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
    """z (n,) of the problem with matrix m (n, n) and vector q (n,).

    Raises
    ------
    NoComplementarySolution : if the pivoting ends on a ray.
    """
    z, work = np.zeros(len(q)), np.empty(lcp_size(len(q)))
    m, q = (np.ascontiguousarray(x, dtype=np.float64) for x in (m, q))
    if not _find(
        address_of(find_complementary, FIND_SIGNATURE), address_of(least_norm, LEAST_NORM_SIGNATURE), m, q, z, work
    ):
        raise NoComplementarySolution("Lemke's pivoting ends on a ray: the complementarity problem has no solution")
    return z


@compiled
def _find(find: int, by_norm: int, m: Any, q: Any, z: Any, work: Any) -> bool:
    return bool(call_find(find, by_norm, m, q, z, work.ctypes.data))


@internal
def find_complementary(by_norm: int, m: Any, q: Any, z: Any, work: int) -> bool:
    """z (n,) of the problem with m (n, n) and q (n,); False if the pivoting ends on a ray. `by_norm` is the address
    of `least_norm`, `work` that of `lcp_size` numbers."""
    n, size, least = len(q), 0.0, 0.0
    for i in range(n):
        z[i] = 0.0
        if not np.isfinite(q[i]):
            return False
        size, least = max(size, abs(q[i])), min(least, q[i])
    if least >= -LCP_TIES[0] * size:
        return True
    for tie in LCP_TIES:
        if _lemke(by_norm, m, q, z, size, tie, work):
            least = 0.0
            for i in range(n):
                least = min(least, dot(m[i], z) + q[i])
            if least >= -LCP_VIOLATION * size:
                return True
    return False


@internal
def _lemke(by_norm: int, m: Any, q: Any, z: Any, size: float, tie: float, work: int) -> bool:
    """The solution; False if the pivoting ends on a ray or does not end."""
    n = len(q)
    # columns: w (0 .. n-1), z (n .. 2n-1), the artificial variable (2n), the right-hand side
    start, table = work, mat(work, n, 2 * n + 2)
    work += 8 * n * (2 * n + 2)
    basis, rows = ivec(work, n), ivec(work + 8 * n, n)
    work += 16 * n
    for i in range(n):
        basis[i] = i
        for j in range(n):
            table[i, j], table[i, n + j] = 1.0 if i == j else 0.0, -m[i, j]
        table[i, 2 * n], table[i, 2 * n + 1] = -1.0, q[i] / size
    row, entering = _first_row(table, rows, tie), 2 * n
    for _ in range(60 * n + 100):
        leaving = basis[row]
        _pivot(table, row, entering)
        basis[row] = entering
        if leaving == 2 * n:
            _refine(by_norm, m, q, z, basis, rows, start, work)
            return True
        entering = leaving + n if leaving < n else leaving - n
        row = _ratio_row(table, entering, basis, rows, tie)
        if row < 0:
            return False
    return False


@internal
def _first_row(table: Any, rows: Any, tie: float) -> int:
    """Row of the most negative right-hand side; ties by the lexicographic order."""
    n, least, count = len(table), np.inf, 0
    for i in range(n):
        least = min(least, table[i, 2 * n + 1])
    for i in range(n):
        if table[i, 2 * n + 1] <= least + tie:
            rows[count] = i
            count += 1
    return int(_lexicographic(table, rows, count, -1))


@internal
def _ratio_row(table: Any, entering: int, basis: Any, rows: Any, tie: float) -> int:
    """Row that leaves when column `entering` grows; -1 if nothing limits it."""
    n, largest, least, count = len(table), 1.0, np.inf, 0
    for i in range(n):
        largest = max(largest, abs(table[i, entering]))
    for i in range(n):
        if table[i, entering] > LCP_PIVOT * largest:
            least = min(least, table[i, 2 * n + 1] / table[i, entering])
    for i in range(n):
        x = table[i, entering]
        if x > LCP_PIVOT * largest and table[i, 2 * n + 1] / x <= least + tie * max(1.0, abs(least)):
            if basis[i] == 2 * n:
                return i
            rows[count] = i
            count += 1
    return int(_lexicographic(table, rows, count, entering)) if count > 0 else -1


@internal
def _lexicographic(table: Any, rows: Any, count: int, column: int) -> int:
    """Of the first `count` of `rows` that which is lexicographically least, each over its entry in `column` (-1: as it
    is)."""
    least = rows[0]
    for k in range(1, count):
        row = rows[k]
        one, other = 1.0, 1.0
        if column >= 0:
            one, other = table[row, column], table[least, column]
        for j in range(len(table)):
            x, y = table[row, j] / one, table[least, j] / other
            if x < y:
                least = row
            if x != y:
                break
    return int(least)


@internal
def _pivot(table: Any, row: int, column: int) -> None:
    x = table[row, column]
    for j in range(table.shape[1]):
        table[row, j] /= x
    for i in range(len(table)):
        x = table[i, column]
        if i != row and x != 0.0:
            add(table[i], -x, table[row])


@internal
def _refine(by_norm: int, m: Any, q: Any, z: Any, basis: Any, basic: Any, table: int, work: int) -> None:
    """z of a complementary basis, solved anew from the given matrix: free of the pivoting's rounding. What is at the
    addresses `table` and `work` is used no more."""
    n, count = len(q), 0
    for i in range(n):
        for j in range(n):
            if basis[j] == n + i:
                basic[count] = i
                count += 1
    block, b, x = mat(table, count, count), mat(work, count, 1), mat(work + 8 * count, count, 1)
    for i in range(count):
        b[i, 0] = -q[basic[i]]
        for j in range(count):
            block[i, j] = m[basic[i], basic[j]]
    call_least_norm(by_norm, block, b, x, LCP_RANK, work + 16 * count)
    for i in range(n):
        z[i] = 0.0
    for i in range(count):
        z[basic[i]] = max(x[i, 0], 0.0)
