"""What each of the closed contacts does along its tangents, and which of their rows others imply.

All contacts that press stay closed, with the forces that equally compliant contacts would have
(`assembly/redundant_reactions.py`). One that has reached the limit of its friction and is held by others keeps that
limit."""

import math
from typing import Any

from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..model.rotation3d import dot
from ..rounding import IMMOVABLE, REACHES_LIMIT_NOW, TURNS
from ..state.modes import AT_LIMIT, IDLE, OF_FIRST, OF_NORMAL, OF_SECOND
from ..state.modes import STICKS as STUCK
from .free_tangents import add_tangents, find_sliding, inverse_mass, is_full, list_held, turn_to_friction
from .independent_directions import independent_of
from .rates import masses
from .records import SETTLED, scalars, touching
from .three_tangents import axis_in_frame, first_of, size_of

RANK_OF_MANY, LOOSEST_RANK = 1e-6, 1e-4
"""Parts of an inverse mass: directions of many contacts that differ by less are taken for one; and where rows still
repeat each other. To bring rates of rounding's size to zero takes motions larger by one over the root of that."""


@internal
def _turn(instant: Any, workspace: Any, back: bool) -> None:
    """Directions and responses of the tangents in the frames of the contacts, or `back` as they were."""
    contact = touching(instant)
    count, n = scalars(instant).count, workspace.n
    for rows in (mat(instant.directions, 3 * count, n), mat(instant.responses, 3 * count, n)):
        for i in range(count):
            c, s = contact[i].direction_cos, contact[i].direction_sin
            if vec(instant.included, instant.most)[i] == 0.0 or vec(instant.slides, instant.most)[i] != 0.0:
                continue
            if contact[i].companion != 0.0:
                if contact[i].companion > 0.0:
                    _turn_three(instant, rows, count, i, n, back)
                continue
            s = -s if back else s
            for j in range(n):
                x, y = rows[count + i, j], rows[2 * count + i, j]
                rows[count + i, j], rows[2 * count + i, j] = c * x + s * y, c * y - s * x


@internal
def _turn_three(instant: Any, rows: Any, count: int, i: int, n: int, back: bool) -> None:
    """The same of contact i and its companion, of these rows."""
    x, y, z = axis_in_frame(instant, i, 0), axis_in_frame(instant, i, 1), axis_in_frame(instant, i, 2)
    if back:
        x, y, z = (x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])
    for j in range(n):
        was = rows[count + i, j], rows[2 * count + i, j], rows[count + i + 1, j]
        rows[count + i, j], rows[2 * count + i, j], rows[count + i + 1, j] = dot(x, was), dot(y, was), dot(z, was)


@internal
def _bit(block: int) -> int:
    """What `implied_rows` says of a row of the normals, of the first or the second tangents."""
    return OF_NORMAL if block == 0 else (OF_FIRST if block == 1 else OF_SECOND)


@internal
def _list_closed(instant: Any) -> int:
    """Normals of the contacts that stay closed, to `some`, those that carry most before others; how many."""
    some, f_n, total = ivec(instant.some, 3 * instant.most), touching(instant).normal_force, 0
    for i in range(scalars(instant).count):
        if vec(instant.closes, instant.most)[i] != 0.0:
            at = total
            while at > 0 and f_n[some[at - 1]] < f_n[i]:
                some[at] = some[at - 1]
                at -= 1
            some[at] = i
            total += 1
    return total


@internal
def _list_at_limit(instant: Any, slides: float, total: int) -> int:
    """Tangents along the friction of those at their limits, behind the first `total` rows in `some`: of those that
    could slide (`can_slide`), or of the others. How many rows there are then."""
    contact = touching(instant)
    count, some = scalars(instant).count, ivec(instant.some, 3 * instant.most)
    for i in range(count):
        at_limit = vec(instant.included, instant.most)[i] != 0.0 and contact[i].new_slide_mode == AT_LIMIT
        if at_limit and vec(instant.can_slide, instant.most)[i] == slides:
            if contact[i].companion >= 0.0:
                some[total] = 2 * count + i
                total += 1
            if slides != 0.0:
                contact[i].new_slide_mode = STUCK
    return total


@internal
def _least_mass(instant: Any, row: int) -> float:
    """Of a row that is turned with three tangents what rounding may make of none, in parts of what these have."""
    count, total = scalars(instant).count, 0.0
    own, a = first_of(instant, row % count), masses(instant, count)
    if touching(instant)[own].companion == 0.0 or row < count:
        return 0.0
    for k in (count + own, 2 * count + own, count + own + 1):
        total += a[k, k]
    return IMMOVABLE * total


