"""Friction of contacts that stick: what it takes away from the normals' block, and how contacts share it."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..linalg.small import add, least_norm, least_norm_size

RANK = 1e-10
"""Singular values of the block of friction that sticks below this part of the largest are zero."""


def sticking_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `take_away` and `shared` for n contacts."""
    return n * n + 3 * n + least_norm_size(n, n, n)


@internal
def take_away(cn: Any, stuck: Any, tn: Any, across: Any, matrix: Any, work: int) -> None:
    """matrix (n, n) -= A_NT along^+ tn[stuck], where along = A_TT[stuck, stuck]: the motion of the normals with the
    contacts `stuck` (numbers) held along their tangents. across (stuck, n) becomes along^+ A_NT[:, stuck]^T; tn (n, n) is
    the tangents' motion by the normal forces. `work`: the address of `sticking_size` numbers."""
    n, count = len(matrix), len(stuck)
    if count == 0:
        return
    nt, tt = mat(cn.nt, n, n), mat(cn.tt, n, n)
    along, b = mat(work, count, count), mat(work + 8 * count * count, count, n)
    work += 8 * count * (count + n)
    for i in range(count):
        for j in range(count):
            along[i, j] = tt[stuck[i], stuck[j]]
        for j in range(n):
            b[i, j] = nt[j, stuck[i]]
    least_norm(along, b, across, RANK, work)
    for i in range(n):
        for k in range(count):
            add(matrix[i], -across[k, i], tn[stuck[k]])


@internal
def shared(cn: Any, stuck: Any, limit: Any, wanted: Any, friction: Any, work: int) -> None:
    """Friction of the contacts `stuck` (numbers) that makes the motion `wanted` along their tangents: each takes as much
    of its `limit` as the others that it shares with, sum of friction^2/limit being least. All (stuck,)."""
    n, count = cn.n, len(stuck)
    tt = mat(cn.tt, n, n)
    matrix, b, x = mat(work, count, count), mat(wanted, count, 1), mat(friction, count, 1)
    for i in range(count):
        for j in range(count):
            matrix[i, j] = tt[stuck[i], stuck[j]] * np.sqrt(limit[j])
    least_norm(matrix, b, x, RANK, work + 8 * count * count)
    for i in range(count):
        x[i, 0] *= np.sqrt(limit[i])
