"""What each of the closed contacts does along its tangents, and which of their rows others imply.

All contacts that press stay closed, with the forces that equally compliant contacts would have
(`assembly/compatibility.py`). One that has reached the limit of its friction and is held by others keeps that limit.
"""

import math
from typing import Any

from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..model.rotation3d import dot
from ..rounding import IMMOVABLE, REACHES_LIMIT_NOW, TURNS
from ..state.modes import AT_LIMIT, IDLE, OF_FIRST, OF_NORMAL, OF_SECOND
from ..state.modes import STICKS as STUCK
from .forces import independent_of
from .free_tangents import add_tangents, find_sliding, inverse_mass, is_full, list_held, turn_to_friction
from .loaded import is_loaded
from .rates import masses
from .records import (
    CLOSES,
    COMPANION,
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
    OTHER_FLAG,
    RANK,
    SETTLED,
    SIN_WAY,
    STATIC,
    clear,
    col,
    real,
    whole,
)
from .three_tangents import axis_in_frame, first_of, size_of

RANK_OF_MANY, LOOSEST_RANK = 1e-6, 1e-4
"""Parts of an inverse mass: directions of many contacts that differ by less are taken for one; and at an instant that
does not settle. To bring rates of rounding's size to zero takes motions larger by one over the root of that."""


@internal
def _turn(ev: Any, ws: Any, back: bool) -> None:
    """Directions and responses of the tangents in the frames of the contacts, or `back` as they were."""
    count, n = whole(ev)[COUNT], ws.n
    for rows in (mat(ev.directions, 3 * count, n), mat(ev.responses, 3 * count, n)):
        for i in range(count):
            c, s = col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i]
            if col(ev, FLAG)[i] == 0.0 or col(ev, DIRECTION)[i] != 0.0:
                continue
            if col(ev, COMPANION)[i] != 0.0:
                if col(ev, COMPANION)[i] > 0.0:
                    _turn_three(ev, rows, count, i, n, back)
                continue
            s = -s if back else s
            for j in range(n):
                x, y = rows[count + i, j], rows[2 * count + i, j]
                rows[count + i, j], rows[2 * count + i, j] = c * x + s * y, c * y - s * x


@internal
def _turn_three(ev: Any, rows: Any, count: int, i: int, n: int, back: bool) -> None:
    """The same of contact i and its companion, of these rows."""
    x, y, z = axis_in_frame(ev, i, 0), axis_in_frame(ev, i, 1), axis_in_frame(ev, i, 2)
    if back:
        x, y, z = (x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])
    for j in range(n):
        was = rows[count + i, j], rows[2 * count + i, j], rows[count + i + 1, j]
        rows[count + i, j], rows[2 * count + i, j], rows[count + i + 1, j] = dot(x, was), dot(y, was), dot(z, was)


@internal
def _bit(block: int) -> int:
    """What IMPLIED of the memory says of a row of the normals, of the first or the second tangents."""
    return OF_NORMAL if block == 0 else (OF_FIRST if block == 1 else OF_SECOND)


@internal
def _list_closed(ev: Any) -> int:
    """Normals of the contacts that stay closed, to `some`, those that carry most before others; how many."""
    some, f_n, total = ivec(ev.some, 3 * ev.most), col(ev, F_N), 0
    for i in range(whole(ev)[COUNT]):
        if col(ev, CLOSES)[i] != 0.0:
            at = total
            while at > 0 and f_n[some[at - 1]] < f_n[i]:
                some[at] = some[at - 1]
                at -= 1
            some[at] = i
            total += 1
    return total


@internal
def _open_unloaded(ev: Any, ws: Any) -> None:
    """Contacts without force whose gaps others hold do not stay closed: they would share the others' load."""
    count, some, chosen = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most), ivec(ev.chosen, 3 * ev.most)
    closes, total = col(ev, CLOSES), 0
    for block in range(3):
        for i in range(count):
            sticks = block == 0 or (col(ev, DIRECTION)[i] == 0.0 and col(ev, STATIC)[i] > 0.0)
            if (
                closes[i] != 0.0
                and is_loaded(ev, i)
                and sticks
                and masses(ev, count)[block * count + i, block * count + i] > 0.0
            ):
                some[total] = block * count + i
                total += 1
    loaded = total
    for i in range(count):
        if closes[i] != 0.0 and not is_loaded(ev, i):
            some[total] = i
            total += 1
    if total == loaded:
        return
    kept = independent_of(ev, ws, loaded, total, total, real(ev)[RANK])
    for j in range(loaded, total):
        closes[some[j]] = 0.0
    for j in range(kept):
        if chosen[j] >= loaded:
            closes[some[chosen[j]]] = 1.0


@internal
def _list_at_limit(ev: Any, slides: float, total: int) -> int:
    """Tangents along the friction of those at their limits, behind the first `total` rows in `some`: of those that
    could slide (1 in OTHER_FLAG), or of the others. How many rows there are then."""
    count, some = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most)
    for i in range(count):
        at_limit = col(ev, FLAG)[i] != 0.0 and col(ev, NEW_SLIDE)[i] == AT_LIMIT
        if at_limit and col(ev, OTHER_FLAG)[i] == slides:
            if col(ev, COMPANION)[i] >= 0.0:
                some[total] = 2 * count + i
                total += 1
            if slides != 0.0:
                col(ev, NEW_SLIDE)[i] = STUCK
    return total


