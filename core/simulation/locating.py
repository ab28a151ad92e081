"""Locating an event within a step over a singular position."""

from typing import TYPE_CHECKING

from ..compiled.from_python import FromPython
from ..state.workspace_records import OK

if TYPE_CHECKING:
    from ..recovery.singular_passage import LongStep
    from .simulation import Simulation


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
    sim.flush()
    sim.pending = sim.drive.take_pending()
