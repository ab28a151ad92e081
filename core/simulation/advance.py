"""The Python side of the time loop: what happens at event rate."""

import logging
import math
from typing import TYPE_CHECKING

import numpy as np

from ..errors import SimulationError
from ..events import Fallback
from ..methods.history import recall
from ..recovery.near_singular import STRAINED_GROWTH
from ..recovery.repartition import repair
from ..rounding import NO_STEP, SHORTEST
from ..state.run_records import (
    CHUNK,
    DUE,
    FAILED,
    FIXED_STEP,
    FULL,
    JAM,
    NEAR_SINGULAR,
    REACHED,
    REPARTITION,
    SETTLE,
    STEP_SIZE,
    STEP_TOO_SMALL,
    TRIAL_STEP,
    UNLOCATED,
    VIOLATED,
    WANTED,
)
from ..state.workspace_records import (
    FAILED_NORM,
    INNER_DIVERGED,
    LEAST_CONDITION,
    LOOKED_CONDITION,
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_SLOW,
    REANALYZE,
    SINGULAR,
    WORST_CONDITION,
)
from ..time_loop.time_loop import trial_step
from .failures import failure_of
from .locating import locate_again, locate_in_long_step
from .painleve import refuse_passed_jam
from .step_budget import step_count, steps_left
from .step_subdivision import Division

if TYPE_CHECKING:
    from .simulation import Simulation

logger = logging.getLogger(__name__)

CHUNK_STEPS = 20_000
"""Steps between two reports of progress, of systems with up to 100 coordinates; larger ones report more often."""
_REASONS = {
    OUTER_DIVERGED: ("outer", "the outer loop diverged"),
    OUTER_SLOW: ("outer", "the outer loop did not converge"),
    INNER_DIVERGED: ("inner", "the inner loop on the dependent coordinates did not converge"),
    SINGULAR: ("outer", "the system matrix became singular"),
    REANALYZE: ("outer", "the pivots of the system matrix kept degrading"),
    NOT_FINITE: ("outer", "a value became infinite or NaN"),
    STEP_TOO_SMALL: ("step size", "the error control asked for a step below what the time can resolve"),
}

_REPAIRABLE = (REANALYZE, SINGULAR, INNER_DIVERGED, OUTER_SLOW, OUTER_DIVERGED)
"""Failures that a new partition and new orderings may cure."""


