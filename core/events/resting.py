"""Which of the contacts that touch at one instant are at rest, and which of them slide: their rates tell.

At rest are those that neither separate nor approach. For these the free accelerations are found, and gaps that would
fall back at once are at rest too.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..rounding import NO_ACCELERATION, PERHAPS_REST
from ..state.modes import CLOSED
from ..tables.levels import rate_size
from .forces import remove_rates
from .reading import largest_acceleration, unresolved_speed
from .records import (
    ACCELERATIONS,
    AT_REST,
    B_N,
    B_T,
    COUNT,
    FLAG,
    KNOWN,
    NONE,
    OTHER_FLAG,
    RATE,
    READY,
    ROUNDING,
    SETTLED,
    SIZE,
    SLID,
    SLIDE_RATE,
    SLOW,
    SPARE,
    STATIC,
    STOPS,
    STRUCK,
    WAS,
    col,
    real,
    whole,
)
from .touching import force_noise, free_accelerations, looks_again, push, push_and_account

AHEAD, FARTHEST_AHEAD = 1e-9, 1e-6
"""How far the mechanism is moved, of its size, to see what holds a moment later: at the second event of an instant, and
ten times farther at each of the following ones, but not beyond."""


@internal
def look(ev: Any, ms: Any) -> None:
    """What the rates say: +-1 in `KNOWN` where the contact slides, 0 where friction decides."""
    slide_rate, known, slid = col(ev, SLIDE_RATE), col(ev, KNOWN), col(ev, SLID)
    for i in range(whole(ev)[COUNT]):
        slow = max(col(ev, SLOW)[i], col(ev, ROUNDING)[i])
        known[i] = np.sign(slide_rate[i]) if abs(slide_rate[i]) > slow else 0.0
        if whole(ev)[STRUCK] == 0 and col(ev, WAS)[i] == CLOSED:
            # one that did not slide by itself, since others held it, may already go the other way by a little
            turned = ms.exact != 0 and slid[i] * slide_rate[i] < -slow
            # what the forces were before this instant says nothing of one that hardly moves
            moves = abs(slide_rate[i]) > slow and col(ev, STOPS)[i] == 0.0
            slides = abs(slid[i]) == 1.0 and (turned or moves)
            way = np.sign(slide_rate[i]) if turned else slid[i]
            known[i] = way if slides else 0.0


@internal
def begin_rest(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Which contacts neither separate nor approach. `ACCELERATIONS` of the coordinates before, 1/s^2, are given."""
    count, at_rest, contacts = whole(ev)[COUNT], col(ev, AT_REST), ivec(ev.contacts, ev.most)
    look(ev, ms)
    rates, slow = col(ev, RATE), whole(ev)[STRUCK] == 0
    for i in range(count):
        at_rest[i] = abs(rates[i]) <= col(ev, ROUNDING)[i]
        # a constraint that holds does not separate, however much its method drifts
        if whole(ev)[STRUCK] == 0 and col(ev, WAS)[i] == CLOSED:
            at_rest[i] = 1.0
        slow = slow or abs(rates[i]) <= PERHAPS_REST * rate_size(ws, contacts[i])
    _stop_slow(ev, dr, ws, ms)
    whole(ev)[READY] = 0
    if not slow:
        return SETTLED
    return find_free(ev, dr, ws, ms, real(ev)[ACCELERATIONS])


@internal
def _stop_slow(ev: Any, dr: Any, ws: Any, ms: Any) -> None:
    """Where instants crowd, take away what is left of sliding that counts as none (`crowding.py`)."""
    some = False
    for i in range(whole(ev)[COUNT]):
        none = col(ev, KNOWN)[i] == 0.0 and col(ev, AT_REST)[i] != 0.0 and col(ev, STATIC)[i] > 0.0
        some = some or (none and abs(col(ev, SLIDE_RATE)[i]) > col(ev, ROUNDING)[i])
    if some and ms.exact != 0:
        stop(ev, dr, ws, ms)


