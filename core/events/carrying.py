"""Which of the closed contacts carry: constraints that do not repeat each other.

With dependent directions (a body on two feet) sticking friction is not unique: one of them has the sliding distance
as a constraint, the others carry a constant share of their normal force (IDLE, with their RATIO) until the first
reaches its limit; then it keeps that limit and another takes the rest, or all let go.
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..linalg.small import solve_square
from ..state.modes import IDLE
from ..state.modes import STICKS as STUCK
from .forces import independent_of
from .records import (
    CLOSES,
    COUNT,
    DIRECTION,
    F_N,
    F_T,
    FIRST,
    FLAG,
    KINETIC,
    NEW_IMPLIED,
    NEW_RATIO,
    NEW_SLIDE,
    RANK,
    SETTLED,
    clear,
    col,
    delassus,
    real,
    whole,
)
from .sticking import sticking

RANK_OF_MANY, LOOSEST_RANK = 1e-6, 1e-4
"""Parts of an inverse mass: directions of many contacts that differ by less are taken for one; and at an instant that
does not settle. To bring rates of rounding's size to zero takes motions larger by one over the root of that."""
PULLING = 1e-3
"""Of the largest force of the contacts: one that pulls by more has been kept together with the wrong others."""
LEFT_OPEN = 1e-6
"""Part of the determinant of the contacts' inverse masses that constant shares leave where they say next to nothing of
how large the forces are."""


@internal
def keep(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Of the contacts in `CLOSES` those that do not repeat each other, to `RANK`, with what each does along its tangent
    (SLIDE and RATIO): `FLAG`, `NEW_SLIDE`, `NEW_RATIO`. Contacts that repeat each other nearly need large forces
    against each other to move as constraints say: where an instant does not settle, more and more of them count as
    one."""
    number = _keep(ev, ws)
    while number > 0 and _left_open(ev, number) and keep_others(ev, ws):
        number = _keep(ev, ws)
    return SETTLED


@internal
def _keep(ev: Any, ws: Any) -> int:
    """With the present order of the tangents: how many directions, `some` of `chosen`."""
    count, closes, f_n, flag = whole(ev)[COUNT], col(ev, CLOSES), col(ev, F_N), col(ev, FLAG)
    some, order, chosen = ivec(ev.some, 2 * ev.most), ivec(ev.order, 2 * ev.most), ivec(ev.chosen, 2 * ev.most)
    slide, ratio, kinetic, direction = col(ev, NEW_SLIDE), col(ev, NEW_RATIO), col(ev, KINETIC), col(ev, DIRECTION)
    rank = real(ev)[RANK]
    clear(flag, count)
    clear(col(ev, NEW_IMPLIED), count)
    stuck, normals, kept = sticking(ev), 0, 0
    for i in range(count):
        if closes[i] != 0.0:
            at = normals
            while at > 0 and f_n[some[at - 1]] < f_n[i]:
                some[at] = some[at - 1]
                at -= 1
            some[at] = i
            normals += 1
    if normals == 0:
        return 0
    for j in range(stuck):
        if closes[order[j]] != 0.0:
            at = normals + kept
            while at > normals and col(ev, FIRST)[some[at - 1] - count] < col(ev, FIRST)[order[j]]:
                some[at] = some[at - 1]
                at -= 1
            some[at] = count + order[j]
            kept += 1
    number = independent_of(ev, ws, 2, normals + kept, rank)
    for j in range(number):
        if chosen[j] < normals:
            i = some[chosen[j]]
            flag[i] = 1.0
            slides = direction[i] != 0.0 and _has_friction(ev, ws, i)
            slide[i] = direction[i] if slides else IDLE
            ratio[i] = -kinetic[i] * direction[i] if slides else (col(ev, F_T)[i] / f_n[i] if f_n[i] > 0.0 else 0.0)
    for j in range(number):
        if chosen[j] >= normals:
            i = some[chosen[j]] - count
            slide[i], ratio[i] = STUCK, 0.0
    return number


@internal
def _left_open(ev: Any, number: int) -> bool:
    """True if the constant shares of contacts that others hold leave the forces open, in directions in which they are
    clear without."""
    count, any_shares = whole(ev)[COUNT], False
    for i in range(count):
        any_shares = any_shares or (col(ev, FLAG)[i] != 0.0 and _shares(ev, i))
    if not any_shares:
        return False
    return _size(ev, number, True) < _size(ev, number, False) + math.log(LEFT_OPEN)


@internal
def _shares(ev: Any, i: int) -> bool:
    return bool(col(ev, NEW_SLIDE)[i] == IDLE and col(ev, NEW_RATIO)[i] != 0.0)


@internal
def _size(ev: Any, number: int, shared: bool) -> float:
    """Logarithm of the determinant's size of the kept directions' motion by their forces, friction of what slides
    included; `shared`: constant shares too."""
    count, ratio, n = whole(ev)[COUNT], col(ev, NEW_RATIO), number
    a, some, chosen = delassus(ev, count), ivec(ev.some, 2 * ev.most), ivec(ev.chosen, 2 * ev.most)
    matrix, right = mat(ev.matrix, n, n), vec(ev.matrix + 8 * n * n, n)
    for j in range(n):
        q, right[j] = some[chosen[j]], 0.0
        slope = 0.0 if q >= count or (_shares(ev, q) and not shared) else ratio[q]
        for i in range(n):
            p = some[chosen[i]]
            matrix[i, j] = a[p, q] + (slope * a[p, count + q] if slope != 0.0 else 0.0)
    if solve_square(matrix, right) == 0:
        return -math.inf
    size = 0.0
    for i in range(n):
        size += math.log(abs(matrix[i, i]))
    return size


@internal
def keep_others(ev: Any, ws: Any) -> bool:
    """Say that `keep` is to begin with those along whose tangents others were left to hold; False if there are none.

    A disk that presses against two others balances their friction by itself: if one is to carry a constant share of its
    normal force, that share is the one with which the disk is in balance under any normal force, and nothing says how
    large that is.
    """
    count, first, some, latest = whole(ev)[COUNT], col(ev, FIRST), False, 0.0
    for i in range(count):
        latest = max(latest, first[i])
    stuck, order = sticking(ev), ivec(ev.order, 2 * ev.most)
    for j in range(stuck):
        i = order[j]
        if col(ev, FLAG)[i] != 0.0 and col(ev, NEW_SLIDE)[i] == IDLE and first[i] == 0.0:
            first[i], some = latest + 1.0, True
    return some


@internal
def pulls(ev: Any, ws: Any) -> bool:
    """True if a contact that has been kept pulls, by more than what the forces may be wrong by."""
    lam, rows, contacts = vec(ws.lam, ws.m_ext), ivec(ws.contact_rows, ws.n_contacts), ivec(ev.contacts, ev.most)
    largest, least = 0.0, 0.0
    for i in range(whole(ev)[COUNT]):
        if col(ev, FLAG)[i] != 0.0:
            largest = max(largest, col(ev, F_N)[i])
            least = min(least, -lam[rows[contacts[i]]])
    return least < -PULLING * largest


@internal
def _has_friction(ev: Any, ws: Any, i: int) -> bool:
    return bool(ivec(ws.contact_slide_rows, ws.n_contacts)[ivec(ev.contacts, ev.most)[i]] >= 0)
