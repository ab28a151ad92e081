"""Fixed steps that do not converge are divided inside."""

import logging
import math
from typing import TYPE_CHECKING

from ..methods.history import recall
from ..rounding import NO_STEP
from ..state.run_records import FIXED_STEP, TRIAL_STEP
from ..state.workspace_records import FACTOR_AGE

if TYPE_CHECKING:
    from .simulation import Simulation

logger = logging.getLogger(__name__)

MOST_HALVINGS = 20
"""Of a fixed step: what does not converge with a millionth of it does so for other reasons than its size. Friction in a
layer of 1e-8 m/s takes 19 at the instant when a mass comes to rest."""
MOST_FAILURES = 50
"""In one fixed step. That instant takes up to 25."""
SHARE, ALLOWANCE = 0.1, 10
"""Of the whole steps so far, how many may be divided: a part, and a few. Division is for rare instants; where it is
the rule the step is too large, and a run would take many times the steps that it was asked for."""
AT_ONCE = 4
"""Smaller steps that are made before they grow again."""


class Division:
    """The division of a fixed step, while one is divided.

    Attributes
    ----------
    until : where the step was to end, s; -inf while none is divided.
    stop : where the present smaller steps end, s; inf while none is divided.
    """

    def __init__(self, sim: "Simulation") -> None:
        self._sim, self._whole = sim, float(sim.clock[FIXED_STEP])
        self._halvings = self._failures = 0
        self.until, self.stop = -math.inf, math.inf

    def halve(self) -> bool:
        """Go on from the newest row with half the step that has failed; False where steps are not divided: with error
        control, by the simple iteration, whose limit is what a user wants to know, or beyond the bounds above."""
        sim = self._sim
        if self._whole == 0.0 or sim.outer == "simple" or self._beyond_bounds():
            return False
        self._failures += 1
        if self.stop == math.inf:
            self.until = sim.t_internal + float(sim.clock[TRIAL_STEP])
            sim.divided_steps += 1
            if not sim.reported_division:
                sim.reported_division = True
                logger.warning(
                    "at t = %.9g s a fixed step of %.3g s does not converge: it is made of smaller ones. This is said "
                    "once; stats['divided_steps'] counts such steps",
                    sim.t_internal,
                    self._whole,
                )
        recall(sim.workspace.record, sim._method.record, 0)
        sim.workspace.arrays["rate"][FACTOR_AGE] = -1.0
        self._set(self._halvings + 1)
        return True

    def _beyond_bounds(self) -> bool:
        if self.stop < math.inf:
            return self._halvings == MOST_HALVINGS or self._failures == MOST_FAILURES
        return self._sim.divided_steps >= ALLOWANCE + SHARE * self._whole_steps()

    def _whole_steps(self) -> float:
        """How many the run so far is long."""
        return (self._sim.t_internal - self._sim.settings.t0) / self._whole

    def tried(self) -> str:
        """What has been tried, of a run with fixed steps that ends."""
        step = f"fixed step {self._whole:.3g} s"
        if self.stop < math.inf:
            return f"{step}, divided into parts down to {float(self._sim.clock[FIXED_STEP]):.3g} s"
        if self._sim.divided_steps == 0:
            return step
        return (
            f"{step}; {self._sim.divided_steps} of {self._whole_steps():.0f} steps so far did not converge and were "
            f"divided, at most {ALLOWANCE} and {100.0 * SHARE:.0f} % of all are"
        )

    def go_on(self) -> bool:
        """Go on with larger steps where smaller ones have ended, with whole ones behind the divided one; False if none
        is divided."""
        if self.stop == math.inf:
            return False
        now = self._sim.t_internal
        if self.until - now <= NO_STEP * abs(now):  # no step fits between
            self.end()
        else:
            self._set(max(self._halvings - 1, 1))
        return True

    def _set(self, halvings: int) -> None:
        self._halvings, h = halvings, 0.5**halvings * self._whole
        self._sim.clock[FIXED_STEP] = h
        self.stop = min(self.until, self._sim.t_internal + AT_ONCE * h)

    def end(self) -> None:
        """Go on with whole steps."""
        self._halvings, self._failures, self.until, self.stop = 0, 0, -math.inf, math.inf
        self._sim.clock[FIXED_STEP] = self._whole