@internal
def _least_mass(ev: Any, row: int) -> float:
    """Of a row that is turned with three tangents what rounding may make of none, in parts of what these have."""
    count, total = whole(ev)[COUNT], 0.0
    own, a = first_of(ev, row % count), masses(ev, count)
    if col(ev, COMPANION)[own] == 0.0 or row < count:
        return 0.0
    for k in (count + own, 2 * count + own, count + own + 1):
        total += a[k, k]
    return IMMOVABLE * total


@internal
def _drop_immovable(ev: Any, total: int) -> int:
    """Keep those of the first `total` rows in `some` that have an inverse mass; how many. A tangent that joints hold
    has none, and rounding must not say that it has."""
    some, moving = ivec(ev.some, 3 * ev.most), 0
    for j in range(total):
        if inverse_mass(ev, some[j]) > _least_mass(ev, some[j]):
            some[moving] = some[j]
            moving += 1
    return moving


@internal
def _say_at_limit(ev: Any, ws: Any, i: int, tied: bool) -> None:
    """What contact i does whose friction has reached its limit, once it is known whether it sticks; `tied`: another one
    that has reached it is to hold the rest, for which it gets a margin."""
    plane, sticks = not in_space(ws, ivec(ev.contacts, ev.most)[i]), col(ev, NEW_SLIDE)[i] == STUCK
    if not sticks:
        ratio = size_of(ev, i, col(ev, F_T), col(ev, F_S)) / col(ev, F_N)[i]
        col(ev, NEW_SLIDE)[i] = IDLE if plane else AT_LIMIT
        col(ev, NEW_RATIO)[i] = (1.0 - TURNS) * ratio if tied else ratio
    if plane:
        # along the one tangent that it has
        bits = int(col(ev, NEW_IMPLIED)[i])
        col(ev, NEW_IMPLIED)[i] = bits & OF_NORMAL | (OF_FIRST if bits & OF_SECOND != 0 else 0)
        col(ev, COS_WAY)[i] = 1.0 if sticks else math.copysign(1.0, col(ev, F_T)[i])
        col(ev, SIN_WAY)[i] = 0.0


@internal
def keep(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """What contacts do, to FLAG, NEW_SLIDE, NEW_RATIO, NEW_IMPLIED: normals first, then tangents of those that stick,
    those at their limits last. Friction at its limit that other friction at its limit holds
    (`free_tangents.find_sliding`) stays there, unless nothing else is left to hold that tangent."""
    count, some, flag, full = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most), col(ev, FLAG), col(ev, OTHER_FLAG)
    implied, slide, ratio = col(ev, NEW_IMPLIED), col(ev, NEW_SLIDE), col(ev, NEW_RATIO)
    friction, chosen = vec(dr.friction, ws.n_contacts), ivec(ev.chosen, 3 * ev.most)
    clear(implied, count)
    _open_unloaded(ev, ws)
    for i in range(count):
        flag[i] = 1.0 if col(ev, CLOSES)[i] != 0.0 else 0.0
    find_sliding(ev, list_held(ev, ws, flag, REACHES_LIMIT_NOW, full), full)
    for i in range(count):
        full[i] = full[first_of(ev, i)]
    normals = total = _list_closed(ev)
    for at_limit in range(2):
        for i in range(count):
            if flag[i] == 0.0:
                continue
            if col(ev, STATIC)[i] == 0.0 or col(ev, DIRECTION)[i] != 0.0:
                # (what a spin leaves of it the contact itself says)
                rubs = col(ev, STATIC)[i] > 0.0
                slide[i] = 1.0 if rubs else IDLE
                ratio[i] = -friction[ivec(ev.contacts, ev.most)[i]] if rubs else 0.0
            elif is_full(ev, i, REACHES_LIMIT_NOW) == (at_limit == 1):
                turn_to_friction(ev, i, at_limit == 1)
                slide[i], ratio[i] = AT_LIMIT if at_limit == 1 else STUCK, 0.0
                total = add_tangents(ev, ws, i, at_limit == 1, total)
    total = _list_at_limit(ev, 1.0, total)
    for j in range(total):
        implied[some[j] % count] += _bit(some[j] // count)
    firm = _drop_immovable(ev, total)
    total = _drop_immovable(ev, _list_at_limit(ev, 0.0, firm))
    _turn(ev, ws, False)
    kept, tied = independent_of(ev, ws, normals, firm, total, real(ev)[RANK]), False
    _turn(ev, ws, True)
    for j in range(kept):
        row = some[chosen[j]]
        if chosen[j] < firm:
            implied[row % count] -= _bit(row // count)
        else:
            slide[row % count], tied = STUCK, True
            slide[row % count + int(col(ev, COMPANION)[row % count])] = STUCK
    for i in range(count):
        rests = flag[i] != 0.0 and col(ev, STATIC)[i] != 0.0 and col(ev, DIRECTION)[i] == 0.0
        if rests and is_full(ev, i, REACHES_LIMIT_NOW):
            _say_at_limit(ev, ws, i, tied)
    return SETTLED
