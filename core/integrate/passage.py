"""Passing singular positions: positions where constraints depend on one another only there (bars in line).

The motion is smooth through them, but Phi_q loses rank: at a distance d rounding is multiplied by 1/d in the positions,
1/d^2 in the velocities and 1/d^3 in the accelerations across the motion. Steps that shrink towards such a position
never get past it. So the step is chosen such that none of its stages comes near: a step over it, from predictions that
are smooth, which keeps the inner loop on the branch on which the mechanism arrives.
"""

import itertools
import logging
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from ..methods.history import recall
from ..methods.registry import STARTER_STAGES
from ..system.records import ATOL, FACTOR_AGE, NEWTON_TOLERANCE, OK, REANALYZE, RTOL
from ..system.redundancy import least_singular_value
from .loop import accept, trial_step, violates_redundant
from .records import EVENT, HELD, STEP_SIZE, STOP_TIME, TRIAL_STEP
from .repair import repair
from .watch import find_events

if TYPE_CHECKING:
    from .simulation import Simulation

logger = logging.getLogger(__name__)

REACH = 12.0
FARTHEST = 60.0
RECENT = 7
"""How far ahead a singular position matters, in steps."""
LOOKS = 25
"""Places where it is looked for."""
DIP = 0.1
"""A singular position lies where the least singular value falls below this part of its values around."""
SIZES = (0.4, 0.5, 0.65, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0)
"""Steps that are tried, in units of the natural one."""
LEAST_CLEARANCE = 0.05
"""No stage is put nearer to the singular position, in units of the natural step."""
CHEAPEST = 5
"""So many of them are tried with all tolerances before the others. A step's price in units of the tolerance: truncation
grows as size^5, rounding in h times the accelerations as the inverse cube of the distance, and small steps are slow."""
EPSILON = 4e-16
RELAXATIONS = ((1.0, 1.0), (30.0, 1.0), (30.0, 10.0), (30.0, 100.0), (30.0, 1e3), (30.0, 1e4))
"""Factors on the outer loop's tolerance and on those of the error control, since rounding is larger here: what it does
to the accelerations across the motion must not keep the outer loop from ending."""
LARGEST_TOLERANCE = 1e-4
"""The tolerances are not relaxed beyond this."""
TURN = 0.2
"""Largest change of the velocities against their extrapolation, relative to the largest, on the same branch."""


def pass_singular(sim: "Simulation") -> int:
    """One accepted step from the newest row that keeps away from a singular position near by.

    Returns OK; REANALYZE if there is no such position within reach or no step could be made (nothing is accepted then);
    EVENT if a contact has an event in the step (not accepted; TRIAL_STEP is its size).

    Raises
    ------
    SimulationError : if every step over the position leads to another branch.
    """
    natural = _natural_step(sim)
    remaining = float(sim.clock[STOP_TIME]) - sim.t_internal
    path = _Path(sim)
    found = _singular_position(sim, path, REACH * natural, natural)
    if found is None:
        return REANALYZE
    near, steepness = found
    stages = STARTER_STAGES if sim.method_arrays["ring"][1] < sim.formula.rows else sim.formula.stages
    rounding = EPSILON * max(1.0, float(np.max(np.abs(path(0.0)[0])))) / steepness**2 / sim.settings.rtol

    def price(distance: float, h: float) -> float:
        clearance = min(abs(c * h - distance) for c in stages)
        if clearance < LEAST_CLEARANCE * natural:
            return math.inf
        return (h / natural) ** 5 + rounding * h / clearance**3 + natural / h

    def with_next(h: float) -> float:
        """The price of the step, and if it ends before the position that of the step over it."""
        rest = near - h
        over = [size * natural for size in SIZES if size * natural > rest]
        return price(near, h) + (min(price(rest, x) for x in over) if 0.0 < rest and over else 0.0)

    sizes = {min(size * natural, remaining) for size in SIZES}
    prices = {h: with_next(h) for h in sorted(sizes) if with_next(h) < math.inf}
    steps = sorted(prices, key=prices.__getitem__)
    logger.debug("singular position %.3g s from t = %.9g s; steps to try: %s", near, sim.t_internal, steps)
    return _try(sim, path, (steps[:CHEAPEST], steps[CHEAPEST:]), natural, sim.t_internal + near)


