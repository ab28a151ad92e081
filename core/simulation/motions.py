"""What a run does when an input that is a motion changes (`tlismni.core.model.motion` says why)."""

import logging
from collections.abc import Callable, Collection, Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.evaluate import evaluate_residuals
from ..assembly.workspace import Workspace
from ..errors import SimulationError
from ..model.motion import INPUT_DURATION, INPUT_JUMP, INPUT_RATE_JUMP, INPUT_SINCE, InputMotion
from .restore import restart_here

if TYPE_CHECKING:
    from .simulation import Simulation

logger = logging.getLogger(__name__)

LARGE_JUMP = 0.01
"""Of the size of the mechanism (a turn: of 1 rad); a larger jump of a position is reported."""

MOST_ROUNDS = 20
DIFFERENCE, SAME_OFFSET = 1e-5, 1e-12
"""Of the size of the mechanism (a turn: of 1 rad): the difference that slopes are taken of, and where Newton's
iteration ends."""

LONGEST_WAY = 1000.0
"""Of the size of the mechanism (a turn: of 1 rad), within one communication step: more is a slip of the pen, and steps
that no shape passes through would take for ever."""

State = tuple[InputMotion, float, float]


def begin(workspace: Workspace, t0: float, offsets: NDArray[np.float64] | None = None) -> None:
    """Begin the motions of inputs at time `t0`, s; `offsets` (motions, 2): beside their inputs by these positions and
    rates."""
    for k, motion in enumerate(workspace.assembly.motions):
        off, rate = (0.0, 0.0) if offsets is None else offsets[k]
        workspace.arrays["inputs"][motion.jumps] = (off, rate, t0, 0.0)


def fitting_offsets(workspace: Workspace, place: Callable[[], None]) -> NDArray[np.float64]:
    """The offsets (motions, 2) of positions and rates with which the motions of inputs fit the start that `place` puts
    into the workspace: those that leave the least of the constraints' violations, by Gauss and Newton."""
    t0, count = float(workspace.arrays["t"][0]), len(workspace.assembly.motions)
    offsets, most = np.zeros((count, 2)), size_of(workspace.assembly)

    def violations(level: int) -> NDArray[np.float64]:
        begin(workspace, t0, offsets)
        place()
        evaluate_residuals(workspace.record)
        rows = workspace.structure.active
        return np.array(workspace.arrays[("phi", "phid")[level]][rows])

    for level, rounds in ((0, MOST_ROUNDS), (1, 1)):
        for _ in range(rounds):
            here, columns = violations(level), []
            for k in range(count):
                # rates stand linearly in phid; positions are looked at from both sides
                step = most if level else DIFFERENCE * most
                offsets[k, level] += step
                above = violations(level)
                offsets[k, level] -= 2.0 * step
                columns.append((above - violations(level)) / (2.0 * step))
                offsets[k, level] += step
            change = np.linalg.lstsq(np.array(columns).T, -here, rcond=None)[0]
            offsets[:, level] += change
            if np.max(np.abs(change)) <= SAME_OFFSET * most:
                break
    return offsets


def led_by(sim: "Simulation", channels: Collection[int]) -> list[State]:
    """The motions that the input channels of these numbers lead, with position and velocity at the present time."""
    inputs = sim.workspace.arrays["inputs"]
    moved = [m for m in sim.assembly.motions if m.position in channels or m.rate in channels]
    return [(m, *m.state(inputs, sim.t)) for m in moved]


def lead(sim: "Simulation", states: Iterable[State]) -> None:
    """Let motions in these states follow what the channels say now. At the start they begin there."""
    inputs = sim.workspace.arrays["inputs"]
    for motion, x, v in states:
        inputs[motion.jumps, INPUT_SINCE] = sim.t
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
        if row[INPUT_DURATION] == 0.0 and (row[INPUT_JUMP] != 0.0 or row[INPUT_RATE_JUMP] != 0.0) and t > sim.t:
            _refuse_long_way(sim, motion, t)
            row[INPUT_DURATION] = t - row[INPUT_SINCE]
            changed = True
            _warn_if_large(sim, motion, float(row[INPUT_JUMP]), float(row[INPUT_DURATION]))
    if changed:
        restart_here(sim)


def _refuse_long_way(sim: "Simulation", motion: InputMotion, t: float) -> None:
    inputs = sim.workspace.arrays["inputs"]
    way = motion.said(inputs, t)[0] - motion.state(inputs, sim.t)[0]
    most = LONGEST_WAY * size_of(sim.assembly)
    if not abs(way) <= most:
        names = sim.assembly.input_names
        led = [names[k] for k in (motion.position, motion.rate) if k >= 0]
        raise SimulationError(
            f"inputs {led} ask for a way of {way:.3g} from t = {sim.t:.9g} s to {t:.9g} s, more than {LONGEST_WAY:g} "
            f"times the mechanism's size: check their values and units ({size_of(sim.assembly):.3g} is its size)",
            t=sim.t,
            loop="event",
        )


def size_of(assembly: Assembly) -> float:
    """Size of the mechanism, m; at least that of an angle, 1 rad, where there are angles."""
    return float(max(assembly.coordinate_scale, default=1.0))


def _warn_if_large(sim: "Simulation", motion: InputMotion, jump: float, duration: float) -> None:
    if abs(jump) > LARGE_JUMP * size_of(sim.assembly) and motion.jumps not in sim.reported_jumps:
        sim.reported_jumps |= {motion.jumps}
        logger.warning(
            "at t = %.9g s the motion is %.3g away from its input '%s': it follows within the next %.3g s, and so it "
            "does from now on without a word. Shorter communication steps, or a velocity that fits the position, make "
            "the jumps smaller",
            sim.t,
            jump,
            sim.assembly.input_names[motion.position],
            duration,
        )
