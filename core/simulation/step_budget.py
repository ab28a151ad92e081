"""How many steps (and instants with events) a run may take on the way to a time that is asked for."""

import sys
from typing import TYPE_CHECKING

from ..errors import SimulationError
from ..state.workspace_records import counters_of

if TYPE_CHECKING:
    from .simulation import Simulation


def step_count(sim: "Simulation") -> int:
    """Steps accepted so far, and instants with events: each of these may begin and end a step."""
    return int(counters_of(sim.workspace.arrays["counters"]).steps) + sim.events_handled


def steps_left(sim: "Simulation", first: int, t: float) -> int:
    """Steps that may still be taken on the way to `t`, s, which began at step `first`; at least 1.

    Raises
    ------
    SimulationError : if there are none left.
    """
    most = sim.settings.max_steps
    if most is None:
        return sys.maxsize
    left = first + most - step_count(sim)
    if left > 0:
        return left
    now, h = sim.t_internal, float(sim.clock.trial_step)
    raise SimulationError(
        f"max_steps = {most} steps (and instants with events) were not enough to reach t = {t:.9g} s: they ended at "
        f"t = {now:.9g} s, and the last was {h:.3g} s long. Ask for a nearer time, give a larger max_steps or looser "
        "tolerances, or look for what is so fast: a load or a speed that is out of proportion, a contact that is too "
        "stiff.",
        t=now,
        loop="step size",
    )
