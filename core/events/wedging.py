"""Contacts that wedge each other: where no forces exist, sliding stops by impulses without a collision.

With the directions of sliding given, the forces of several contacts may have no solution: more normal force makes more
friction, which asks for more normal force. What slides then stops at once (Painleve 1895 for one contact; Moreau 1988:
a tangential impact). The impulses are those of a moment in which the velocities may change: rates and, times the
moment, free accelerations, without any direction of sliding given. This problem has a solution; where forces exist the
impulses are small as the moment is, where none do they are what stops the sliding.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec
from ..methods.history import history_time
from ..state.run_records import IMPACT
from .forces import NO_SOLUTION, SPEED, impulses_among
from .records import (
    AT_REST,
    B_N,
    B_T,
    BASE,
    COUNT,
    LEAVES,
    LOSS,
    NOW_N,
    NOW_T,
    PART,
    RATE,
    RIGHT_N,
    RIGHT_T,
    ROUNDING,
    SLIDE_RATE,
    SLIPS,
    SLOW,
    STOP_LOSS,
    STOPS,
    STRUCK,
    col,
    copy,
    whole,
)
from .report import report
from .resting import look, stop
from .touching import push_and_account

MOST_WEDGES = 3
"""Times at one instant that forces are looked for."""
MOMENT = 1.0 / SPEED
"""How long the moment is, in parts of the time in which free accelerations make the speeds of sliding: where forces are
found that would stop the sliding sooner, it is these impulses that stop it."""
NOTICED = 1e-3
"""Of the largest impulse: what is reported as an event. The rest is what forces do in the moment."""


@internal
def wedge(ev: Any, dr: Any, ws: Any, ms: Any) -> bool:
    """Stop what slides and finds no forces; False if nothing slides or no impulses are found. Rates and free
    accelerations are given."""
    count, rate, slide_rate = whole(ev)[COUNT], col(ev, RATE), col(ev, SLIDE_RATE)
    b_n, b_t, at_rest, slow = col(ev, B_N), col(ev, B_T), col(ev, AT_REST), col(ev, SLOW)
    fastest, largest = 0.0, 0.0
    for i in range(count):
        if at_rest[i] != 0.0:
            fastest = max(fastest, abs(slide_rate[i]))
            largest = max(largest, abs(b_n[i]), abs(b_t[i]))
    if fastest == 0.0 or largest == 0.0:
        return False
    moment = MOMENT * fastest / largest
    for i in range(count):
        col(ev, PART)[i], col(ev, BASE)[i] = at_rest[i], 0.0
        col(ev, RIGHT_N)[i], col(ev, RIGHT_T)[i] = rate[i] + moment * b_n[i], slide_rate[i] + moment * b_t[i]
    if impulses_among(ev, count) == NO_SOLUTION:
        # with those that separate: what the others set going may press them
        for i in range(count):
            col(ev, PART)[i] = 1.0
        if impulses_among(ev, count) == NO_SOLUTION:
            return False
    copy(col(ev, LOSS), col(ev, STOP_LOSS), count)
    push_and_account(ev, dr, ws, col(ev, NOW_N), col(ev, NOW_T))
    whole(ev)[STRUCK] = 1
    for i in range(count):
        col(ev, LEAVES)[i] = col(ev, STOPS)[i] = col(ev, SLIPS)[i] = 0.0
        at_rest[i] = abs(rate[i]) <= max(2.0 * moment * largest, col(ev, ROUNDING)[i])
        slow[i] = max(slow[i], 2.0 * moment * largest)
    look(ev, ms)
    stop(ev, dr, ws, ms)
    _report(ev, dr, ms)
    return True


@internal
def _report(ev: Any, dr: Any, ms: Any) -> None:
    """Events of the contacts whose impulses are more than forces make in the moment."""
    count, contacts, normal, along = whole(ev)[COUNT], ivec(ev.contacts, ev.most), col(ev, NOW_N), col(ev, NOW_T)
    strongest = 0.0
    for i in range(count):
        strongest = max(strongest, normal[i], abs(along[i]))
    for i in range(count):
        if max(normal[i], abs(along[i])) > NOTICED * strongest:
            loss = col(ev, STOP_LOSS)[i] - col(ev, LOSS)[i]
            apart = max(col(ev, RATE)[i], 0.0)
            report(dr, history_time(ms, 0), IMPACT, contacts[i], normal[i], loss, 0.0, apart, 0.0, along[i])
