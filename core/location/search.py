"""Locating events inside a step: it is made again with other sizes until it ends at the first of them.

The dense output says between which places in the step a root lies (`watch.py`, `certain.py`); here the motion itself
decides. A root is searched by secant steps down to rounding, with a safeguard as in ITP: bisection where three trials
do not halve the bracket. The search ends on the safe side of a root, so that what follows does not find the same
crossing again, but behind a jump of the function, since what it asks for is seen only there.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_time, recall
from ..rounding import GAP_ROUNDING, NO_STEP, PRESSING, RESOLVED_TIME, SAME_INSTANT, SAME_TRIAL, UNRESOLVED
from ..state.modes import ACTIVE, CLOSED, IDLE, MEMORY_SIZE, MODE, OPEN, SLIDE
from ..state.run_records import (
    CLOCK_SIZE,
    FOUND_SIZE,
    TRIAL_STEP,
    WATCH,
    call_accept,
    call_find_events,
    call_trial,
)
from ..state.workspace_records import FACTOR_AGE, OK, OUTER_RATE, RATE_SIZE
from ..tables.levels import position_level
from .probe import BRACKET, HAPPENS, VIEW, look
from .watch import friction_margin

MAX_TRIALS, MOST_HALVINGS, MOST_LOOKS, MOST_NEWTON = 60, 40, 60, 6
JUMP = 1e-6
"""A function that is this large, relative to its largest value, right beside its root jumps there."""
AT_ONCE = 1e-6
"""Of a step. Methods that do not meet the constraints at all levels do not give the newest row's force (or gap rate)
in the limit of small steps: an event located this near to it lies at the row itself, and no step is made to it."""
LATER = 1.001
"""Events that the dense output puts this much later than the first one are searched for only if they turn out to lie
before it: each search makes the step several times."""

NEAREST = 3
"""Sizes of steps before and beyond the last event that was searched for, and the size that ends there."""

# what is searched for a root
GAP, FORCE, OVERLAP, CLOSING = range(4)
# columns of `found`
SIZE, STATE, PLACES = range(3)
UNKNOWN, HAPPENED, SAFE, CANDIDATE = 0.0, 1.0, 2.0, 3.0


@internal
def make_trial(dr: Any, ws: Any, ms: Any, lc: Any, step: float, full: float) -> int:
    """Make the step again with another size. Small fractions of it are made by the one-step starter: the multistep
    coefficients of a grid with a very small last step lose digits."""
    last = vec(dr.last_trial, 1)
    if last[0] == step:
        return OK
    starter, rows = lc.starter, lc.rows
    if step < 0.1 * full or rows == 1:
        lc.starter = lc.fine_starter
        if rows > 1:
            lc.rows = 1_000_000_000
    # with old matrices the same step would come out a little different each time it is made
    rate = vec(ws.rate, RATE_SIZE)
    rate[FACTOR_AGE], rate[OUTER_RATE] = -1.0, 1.0
    status = call_trial(dr.trial, ws, ms, lc, step)
    lc.starter, lc.rows = starter, rows
    last[0] = step if status == OK else -1.0
    return status


@internal
def _value(
    dr: Any, ws: Any, ms: Any, lc: Any, k: int, what: int, sign: float, slack: float, step: float, full: float
) -> Any:
    """(status, value) at the end of a step of this size of what is positive before the event."""
    status = make_trial(dr, ws, ms, lc, step, full)
    if status != OK:
        return status, 0.0
    row = ivec(ws.contact_rows, ws.n_contacts)[k]
    if what == GAP or what == OVERLAP:
        return OK, sign * vec(ws.phi, ws.m_ext)[row] + slack
    if what == CLOSING:
        return OK, vec(ws.phidd, ws.m_ext)[row] + slack
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    force = sign * vec(ws.monitor, ws.n_contacts)[k]
    if memory[MODE] == CLOSED and vec(ws.contact_sticking, ws.n_contacts)[k] > 0.0 and memory[SLIDE] != IDLE:
        force = min(force, friction_margin(ws, k))
    return OK, force


@internal
def _root(
    dr: Any, ws: Any, ms: Any, lc: Any, k: int, what: int, sign: float, slack: float,
    low: float, high: float, floor: float, full: float,
) -> Any:  # fmt: skip
    """(status, size, whether it happens) of the step that ends at the root of what is positive at `low` and negative at
    `high`; that step is the current point. Not: up to that size there is none, and another
    contact has its event before it."""
    x_low, x_high, f_low, f_high, largest = low, high, np.nan, np.nan, 0.0
    # what ends one force often ends others
    nearest = vec(dr.nearest, NEAREST)
    if low <= nearest[0] < high:
        x_high = min(nearest[1], high)
        status, f_high = _value(dr, ws, ms, lc, k, what, sign, slack, x_high, full)
        if status != OK or f_high > 0.0:
            return status, x_high, False
        if nearest[0] > low:
            status, f_low = _value(dr, ws, ms, lc, k, what, sign, slack, nearest[0], full)
        if status != OK or nearest[0] == low or f_low > 0.0:
            return status, nearest[2], True
        x_high, f_high, f_low = nearest[0], f_low, np.nan
    resolved = NO_STEP * abs(history_time(ms, 0))
    x, last_x, last_f = 0.5 * (x_low + x_high), np.nan, np.nan
    # widths of the bracket three, two and one trials ago
    third, second, first, trials = np.inf, np.inf, x_high - x_low, 1
    for _ in range(MAX_TRIALS):
        status, f = _value(dr, ws, ms, lc, k, what, sign, slack, x, full)
        if status != OK or abs(f) <= floor:
            return status, x, True
        largest = max(largest, abs(f))
        if f > 0.0:
            x_low, f_low = x, f
        else:
            x_high, f_high = x, f
        width, least = x_high - x_low, max(RESOLVED_TIME * abs(x_high), resolved)
        if width <= least:
            break
        slow = trials >= 3 and width > 0.5 * third
        third, second, first = second, first, width
        trials += 1
        if f != last_f and not np.isnan(last_f):
            proposal = x - f * (x - last_x) / (f - last_f)
        elif not np.isnan(f_low) and not np.isnan(f_high):
            proposal = x_low + width * f_low / (f_low - f_high)
        else:
            proposal = 0.5 * (x_low + x_high)
        if slow or not x_low < proposal < x_high:
            proposal = 0.5 * (x_low + x_high)
        elif abs(proposal - x) < 0.5 * least:
            # at the root: look just beyond it, so that it is between two places (Brent 1973)
            proposal = x + (0.5 * least if f > 0.0 else -0.5 * least)
        last_x, last_f = x, f
        x = proposal
    # a gap below zero by rounding that nothing closes would pass the same limit again
    if (f_low > JUMP * largest or what == OVERLAP) and not np.isnan(f_high):
        x = x_high
    elif x_low > low:
        # the side past the event would be found again as a crossing: end on the safe one
        x = x_low
    nearest[0], nearest[1], nearest[2] = x_low * (1.0 - SAME_INSTANT), x_high * (1.0 + SAME_INSTANT), x
    return make_trial(dr, ws, ms, lc, x, full), x, True


@internal
def dense_root(ws: Any, ms: Any, lc: Any, k: int, h: float, sign: float, low: float, high: float) -> float:
    """Size of the step at which the dense output of the one that ends at the current point, of size h, has its root
    between `low` and `high`."""
    row, view = ivec(ws.contact_rows, ws.n_contacts)[k], np.empty(VIEW)
    x = 0.5 * (low + high)
    for _ in range(MOST_LOOKS):
        look(ws, ms, lc, k, row, h, x / h, view)
        g, rate = sign * view[0], sign * view[1]
        if g > 0.0:
            low = x
        else:
            high = x
        proposal = x - g / rate if rate != 0.0 else low
        if not low < proposal < high:
            proposal = 0.5 * (low + high)
        if abs(proposal - x) <= SAME_TRIAL * h:
            break
        x = proposal
    return x


@internal
def _by_rate(
    dr: Any, ws: Any, ms: Any, lc: Any, k: int, sign: float, low: float, high: float, guess: float, floor: float,
    full: float,
) -> Any:  # fmt: skip
    """(status, size, found) of the step that ends at a root of the gap, by Newton's method from the dense output's: two
    or three trials where the gap crosses zero plainly. Not found: where it does not, or not between `low` and `high`.
    """
    row, x = ivec(ws.contact_rows, ws.n_contacts)[k], guess
    for _ in range(MOST_NEWTON):
        status, g = _value(dr, ws, ms, lc, k, GAP, sign, 0.0, x, full)
        if status != OK:
            return status, x, False
        rate = sign * vec(ws.phid, ws.m_ext)[row]
        if abs(g) <= floor and rate < 0.0:
            return OK, x, True
        if not rate < 0.0:
            return OK, x, False
        change = -g / rate
        # of the step, not of the time: the state is as exact as the former
        if abs(change) <= 2.0 * RESOLVED_TIME * x:
            if g < 0.0:
                # the side past the event would be found again as a crossing: end on the safe one
                x += change - 2.0 * RESOLVED_TIME * x
            return make_trial(dr, ws, ms, lc, x, full), x, True
        x += change
        if not low < x < high:
            return OK, x, False
    return OK, x, False


@internal
def _go_back(
    dr: Any, ws: Any, ms: Any, lc: Any, k: int, what: int, sign: float, low: float, high: float, h: float
) -> Any:
    """(status, low, high): where the motion is ahead of its interpolant, back to where it is still on the safe side."""
    for _ in range(MOST_HALVINGS):
        if low == 0.0:
            break
        status, f = _value(dr, ws, ms, lc, k, what, sign, 0.0, low, h)
        if status != OK:
            return status, low, high
        if f > 0.0:
            break
        low, high = 0.5 * low, low
    return OK, low, high


@internal
def _by_force(dr: Any, ws: Any, ms: Any, lc: Any, k: int, sign: float, low: float, high: float, h: float) -> Any:
    """(status, size, whether it happens) of an event at which a force or what friction can still hold ends."""
    if high < h:
        status, f = _value(dr, ws, ms, lc, k, FORCE, sign, 0.0, high, h)
        if status != OK:
            return status, high, False
        if f > 0.0:
            return OK, high if high > AT_ONCE * h else h, False
    status, low, high = _go_back(dr, ws, ms, lc, k, FORCE, sign, low, high, h)
    if status != OK:
        return status, low, False
    return _root(dr, ws, ms, lc, k, FORCE, sign, 0.0, low, high, 0.0, h)


@internal
def _begins_to_close(dr: Any, ws: Any, ms: Any, lc: Any, k: int, h: float, overlap: float) -> Any:
    """(status, size, whether it happens) of the step at which shapes that touch without force begin to close: their
    gap, zero by rounding, says so late, its acceleration says it at once, and where that jumps (a corner is passed)
    just behind."""
    status, end = _value(dr, ws, ms, lc, k, OVERLAP, 1.0, overlap, h, h)
    if status != OK:
        return status, h, True
    none, a, scale = 0.0, vec(ws.a, ws.n), vec(ws.scale, ws.n)
    for i in range(ws.n):
        none = max(none, abs(a[i]) / scale[i])
    row = ivec(ws.contact_rows, ws.n_contacts)[k]
    none *= PRESSING * vec(ws.row_scale, ws.m_ext)[row]
    before = mat(lc.watch, ws.n_contacts, WATCH)[k, 2]
    if before > -none and vec(ws.phidd, ws.m_ext)[row] < -none:
        return _root(dr, ws, ms, lc, k, CLOSING, 1.0, none, 0.0, h, 0.0, h)
    if end <= 0.0:
        return _root(dr, ws, ms, lc, k, OVERLAP, 1.0, overlap, 0.0, h, 0.0, h)
    return OK, h, True


@internal
def _event_step(dr: Any, ws: Any, ms: Any, lc: Any, k: int, h: float, places: Any) -> Any:
    """(status, size, True) of the step at which contact k has its event; or (status, size, False): up to that size the
    motion has none. `places`: the gap at the end of the step of size h; sizes before a root of the gap's dense output,
    beyond it, where that is deepest, and that root itself."""
    mode = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, MODE]
    end, low, high, deepest, guess = places[0], places[1], places[2], places[3], places[4]
    if mode == CLOSED or (mode != OPEN and end <= 0.0 and high == h):
        return _by_force(dr, ws, ms, lc, k, 1.0 if mode == CLOSED or mode == ACTIVE else -1.0, low, high, h)
    sign = 1.0 if mode == OPEN else -1.0
    size = position_level(ws) * vec(ws.row_scale, ws.m_ext)[ivec(ws.contact_rows, ws.n_contacts)[k]]
    overlap = GAP_ROUNDING * size
    pulls = mode == ACTIVE and ivec(ws.contact_release, ws.n_contacts)[k] == 2
    start = mat(lc.watch, ws.n_contacts, WATCH)[k]
    comes_from_afar = abs(start[0]) > overlap or sign * start[1] * guess > overlap
    if not pulls and low < guess < high and comes_from_afar:
        status, found, good = _by_rate(dr, ws, ms, lc, k, sign, low, high, guess, RESOLVED_TIME * size, h)
        if status != OK or good:
            return status, found, good
    if high < h:
        status, g = _value(dr, ws, ms, lc, k, GAP, sign, 0.0, high, h)
        if status != OK:
            return status, high, False
        if g > 0.0:
            # the motion is behind its dense output: look where that goes deepest
            low, beyond = high, False
            if low < deepest < h:
                status, g = _value(dr, ws, ms, lc, k, GAP, sign, 0.0, deepest, h)
                if status != OK:
                    return status, deepest, False
                beyond = g <= 0.0
            if beyond:
                high = deepest
            elif sign * end <= 0.0:
                high = h
            else:
                # what the dense output has shown is its own error; the very start of the step is no place to stop at
                return OK, max(low, deepest) if low > AT_ONCE * h else h, False
    status, low, high = _go_back(dr, ws, ms, lc, k, GAP, sign, low, high, h)
    if status != OK:
        return status, low, False
    # one that drifts by rounding may have gone a little beyond what is rounding of the gap
    if mode == OPEN and -UNRESOLVED * size <= start[0] <= overlap:
        status, g = OK, mat(lc.watch, ws.n_contacts, WATCH)[k, 0]
        if low > 0.0:
            status, g = _value(dr, ws, ms, lc, k, GAP, sign, 0.0, low, h)
        if status != OK:
            return status, low, False
        if g <= overlap:
            return _begins_to_close(dr, ws, ms, lc, k, h, max(overlap, 0.5 * overlap - start[0]))
    status, opened, happens = _root(dr, ws, ms, lc, k, GAP, sign, 0.0, low, high, RESOLVED_TIME * size, h)
    if status == OK and happens and pulls and vec(ws.monitor, ws.n_contacts)[k] < 0.0:
        # the gap opens within this step, but the force has become tensile before
        return _root(dr, ws, ms, lc, k, FORCE, 1.0, 0.0, 0.0, opened, 0.0, h)
    return status, opened, happens


@internal
def _guess(ws: Any, ms: Any, lc: Any, k: int, h: float, places: Any) -> float:
    """Where in the step of size h that ends at the current point the dense output says that the event is; -1: it does
    not say."""
    mode, end = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, MODE], places[0]
    if mode == CLOSED or (mode != OPEN and end <= 0.0 and places[2] == h):
        return -1.0
    return dense_root(ws, ms, lc, k, h, 1.0 if mode == OPEN else -1.0, places[1], places[2])


@internal
def locate(dr: Any, ws: Any, ms: Any, lc: Any) -> int:
    """End the step at the first event in it, accept that, and set `pending`; OK, or the status of a step that cannot be
    made: nothing is accepted then.

    The current point must be the end of the step of size TRIAL_STEP, in which events have been found.
    """
    h = vec(lc.clock, CLOCK_SIZE)[TRIAL_STEP]
    found, pending = mat(dr.found, ws.n_contacts, FOUND_SIZE), ivec(dr.pending, ws.n_contacts)
    brackets = mat(lc.brackets, ws.n_contacts, BRACKET)
    vec(dr.last_trial, 1)[0] = vec(dr.nearest, NEAREST)[0] = -1.0
    for k in range(ws.n_contacts):
        found[k, STATE] = UNKNOWN
    step, least = h, NO_STEP * abs(history_time(ms, 0))
    while call_find_events(lc.find_events, ws, ms, lc, step, True):
        late, first, soonest = False, step, np.inf
        for k in range(ws.n_contacts):
            if brackets[k, HAPPENS] == 0.0 or found[k, STATE] != UNKNOWN:
                continue
            late = True
            # the shorter step may end where a gap is negative that the longer one has passed
            places = found[k, PLACES:]
            places[0] = vec(ws.phi, ws.m_ext)[ivec(ws.contact_rows, ws.n_contacts)[k]]
            for i in range(3):
                places[1 + i] = step * brackets[k, i]
            places[4] = _guess(ws, ms, lc, k, step, places)
            if places[4] >= 0.0:
                soonest = min(soonest, places[4])
            found[k, STATE] = CANDIDATE
        if not late:
            break
        for k in range(ws.n_contacts):
            if found[k, STATE] == CANDIDATE and found[k, PLACES + 4] > LATER * soonest:
                found[k, STATE] = UNKNOWN
        nearest = np.inf
        for k in range(ws.n_contacts):
            if found[k, STATE] == CANDIDATE:
                status, size, happens = _event_step(dr, ws, ms, lc, k, step, found[k, PLACES:])
                if status != OK:
                    return status
                # where the motion has none up to next to no time, what was seen is rounding
                found[k, SIZE] = size if happens or size > least else step
                found[k, STATE] = HAPPENED if happens else SAFE
            if found[k, STATE] != UNKNOWN:
                first = min(first, found[k, SIZE])
            if found[k, STATE] == HAPPENED:
                nearest = min(nearest, found[k, SIZE])
        # no time lies between: a step to there would be none
        at_once = least if ms.exact != 0 else AT_ONCE * h
        if (nearest if ms.exact != 0 else first) <= at_once:
            recall(ws, ms, 0)
            for k in range(ws.n_contacts):
                pending[k] = 1 if found[k, STATE] == HAPPENED and found[k, SIZE] <= at_once else 0
            return OK
        step = first
        status = make_trial(dr, ws, ms, lc, step, h)
        if status != OK:
            return status
    call_accept(dr.accept, ws, ms, lc)
    for k in range(ws.n_contacts):
        pending[k] = 1 if found[k, STATE] == HAPPENED and found[k, SIZE] <= step * (1.0 + SAME_INSTANT) else 0
    return OK
