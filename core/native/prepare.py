"""What a run without Python has to find ready: memory.

Compiled code builds structures, partitions and the factors of matrices into memory that Python has given
(`docs/architecture.md`). So the run is made once before it is written down, to see how much that takes; then there is
twice as much. None of this changes a bit of the run.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.partition import prepare
from ..assembly.workspace import all_tangents
from ..errors import ConsistencyError
from ..laws import ForceLaw
from ..linalg import SingularMatrixError
from ..multibody_model import Model
from ..simulation.drive_record import Drive
from .errors import NativeError

POINTS = 32
"""Times at which the rehearsal stops."""
PLACES = 4
"""For structures at most: the present one, the one to come back to, and two to build. A state holds them all."""
ROOMS = 2
"""How much more room there is than was needed."""


def points(began: float, t_end: float) -> list[float]:
    """Times of the rehearsal, s."""
    return [began + (t_end - began) * k / POINTS for k in range(1, POINTS + 1)]


def start_inputs(sim: Any) -> list[float]:
    """The inputs as they are."""
    return [float(sim.workspace.arrays["inputs"][k, 0]) for k in range(len(sim.assembly.input_names))]


def rehearse(sim: Any, t_end: float) -> list[NDArray[np.float64]]:
    """Give `sim`, which has just begun, the memory for a run to `t_end` (s), and more; then it is where it was. Returns
    the channels at the `points`.

    Raises
    ------
    NativeError : for a model that takes Python at any event. SimulationError : if the run fails.
    """
    _refuse(sim)
    start, began, events = sim.state(), sim.t, list(sim.events)
    found = [channels_at(sim, t) for t in points(began, t_end)]
    sim.restore(start)
    _close_all(sim)
    _make_room(sim)
    sim.restore(start)
    # the present structure comes first, the other places are room without content
    sim.workspace.keep_slots(len(sim.workspace.slots.structures))
    sim.restore(start)
    sim.events[:] = events
    _as_at_first(sim)
    return found


def channels_at(sim: Any, t: float) -> NDArray[np.float64]:
    """Let a run go to `t` (s) with the inputs as they are: the channels there."""
    quick = sim.exchange(start_inputs(sim), t)
    return np.asarray(sim.values() if quick is None else quick)


def _refuse(sim: Any) -> None:
    """Raise NativeError for a model that takes Python at any event."""
    assembly = sim.assembly
    if not isinstance(sim.system, Model):
        raise NativeError(
            f"a {type(sim.system).__name__} is made of Python functions, which only Python can call: describe it as a "
            "Model"
        )
    if assembly.pool is not None:
        raise NativeError(
            f"group '{assembly.pool.names[0]}' has `most_contacts`, and which pairs take its contacts is known with "
            "Python alone: leave it out for a contact for each pair, or use the FMU that runs with Python"
        )
    if sim.settings.fallback and sim.outer != "newton":
        raise NativeError(
            "which outer loop takes over from another (fallback) is for Python to say: leave fallback out, or use "
            "outer='newton'"
        )
    if assembly.contacts and sim.workspace.dropped:
        raise NativeError(
            f"{len(sim.workspace.dropped)} constraints repeat others, and there are contacts: which of them are left "
            "out Python looks at in every impact. Leave the redundant joints out of the model, or use the FMU that "
            "runs with Python"
        )


def _close_all(sim: Any) -> None:
    """Meet the largest structure: that of all contacts at once, with pivots if it has any here."""
    contacts, workspace = sim.assembly.contacts, sim.workspace
    acting = frozenset(k for k, contact in enumerate(contacts) if isinstance(contact.law, ForceLaw))
    closed = frozenset(range(len(contacts))) - acting
    tangents = all_tangents(sim.assembly)
    workspace.engage(closed, acting, frozenset(k for k in tangents if k % len(contacts) in closed))
    try:
        prepare(workspace)
    except (ConsistencyError, SingularMatrixError):
        pass  # not all of them can be closed here


def _make_room(sim: Any) -> None:
    """Room for more than the rehearsal has needed: there is nobody to give it later."""
    drive: Drive = sim.drive
    if sim.assembly.contacts:
        every = len(sim.assembly.contacts)
        decided = drive.instant.decided if sim.formula.impulses else every
        drive.instant = drive.instant.with_room(every, decided, ROOMS * drive.instant.rows_space, 2 * sim.assembly.n)
        drive.record.set_size("instant", drive.instant.address)
    workspace, slots = sim.workspace, sim.workspace.slots
    slots.ask(ROOMS)
    workspace.give_room()
    workspace.keep_slots(min(PLACES, len(slots.structures)))


def _as_at_first(sim: Any) -> None:
    """Counters and the guard against endless events begin anew, as in a run that has not been restored."""
    sim.drive.counts.numbers[:] = 0
    sim.guard.begin(sim.t)
