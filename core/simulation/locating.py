"""Locating an event where that takes Python: with other pivots, or within a step over a singular position."""

from typing import TYPE_CHECKING

from ..compiled.from_python import FromPython
from ..recovery.repartition import repair
from ..state.workspace_records import OK

if TYPE_CHECKING:
    from ..recovery.singular_passage import LongStep
    from .simulation import Simulation

ATTEMPTS = 3
"""Each with the pivots of the newest row; a trial that fails with all of them needs shorter steps."""


def locate_again(sim: "Simulation") -> bool:
    """Locate, in the step from the newest row, the event that could not be located because a trial failed.

    False: it takes a shorter step; the newest row is the current point then.
    """
    for _ in range(ATTEMPTS):
        repair(sim)
        if sim.drive.locate() == OK:
            _take(sim)
            return True
    return False


def locate_in_long_step(sim: "Simulation", over: "LongStep") -> None:
    """Locate the first event in the step of size TRIAL_STEP that `over` has made, by shorter ones of its kind.

    Raises
    ------
    SimulationError : if no such step ends at the event.
    """
    trial = FromPython(over.trial)
    status = sim.drive.locate(trial.address)
    trial.raise_error()
    if status != OK:
        raise RuntimeError(f"a step over a singular position ended with status {status}")
    _take(sim)


def _take(sim: "Simulation") -> None:
    sim.flush()
    sim.pending = sim.drive.take_pending()
