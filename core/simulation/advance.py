"""The Python side of the time loop: what `drive` leaves to Python."""

import math
from typing import TYPE_CHECKING

from ..rounding import NO_STEP
from ..state.run_records import CHUNK, DUE, EVENTS_FULL, FAILED, REACHED, SETTLE, WANTED
from .answers import answer
from .failures import failure_of
from .step_budget import step_count, steps_left

if TYPE_CHECKING:
    from .simulation import Simulation

CHUNK_STEPS = 20_000
"""Steps between two reports of progress, of systems with up to 100 coordinates; larger ones report more often."""


def steps_at_once(n: int) -> int:
    """Steps between two reports of progress, of a system with n coordinates."""
    return max(1, CHUNK_STEPS * 100 // max(100, n))


def advance_to(
    sim: "Simulation", t: float, stop: float, hold: bool = False, came: tuple[int, int] | None = None
) -> None:
    """Step until the newest row is at or beyond `t`; no step goes beyond `stop`. `hold`: until events are pending.
    `came`: the step count at the beginning, and what `drive_on` has returned a moment ago."""
    first, code = (step_count(sim), None) if came is None else came
    try:
        _go(sim, t, stop, hold, first, code)
    except BaseException:
        # it may have been on the way back to compiled code, which had let some sleep, or had asked for something
        sim.drive.wake()
        sim.drive.end_recovery(sim.clock)
        raise


def _go(sim: "Simulation", t: float, stop: float, hold: bool, first: int, code: int | None) -> None:
    chunk = steps_at_once(sim.assembly.n)
    while True:
        if code is None:
            if sim.pending:
                if sim.t_internal > t or hold:
                    return
                sim._handle_pending()
                continue
            left = min(chunk, steps_left(sim, first, t))
            code = sim.drive.go(t, stop, left, hold or not sim.compiled_events)
            sim.workspace.sync()
            sim.take_events()
        returned, code = code, None
        sim.flush()
        if returned in (CHUNK, EVENTS_FULL):
            sim.report_progress(sim.t_internal)
        elif returned == REACHED:
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
        else:
            answer(sim, returned)


def _next_break(sim: "Simulation") -> float:
    return min((b for b in sim.assembly.breakpoints if b > sim.t_internal), default=math.inf)


def due_break(sim: "Simulation") -> float | None:
    """The breakpoint that the newest step ended just before, if it did: no step fits between."""
    now, ahead = sim.t_internal, _next_break(sim)
    return ahead if math.nextafter(ahead, -math.inf) - now <= NO_STEP * abs(now) else None


def restart_at(sim: "Simulation", t: float) -> None:
    """Go on at the breakpoint t, just after the newest row, where a force or the rate of a driver jumps
    (`events/breakpoint.py`)."""
    sim.flush()
    sim.take_events()
    if sim.workspace.dropped:
        sim.look_at_redundant_rows()
    sim.settle(lambda: sim.drive.pass_breakpoint(t))
