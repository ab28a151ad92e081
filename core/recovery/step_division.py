"""Fixed steps that do not converge are divided inside, compiled. The division of a step is a part of the state."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..events.progress import GUARD_SIZE, RUN_BEGAN
from ..methods.history import history_time, recall
from ..rounding import NO_STEP
from ..state.run_records import (
    DIVIDED_STEPS,
    DIVIDED_UNTIL,
    FAILURES,
    FIXED_STEP,
    HALVINGS,
    PARTS_UNTIL,
    TRIAL_STEP,
)
from ..state.workspace_records import CONTROL_SIZE, FACTOR_AGE, OUTER_LOOP, RATE_SIZE

MOST_HALVINGS = 20
"""Of a fixed step: what does not converge with a millionth of it does so for other reasons than its size. Friction in a
layer of 1e-8 m/s takes 19 at the instant when a mass comes to rest."""
MOST_FAILURES = 50
"""In one fixed step. That instant takes up to 25."""
DIVIDED_SHARE, ALLOWANCE = 0.1, 10
"""Of the whole steps so far, how many may be divided: a part, and a few. Division is for rare instants; where it is
the rule the step is too large, and a run would take many times the steps that it was asked for."""
AT_ONCE = 4.0
"""Smaller steps that are made before they grow again."""


@internal
def halve_step(drive: Any, workspace: Any, method: Any, clock: Any) -> bool:
    """Go on from the newest row with half the fixed step that has failed; False where steps are not divided: with error
    control, by the simple iteration, whose limit is what a user wants to know, or beyond the bounds above."""
    if clock[FIXED_STEP] == 0.0 or vec(workspace.control, CONTROL_SIZE)[OUTER_LOOP] == 1.0:
        return False
    now = history_time(method, 0)
    if clock[HALVINGS] > 0.0:
        if clock[HALVINGS] == MOST_HALVINGS or clock[FAILURES] == MOST_FAILURES:
            return False
    else:
        began = vec(drive.guard, GUARD_SIZE)[RUN_BEGAN]
        if clock[DIVIDED_STEPS] >= ALLOWANCE + DIVIDED_SHARE * ((now - began) / clock[FIXED_STEP]):
            return False
        clock[DIVIDED_UNTIL] = now + clock[TRIAL_STEP]
        clock[DIVIDED_STEPS] += 1.0
    clock[FAILURES] += 1.0
    recall(workspace, method, 0)
    vec(workspace.rate, RATE_SIZE)[FACTOR_AGE] = -1.0
    _set_parts(clock, clock[HALVINGS] + 1.0, now)
    return True


@internal
def grow_parts(clock: Any, now: float) -> bool:
    """Go on with larger steps where smaller ones have ended, with whole ones behind the divided one; False if none is
    divided, or its parts go on from `now` (s), the time of the newest row."""
    if clock[HALVINGS] == 0.0:
        return False
    if clock[DIVIDED_UNTIL] - now <= NO_STEP * abs(now):  # no step fits between
        end_division(clock)
    elif clock[PARTS_UNTIL] - now > NO_STEP * abs(now):
        return False
    else:
        _set_parts(clock, max(clock[HALVINGS] - 1.0, 1.0), now)
    return True


@internal
def end_division(clock: Any) -> None:
    """Go on with whole steps."""
    clock[FIXED_STEP] *= 2.0 ** clock[HALVINGS]
    clock[HALVINGS] = clock[FAILURES] = clock[DIVIDED_UNTIL] = clock[PARTS_UNTIL] = 0.0


@internal
def _set_parts(clock: Any, halvings: float, now: float) -> None:
    clock[FIXED_STEP] *= 2.0 ** (clock[HALVINGS] - halvings)
    clock[HALVINGS] = halvings
    clock[PARTS_UNTIL] = min(clock[DIVIDED_UNTIL], now + AT_ONCE * clock[FIXED_STEP])
