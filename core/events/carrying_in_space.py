"""What each of the closed contacts with two tangents does, and which of their rows others imply: as `carrying.py`.

All contacts that press stay closed, with the forces that equally compliant contacts would have
(`tables/compatibility.py`). One that has reached the limit of its friction and is held by others keeps that limit.
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..cones.directions import call_independent
from ..rounding import REACHES_LIMIT_NOW
from ..state.modes import AT_LIMIT, IDLE, OF_FIRST, OF_NORMAL, OF_SECOND
from ..state.modes import STICKS as STUCK
from ..tables.held import in_space
from .free_tangents import add_tangents, inverse_mass, is_free, is_full, turn_to_friction
from .records import (
    CLOSES,
    COS_WAY,
    COUNT,
    DIRECTION,
    F_N,
    F_S,
    F_T,
    FLAG,
    NEW_IMPLIED,
    NEW_RATIO,
    NEW_SLIDE,
    RANK,
    SETTLED,
    SIN_WAY,
    STATIC,
    clear,
    col,
    real,
    whole,
)


@internal
def _independent(ev: Any, ws: Any, number: int, rank: float) -> int:
    """As `forces.independent_of`, among all three blocks."""
    count, work = whole(ev)[COUNT], vec(ev.work, ev.work_size)
    directions, responses = mat(ev.directions, 3 * count, ws.n), mat(ev.responses, 3 * count, ws.n)
    some, chosen = ivec(ev.some, number), ivec(ev.chosen, 3 * ev.most)
    return int(call_independent(ev.independent, directions, responses, some, rank, chosen, work))


@internal
def _turn(ev: Any, ws: Any, back: bool) -> None:
    """Directions and responses of the tangents in the frames of the contacts, or `back` as they were."""
    count, n = whole(ev)[COUNT], ws.n
    for rows in (mat(ev.directions, 3 * count, n), mat(ev.responses, 3 * count, n)):
        for i in range(count):
            c, s = col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i]
            if col(ev, FLAG)[i] == 0.0 or col(ev, DIRECTION)[i] != 0.0:
                continue
            s = -s if back else s
            for j in range(n):
                x, y = rows[count + i, j], rows[2 * count + i, j]
                rows[count + i, j], rows[2 * count + i, j] = c * x + s * y, c * y - s * x


@internal
def _bit(block: int) -> int:
    """What IMPLIED of the memory says of a row of the normals, of the first or the second tangents."""
    return OF_NORMAL if block == 0 else (OF_FIRST if block == 1 else OF_SECOND)


@internal
def _keep_at_limit(ev: Any, ws: Any, i: int, held: int, total: int) -> int:
    """Contact i, at the limit of its friction: it keeps that limit if the first `held` rows in `some` hold it, else it
    sticks as long as nothing moves it. How many rows there are then."""
    count, some = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most)
    plane, free = not in_space(ws, ivec(ev.contacts, ev.most)[i]), is_free(ev, held, i)
    friction = math.hypot(col(ev, F_T)[i], col(ev, F_S)[i])
    if free:
        col(ev, NEW_SLIDE)[i] = STUCK
        some[total] = count + i if plane else 2 * count + i
    else:
        col(ev, NEW_SLIDE)[i], col(ev, NEW_RATIO)[i] = IDLE if plane else AT_LIMIT, friction / col(ev, F_N)[i]
    if plane:
        # along the one tangent that it has
        col(ev, COS_WAY)[i] = 1.0 if free else math.copysign(1.0, col(ev, F_T)[i])
        col(ev, SIN_WAY)[i] = 0.0
    return total + 1 if free else total


@internal
def keep_in_space(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """As `keep`: normals first, those that carry most before others, then tangents of those that stick, those at their
    limits last."""
    count, some, flag = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most), col(ev, FLAG)
    f_n, implied, slide, ratio = col(ev, F_N), col(ev, NEW_IMPLIED), col(ev, NEW_SLIDE), col(ev, NEW_RATIO)
    rank, total, friction = real(ev)[RANK], 0, vec(dr.friction, ws.n_contacts)
    clear(flag, count)
    clear(implied, count)
    for i in range(count):
        if col(ev, CLOSES)[i] != 0.0:
            flag[i] = 1.0
            at = total
            while at > 0 and f_n[some[at - 1]] < f_n[i]:
                some[at] = some[at - 1]
                at -= 1
            some[at] = i
            total += 1
    for at_limit in range(2):
        for i in range(count):
            if flag[i] == 0.0:
                continue
            full = is_full(ev, i, REACHES_LIMIT_NOW)
            if col(ev, STATIC)[i] == 0.0 or col(ev, DIRECTION)[i] != 0.0:
                # (what a spin leaves of it the contact itself says)
                rubs = col(ev, STATIC)[i] > 0.0
                slide[i] = 1.0 if rubs else IDLE
                ratio[i] = -friction[ivec(ev.contacts, ev.most)[i]] if rubs else 0.0
            elif full == (at_limit == 1):
                turn_to_friction(ev, i, full)
                slide[i], ratio[i] = AT_LIMIT if full else STUCK, 0.0
                total = add_tangents(ev, ws, i, full, total)
    held = total
    for i in range(count):
        if flag[i] != 0.0 and slide[i] == AT_LIMIT:
            total = _keep_at_limit(ev, ws, i, held, total)
    for j in range(total):
        implied[some[j] % count] += _bit(some[j] // count)
    # a tangent that joints hold has no inverse mass, and rounding must not say that it has
    moving = 0
    for j in range(total):
        if inverse_mass(ev, some[j]) > 0.0:
            some[moving] = some[j]
            moving += 1
    total = moving
    _turn(ev, ws, False)
    kept, chosen = _independent(ev, ws, total, rank), ivec(ev.chosen, 3 * ev.most)
    _turn(ev, ws, True)
    for j in range(kept):
        row = some[chosen[j]]
        implied[row % count] -= _bit(row // count)
    return SETTLED
