"""Forces of the contacts at rest: those under which none of them pulls, and friction is within its limits.

Contacts that reach the limit of their friction together, and bodies that stand on more contacts than they need, leave a
choice of forces: it is made here. Where there are none, or friction turns what normal forces do round, a jam
is named.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec
from ..rounding import PRESSING
from ..state.modes import CLOSED
from .forces import NO_SOLUTION, among, farthest_of
from .jams import name_jammed, refuse_jam
from .loaded import is_loaded, note_loaded
from .records import (
    APART,
    AT_REST,
    COUNT,
    DIRECTION,
    F_N,
    F_T,
    FLAG,
    FULL,
    KEPT_DIRECTION,
    KEPT_FULL,
    KEPT_TAKES,
    KINETIC,
    KNOWN,
    LEAVES,
    NO_FORCES,
    NONE,
    OTHER_N,
    OTHER_T,
    OTHER_WN,
    OTHER_WT,
    READY,
    SETTLED,
    SIZE,
    SLIPPING,
    SLIPS,
    STATIC,
    STICKS,
    STRUCK,
    TAKES,
    W_N,
    W_T,
    WAS,
    clear,
    col,
    copy,
    real,
    whole,
)
from .resting import fastest_free, find_free, hold_back
from .sticking import find_beginning, held


@internal
def find_forces(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Forces of all touching contacts (zero where they separate), in `F_N` and `F_T`."""
    count, takes, leaves, at_rest = whole(ev)[COUNT], col(ev, TAKES), col(ev, LEAVES), col(ev, AT_REST)
    if whole(ev)[READY] == 0:
        status = find_free(ev, dr, ws, ms, 0.0)
        if status != SETTLED:
            return status
    for i in range(count):
        takes[i] = at_rest[i] != 0.0 and leaves[i] == 0.0
    status = _balance(ev, ws, ms)
    if status == SETTLED and _turned(ev):
        status = _balance(ev, ws, ms)
    for _ in range(count):
        # one that opens so slowly that it falls back at once
        if status != SETTLED or not hold_back(ev, ws, ms, col(ev, W_N)):
            break
        for i in range(count):
            takes[i] = 1.0 if col(ev, FLAG)[i] != 0.0 else takes[i]
        status = _balance(ev, ws, ms)
    if status != SETTLED:
        return status
    _stand_apart(ev, ws, ms)
    return refuse_jam(ev, ws)


@internal
def _turned(ev: Any) -> bool:
    """True if a contact that has reached the limit of its friction would set off the other way, since others have let
    go at the same instant: then it is friction that decides."""
    slips, found, fastest = col(ev, SLIPS), False, fastest_free(ev)
    for i in range(whole(ev)[COUNT]):
        if slips[i] * col(ev, W_T)[i] < -PRESSING * fastest and col(ev, DIRECTION)[i] == slips[i]:
            slips[i], found = 0.0, True
    return found


@internal
def _stand_apart(ev: Any, ws: Any, ms: Any) -> None:
    """Of contacts whose normals repeat each other take those that lie farthest apart: on them a body stands firmly."""
    count, apart = whole(ev)[COUNT], col(ev, APART)
    if not _spread(ev, ws, apart):
        return
    kept = (DIRECTION, KEPT_DIRECTION), (FULL, KEPT_FULL), (TAKES, KEPT_TAKES)
    for one, other in kept:
        copy(col(ev, other), col(ev, one), count)
    slipping, sticks = whole(ev)[SLIPPING], whole(ev)[STICKS]
    _swap_forces(ev, count)
    copy(col(ev, TAKES), apart, count)
    good = _balance(ev, ws, ms) == SETTLED
    for i in range(count):
        good = good and (apart[i] == 0.0 or is_loaded(ev, i))
    if good:
        return
    for one, other in kept:
        copy(col(ev, one), col(ev, other), count)
    whole(ev)[SLIPPING], whole(ev)[STICKS] = slipping, sticks
    _swap_forces(ev, count)
    note_loaded(ev, ws)


@internal
def _swap_forces(ev: Any, count: int) -> None:
    for one, other in ((F_N, OTHER_N), (F_T, OTHER_T), (W_N, OTHER_WN), (W_T, OTHER_WT)):
        for i in range(count):
            x = col(ev, one)[i]
            col(ev, one)[i] = col(ev, other)[i]
            col(ev, other)[i] = x


@internal
def _spread(ev: Any, ws: Any, apart: Any) -> bool:
    """Which contacts that is; False if there are none, or if nothing asks for a new choice."""
    count, some, asked, still = whole(ev)[COUNT], ivec(ev.some, 2 * ev.most), whole(ev)[STRUCK] != 0, 0
    for i in range(count):
        asked = asked or (is_loaded(ev, i) and col(ev, WAS)[i] != CLOSED)
    if not asked:
        return False
    for i in range(count):
        if col(ev, TAKES)[i] != 0.0 and abs(col(ev, W_N)[i]) <= 1e3 * real(ev)[NONE] * col(ev, SIZE)[i]:
            some[still] = i
            still += 1
    number = farthest_of(ev, count, still)
    chosen, every = ivec(ev.chosen, 2 * ev.most), True
    for j in range(number):
        every = every and is_loaded(ev, chosen[j])
    if number == still or every:
        return False
    clear(apart, count)
    for j in range(number):
        apart[chosen[j]] = 1.0
    return True


@internal
def _balance(ev: Any, ws: Any, ms: Any) -> int:
    """Forces of the contacts `TAKES`."""
    count, slips, direction, known = whole(ev)[COUNT], col(ev, SLIPS), col(ev, DIRECTION), col(ev, KNOWN)
    full, any_slips, differ = col(ev, FULL), False, False
    for i in range(count):
        direction[i], full[i] = known[i], 0.0
        any_slips = any_slips or slips[i] != 0.0
    whole(ev)[SLIPPING] = 0
    if any_slips:
        if held(ev, ws):
            return SETTLED
        whole(ev)[SLIPPING] = 1
        for i in range(count):
            direction[i] = slips[i] if slips[i] != 0.0 else direction[i]
    for _ in range(count + 1):
        status = _solve(ev, ws, ms)
        if status != SETTLED:
            return status
        find_beginning(ev, ws)
        differ = False
        begins = col(ev, FLAG)
        for i in range(count):
            if begins[i] != 0.0:
                differ = differ or col(ev, KINETIC)[i] != col(ev, STATIC)[i]
                direction[i] = -np.sign(col(ev, F_T)[i])
        if not differ:
            break
    return SETTLED


@internal
def _solve(ev: Any, ws: Any, ms: Any) -> int:
    count, takes, none = whole(ev)[COUNT], col(ev, TAKES), real(ev)[NONE]
    for _ in range(2):
        if among(ev, count, takes, col(ev, DIRECTION), col(ev, DIRECTION)) == NO_SOLUTION:
            name_jammed(ev, ws)
            return NO_FORCES
        note_loaded(ev, ws)
        # one that leaves does so unless the others' forces press it together again
        again = False
        for i in range(count):
            pressed = col(ev, W_N)[i] < -1e3 * none * col(ev, SIZE)[i]
            if ms.exact != 0 and col(ev, AT_REST)[i] != 0.0 and takes[i] == 0.0 and pressed:
                takes[i], again = 1.0, True
        if not again:
            break
    return SETTLED
