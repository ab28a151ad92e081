"""Along which of its two tangents a contact is held by itself, beside all that others hold: both, one, or none."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat
from ..linalg.small import call_least_norm
from ..state.modes import ALONG
from ..state.modes import STICKS as STUCK
from .forces import cones_at
from .rates_in_space import masses
from .records import COS_WAY, COUNT, F_N, F_S, F_T, NEW_RATIO, NEW_SLIDE, SIN_WAY, col, whole

RANK_OF_HELD = 1e-8
"""Of its inverse mass: a tangent of which no more is left beside others is held by these."""


@internal
def _part(ev: Any, count: int, row: int, which: int) -> Any:
    """(direction, factor) of the two that make row `row`: a normal, or the first or second tangent of a contact, in its
    own frame."""
    i = row % count
    c, s = col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i]
    if row < count:
        return (row, 1.0) if which == 0 else (row, 0.0)
    if row < 2 * count:
        return (count + i, c) if which == 0 else (2 * count + i, s)
    return (count + i, -s) if which == 0 else (2 * count + i, c)


@internal
def _between(ev: Any, count: int, one: int, other: int) -> float:
    """Inverse mass between two rows."""
    a, total = masses(ev, count), 0.0
    for j in range(2):
        p, of_p = _part(ev, count, one, j)
        for k in range(2):
            q, of_q = _part(ev, count, other, k)
            total += of_p * of_q * a[p, q]
    return total


@internal
def hold(ev: Any, total: int, i: int, rank: float) -> int:
    """Along which tangents contact i is held by itself beside the first `total` rows in `some`: both, one, or none, to
    NEW_SLIDE with the way and the share; the rows go to `some`, and their number is returned. One is that which the
    others hold least."""
    count, some = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most)
    f_n, f_t, f_s = col(ev, F_N)[i], col(ev, F_T)[i], col(ev, F_S)[i]
    cos_way, sin_way, c, s = col(ev, COS_WAY), col(ev, SIN_WAY), col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i]
    cos_way[i], sin_way[i] = 1.0, 0.0
    matrix, rows = mat(ev.space_room, total, total), (count + i, 2 * count + i)
    right = mat(ev.space_room + 8 * total * total, total, 2)
    found = mat(ev.space_room + 8 * total * (total + 2), total, 2)
    for k in range(total):
        for j in range(2):
            right[k, j] = _between(ev, count, some[k], rows[j])
        for j in range(total):
            matrix[k, j] = _between(ev, count, some[k], some[j])
    most = 3 * ev.most
    work = ev.space_room + 8 * (most * most + 4 * most)
    call_least_norm(cones_at(ev.cones).least_norm, matrix, right, found, RANK_OF_HELD, work)
    # what is left of both, and its principal directions
    left_11, left_12 = _between(ev, count, rows[0], rows[0]), _between(ev, count, rows[0], rows[1])
    left_22 = _between(ev, count, rows[1], rows[1])
    least = max(rank, RANK_OF_HELD) * (left_11 + left_22)
    for k in range(total):
        first, second = _between(ev, count, some[k], rows[0]), _between(ev, count, some[k], rows[1])
        left_11 -= first * found[k, 0]
        left_12 -= first * found[k, 1]
        left_22 -= second * found[k, 1]
    half, radius = 0.5 * (left_11 + left_22), math.hypot(0.5 * (left_11 - left_22), left_12)
    if half - radius > least:
        col(ev, NEW_SLIDE)[i], col(ev, NEW_RATIO)[i] = STUCK, 0.0
        some[total], some[total + 1] = rows
        return 2
    if half + radius > least:
        angle = 0.5 * math.atan2(2.0 * left_12, left_11 - left_22)
        cos_way[i], sin_way[i] = math.cos(angle), math.sin(angle)
        col(ev, NEW_SLIDE)[i] = ALONG
        col(ev, NEW_RATIO)[i] = (cos_way[i] * f_s - sin_way[i] * f_t) / f_n if f_n > 0.0 else 0.0
        some[total] = rows[0]
        return 1
    cos_way[i], sin_way[i] = c, s
    return 0
