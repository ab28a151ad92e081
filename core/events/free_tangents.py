"""What closed gaps and other sticking contacts leave free of a contact's tangents.

Rows are numbers: a contact, plus the count of contacts for its first tangent, plus twice that for its second. Tangents
are those of the contact's frame (`direction_cos`, `direction_sin`). Where friction has reached its limit the second one
is along it, and the first one, across, is held: friction can turn, but not grow.
"""

import math
from typing import Any

from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contact_solvers.nonnegative import nonnegative
from ..linalg.small import call_least_norm
from ..rounding import DIRECTION_RANK
from .independent_directions import cones_at
from .rates import masses
from .records import scalars, touching
from .three_tangents import axis_in_frame, first_of, size_of, turn_frame

RANK_OF_FREE = 1e-6
"""Of its inverse mass: a tangent of which no more is left beside other rows is held by these."""


@internal
def is_full(instant: Any, i: int, near: float) -> bool:
    """True if the friction of contact i has reached its limit, but for the part `near` of it."""
    contact = touching(instant)
    size, limit = (
        size_of(instant, i, contact.friction_force, contact.friction_force2),
        contact[i].static_friction * contact[i].normal_force,
    )
    return size > 0.0 and size >= (1.0 - near) * limit


@internal
def turn_to_friction(instant: Any, i: int, full: bool) -> None:
    """The frame of contact i: its second tangent along its friction if that is `full`, else as it was found."""
    contact = touching(instant)
    if contact[i].companion != 0.0:
        turn_frame(instant, i, contact.friction_force, contact.friction_force2, full)
        return
    size = math.hypot(contact[i].friction_force, contact[i].friction_force2)
    contact[i].direction_cos = contact[i].friction_force2 / size if full else 1.0
    contact[i].direction_sin = -contact[i].friction_force / size if full else 0.0


@internal
def add_tangents(instant: Any, workspace: Any, i: int, full: bool, total: int) -> int:
    """Add the rows that contact i holds along its tangents to the first `total` in `some`; how many there are then."""
    count, some = scalars(instant).count, ivec(instant.some, 3 * instant.most)
    plane = not in_space(workspace, ivec(instant.contacts, instant.most)[i])
    if plane and full:
        return total
    some[total] = count + i
    if plane or full or touching(instant)[i].companion < 0.0:
        return total + 1
    some[total + 1] = 2 * count + i
    return total + 2


@internal
def _part(instant: Any, count: int, row: int, which: int) -> Any:
    """(direction, factor) of the two, or three, that make row `row`, which is none of a companion's second tangent."""
    contact = touching(instant)
    i = row % count
    c, s = contact[i].direction_cos, contact[i].direction_sin
    if row < count:
        return (row, 1.0) if which == 0 else (row, 0.0)
    if contact[i].companion != 0.0:
        own = first_of(instant, i)
        x, y, z = axis_in_frame(instant, own, row // count - 1 if i == own else 2)
        return (count + own, x) if which == 0 else (2 * count + own, y) if which == 1 else (count + own + 1, z)
    if which == 2:
        return row, 0.0
    if row < 2 * count:
        return (count + i, c) if which == 0 else (2 * count + i, s)
    return (count + i, -s) if which == 0 else (2 * count + i, c)


@internal
def _between(instant: Any, count: int, one: int, other: int) -> float:
    """Inverse mass between two rows."""
    a, total = masses(instant, count), 0.0
    for j in range(3 if touching(instant)[one % count].companion != 0.0 else 2):
        p, of_p = _part(instant, count, one, j)
        for k in range(3 if touching(instant)[other % count].companion != 0.0 else 2):
            q, of_q = _part(instant, count, other, k)
            total += of_p * of_q * a[p, q]
    return total


@internal
def inverse_mass(instant: Any, row: int) -> float:
    """Inverse mass of a row."""
    return _between(instant, scalars(instant).count, row, row)


@internal
def find_sliding(instant: Any, held: int, free: Any) -> None:
    """Which contacts begin to slide: in `free`, in which 1 stands for those whose friction has reached its limit, 0
    for those of them that cannot slide against it while the first `held` rows in `some` are held.

    Contact i slides if the bodies have a motion with w_i > 0 and w_j >= 0 for all contacts at their limits, w the speed
    against friction. If they have none, forces z >= 0 with z_i > 0 exist that move nothing (Tucker 1956): friction at
    the limit with other friction for its counterpart, as of a ball in a groove, of which some can be taken off. Both
    answers are of one problem: contact i is pushed along by 1, the others resist where it would move them backwards.
    """
    count, some, at_limit = (
        scalars(instant).count,
        ivec(instant.some, 3 * instant.most),
        ivec(instant.chosen, 3 * instant.most),
    )
    number = 0
    for i in range(count):
        if free[i] != 0.0:
            at_limit[number] = 2 * count + i
            number += 1
    if number == 0:
        return
    room = instant.space_room
    matrix, right = mat(room, held, held), mat(room + 8 * held * held, held, number)
    room += 8 * held * (held + number)
    found, left = mat(room, held, number), mat(room + 8 * held * number, number, number)
    room += 8 * number * (held + number)
    z, w, r, work = (
        vec(room, number),
        vec(room + 8 * number, number),
        vec(room + 16 * number, number),
        room + 24 * number,
    )
    for k in range(held):
        for j in range(held):
            matrix[k, j] = _between(instant, count, some[k], some[j])
        for j in range(number):
            right[k, j] = _between(instant, count, some[k], at_limit[j])
    if held > 0:
        call_least_norm(cones_at(instant.cones).least_norm, matrix, right, found, DIRECTION_RANK, work)
    for j in range(number):
        for i in range(number):
            own = _between(instant, count, at_limit[i], at_limit[j])
            left[i, j] = own
            for k in range(held):
                left[i, j] -= _between(instant, count, some[k], at_limit[i]) * found[k, j]
            if i == j and left[i, i] <= RANK_OF_FREE * own:
                left[i, i] = 0.0
    for i in range(number):
        for j in range(number):
            r[j] = left[j, i]
        moves = left[i, i] > 0.0
        if moves:
            nonnegative(left, r, i, RANK_OF_FREE, z, w, work)
            moves = w[i] > RANK_OF_FREE * left[i, i]
        free[at_limit[i] - 2 * count] = 1.0 if moves else 0.0


@internal
def list_held(instant: Any, workspace: Any, among: Any, near: float, free: Any) -> int:
    """Rows that are held, to `some`, with their frames: normals of the contacts `among` that press, and tangents of
    those that stick; how many. In `free`: 1 for those whose friction has reached its limit, but for the part `near`."""
    contact = touching(instant)
    count, some, total = scalars(instant).count, ivec(instant.some, 3 * instant.most), 0
    direction, f_n = vec(instant.slides, instant.most), contact.normal_force
    for i in range(count):
        free[i] = 0.0
        if among[i] != 0.0 and f_n[i] > 0.0:
            some[total] = i
            total += 1
    for i in range(count):
        if among[i] != 0.0 and f_n[i] > 0.0 and direction[i] == 0.0 and contact[i].static_friction > 0.0:
            full = is_full(instant, i, near)
            free[i] = 1.0 if full and contact[i].companion >= 0.0 else 0.0
            turn_to_friction(instant, i, full)
            total = add_tangents(instant, workspace, i, full, total)
    return total
