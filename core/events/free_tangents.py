"""What closed gaps and other sticking contacts leave free of a contact's tangents.

Rows are numbers: a contact, plus the count of contacts for its first tangent, plus twice that for its second. Tangents
are those of the contact's frame (COS_WAY, SIN_WAY). Where friction has reached its limit the second one is along it,
and the first one, across, is held: friction can turn, but not grow.
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat
from ..linalg.small import call_least_norm
from ..rounding import DIRECTION_RANK
from ..tables.held import in_space
from .forces import cones_at
from .rates_in_space import masses
from .records import COS_WAY, COUNT, F_N, F_S, F_T, SIN_WAY, STATIC, TAKES, col, whole

RANK_OF_FREE = 1e-6
"""Of its inverse mass: a tangent of which no more is left beside other rows is held by these."""


@internal
def is_full(ev: Any, i: int, near: float) -> bool:
    """True if the friction of contact i has reached its limit, but for the part `near` of it."""
    size, limit = math.hypot(col(ev, F_T)[i], col(ev, F_S)[i]), col(ev, STATIC)[i] * col(ev, F_N)[i]
    return size > 0.0 and size >= (1.0 - near) * limit


@internal
def turn_to_friction(ev: Any, i: int, full: bool) -> None:
    """The frame of contact i: its second tangent along its friction if that is `full`, else as it was found."""
    size = math.hypot(col(ev, F_T)[i], col(ev, F_S)[i])
    col(ev, COS_WAY)[i] = col(ev, F_S)[i] / size if full else 1.0
    col(ev, SIN_WAY)[i] = -col(ev, F_T)[i] / size if full else 0.0


@internal
def add_tangents(ev: Any, ws: Any, i: int, full: bool, total: int) -> int:
    """Add the rows that contact i holds along its tangents to the first `total` in `some`; how many there are then."""
    count, some = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most)
    plane = not in_space(ws, ivec(ev.contacts, ev.most)[i])
    if plane and full:
        return total
    some[total] = count + i
    if plane or full:
        return total + 1
    some[total + 1] = 2 * count + i
    return total + 2


@internal
def _part(ev: Any, count: int, row: int, which: int) -> Any:
    """(direction, factor) of the two that make row `row`."""
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
def inverse_mass(ev: Any, row: int) -> float:
    """Inverse mass of a row."""
    return _between(ev, whole(ev)[COUNT], row, row)


@internal
def is_free(ev: Any, total: int, i: int) -> bool:
    """True if contact i, whose friction has reached its limit, can slide along it beside the first `total` rows in
    `some`, which are held."""
    count, some, most = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most), 3 * ev.most
    row = 2 * count + i
    matrix, right = mat(ev.space_room, total, total), mat(ev.space_room + 8 * total * total, total, 1)
    found, work = mat(ev.space_room + 8 * total * (total + 1), total, 1), ev.space_room + 8 * (most * most + 4 * most)
    for k in range(total):
        right[k, 0] = _between(ev, count, some[k], row)
        for j in range(total):
            matrix[k, j] = _between(ev, count, some[k], some[j])
    left = _between(ev, count, row, row)
    least = RANK_OF_FREE * left
    if total > 0:
        call_least_norm(cones_at(ev.cones).least_norm, matrix, right, found, DIRECTION_RANK, work)
    for k in range(total):
        left -= _between(ev, count, some[k], row) * found[k, 0]
    return left > least


@internal
def list_held(ev: Any, ws: Any, direction: Any, near: float) -> int:
    """Rows that are held, to `some`: normals of the contacts that press, and tangents of those that stick, with their
    frames; how many."""
    count, some, total = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most), 0
    for i in range(count):
        if col(ev, TAKES)[i] != 0.0 and col(ev, F_N)[i] > 0.0:
            some[total] = i
            total += 1
    for i in range(count):
        pressed = col(ev, TAKES)[i] != 0.0 and col(ev, F_N)[i] > 0.0
        if pressed and direction[i] == 0.0 and col(ev, STATIC)[i] > 0.0:
            full = is_full(ev, i, near)
            turn_to_friction(ev, i, full)
            total = add_tangents(ev, ws, i, full, total)
    return total
