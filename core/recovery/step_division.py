"""Fixed steps that do not converge are divided inside, compiled. The division of a step is a part of the state."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..events.progress import GUARD_SIZE, RUN_BEGAN
from ..methods.history import history_time, recall
from ..rounding import NO_STEP
from ..state.workspace_records import control_at, convergence_at

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
    if clock.fixed_step == 0.0 or control_at(workspace.control).outer_loop == 1.0:
        return False
    now = history_time(method, 0)
    if clock.halvings > 0.0:
        if clock.halvings == MOST_HALVINGS or clock.failures == MOST_FAILURES:
            return False
    else:
        began = vec(drive.guard, GUARD_SIZE)[RUN_BEGAN]
        if clock.divided_steps >= ALLOWANCE + DIVIDED_SHARE * ((now - began) / clock.fixed_step):
            return False
        clock.divided_until = now + clock.trial_step
        clock.divided_steps += 1.0
    clock.failures += 1.0
    recall(workspace, method, 0)
    convergence_at(workspace.rate).factor_age = -1.0
    _set_parts(clock, clock.halvings + 1.0, now)
    return True


@internal
def grow_parts(clock: Any, now: float) -> bool:
    """Go on with larger steps where smaller ones have ended, with whole ones behind the divided one; False if none is
    divided, or its parts go on from `now` (s), the time of the newest row."""
    if clock.halvings == 0.0:
        return False
    if clock.divided_until - now <= NO_STEP * abs(now):  # no step fits between
        end_division(clock)
    elif clock.parts_until - now > NO_STEP * abs(now):
        return False
    else:
        _set_parts(clock, max(clock.halvings - 1.0, 1.0), now)
    return True


@internal
def end_division(clock: Any) -> None:
    """Go on with whole steps."""
    clock.fixed_step *= 2.0**clock.halvings
    clock.halvings = clock.failures = clock.divided_until = clock.parts_until = 0.0


@internal
def _set_parts(clock: Any, halvings: float, now: float) -> None:
    clock.fixed_step *= 2.0 ** (clock.halvings - halvings)
    clock.halvings = halvings
    clock.parts_until = min(clock.divided_until, now + AT_ONCE * clock.fixed_step)
