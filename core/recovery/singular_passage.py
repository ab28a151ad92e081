"""Passing singular positions: positions where constraints depend on one another only there (bars in line).

The motion is smooth through them, but Phi_q loses rank: at a distance d rounding is multiplied by 1/d in the positions,
1/d^2 in the velocities and 1/d^3 in the accelerations across the motion. Steps that shrink towards such a position
never get past it. So one long step is made over it (`collocation.py`), which begins and ends where rounding does no
harm, and whose stages keep clear of the position. Its order is raised until the result stands still: what two orders
differ by then is the error, of truncation and of rounding. Truncation calls for a shorter step, begun nearer to the
position; rounding for a longer one. So the region in which the step may begin is wide, and rounding does not decide.
"""

import logging
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..assembly.evaluate import evaluate_residuals
from ..assembly.singular_values import singular_directions
from ..errors import SimulationError
from ..event_detection.crossings import find_events
from ..methods.history import recall
from ..rounding import CONSTRAINT_NOISE, SAME_INSTANT
from ..state.run_records import EVENT
from ..state.workspace_records import OK, REANALYZE, control_of, convergence_of
from ..time_loop.time_loop import accept, set_weights_at, violates_redundant
from .collocation import Collocation, Points, gauss
from .singular_position import find_singular, natural_step
from .step_plans import clear_stages, step_plans

if TYPE_CHECKING:
    from ..simulation.simulation import Simulation

logger = logging.getLogger(__name__)

FALLING = 0.3
"""Ratio of two differences between orders up to which truncation is what they show."""
UNDETERMINED = 1e-4
"""Least singular value of the scaled Phi_q up to which a point is not brought onto the constraints: rounding would move
it by more than the error of the polynomial."""
NOISELESS = 0.01
"""Of the tolerance: directions across which rounding is less are not looked for."""
LARGEST_TOLERANCE = 1e-4
"""Relative error up to which a step over the position is better than none."""
TURN = 0.2
"""Largest change of the velocities against their extrapolation, relative to the largest, on the same branch."""


def pass_singular(sim: "Simulation", last_resort: bool = False) -> "tuple[int, LongStep | None]":
    """One accepted long step from the newest row over a singular position near by, or away from one behind.

    Returns OK; REANALYZE if there is no such position within reach, if the step had better begin nearer to it, or if no
    step could be made (nothing is accepted then); EVENT if a contact has an event at once: nothing is accepted,
    TRIAL_STEP is the size of a step that it lies in, which the current point ends, and the second value makes such
    steps. `last_resort`: ordinary steps do not lead any nearer.

    Raises
    ------
    SimulationError : if the motion branches there.
    """
    natural = natural_step(sim)
    remaining = float(sim.clock.stop_time) - sim.t_internal
    found = find_singular(sim, natural)
    if found is None:
        return REANALYZE, None
    near, steepness = found
    set_weights_at(sim.workspace.record, sim._method.record)
    over = LongStep(sim, near, steepness)
    may_come_nearer = near > 2.0 * natural and not last_resort
    best: _Result | None = None
    for h, stages in step_plans(near, natural, remaining):
        result = over.make(h, stages)
        logger.debug(
            "over the singular position %.3g s from t = %.9g s by %.3g s: error %.3g of the tolerance%s",
            near, sim.t_internal, h, result.error, ", of truncation" if result.truncation else "",
        )  # fmt: skip
        if best is None or result.error < best.error:
            best = result
        if best.error <= 1.0 or (may_come_nearer and result.truncation):
            break
    if best is None or (may_come_nearer and (_too_long(best) or _leaps(sim, best))):
        return REANALYZE, None
    if best.points is None or best.error * sim.rtol > LARGEST_TOLERANCE:
        if last_resort:
            _refuse_branching(sim, best, sim.t_internal + near)
        return REANALYZE, None
    if best.error > 1.0:
        logger.warning(
            "the singular position at t = %.9g s was passed with an estimated error of %.3g times the tolerances "
            "(rtol = %.3g): that is what rounding leaves of a step over it",
            sim.t_internal + near, best.error, sim.rtol,
        )  # fmt: skip
    return _accept(sim, over, best.points, natural)


@dataclass
class _Result:
    """What came of one size of step: its points, its error in units of the tolerance, and whether more stages would
    still have made that smaller."""

    points: Points | None
    error: float
    truncation: bool


