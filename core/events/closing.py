"""Which of the touching contacts stay closed: those that press, and some that carry nothing."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec
from ..rounding import FORCE_AT_EVENT, PRESSING
from ..state.modes import CLOSED, OPEN
from .loaded import is_loaded
from .reading import comes_back
from .records import (
    AT_REST,
    B_N,
    B_S,
    B_T,
    CLOSES,
    COS_WAY,
    COUNT,
    DIRECTION,
    F_N,
    LEAVES,
    NONE,
    SETTLED,
    SIN_WAY,
    SIZE,
    SPARE,
    STATIC,
    STRUCK,
    W_N,
    W_S,
    W_T,
    WAS,
    call_part,
    clear,
    col,
    real,
    whole,
)
from .three_tangents import size_of
from .touching import free_jerks, looks_again

CLOSES_FROM, CLOSES_TO = 3, 12
"""Looks at one instant in which contacts that carry nothing close. Before, they stay as they are; after, those that
have pulled by rounding stay open, or some would open and others close in turns: bodies that fall side by side."""


@internal
def choose(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Which contacts stay closed, to `CLOSES`."""
    count, closes, now = whole(ev)[COUNT], col(ev, CLOSES), whole(ev)[STRUCK] == 0
    clear(closes, count)
    rests = False
    for i in range(count):
        rests = rests or col(ev, AT_REST)[i] != 0.0
    if not rests:
        return SETTLED
    status = call_part(ev.find_forces, ev, dr, ws, ms)
    if status != SETTLED:
        return status
    idle, none, least = False, real(ev)[NONE], _least_force(ev) if now else 0.0
    for i in range(count):
        unasked = col(ev, WAS)[i] == OPEN and ivec(dr.pending, ws.n_contacts)[ivec(ev.contacts, ev.most)[i]] == 0
        closes[i] = is_loaded(ev, i) and not (unasked and col(ev, F_N)[i] < least)
        leaves = col(ev, LEAVES)[i] != 0.0
        if now and col(ev, WAS)[i] == CLOSED and not leaves and abs(col(ev, W_N)[i]) <= none * col(ev, SIZE)[i]:
            # touching without force: as it was
            closes[i] = 1.0
        idle = idle or (col(ev, AT_REST)[i] != 0.0 and closes[i] == 0.0 and not leaves)
    if idle:
        _close_idle(ev, dr, ws, closes)
    _slide_unloaded(ev, ws, closes)
    return SETTLED


@internal
def _least_force(ev: Any) -> float:
    """Force from which on contacts close that were open and have no event of their own, N: 0 unless another one opens
    since its force has come to zero. That event is known as well as its time, and so are forces without it."""
    leaves, largest = False, 0.0
    for i in range(whole(ev)[COUNT]):
        leaves, largest = leaves or col(ev, LEAVES)[i] != 0.0, max(largest, col(ev, F_N)[i])
    return FORCE_AT_EVENT * largest if leaves else 0.0


@internal
def _slide_unloaded(ev: Any, ws: Any, closes: Any) -> None:
    """Contacts that stay closed without force begin to slide where nothing holds them: no friction does."""
    fastest, direction = 0.0, col(ev, DIRECTION)
    for i in range(whole(ev)[COUNT]):
        fastest = max(fastest, abs(col(ev, B_N)[i]), abs(col(ev, B_T)[i]), abs(col(ev, B_S)[i]))
    for i in range(whole(ev)[COUNT]):
        free = col(ev, STATIC)[i] > 0.0 and direction[i] == 0.0 and col(ev, F_N)[i] == 0.0
        x, y, speed = col(ev, W_T)[i], col(ev, W_S)[i], size_of(ev, i, col(ev, W_T), col(ev, W_S))
        if free and closes[i] != 0.0 and speed > PRESSING * fastest:
            direction[i] = 1.0
            col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = x / speed, y / speed


@internal
def _close_idle(ev: Any, dr: Any, ws: Any, closes: Any) -> None:
    """Contacts that carry nothing close where they would come back, or where every step closes them at once."""
    jerks, contacts, none = col(ev, SPARE), ivec(ev.contacts, ev.most), real(ev)[NONE]
    free_jerks(ev, ws, jerks)
    for i in range(whole(ev)[COUNT]):
        if col(ev, AT_REST)[i] == 0.0 or closes[i] != 0.0 or col(ev, LEAVES)[i] != 0.0:
            continue
        motion = col(ev, W_N)[i]
        # nothing presses it, or others carry all: a table on two feet in balance, whose third one touches
        again = abs(motion) <= none * col(ev, SIZE)[i] and CLOSES_FROM <= looks_again(dr) <= CLOSES_TO
        if again or comes_back(ws, contacts[i], jerks[i], motion):
            closes[i] = 1.0