def near_singular(sim: "Simulation") -> float | None:
    """Time of a singular position a few steps from the newest row, s; None if there is none."""
    if sim.workspace.structure.active.size == 0:
        return None
    natural = _natural_step(sim)
    found = _singular_position(sim, _Path(sim), REACH * natural, natural)
    return None if found is None else sim.t_internal + found[0]


def _natural_step(sim: "Simulation") -> float:
    """The step that the smooth motion allows: that of the trial, or the usual one of late if trials have shrunk."""
    ring, times = sim.method_arrays["ring"], sim.method_arrays["times"]
    rows = [int(ring[0] - back) % len(times) for back in range(min(int(ring[1]), RECENT))]
    gaps = -np.diff(times[rows])
    return max(float(sim.clock[TRIAL_STEP]), float(np.median(gaps)) if len(gaps) else 0.0)


class _Path:
    """Extrapolation of the motion beyond the newest row: the quintic through (q, v, a) of the newest two."""

    def __init__(self, sim: "Simulation") -> None:
        # importing scipy costs more than most runs: only who needs it pays
        from scipy.interpolate import KroghInterpolator

        n, n_ext = sim.assembly.n, sim.assembly.n_extended
        ring, times = sim.method_arrays["ring"], sim.method_arrays["times"]
        rows = [int(ring[0] - back) % len(times) for back in range(min(int(ring[1]), 2))]
        self.newest = float(times[rows[0]])
        nodes, values = [], []
        for row in rows:
            state = sim.method_arrays["history"][row]
            nodes += 3 * [float(times[row]) - self.newest]
            values += [state[:n], state[n_ext : n_ext + n], state[2 * n_ext : 2 * n_ext + n]]
        self.known = self.newest - float(times[rows[-1]])
        self._polynomial = KroghInterpolator(np.array(nodes), np.array(values))

    def __call__(self, ahead: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(q, v) so many seconds ahead."""
        q, v = self._polynomial.derivatives(ahead, 2)
        return q, v


def _singular_position(sim: "Simulation", path: _Path, reach: float, natural: float) -> tuple[float, float] | None:
    """Seconds to the first singular position on the extrapolated path (negative: behind), and how fast the least
    singular value of the scaled Phi_q grows away from it, 1/s; None if there is no such position within reach."""
    workspace, n = sim.workspace, sim.assembly.n

    def distance(ahead: float) -> float:
        workspace.arrays["q"][:n], workspace.arrays["v"][:n] = path(ahead)
        workspace.arrays["t"][0] = path.newest + ahead
        return least_singular_value(workspace)

    recall(workspace.record, sim._method.record, 0)
    here, next_one = distance(0.0), distance(natural)
    if next_one < here:
        # where it would be zero if it went on like this
        reach = min(max(reach, 1.5 * natural * here / (here - next_one)), FARTHEST * natural)
    times = np.linspace(-reach if path.known > 0.0 else 0.0, reach, LOOKS)
    values = np.array([distance(s) for s in times])
    for k in range(1, LOOKS - 1):
        if not values[k - 1] >= values[k] <= values[k + 1]:
            continue
        low, high = float(times[k - 1]), float(times[k + 1])
        for _ in range(14):
            third = (high - low) / 3.0
            if distance(low + third) < distance(high - third):
                high -= third
            else:
                low += third
        found = 0.5 * (low + high)
        around = min(float(np.max(values[:k])), float(np.max(values[k + 1 :])))
        if distance(found) < DIP * around:
            return found, min(distance(found - natural), distance(found + natural)) / natural
    return None


def _try(sim: "Simulation", path: _Path, steps: tuple[list[float], ...], natural: float, singular: float) -> int:
    """Accept the first of the steps that converges, keeps the tolerances (relaxed if need be) and the branch."""
    rate = sim.workspace.arrays["rate"]
    ws, lc = sim.workspace.record, sim._loop.record
    turned = False
    before = _tolerances(sim)
    relaxations = [r for r in RELAXATIONS if r[1] == 1.0 or sim.settings.rtol * r[1] <= LARGEST_TOLERANCE]
    try:
        # tolerances are relaxed before the step is made much smaller: that would lead nearer without getting past
        for some in steps:
            for (of_newton, of_error), h in itertools.product(relaxations, some):
                _set_tolerances(sim, before, of_newton, of_error)
                rate[FACTOR_AGE] = -1.0
                status = _trial(sim, h)
                if status != OK or not sim.method_arrays["error"][0] <= 1.0:
                    continue
                if violates_redundant(ws, of_error):
                    continue
                if _leaves_branch(sim, path, h):
                    turned = True
                    continue
                if of_error > 1.0:
                    logger.debug("step at t = %.9g s with tolerances relaxed by %g", sim.t_internal, of_error)
                sim.clock[[TRIAL_STEP, STEP_SIZE, HELD]] = h, natural, 0.0
                if find_events(ws, sim._method.record, lc, h, False):
                    return EVENT
                _accept(sim, h)
                return OK
    finally:
        _set_tolerances(sim, before)
    if turned:
        t = sim.t_internal
        raise SimulationError(
            f"at t = {t:.9g} s the mechanism comes to the singular position of t = {singular:.9g} s, where its motion "
            "branches: every step over it leads to a branch on which the velocities would jump. Choose a smaller "
            "max_step, or other initial velocities so that the position is passed faster.",
            t=t,
            loop="inner",
        )
    return REANALYZE


def _tolerances(sim: "Simulation") -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Tolerances of the outer loop and of the error control, absolute ones of coordinates and of velocities."""
    arrays = sim.workspace.arrays
    return arrays["control"][[NEWTON_TOLERANCE, RTOL, ATOL]].copy(), arrays["atol_q"].copy(), arrays["atol_v"].copy()


def _set_tolerances(sim: "Simulation", given: Any, of_newton: float = 1.0, of_error: float = 1.0) -> None:
    arrays = sim.workspace.arrays
    arrays["control"][[NEWTON_TOLERANCE, RTOL, ATOL]] = given[0] * (of_newton, of_error, of_error)
    arrays["atol_q"][:], arrays["atol_v"][:] = given[1] * of_error, given[2] * of_error


def _trial(sim: "Simulation", h: float) -> int:
    status = int(trial_step(sim.workspace.record, sim._method.record, sim._loop.record, h))
    if status == REANALYZE:
        repair(sim)
        status = int(trial_step(sim.workspace.record, sim._method.record, sim._loop.record, h))
    return status


def _leaves_branch(sim: "Simulation", path: _Path, h: float) -> bool:
    """True if the velocities at the step's end are not those that the path so far leads to."""
    n, scale = sim.assembly.n, sim.assembly.coordinate_scale
    expected, found = path(h)[1] / scale, sim.workspace.arrays["v"][:n] / scale
    largest = max(float(np.max(np.abs(expected))), float(np.max(np.abs(found))))
    return not float(np.max(np.abs(found - expected))) <= TURN * largest


def _accept(sim: "Simulation", h: float) -> None:
    ws, ms, lc = sim.workspace.record, sim._method.record, sim._loop.record
    if h == sim.clock[STOP_TIME] - sim.t_internal:
        # the stop time itself, not t + h with its rounding
        sim.workspace.arrays["t"][0] = sim.clock[STOP_TIME]
    accept(ws, ms, lc)
    sim.flush()
