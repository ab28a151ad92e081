"""Friction of contacts that stick: what it takes away from the normals' block, and how contacts share it."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import mat
from ..linalg.small import add, call_least_norm, least_norm_size
from ..rounding import STICKING_RANK


def sticking_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `hold_tangents` and `share` for n contacts."""
    return 2 * n * n + least_norm_size(n, n, n)


@internal
def hold_tangents(cn: Any, stuck: Any, tn: Any, matrix: Any, across: Any, work: int) -> None:
    """matrix (n, n), the motion of the normals by normal forces, becomes that with the contacts `stuck` (numbers) held
    along their tangents: minus A_NT along^+ tn[stuck], along = A_TT[stuck, stuck].

    tn (n, n): motion of the tangents by normal forces. across (stuck, n) becomes along^+ A_NT[:, stuck]^T. `work`: the
    address of `sticking_size` numbers.
    """
    n, count = len(matrix), len(stuck)
    nt, tt = mat(cn.nt, n, n), mat(cn.tt, n, n)
    along, b = mat(work, count, count), mat(work + 8 * count * count, count, n)
    for i in range(count):
        for j in range(count):
            along[i, j] = tt[stuck[i], stuck[j]]
        for j in range(n):
            b[i, j] = nt[j, stuck[i]]
    call_least_norm(cn.least_norm, along, b, across, STICKING_RANK, work + 8 * count * (count + n))
    for i in range(n):
        for k in range(count):
            add(matrix[i], -across[k, i], tn[stuck[k]])


@internal
def share(cn: Any, stuck: Any, limit: Any, wanted: Any, friction: Any, work: int) -> None:
    """Friction (stuck, 1) of the contacts `stuck` (numbers) that makes the motion `wanted` (stuck, 1), which is
    overwritten, along their tangents: each takes as much of its `limit` (stuck,) as the others that it shares with, sum
    of friction^2/limit being least. `work` as in `hold_tangents`."""
    n, count = cn.n, len(stuck)
    tt, matrix = mat(cn.tt, n, n), mat(work, count, count)
    for i in range(count):
        for j in range(count):
            matrix[i, j] = tt[stuck[i], stuck[j]] * np.sqrt(limit[j])
    call_least_norm(cn.least_norm, matrix, wanted, friction, STICKING_RANK, work + 8 * count * count)
    for i in range(count):
        friction[i, 0] *= np.sqrt(limit[i])