class LongStep:
    """Steps over a singular position from the newest row."""

    def __init__(self, sim: "Simulation", near: float, steepness: float) -> None:
        recall(sim.workspace.record, sim._method.record, 0)
        self.sim, self.near, arrays = sim, near, sim.workspace.arrays
        n, w = sim.assembly.n, sim.assembly.n_extended - len(sim.assembly.work_names)
        rows = sim.workspace.structure.multiplier_rows
        self.start = Points(
            *(np.array(x)[None] for x in (
                arrays["t"][0], arrays["q"][:n], arrays["v"][:n], arrays["a"][:n], arrays["lam"][rows],
                arrays["v"][w:], arrays["a"][w:],
            ))
        )  # fmt: skip
        singular = float(arrays["t"][0]) + near

        def trusted(t: float) -> bool:
            return steepness * abs(t - singular) > UNDETERMINED

        noise = LARGEST_TOLERANCE / sim.rtol
        self.collocation = Collocation(sim, self.start, trusted, noise)
        self.weights = tuple(arrays[name][:n].copy() for name in ("weight_q", "weight_v"))
        self.work_weights = arrays["weight_v"][w:].copy()

    def place(self, points: Points, k: int) -> None:
        """Point k becomes the current one."""
        arrays, n, stop = self.sim.workspace.arrays, len(self.weights[0]), float(self.sim.clock.stop_time)
        w = len(arrays["v"]) - points.work.shape[1]
        arrays["t"][0] = points.times[k]
        if k == len(points.times) - 1 and abs(points.times[k] - stop) <= SAME_INSTANT * np.ptp(points.times):
            # the stop time itself, not t + h with its rounding
            arrays["t"][0] = stop
        arrays["q"][:n], arrays["v"][:n], arrays["a"][:n] = points.q[k], points.v[k], points.a[k]
        arrays["lam"][self.sim.workspace.structure.multiplier_rows] = points.lam[k]
        arrays["v"][w:], arrays["a"][w:] = points.work[k], points.power[k]
        arrays["aux"][:] = arrays["a"]
        evaluate_residuals(self.sim.workspace.record)

    def trial(self, h: float) -> int:
        """A step of size h, not accepted yet; its end becomes the current point. Returns OK.

        Raises
        ------
        SimulationError : if there is none.
        """
        points = self.make(h, clear_stages(h, self.near)).points
        if points is None:
            raise SimulationError(
                f"at t = {self.sim.t_internal + h:.9g} s a contact has an event so near to the singular position of "
                f"t = {self.sim.t_internal + self.near:.9g} s that no step ends there: move the contact a little",
                t=self.sim.t_internal,
                loop="event",
            )
        self.place(points, len(points.times) - 1)
        return OK

    def make(self, h: float, stages: tuple[int, ...]) -> _Result:
        """A step of size h, with more stages until it stands still."""
        before: Points | None = None
        best, last_inside, last_error = _Result(None, math.inf, True), math.inf, math.inf
        falling = True
        for s in stages:
            times = float(self.start.times[0]) + gauss(s).c * h
            if before is None:
                guess = Points(times, *(np.repeat(x, s, axis=0) for x in self._start_values()))
            else:
                guess = before.at(times)
            points = self.collocation.step(h, s, guess)
            if points is not None and before is not None:
                there = points.at(before.times)
                inside = max(self._distance(there, before, k) for k in range(1, len(before.times)))
                error = self._distance(points, before, -1)
                if error > 1.0:
                    error = self._distance(self._without_noise(points, before), before, -1)
                if error <= 1.0 and not 1.0 < inside <= FALLING * last_inside:
                    return _Result(points, error, False)
                # one difference may be smaller than another by chance
                falls = error <= FALLING * last_error
                truncation, falling = falling and falls, falls
                best = (
                    _Result(points, error, truncation) if error < best.error else replace(best, truncation=truncation)
                )
                last_inside, last_error = inside, error
            before = points
        return best

    def _start_values(self) -> tuple[NDArray[np.float64], ...]:
        start = self.start
        return start.q, start.v, start.a, start.lam, start.work, start.power

    def _without_noise(self, one: Points, other: Points) -> Points:
        """`one` with an end that differs from that of `other` by less: by what rounding makes of the constraints there.
        It is no error of the step, and later ones do not take it over."""
        workspace, n = self.sim.workspace, len(self.weights[0])
        workspace.arrays["q"][:n], workspace.arrays["v"][:n] = one.q[-1], one.v[-1]
        workspace.arrays["t"][0] = one.times[-1]
        scale = self.sim.assembly.coordinate_scale
        level = CONSTRAINT_NOISE * max(1.0, float(np.max(np.abs(one.q[-1] / scale))))
        speed = float(np.max(np.abs(one.v[-1] / scale)))
        least_q, least_v = (NOISELESS * float(np.min(weight / scale)) for weight in self.weights)
        values, directions = singular_directions(workspace, max(level / least_q, np.sqrt(level * speed / least_v)))
        noise_q = level / np.maximum(values, 1e-300)
        noise_v = noise_q * speed / np.maximum(values, 1e-300)
        ends = []
        for x, y, noise in ((one.q[-1], other.q[-1], noise_q), (one.v[-1], other.v[-1], noise_v)):
            parts = directions @ ((x - y) / scale)
            ends.append(x - scale * (np.clip(parts, -noise, noise) @ directions))
        return replace(one, q=np.vstack([one.q[:-1], ends[0]]), v=np.vstack([one.v[:-1], ends[1]]))

    def _distance(self, one: Points, other: Points, k: int) -> float:
        """Norm of the difference at point k, in units of the tolerance."""
        pairs = ((one.q, other.q, self.weights[0]), (one.v, other.v, self.weights[1]))
        norms = [float(np.sqrt(np.mean(((x[k] - y[k]) / weight) ** 2))) for x, y, weight in pairs]
        return max(*norms, float(np.max(np.abs(one.work[k] - other.work[k]) / self.work_weights, initial=0.0)))


