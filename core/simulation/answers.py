"""What Python does where the policy of `recovery/policy.py` asks for it, and why a run ends."""

import logging
import math
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from ..errors import SimulationError
from ..events import Fallback
from ..methods.history import recall
from ..recovery.repartition import repair
from ..recovery.step_division import ALLOWANCE, DIVIDED_SHARE
from ..state.run_records import (
    DIVIDES,
    DONE,
    FALL_BACK,
    GOES_BY_IMPULSES,
    JAM,
    LAST_RESORT,
    NEAR_SINGULAR,
    NOT_DONE,
    OTHER_ROWS,
    REPARTITION,
    STEP_TOO_SMALL,
    UNLOCATED,
    UNREPAIRED,
    VIOLATED,
)
from ..state.workspace_records import (
    INNER_DIVERGED,
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_SLOW,
    REANALYZE,
    SINGULAR,
    convergence_of,
)
from ..time_loop.time_loop import trial_step
from .locating import locate_in_long_step
from .painleve import refuse_passed_jam

if TYPE_CHECKING:
    from .simulation import Simulation

logger = logging.getLogger(__name__)

_REASONS = {
    OUTER_DIVERGED: ("outer", "the outer loop diverged"),
    OUTER_SLOW: ("outer", "the outer loop did not converge"),
    INNER_DIVERGED: ("inner", "the inner loop on the dependent coordinates did not converge"),
    SINGULAR: ("outer", "the system matrix became singular"),
    REANALYZE: ("outer", "the pivots of the system matrix kept degrading"),
    NOT_FINITE: ("outer", "a value became infinite or NaN"),
    STEP_TOO_SMALL: ("step size", "the error control asked for a step below what the time can resolve"),
    UNLOCATED: ("outer", "the outer loop did not converge"),
    JAM: ("contact", "sliding contacts jam"),
}
"""The loop that failed, and why."""


def answer(sim: "Simulation", code: int) -> None:
    """Do what `code` asks for, say what it tells, or raise why the run ends.

    Raises
    ------
    SimulationError : where the policy knows no other way.
    """
    drive = sim.drive
    if code == REPARTITION:
        try:
            drive.answer(OTHER_ROWS if repair(sim) else DONE)
        except SimulationError:
            drive.answer(NOT_DONE)
    elif code in (NEAR_SINGULAR, LAST_RESORT):
        drive.answer(DONE if _pass_singular(sim, code == LAST_RESORT) else NOT_DONE)
    elif code == FALL_BACK:
        _fall_back(sim)
    elif code == DIVIDES:
        _say_division(sim)
    elif code == GOES_BY_IMPULSES:
        logger.warning(
            "at t = %.9g s steps of impulses take over among many contacts: %s",
            sim.t_internal,
            _REASONS[int(drive.counts.cause)][1],
        )
    elif code == UNREPAIRED:
        repair(sim)  # raises, and says which rows
        raise RuntimeError(f"the constraints cannot be partitioned: status {drive.status}")
    elif code == VIOLATED:
        _violated(sim)
    elif code == JAM:
        refuse_passed_jam(sim)
    else:
        _fail(sim, code)


def _say_division(sim: "Simulation") -> None:
    if not sim.reported_division:
        sim.reported_division = True
        logger.warning(
            "at t = %.9g s a fixed step of %.3g s does not converge: it is made of smaller ones. This is said once; "
            "stats['divided_steps'] counts such steps",
            sim.t_internal,
            sim.settings.step,
        )


def _fall_back(sim: "Simulation") -> None:
    """Let Newton's outer loop take over from one that has failed, and say so."""
    t, h, outer = sim.t_internal, float(sim.clock.trial_step), sim.outer
    reason = f"{_REASONS[int(sim.drive.counts.cause)][1]} with a step of {h:.3g} s{_limit(sim, h)}"
    logger.warning("at t = %.9g s outer loop '%s' gave way to 'newton': %s", t, outer, reason)
    sim.fallbacks.append(Fallback(t, outer, reason))
    sim.use_outer_loop("newton")
    recall(sim.workspace.record, sim._method.record, 0)


def _limit(sim: "Simulation", h: float) -> str:
    """The largest step of the simple iteration, as its measured contraction tells."""
    rate = float(convergence_of(sim.workspace.arrays["rate"]).failed_norm)
    if sim.outer != "simple" or not (math.isfinite(rate) and rate > 0.0):
        return ""
    return f" (contraction {rate:.3g}; it goes with h^2, so the limit is about {h / math.sqrt(rate):.3g} s)"


