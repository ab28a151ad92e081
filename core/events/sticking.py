"""Contacts that friction holds: which of them stick, and which let go at its limit because no others hold them."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec
from ..rounding import NO_SLIDING, PRESSING, REACHES_LIMIT, TO_SPARE
from ..state.modes import CLOSED, IDLE
from .forces import NO_SOLUTION, among, independent_of
from .loaded import is_loaded, note_loaded
from .records import (
    AT_REST,
    B_T,
    COUNT,
    DIRECTION,
    EARLY,
    F_N,
    F_T,
    FLAG,
    FULL,
    OLD_RATIO,
    SLID,
    SLIPPING,
    SLIPS,
    SPARE,
    STATIC,
    STICKS,
    TAKES,
    W_T,
    WAS,
    clear,
    col,
    delassus,
    whole,
)
from .resting import fastest_free


@internal
def sticking(ev: Any) -> int:
    """Contacts with friction below its limit (or below it in any case: the least distribution was found), to `order`;
    those with the highest limits first, and those at their limits last: where some are to carry a constant share, it is
    these, for as constraints they would be beyond their limits at once. Returns their number."""
    count, static, order, found = whole(ev)[COUNT], col(ev, STATIC), ivec(ev.order, 2 * ev.most), 0
    early = col(ev, EARLY)
    slipping, f_n, f_t = whole(ev)[SLIPPING] != 0, col(ev, F_N), col(ev, F_T)
    fastest = fastest_free(ev)
    for i in range(count):
        limit = static[i] * f_n[i]
        below = abs(f_t[i]) < limit * (1.0 - REACHES_LIMIT) or limit == 0.0
        # blocks that ride on one another need just the limit
        below = below or (not slipping and (whole(ev)[STICKS] != 0 or _stays(ev, i)))
        # where next to nothing presses, rounding must not say that friction is below the limit of next to nothing
        below = below and (limit == 0.0 or abs(col(ev, W_T)[i]) <= PRESSING * fastest)
        free = static[i] > 0.0 and col(ev, DIRECTION)[i] == 0.0 and col(ev, FULL)[i] == 0.0
        if below and free and col(ev, AT_REST)[i] != 0.0:
            at = found
            at_limit = limit > 0.0 and abs(f_t[i]) >= limit * (1.0 - REACHES_LIMIT)
            early[i] = -1.0 / limit if at_limit else limit
            while at > 0 and early[order[at - 1]] < early[i]:
                order[at] = order[at - 1]
                at -= 1
            order[at] = i
            found += 1
    return found


@internal
def _stays(ev: Any, i: int) -> bool:
    """True if contact i has no acceleration along its tangent but for rounding."""
    count, f_n, f_t = whole(ev)[COUNT], col(ev, F_N), col(ev, F_T)
    a, terms = delassus(ev, count), abs(col(ev, B_T)[i])
    for j in range(count):
        terms += abs(a[j, count + i]) * f_n[j]
    for j in range(count):
        terms += abs(a[count + i, count + j]) * abs(f_t[j])
    return abs(col(ev, W_T)[i]) <= NO_SLIDING * terms


@internal
def find_beginning(ev: Any, ws: Any) -> None:
    """Contacts at the limit of their friction that no others hold, to `FLAG`."""
    count, flag, order, kept = whole(ev)[COUNT], col(ev, FLAG), ivec(ev.order, 2 * ev.most), 0
    for i in range(count):
        free = col(ev, STATIC)[i] > 0.0 and col(ev, DIRECTION)[i] == 0.0
        flag[i] = free and is_loaded(ev, i)
    number = sticking(ev)
    for j in range(number):
        i = order[j]
        flag[i] = 0.0
        if is_loaded(ev, i):
            order[kept] = i
            kept += 1
    for i in range(count):
        if flag[i] != 0.0 and not _moves(ev, ws, kept, i):
            flag[i] = 0.0


@internal
def held(ev: Any, ws: Any) -> bool:
    """Contacts that reach the limit of their friction need not slide: others may hold them. False if they slide."""
    count, slips, full = whole(ev)[COUNT], col(ev, SLIPS), col(ev, FULL)
    direction, static, tried = col(ev, DIRECTION), col(ev, STATIC), col(ev, SPARE)
    for i in range(count):
        ratio = col(ev, OLD_RATIO)[i]
        idle = col(ev, WAS)[i] == CLOSED and col(ev, SLID)[i] == IDLE
        at_limit = idle and abs(ratio) >= static[i] * (1.0 - REACHES_LIMIT)
        full[i] = slips[i] if slips[i] != 0.0 else (-np.sign(ratio) if at_limit else 0.0)
    # those at their limit keep it, others take the rest; or all is distributed anew
    for attempt in range(2):
        for i in range(count):
            tried[i] = direction[i] if direction[i] != 0.0 or attempt == 1 else full[i]
        good = _tries(ev, ws, tried, attempt == 0, REACHES_LIMIT if attempt == 0 else TO_SPARE)
        if good:
            for i in range(count):
                full[i] = 1.0 if attempt == 0 and full[i] != 0.0 else 0.0
            return True
    clear(full, count)
    return False


@internal
def _tries(ev: Any, ws: Any, tried: Any, keeps: bool, spare: float) -> bool:
    """True if the contacts stay where they are with the directions `tried`; `keeps`: those in `FULL` do not move by
    these."""
    count, static, full, order = whole(ev)[COUNT], col(ev, STATIC), col(ev, FULL), ivec(ev.order, 2 * ev.most)
    if among(ev, count, col(ev, TAKES), tried, col(ev, DIRECTION)) == NO_SOLUTION:
        return False
    note_loaded(ev, ws)
    free = 0
    for i in range(count):
        if is_loaded(ev, i) and tried[i] == 0.0 and static[i] > 0.0:
            if abs(col(ev, F_T)[i]) >= static[i] * col(ev, F_N)[i] * (1.0 - spare):
                return False
            order[free] = i
            free += 1
    if free == 0:
        return False
    for i in range(count):
        if keeps and full[i] != 0.0 and is_loaded(ev, i) and _moves(ev, ws, free, i):
            return False
    return True


@internal
def _moves(ev: Any, ws: Any, number: int, i: int) -> bool:
    """True if closed gaps and those that stick, the first `number` in `order`, leave contact i free to slide."""
    count, some, order, normals = whole(ev)[COUNT], ivec(ev.some, 2 * ev.most), ivec(ev.order, 2 * ev.most), 0
    for j in range(count):
        if is_loaded(ev, j):
            some[normals] = j
            normals += 1
    for j in range(number):
        some[normals + j] = count + order[j]
    some[normals + number] = count + i
    kept, chosen = independent_of(ev, ws, 2, normals + number + 1, 0.0), ivec(ev.chosen, 2 * ev.most)
    return kept > 0 and chosen[kept - 1] == normals + number