def _too_long(result: _Result) -> bool:
    """True if a shorter step, begun nearer to the position, would be better."""
    return result.error > 1.0 and result.truncation


def _leaps(sim: "Simulation", result: _Result) -> bool:
    """True if shapes could have passed through each other from one point to the next."""
    if not sim.assembly.contacts or result.points is None:
        return False
    return bool(np.max(np.abs(np.diff(result.points.q, axis=0)) / sim.assembly.leap) > 1.0)


def _refuse_branching(sim: "Simulation", result: _Result, singular: float) -> None:
    """Raise SimulationError if the step has ended with other velocities than those that it began with lead to."""
    if result.points is None:
        return
    h = float(result.points.times[-1] - result.points.times[0])
    scale = sim.assembly.coordinate_scale
    expected = (result.points.v[0] + h * result.points.a[0]) / scale
    found = result.points.v[-1] / scale
    largest = max(float(np.max(np.abs(expected))), float(np.max(np.abs(found))))
    if float(np.max(np.abs(found - expected))) <= TURN * largest:
        return
    t = sim.t_internal
    raise SimulationError(
        f"at t = {t:.9g} s the mechanism comes to the singular position of t = {singular:.9g} s, where its motion "
        "branches: every step over it leads to a branch on which the velocities would jump. Choose a smaller "
        "max_step, or other initial velocities so that the position is passed faster.",
        t=t,
        loop="inner",
    )


def _accept(sim: "Simulation", over: LongStep, points: Points, natural: float) -> tuple[int, LongStep | None]:
    """The points become rows of the history, up to the first event of a contact; OK, or EVENT if that comes at once."""
    workspace, method, loop = sim.workspace.record, sim._method.record, sim._loop.record
    ring, rate = sim.method_arrays["ring"], convergence_of(sim.workspace.arrays["rate"])
    sim.clock.step_size, sim.clock.equal_steps, sim.clock.previous_norm = natural, 0.0, 0.0
    rate.factor_age = -1.0
    count, last = 1, len(points.times)
    for k in range(1, last):
        over.place(points, k)
        gap = float(points.times[k] - points.times[k - 1])
        violated = violates_redundant(workspace, 1.0)
        if violated or find_events(workspace, method, loop, gap, False):
            if count == 1:
                sim.clock.trial_step = gap
                return (REANALYZE, None) if violated else (EVENT, over)
            break
        accept(workspace, method, loop)
        count += 1
    sim.flush()
    ring[1], ring[2] = count, count
    # after all of it the position lies as far behind as it lay ahead: ordinary steps lead away from here
    whole = 2.0 * control_of(sim.workspace.arrays["control"]).most_condition * rate.least_condition
    rate.looked_condition = whole if count == last else 0.0
    return OK, None
