"""Where in a step a function of one contact has its root: the sizes of steps are tried until one ends there.

A root is searched by secant steps down to rounding, with a safeguard as in ITP: bisection where three trials do not
halve the bracket. Where the gap crosses zero plainly, Newton's method from the root of the dense output is shorter. The
search ends on the safe side of a root, so that what follows does not find the same crossing again, but behind a jump
of the function, since what it asks for is seen only there.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..methods.history import history_time
from ..rounding import NO_STEP, RESOLVED_TIME, SAME_INSTANT, SAME_TRIAL
from ..state.workspace_records import OK
from .contact_evaluation import VIEW, look
from .trial_steps import FORCE_ROOT, GAP_ROOT, OVERLAP_ROOT, make_trial, trial_value

MAX_TRIALS, MOST_HALVINGS, MOST_LOOKS, MOST_NEWTON = 60, 40, 60, 6
JUMP = 1e-6
"""A function that is this large, relative to its largest value, right beside its root jumps there."""
SHORT = 1e-6
"""Of a step: the last one before a jump of a force is this long."""
AT_BEGINNING = 1.0 / 16.0
"""Of the bracket that begins where the step does: where its next trial ends if nothing else says where."""
FINE = 1e-2
"""Of that length: how finely the place of the jump is known then."""
CLEARLY = 1e4
"""Of the least time: what is behind a jump by so much is not before it by rounding."""
NEAREST = 4
"""Sizes of steps before and beyond the last event that was searched for, the size that ends there, and 1.0; or, with
0.0, that of the step which ends shortly before it."""


@internal
def _keep_nearest(nearest: Any, low: float, high: float, size: float, happens: bool) -> None:
    """What `find_root` has found, for the other contacts of the same step."""
    nearest[0], nearest[1] = low * (1.0 - SAME_INSTANT), high * (1.0 + SAME_INSTANT)
    nearest[2], nearest[3] = size, 1.0 if happens else 0.0


@internal
def _jumps_behind(low: float, width: float, f_low: float, f_high: float, largest: float, full: float) -> bool:
    """True if a force jumps between steps of size `low` and `width` more, as finely as the step is to end before it."""
    fine = low > 10.0 * SHORT * full and width <= FINE * SHORT * full
    return bool(fine and f_low > JUMP * largest and f_high < -JUMP * largest)


@internal
def find_root(
    drive: Any, workspace: Any, method: Any, loop: Any, k: int, what: int, sign: float, slack: float,
    low: float, high: float, floor: float, full: float,
) -> Any:  # fmt: skip
    """(status, size, whether it happens) of the step that ends at the root of what is positive at `low` and negative at
    `high`; that step is the current point. Not: up to that size there is none, and another
    contact has its event before it."""
    x_low, x_high, f_low, f_high, largest = low, high, np.nan, np.nan, 0.0
    # what ends one force often ends others
    nearest = vec(drive.nearest, NEAREST)
    if low <= nearest[0] < high:
        x_high, status = min(nearest[1], high), OK
        # the trial that has been made last is there for this contact too; and what is behind a jump before which the
        # step ends need not be known: steps over jumps are made in many parts
        first_low = nearest[0] > low and (nearest[3] == 0.0 or vec(drive.last_trial, 1)[0] == nearest[0])
        if first_low:
            status, f_low = trial_value(drive, workspace, method, loop, k, what, sign, slack, nearest[0], full)
            if status == OK and f_low > 0.0 and nearest[3] == 0.0:
                return status, nearest[2], False
        if not first_low or (status == OK and f_low > 0.0):
            status, f_high = trial_value(drive, workspace, method, loop, k, what, sign, slack, x_high, full)
            if status != OK or f_high > 0.0:
                return status, x_high, False
        if nearest[0] > low and not first_low:
            status, f_low = trial_value(drive, workspace, method, loop, k, what, sign, slack, nearest[0], full)
        if status != OK or nearest[0] == low or f_low > 0.0:
            return status, nearest[2], nearest[3] != 0.0
        x_high, f_high, f_low = nearest[0], f_low, np.nan
    resolved = NO_STEP * abs(history_time(method, 0))
    x, last_x, last_f = 0.5 * (x_low + x_high), np.nan, np.nan
    # widths of the bracket three, two and one trials ago
    third, second, first, trials = np.inf, np.inf, x_high - x_low, 1
    for _ in range(MAX_TRIALS):
        status, f = trial_value(drive, workspace, method, loop, k, what, sign, slack, x, full)
        if status != OK or abs(f) <= floor:
            return status, x, True
        largest = max(largest, abs(f))
        if f > 0.0:
            x_low, f_low = x, f
        else:
            x_high, f_high = x, f
        width, least = x_high - x_low, max(RESOLVED_TIME * abs(x_high), resolved)
        if width <= least or (what == FORCE_ROOT and _jumps_behind(x_low, width, f_low, f_high, largest, full)):
            break
        slow = trials >= 3 and width > 0.5 * third
        third, second, first = second, first, width
        trials += 1
        if f != last_f and not np.isnan(last_f):
            proposal = x - f * (x - last_x) / (f - last_f)
        elif not np.isnan(f_low) and not np.isnan(f_high):
            proposal = x_low + width * f_low / (f_low - f_high)
        else:
            proposal = x_low
        if slow or not x_low < proposal < x_high:
            # what is there from the beginning on is there at once: its size has no lower bound to halve towards
            proposal = 0.5 * (x_low + x_high) if x_low > 0.0 else AT_BEGINNING * x_high
        elif abs(proposal - x) < 0.5 * least:
            # at the root: look just beyond it, so that it is between two places (Brent 1973)
            proposal = x + (0.5 * least if f > 0.0 else -0.5 * least)
        last_x, last_f = x, f
        x = proposal
    # a gap below zero by rounding that nothing closes would pass the same limit again
    at_row = what == FORCE_ROOT and x_low == 0.0 and np.isnan(f_low)
    # what may jump from next to nothing (right behind the newest row, nothing else is known of it): a gap does not
    jumps = f_low > JUMP * largest or (what != GAP_ROOT and f_high < -JUMP * largest)
    if (jumps or what == OVERLAP_ROOT) and not np.isnan(f_high):
        if what == FORCE_ROOT and x_low > 10.0 * SHORT * full:
            # a step takes what is at its end for a part of all of it: let the one over the jump be short
            x = x_low - SHORT * full
            _keep_nearest(nearest, x_low, x_high, x, False)
            return make_trial(drive, workspace, method, loop, x, full), x, False
        # clearly behind it: rounding must not take back what has been passed (at the row nothing has been)
        behind = CLEARLY * resolved if at_row else max(0.1 * SHORT * full, CLEARLY * resolved)
        x = min(x_high + behind, full) if what == FORCE_ROOT else x_high
    elif x_low > low:
        # the side past the event would be found again as a crossing: end on the safe one
        x = x_low
    _keep_nearest(nearest, x_low, x_high, x, True)
    return make_trial(drive, workspace, method, loop, x, full), x, True


@internal
def dense_root(workspace: Any, method: Any, loop: Any, k: int, h: float, sign: float, low: float, high: float) -> float:
    """Size of the step at which the dense output of the one that ends at the current point, of size h, has its root
    between `low` and `high`."""
    row, view = ivec(workspace.contact_rows, workspace.n_contacts)[k], np.empty(VIEW)
    x = 0.5 * (low + high)
    for _ in range(MOST_LOOKS):
        look(workspace, method, loop, k, row, h, x / h, view)
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
def root_by_rate(
    drive: Any, workspace: Any, method: Any, loop: Any, k: int, sign: float, low: float, high: float, guess: float,
    floor: float,
    full: float,
) -> Any:  # fmt: skip
    """(status, size, found) of the step that ends at a root of the gap, by Newton's method from the dense output's: two
    or three trials where the gap crosses zero plainly. Not found: where it does not, or not between `low` and `high`.
    """
    row, x = ivec(workspace.contact_rows, workspace.n_contacts)[k], guess
    for _ in range(MOST_NEWTON):
        status, g = trial_value(drive, workspace, method, loop, k, GAP_ROOT, sign, 0.0, x, full)
        if status != OK:
            return status, x, False
        rate = sign * vec(workspace.phid, workspace.m_ext)[row]
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
            return make_trial(drive, workspace, method, loop, x, full), x, True
        x += change
        if not low < x < high:
            return OK, x, False
    return OK, x, False


@internal
def go_back(
    drive: Any,
    workspace: Any,
    method: Any,
    loop: Any,
    k: int,
    what: int,
    sign: float,
    low: float,
    high: float,
    h: float,
) -> Any:
    """(status, low, high): where the motion is ahead of its interpolant, back to where it is still on the safe side."""
    for _ in range(MOST_HALVINGS):
        if low == 0.0:
            break
        status, f = trial_value(drive, workspace, method, loop, k, what, sign, 0.0, low, h)
        if status != OK:
            return status, low, high
        if f > 0.0:
            break
        low, high = 0.5 * low, low
    return OK, low, high