@internal
def _drop_immovable(instant: Any, total: int) -> int:
    """Keep those of the first `total` rows in `some` that have an inverse mass; how many. A tangent that joints hold
    has none, and rounding must not say that it has."""
    some, moving = ivec(instant.some, 3 * instant.most), 0
    for j in range(total):
        if inverse_mass(instant, some[j]) > _least_mass(instant, some[j]):
            some[moving] = some[j]
            moving += 1
    return moving


@internal
def _say_at_limit(instant: Any, workspace: Any, i: int, tied: bool) -> None:
    """What contact i does whose friction has reached its limit, once it is known whether it sticks; `tied`: another one
    that has reached it is to hold the rest, for which it gets a margin."""
    contact = touching(instant)
    plane, sticks = not in_space(workspace, ivec(instant.contacts, instant.most)[i]), contact[i].new_slide_mode == STUCK
    if not sticks:
        # (without a normal force the quotient is one of rounding)
        ratio = min(
            size_of(instant, i, contact.friction_force, contact.friction_force2) / contact[i].normal_force,
            contact[i].static_friction,
        )
        contact[i].new_slide_mode = IDLE if plane else AT_LIMIT
        contact[i].new_ratio = (1.0 - TURNS) * ratio if tied else ratio
    if plane:
        # along the one tangent that it has
        bits = int(contact[i].new_implied)
        contact[i].new_implied = bits & OF_NORMAL | (OF_FIRST if bits & OF_SECOND != 0 else 0)
        contact[i].direction_cos = 1.0 if sticks else math.copysign(1.0, contact[i].friction_force)
        contact[i].direction_sin = 0.0


@internal
def keep(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """What contacts do, to `included` and to `new_slide_mode`, `new_ratio`, `new_implied`:
    normals first, then tangents of those that stick, those at their limits last.
    Friction at its limit that other friction at its limit holds (`free_tangents.find_sliding`) stays there, unless
    nothing else is left to hold that tangent."""
    contact = touching(instant)
    count, some, flag, full = (
        scalars(instant).count,
        ivec(instant.some, 3 * instant.most),
        vec(instant.included, instant.most),
        vec(instant.can_slide, instant.most),
    )
    implied, slide, ratio = contact.new_implied, contact.new_slide_mode, contact.new_ratio
    friction, chosen = vec(drive.friction, workspace.n_contacts), ivec(instant.chosen, 3 * instant.most)
    for i in range(count):
        implied[i] = 0.0
    for i in range(count):
        flag[i] = 1.0 if vec(instant.closes, instant.most)[i] != 0.0 else 0.0
    find_sliding(instant, list_held(instant, workspace, flag, REACHES_LIMIT_NOW, full), full)
    for i in range(count):
        full[i] = full[first_of(instant, i)]
    normals = total = _list_closed(instant)
    for at_limit in range(2):
        for i in range(count):
            if flag[i] == 0.0:
                continue
            if contact[i].static_friction == 0.0 or vec(instant.slides, instant.most)[i] != 0.0:
                # (what a spin leaves of it the contact itself says)
                rubs = contact[i].static_friction > 0.0
                slide[i] = 1.0 if rubs else IDLE
                ratio[i] = -friction[ivec(instant.contacts, instant.most)[i]] if rubs else 0.0
            elif is_full(instant, i, REACHES_LIMIT_NOW) == (at_limit == 1):
                turn_to_friction(instant, i, at_limit == 1)
                slide[i], ratio[i] = AT_LIMIT if at_limit == 1 else STUCK, 0.0
                total = add_tangents(instant, workspace, i, at_limit == 1, total)
    total = _list_at_limit(instant, 1.0, total)
    for j in range(total):
        implied[some[j] % count] += _bit(some[j] // count)
    firm = _drop_immovable(instant, total)
    total = _drop_immovable(instant, _list_at_limit(instant, 0.0, firm))
    _turn(instant, workspace, False)
    kept, tied = independent_of(instant, workspace, normals, firm, total, scalars(instant).rank_tolerance), False
    _turn(instant, workspace, True)
    for j in range(kept):
        row = some[chosen[j]]
        if chosen[j] < firm:
            implied[row % count] -= _bit(row // count)
        else:
            slide[row % count], tied = STUCK, True
            slide[row % count + int(contact[row % count].companion)] = STUCK
    for i in range(count):
        rests = flag[i] != 0.0 and contact[i].static_friction != 0.0 and vec(instant.slides, instant.most)[i] == 0.0
        if rests and is_full(instant, i, REACHES_LIMIT_NOW):
            _say_at_limit(instant, workspace, i, tied)
    return SETTLED
