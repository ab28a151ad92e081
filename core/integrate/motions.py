"""What a run does when an input that is a motion changes (`tlismni.core.model.motion` says why)."""

import logging
from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING

from ..model.motion import DURATION, JUMP, RATE_JUMP, SINCE, InputMotion
from .restore import restart_here

if TYPE_CHECKING:
    from .simulation import Simulation

logger = logging.getLogger(__name__)

LARGE_JUMP = 0.01
"""Of the size of the mechanism (a turn: of 1 rad); a larger jump of a position is reported."""

State = tuple[InputMotion, float, float]


def led_by(sim: "Simulation", channels: Collection[int]) -> list[State]:
    """The motions that the input channels of these numbers lead, with position and velocity at the present time."""
    inputs = sim.workspace.arrays["inputs"]
    moved = [m for m in sim.assembly.motions if m.position in channels or m.rate in channels]
    return [(m, *m.state(inputs, sim.t)) for m in moved]


def lead(sim: "Simulation", states: Iterable[State]) -> None:
    """Let motions in these states follow what the channels say now. Before the first step they start there."""
    inputs = sim.workspace.arrays["inputs"]
    for motion, x, v in states:
        inputs[motion.jumps, SINCE] = sim.t
        said_x, said_v = motion.said(inputs, sim.t)
        jumps = (0.0, 0.0) if at_start(sim) else (x - said_x, v - said_v)
        inputs[motion.jumps] = (*jumps, sim.t, 0.0)


def at_start(sim: "Simulation") -> bool:
    """True before the first step."""
    return not sim.started and sim.t == sim.settings.t0


def start_again(sim: "Simulation") -> None:
    """Start anew with the present inputs, as if nothing had happened yet.

    Raises
    ------
    ConsistencyError : if the start does not fit them.
    """
    arrays = sim.workspace.arrays
    for name in ("memory", "q", "v", "a", "aux", "lam"):
        arrays[name][...] = 0.0
    sim.flush()
    sim.events, sim.stored_events, sim.samples, sim.pending = [], (), [], []
    sim.open_accounts, sim.redundant = {}, ()
    sim.method_arrays["ring"][1] = 0
    sim.workspace.drop(frozenset())
    sim.workspace.engage(frozenset(), frozenset())
    sim._start()


def close_jumps(sim: "Simulation", t: float) -> None:
    """Motions that have jumped at the present time join what their channels say at time `t`, s."""
    inputs = sim.workspace.arrays["inputs"]
    changed = False
    for motion in sim.assembly.motions:
        row = inputs[motion.jumps]
        if row[DURATION] == 0.0 and (row[JUMP] != 0.0 or row[RATE_JUMP] != 0.0) and t > sim.t:
            row[DURATION] = t - row[SINCE]
            changed = True
            _warn_if_large(sim, motion, float(row[JUMP]), float(row[DURATION]))
    if changed:
        restart_here(sim)


def _warn_if_large(sim: "Simulation", motion: InputMotion, jump: float, duration: float) -> None:
    size = float(max(sim.assembly.coordinate_scale, default=1.0))
    if abs(jump) > LARGE_JUMP * size:
        logger.warning(
            "at t = %.9g s the motion is %.3g away from its input '%s': it follows within the next %.3g s. Shorter "
            "communication steps, or a velocity that fits the position, make the jump smaller",
            sim.t,
            jump,
            sim.assembly.input_names[motion.position],
            duration,
        )
