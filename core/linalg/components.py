"""Parts of a factored matrix that have nothing to do with each other, and solutions within a few of them.

Bodies without joints between them are such parts of the equations of motion. A right side that has entries in one or
two of them alone is solved for with the pivots of these.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import uvec, vec

RIGHT_SIDES = 6
"""Right sides that are solved for at once."""


@internal
def _root(parent: Any, i: int) -> int:
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@internal
def _join(parent: Any, i: int, j: int) -> None:
    """The smaller number becomes the root of both."""
    i, j = _root(parent, i), _root(parent, j)
    if i < j:
        parent[j] = i
    else:
        parent[i] = j


@internal
def find_components(lu: Any, component: Any, start: Any, pivots: Any, place: Any) -> int:
    """Which pivots of a sparse factored matrix are connected: how many such components there are.

    component (n,): that of each pivot; start (n + 1,), pivots (n,): the pivots of each, ascending; place (n,): pivot of
    each row of the matrix.
    """
    n, nl, nu, count = lu.n, lu.nl, lu.nu, 0
    l_row, l_col, u_row, u_col = uvec(lu.l_row, nl), uvec(lu.l_col, nl), uvec(lu.u_row, nu), uvec(lu.u_col, nu)
    row_at = uvec(lu.row_at, n)
    for j in range(n):
        component[j], place[np.int64(row_at[j])], start[j] = j, j, 0
    for e in range(nl):
        _join(component, np.int64(l_row[e]), np.int64(l_col[e]))
    for e in range(nu):
        _join(component, np.int64(u_row[e]), np.int64(u_col[e]))
    # roots come before what belongs to them
    for j in range(n):
        if component[j] == j:
            component[j] = count
            count += 1
        else:
            component[j] = component[component[j]]
    start[n] = 0
    for j in range(n):
        start[component[j] + 1] += 1
    for c in range(count):
        start[c + 1] += start[c]
    for j in range(n):
        c = component[j]
        pivots[start[c]] = j
        start[c] += 1
    for c in range(count):
        k = count - c
        start[k] = start[k - 1]
    start[0] = 0
    return count


@internal
def solve_component(lu: Any, pivots: Any, first: int, last: int, y: Any) -> None:
    """Solutions with the sparse factors for `RIGHT_SIDES` right sides y (n, RIGHT_SIDES), rows in the order of the
    pivots, that have entries in one component, `pivots[first:last]`; in place."""
    n, nl, nu = lu.n, lu.nl, lu.nu
    v, l_start, u_start = vec(lu.values, nl + nu + n), uvec(lu.l_start, n + 1), uvec(lu.u_start, n + 1)
    l_row, u_row = uvec(lu.l_row, nl), uvec(lu.u_row, nu)
    for e in range(first, last):
        j = pivots[e]
        for p in range(np.int64(l_start[j]), np.int64(l_start[j + 1])):
            i, factor = np.int64(l_row[p]), v[p]
            for k in range(RIGHT_SIDES):
                y[i, k] -= factor * y[j, k]
    for e in range(last - first):
        j = pivots[last - 1 - e]
        for p in range(np.int64(u_start[j]), np.int64(u_start[j + 1])):
            i, factor = np.int64(u_row[p]), v[nl + p]
            for k in range(RIGHT_SIDES):
                y[i, k] -= factor * y[j, k]
    for e in range(first, last):
        j = pivots[e]
        for k in range(RIGHT_SIDES):
            y[j, k] *= v[nl + nu + j]