@internal
def stop(ev: Any, dr: Any, ws: Any, ms: Any) -> None:
    """Take away the rates of the contacts at rest, and of their sliding where friction decides."""
    normal, along = col(ev, SPARE), col(ev, OTHER_FLAG)
    remove_rates(ev, normal, along)
    push_and_account(ev, dr, ws, normal, along)
    look(ev, ms)


@internal
def _ahead(dr: Any, ws: Any) -> float:
    """How far ahead accelerations are looked at, s: where a geometry's curvature jumps (a corner is passed), the
    present point may lie before the jump by rounding, and what holds behind it decides. 0 at first."""
    again, v, scale, speed = looks_again(dr) - 1, vec(ws.v, ws.n_ext), vec(ws.scale, ws.n), 0.0
    if again < 1:
        return 0.0
    for i in range(ws.n):
        speed = max(speed, abs(v[i]) / scale[i])
    return min(AHEAD * 10.0 ** (again - 1), FARTHEST_AHEAD) / speed if speed > 0.0 else 0.0


@internal
def find_free(ev: Any, dr: Any, ws: Any, ms: Any, accelerations: float) -> int:
    """Free accelerations of gaps and sliding distances, with zero for what is rounding."""
    count, n, b_n, b_t, size = whole(ev)[COUNT], ws.n, col(ev, B_N), col(ev, B_T), col(ev, SIZE)
    status = free_accelerations(ev, dr, ws, b_n, b_t, _ahead(dr, ws))
    if status != SETTLED:
        return status
    whole(ev)[READY] = 1
    none = NO_ACCELERATION * max(largest_acceleration(ws), accelerations, 1e-300)
    real(ev)[NONE] = none
    forces, scale = force_noise(ev, ws), vec(ws.scale, n)
    directions, responses = mat(ev.directions, 2 * count, n), mat(ev.responses, 2 * count, n)
    for i in range(2 * count):
        largest, noise = 0.0, 0.0
        for j in range(n):
            largest = max(largest, abs(directions[i, j]) * scale[j])
            noise += abs(responses[i, j]) * forces[j]
        least = max(none * largest, noise)
        if i < count:
            size[i] = largest
            b_n[i] = 0.0 if abs(b_n[i]) <= least else b_n[i]
        else:
            b_t[i - count] = 0.0 if abs(b_t[i - count]) <= least else b_t[i - count]
    hold_back(ev, ws, ms, b_n)
    return SETTLED


@internal
def hold_back(ev: Any, ws: Any, ms: Any, motion: Any) -> bool:
    """Gaps that open but, with these accelerations, less than could be told from zero, are at rest too: what is left of
    the rates is taken away. False if there are none."""
    count, contacts, back, found = whole(ev)[COUNT], ivec(ev.contacts, ev.most), col(ev, FLAG), False
    at_rest = col(ev, AT_REST)
    for i in range(count):
        rate = col(ev, RATE)[i]
        back[i] = at_rest[i] == 0.0 and 0.0 < rate <= unresolved_speed(ws, contacts[i], -motion[i])
        found = found or back[i] != 0.0
    if not found:
        return False
    for i in range(count):
        at_rest[i] = 1.0 if back[i] != 0.0 else at_rest[i]
    if ms.exact == 0:
        return True
    # rounding's worth, which no account sees
    normal, along = col(ev, SPARE), col(ev, OTHER_FLAG)
    remove_rates(ev, normal, along)
    push(ev, ws, normal, along)
    look(ev, ms)
    return True


@internal
def fastest_free(ev: Any) -> float:
    """The largest of the free accelerations, m/s^2."""
    fastest = 0.0
    for i in range(whole(ev)[COUNT]):
        fastest = max(fastest, abs(col(ev, B_N)[i]), abs(col(ev, B_T)[i]))
    return fastest
