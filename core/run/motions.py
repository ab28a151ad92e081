"""What a run does when an input that is a motion changes (`tlismni.core.model.motion` says why)."""

import logging
from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING

from ..errors import SimulationError
from ..model.motion import DURATION, JUMP, RATE_JUMP, SINCE, InputMotion
from ..tables.workspace import Workspace
from .restore import restart_here

if TYPE_CHECKING:
    from .simulation import Simulation

logger = logging.getLogger(__name__)

LARGE_JUMP = 0.01
"""Of the size of the mechanism (a turn: of 1 rad); a larger jump of a position is reported."""

LONGEST_WAY = 1000.0
"""Of the size of the mechanism (a turn: of 1 rad), within one communication step: more is a slip of the pen, and steps
that no shape passes through would take for ever."""

State = tuple[InputMotion, float, float]


def begin(workspace: Workspace, t0: float) -> None:
    """Begin the motions of inputs at time `t0`, s."""
    for motion in workspace.assembly.motions:
        workspace.arrays["inputs"][motion.jumps] = (0.0, 0.0, t0, 0.0)


def led_by(sim: "Simulation", channels: Collection[int]) -> list[State]:
    """The motions that the input channels of these numbers lead, with position and velocity at the present time."""
    inputs = sim.workspace.arrays["inputs"]
    moved = [m for m in sim.assembly.motions if m.position in channels or m.rate in channels]
    return [(m, *m.state(inputs, sim.t)) for m in moved]


def lead(sim: "Simulation", states: Iterable[State]) -> None:
    """Let motions in these states follow what the channels say now. At the start they begin there."""
    inputs = sim.workspace.arrays["inputs"]
    for motion, x, v in states:
        inputs[motion.jumps, SINCE] = sim.t
        said_x, said_v = motion.said(inputs, sim.t)
        jumps = (0.0, 0.0) if at_start(sim) else (x - said_x, v - said_v)
        inputs[motion.jumps] = (*jumps, sim.t, 0.0)


def at_start(sim: "Simulation") -> bool:
    """True as long as motions that are set make the start."""
    return sim.start_open and not sim.started and sim.t == sim.settings.t0


def close_jumps(sim: "Simulation", t: float) -> None:
    """Motions that have jumped at the present time join what their channels say at time `t`, s.

    Raises
    ------
    SimulationError : for a motion that goes absurdly far till then.
    """
    inputs = sim.workspace.arrays["inputs"]
    changed = False
    for motion in sim.assembly.motions:
        row = inputs[motion.jumps]
        if row[DURATION] == 0.0 and (row[JUMP] != 0.0 or row[RATE_JUMP] != 0.0) and t > sim.t:
            _refuse_long_way(sim, motion, t)
            row[DURATION] = t - row[SINCE]
            changed = True
            _warn_if_large(sim, motion, float(row[JUMP]), float(row[DURATION]))
    if changed:
        restart_here(sim)


def _refuse_long_way(sim: "Simulation", motion: InputMotion, t: float) -> None:
    inputs = sim.workspace.arrays["inputs"]
    way = motion.said(inputs, t)[0] - motion.state(inputs, sim.t)[0]
    most = LONGEST_WAY * _size(sim)
    if not abs(way) <= most:
        names = sim.assembly.input_names
        led = [names[k] for k in (motion.position, motion.rate) if k >= 0]
        raise SimulationError(
            f"inputs {led} ask for a way of {way:.3g} from t = {sim.t:.9g} s to {t:.9g} s, more than {LONGEST_WAY:g} "
            f"times the mechanism's size: check their values and units ({_size(sim):.3g} is its size)",
            t=sim.t,
            loop="event",
        )


def _size(sim: "Simulation") -> float:
    return float(max(sim.assembly.coordinate_scale, default=1.0))


def _warn_if_large(sim: "Simulation", motion: InputMotion, jump: float, duration: float) -> None:
    if abs(jump) > LARGE_JUMP * _size(sim):
        logger.warning(
            "at t = %.9g s the motion is %.3g away from its input '%s': it follows within the next %.3g s. Shorter "
            "communication steps, or a velocity that fits the position, make the jump smaller",
            sim.t,
            jump,
            sim.assembly.input_names[motion.position],
            duration,
        )