def steps_at_once(n: int) -> int:
    """Steps between two reports of progress, of a system with n coordinates."""
    return max(1, CHUNK_STEPS * 100 // max(100, n))


def advance_to(
    sim: "Simulation", t: float, stop: float, hold: bool = False, came: tuple[int, int] | None = None
) -> None:
    """Step until the newest row is at or beyond `t`; no step goes beyond `stop`. `hold`: until events are pending.
    `came`: the step count at the beginning, and what `drive_on` has returned a moment ago."""
    try:
        _advance_to(sim, t, stop, hold, came)
    except BaseException:
        # it may have been on the way back to compiled code, which had let some sleep
        sim.drive.wake()
        raise


def _advance_to(sim: "Simulation", t: float, stop: float, hold: bool, came: tuple[int, int] | None) -> None:
    first, code = (step_count(sim), None) if came is None else came
    divided = Division(sim)
    try:
        _go(sim, t, stop, hold, first, code, divided)
    finally:
        divided.end()


def _go(sim: "Simulation", t: float, stop: float, hold: bool, first: int, code: int | None, divided: Division) -> None:
    repaired_at = math.nan
    chunk = steps_at_once(sim.assembly.n)
    while True:
        now = sim.t_internal
        if code is None:
            if sim.pending:
                if now > t or hold:
                    return
                sim._handle_pending()
                continue
            left = min(chunk, steps_left(sim, first, t))
            code = sim.drive.go(max(t, divided.until), min(stop, divided.stop), left, hold or not sim.compiled_events)
            sim.workspace.sync()
            sim.take_events()
        returned, code = code, None
        sim.flush()
        if returned in (CHUNK, FULL):
            sim.report_progress(sim.t_internal)
        elif returned == REACHED:
            if not divided.go_on() or sim.t_internal >= max(t, divided.until):
                return
        elif returned == DUE:
            # only now: until the run goes on from here, samples before this time need the history
            restart_at(sim, min(b for b in sim.assembly.breakpoints if b > sim.t_internal))
        elif returned == SETTLE:
            sim.pending = sim.drive.take_pending()
        elif returned == WANTED:
            sim.build_wanted(sim.drive.status)
        elif returned == FAILED:
            raise failure_of(sim, sim.drive.status)
        elif returned == UNLOCATED:
            if not locate_again(sim) and not (divided.halve() if sim.clock[FIXED_STEP] > 0.0 else _shrink(sim)):
                _fail(sim, OUTER_SLOW, divided)
        elif returned == JAM:
            if not _go_by_impulses(sim, "sliding contacts jam"):
                refuse_passed_jam(sim)
        elif returned == REPARTITION:
            repair(sim)
        elif returned in (OUTER_DIVERGED, OUTER_SLOW) and sim.settings.fallback and sim.outer != "newton":
            _fall_back(sim, returned)
        elif returned == NEAR_SINGULAR:
            _pass_singular(sim)
        elif returned == VIOLATED:
            h = float(sim.clock[TRIAL_STEP])
            if not repair(sim) and not _pass_singular(sim):
                _violated(sim, h)
        elif returned in _REPAIRABLE and repaired_at != sim.t_internal:
            repaired_at = sim.t_internal
            try:
                repair(sim)
            except SimulationError:
                if not _pass_after_all(sim) and not _go_by_impulses(sim, _reason(returned)[1]):
                    raise
        elif returned in (INNER_DIVERGED, SINGULAR, REANALYZE) and sim.clock[FIXED_STEP] == 0.0 and _shrink(sim):
            if returned == REANALYZE:  # the matrix of the shorter step has other pivots
                repaired_at = math.nan
        elif not (divided.halve() or _pass_after_all(sim) or _go_by_impulses(sim, _reason(returned)[1])):
            _fail(sim, returned, divided)


def _next_break(sim: "Simulation") -> float:
    return min((b for b in sim.assembly.breakpoints if b > sim.t_internal), default=math.inf)


def due_break(sim: "Simulation") -> float | None:
    """The breakpoint that the newest step ended just before, if it did: no step fits between."""
    now, ahead = sim.t_internal, _next_break(sim)
    return ahead if math.nextafter(ahead, -math.inf) - now <= NO_STEP * abs(now) else None


def _shrink(sim: "Simulation") -> bool:
    """A smaller step after a failure of a repaired system; False if it cannot be smaller."""
    h = 0.25 * sim.clock[TRIAL_STEP]
    sim.clock[STEP_SIZE] = h
    return bool(h > SHORTEST * max(abs(sim.t_internal), 1e-6 * sim.scales.time))


def _fall_back(sim: "Simulation", code: int) -> None:
    """Let Newton's outer loop take over from one that has failed, and say so."""
    t, h, outer = sim.t_internal, float(sim.clock[TRIAL_STEP]), sim.outer
    reason = f"{_REASONS[code][1]} with a step of {h:.3g} s{_limit(sim, h)}"
    logger.warning("at t = %.9g s outer loop '%s' gave way to 'newton': %s", t, outer, reason)
    sim.fallbacks.append(Fallback(t, outer, reason))
    sim.use_outer_loop("newton")
    recall(sim.workspace.record, sim._method.record, 0)


def _limit(sim: "Simulation", h: float) -> str:
    """The largest step of the simple iteration, as its measured contraction tells."""
    rate = float(sim.workspace.arrays["rate"][FAILED_NORM])
    if sim.outer != "simple" or not (math.isfinite(rate) and rate > 0.0):
        return ""
    return f" (contraction {rate:.3g}; it goes with h^2, so the limit is about {h / math.sqrt(rate):.3g} s)"


def _violated(sim: "Simulation", h: float) -> None:
    """A row that was taken for redundant does not hold any more, at the end of a step of size h."""
    trial_step(sim.workspace.record, sim._method.record, sim._loop.record, h)
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


def _pass_singular(sim: "Simulation", last_resort: bool = False) -> bool:
    """The constraints are nearly dependent where the step was to end: step over that position, if it is one."""
    from ..recovery.singular_passage import pass_singular  # rare, and no small thing to import

    rate = sim.workspace.arrays["rate"]
    worst = float(rate[WORST_CONDITION])
    if sim.workspace.dropped:
        repair(sim)
    code, over = pass_singular(sim, last_resort)
    if over is not None:
        locate_in_long_step(sim, over)
    elif code != OK:
        # nothing near: go on, and look again when it has become twice as bad
        rate[LOOKED_CONDITION] = 2.0 * max(worst, float(rate[WORST_CONDITION]))
        return False
    return True


def _pass_after_all(sim: "Simulation") -> bool:
    """Step over a singular position because steps towards it have failed; False if there is none."""
    rate = sim.workspace.arrays["rate"]
    near = sim.clock[FIXED_STEP] == 0.0 and rate[WORST_CONDITION] > STRAINED_GROWTH * rate[LEAST_CONDITION] > 0.0
    return bool(near) and _pass_singular(sim, last_resort=True)


def _go_by_impulses(sim: "Simulation", reason: str) -> bool:
    """Steps of impulses from the newest row on, because no other step can be made; False where there are none."""
    if not sim.drive.go_by_impulses():
        return False
    logger.warning("at t = %.9g s steps of impulses take over among many contacts: %s", sim.t_internal, reason)
    return True


def _reason(code: int) -> tuple[str, str]:
    """The loop that failed, and why."""
    return _REASONS.get(code, ("outer", f"status {code}"))


def _fail(sim: "Simulation", code: int, divided: Division) -> None:
    from ..recovery.singular_position import near_singular

    loop, reason = _reason(code)
    t, h, settings = sim.t_internal, float(sim.clock[TRIAL_STEP]), sim.settings
    tried = divided.tried() if settings.step else f"steps down to {h:.3g} s, new partition and factorisation"
    if sim.outer == "simple" and loop == "outer":
        rate = float(sim.workspace.arrays["rate"][FAILED_NORM])
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


def restart_at(sim: "Simulation", t: float) -> None:
    """Go on at the breakpoint t, just after the newest row, where a force or the rate of a driver jumps
    (`events/breakpoint.py`)."""
    sim.flush()
    sim.take_events()
    if sim.workspace.dropped:
        sim.look_at_redundant_rows()
    sim.settle(lambda: sim.drive.pass_breakpoint(t))