def _violated(sim: "Simulation") -> NoReturn:
    """A row that was taken for redundant does not hold any more at the end of the step that was tried."""
    trial_step(sim.workspace.record, sim._method.record, sim._loop.record, float(sim.clock.trial_step))
    arrays, assembly = sim.workspace.arrays, sim.assembly
    rows = sim.workspace.structure.redundant
    worst = int(rows[np.argmax(np.abs(arrays["phi"][rows]))])
    name, t = assembly.row_names[worst], float(arrays["t"][0])
    raise SimulationError(
        f"constraint '{name}' (row {worst - assembly.row_names.index(name)}) repeated others at the start, but at "
        f"t = {t:.9g} s the motion that those allow violates it by {arrays['phi'][worst]:.3g}: the constraints "
        "contradict each other from there on. Remove the joint, or make its dimensions (or its driver) fit the others.",
        t=sim.t_internal,
        loop="inner",
    )


def _pass_singular(sim: "Simulation", last_resort: bool) -> bool:
    """The constraints are nearly dependent where the step was to end: step over that position, if it is one.
    `last_resort`: steps towards it have failed."""
    from ..recovery.singular_passage import pass_singular  # rare, and no small thing to import

    rate, tried = convergence_of(sim.workspace.arrays["rate"]), float(sim.clock.trial_step)
    worst = float(rate.worst_condition)
    if sim.workspace.dropped:
        repair(sim)
    code, over = pass_singular(sim, last_resort)
    if over is not None:
        locate_in_long_step(sim, over)
    elif code != OK:
        # nothing near: go on, and look again when it has become twice as bad
        rate.looked_condition = 2.0 * max(worst, float(rate.worst_condition))
        sim.clock.trial_step = tried
        return False
    return True


def _fail(sim: "Simulation", code: int) -> NoReturn:
    from ..recovery.singular_position import near_singular

    loop, reason = _REASONS.get(code, ("outer", f"status {code}"))
    t, h, settings = sim.t_internal, float(sim.clock.trial_step), sim.settings
    tried = _tried(sim, settings.step) if settings.step else f"steps down to {h:.3g} s, new partition and factorisation"
    if sim.outer == "simple" and loop == "outer":
        rate = float(convergence_of(sim.workspace.arrays["rate"]).failed_norm)
        remedy = (
            f"The simple iteration contracts only if c_q omega^2 < 1 (its factor was {rate:.3g}; c_q = beta h^2 or "
            f"(h b)^2), omega the highest frequency: the largest step here is about {h / math.sqrt(rate):.3g} s. Use "
            "outer='newton' or 'jfnk', fallback=True, or a smaller step"
        )
    elif (singular := near_singular(sim)) is not None:
        remedy = (
            f"At t = {singular:.9g} s the mechanism is in a singular position (constraints depend on one another only "
            "there, bars in line), which these steps do not get past: use error control (step=None), looser "
            "tolerances, a method of higher order, or start behind that position"
        )
    elif settings.step:
        remedy = "Use a smaller step, or error-controlled steps (step=None)"
    elif loop == "inner":
        remedy = "Start elsewhere, or set a smaller max_step"
    elif code == STEP_TOO_SMALL:
        remedy = "Loosen rtol and atol, or look for a force that jumps or grows without bound near this time"
    else:
        remedy = "Look for a force that is not finite or not smooth near this time; try a smaller max_step"
    raise SimulationError(
        f"method '{settings.method}' stopped at t = {t:.9g} s: {reason} (tried: {tried}). {remedy}.",
        t=t,
        loop=loop,
    )


def _tried(sim: "Simulation", whole: float) -> str:
    """What has been tried, of a run with fixed steps of size `whole` (s)."""
    step, divided = f"fixed step {whole:.3g} s", sim.divided_steps
    if sim.clock.halvings > 0.0:
        return f"{step}, divided into parts down to {float(sim.clock.fixed_step):.3g} s"
    if divided == 0:
        return step
    return (
        f"{step}; {divided} of {(sim.t_internal - sim.settings.t0) / whole:.0f} steps so far did not converge and were "
        f"divided, at most {ALLOWANCE} and {100.0 * DIVIDED_SHARE:.0f} % of all are"
    )
