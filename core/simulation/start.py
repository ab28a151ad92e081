"""The start of a run: compiled code makes it (`begin.py`).

Memory, rows that repeat others, and sentences for what is no start are Python's."""

import logging
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.evaluate import evaluate_residuals
from ..assembly.partition import prepare
from ..assembly.redundancy import check_rates, find_redundant
from ..assembly.scales import Scales
from ..errors import ConsistencyError, SimulationError
from ..events.records import DECLINED, SETTLED, WANT_MEMORY
from ..rounding import START_MOVED
from ..state.modes import ACTIVE
from ..state.workspace_records import control_of
from . import motions
from .begin import NO_POSITIONS, NO_VELOCITIES, OVERLAPS, SINGULAR_START, START_UNSOLVED
from .begin_now import measure_now, place_now, start_now
from .begin_record import GIVEN_START_TOLERANCE, LOOK_AT_RANK, MOVED_MOST, MOVED_POSITIONS, MOVED_RATES
from .failures import failure_of

if TYPE_CHECKING:
    from ..assembly.workspace import Workspace
    from .engine import Engine
    from .simulation import Simulation

logger = logging.getLogger(__name__)

Kept = tuple[NDArray[np.uint8], NDArray[np.int64]]
"""State and statistics."""

_FAR = (NO_POSITIONS, NO_VELOCITIES)
WAY_AT_ONCE = 0.1
"""Of the size of the mechanism (a turn: of 1 rad): how far inputs lead the bodies at once on the way to their start."""

_MAY_REPEAT = (NO_POSITIONS, NO_VELOCITIES, SINGULAR_START)
"""What rows that repeat others may be the reason of."""


def begin(sim: "Engine") -> None:
    """Measure the model's scales and make a consistent start.

    Raises
    ------
    ConsistencyError, SimulationError : if there is none.
    """
    sim.beginning.take_numbers(sim.assembly, sim.workspace.assembly)
    motions.begin(sim.workspace, sim.settings.t0)
    status = _act(sim, measure_now)
    if status != SETTLED:
        raise RuntimeError(f"status {status} of a measurement is not known")
    control = control_of(sim.workspace.arrays["control"])
    sim.scales = Scales(sim.assembly.length, control.rate_scale, control.energy_scale)
    start(sim)


def start(sim: "Engine") -> None:
    """A consistent start, with the model's scales as they have been measured. Raises as `begin`."""
    motions.begin(sim.workspace, sim.settings.t0)
    before = _now(sim.workspace)
    try:
        status = _attempt(sim)
        if status != SETTLED:
            failure = _failure(sim, status)
            if not (status in _FAR and sim.assembly.motions and _follow_inputs(sim, before)):
                raise failure
    except BaseException:
        sim.drive.take_pending()  # who goes on from an earlier state does not want them
        raise
    for level, place in (("positions q0", MOVED_POSITIONS), ("velocities v0", MOVED_RATES)):
        if (moved := sim.beginning.found[place]) > START_MOVED:
            logger.info("%s moved by up to %.3g (relative) to meet the constraints", level, moved)
    if sim.redundant:
        check_rates(sim.workspace, sim.redundant)
    _warn_of_laid_contacts(sim)
    sim.take_events()
    sim.table.initial_energy = sim.table.total_energy(sim.sample())
    sim._sample_now()
    sim.pending = sim.drive.take_pending()
    sim._handle_pending()
    _forget_before(sim)
    sim.guard.begin(sim.t)  # what happens at the start does not count


def _attempt(sim: "Engine") -> int:
    """A start from the state as it is: its status."""
    numbers, before = sim.beginning.numbers, _now(sim.workspace)
    sim.redundant = ()
    numbers[LOOK_AT_RANK] = float(sim.settings.redundant != "refuse")
    status = _act(sim, start_now)
    if status in _MAY_REPEAT and numbers[LOOK_AT_RANK]:
        _go_back(sim.workspace, before)
        place_now(sim.beginning.record.record)
        sim.redundant = find_redundant(sim.workspace)
        numbers[LOOK_AT_RANK] = 0.0
        _go_back(sim.workspace, before)
        status = _act(sim, start_now)
    return status


def _follow_inputs(sim: "Engine", before: Kept) -> bool:
    """A start where the inputs say, however far the bodies are moved to it; False if the model's own start meets the
    constraints for no values of the inputs that lead motions.

    A model says where its bodies are for some values of its inputs, not for those that a master or a course sets."""
    arrays, numbers, tolerance = sim.beginning.record.arrays, sim.beginning.numbers, sim.settings.start_tolerance
    q0 = arrays["q0"].copy()
    _go_back(sim.workspace, before)
    offsets = motions.fitting_offsets(sim.workspace, lambda: place_now(sim.beginning.record.record))
    motions.begin(sim.workspace, sim.settings.t0, offsets)
    if _attempt(sim) != SETTLED:
        return False
    far = float(np.max(np.abs(offsets[:, 0]))) / motions.size_of(sim.assembly)
    ways = range(math.ceil(far / WAY_AT_ONCE) - 1, -1, -1) if far > WAY_AT_ONCE else (0,)
    try:
        numbers[GIVEN_START_TOLERANCE] = np.inf
        for k in ways:
            # bodies go with the inputs in small ways: of several ways to put them together theirs is kept
            arrays["q0"][:] = sim.workspace.arrays["q"][: sim.assembly.n]
            _go_back(sim.workspace, before)
            motions.begin(sim.workspace, sim.settings.t0, offsets * (k / len(ways)))
            sim.drive.take_pending()
            if _attempt(sim) != SETTLED:
                return False
    finally:
        numbers[GIVEN_START_TOLERANCE], arrays["q0"][:] = tolerance, q0
    return True


def _forget_before(sim: "Engine") -> None:
    """Contacts that touch at the start are closed from there on: the sample before they are settled, in which nothing
    carries, is none of the motion. Where velocities jump by impacts both samples count."""
    sim.flush()
    sim.take_events()
    if sum(map(len, sim.samples)) > 1 and not any(event.kind == "impact" for event in sim.events):
        del sim.samples[0]


def _warn_of_laid_contacts(sim: "Engine") -> None:
    """Say which contacts press from the start with a law whose damping refers to a speed that they have not had."""
    memory, contacts = sim.memory, sim.assembly.contacts
    laid = [c for c, row in zip(contacts, memory, strict=False) if row.mode == ACTIVE and row.laid_mass > 0.0]
    if laid:
        logger.warning(
            "%s begin%s without an approach, and the damping of %s refers to one: it is that of the blow which goes as "
            "deep (docs/contact-laws.md). KelvinVoigt and Tsuji have a damping of their own; minimum_approach_speed "
            "of the law sets a larger speed",
            ", ".join(f"'{c.name}'" for c in laid),
            "" if len(laid) > 1 else "s",
            ", ".join(sorted({type(c.law).__name__ for c in laid})),
        )


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
    sim.method_arrays["ring"][1] = 0
    sim.workspace.drop(frozenset())
    sim.workspace.engage(frozenset(), frozenset())
    start(sim)


def _now(workspace: "Workspace") -> Kept:
    """State and statistics, to go back to."""
    return workspace.state_bytes.copy(), workspace.arrays["counters"].copy()


def _go_back(workspace: "Workspace", before: Kept) -> None:
    """State and statistics as they were: what is tried again is counted once."""
    workspace.state_bytes[:], workspace.arrays["counters"][:] = before


def _act(sim: "Engine", act: Callable[[Any], Any]) -> int:
    """Let compiled code do its part, from the state as it is, with the memory that it wants; its status."""
    before = _now(sim.workspace)
    while DECLINED < (status := int(act(sim.beginning.record.record))) <= WANT_MEMORY:
        sim.workspace.sync()
        sim.build_wanted(status)
        _go_back(sim.workspace, before)
    sim.workspace.sync()
    return status


def _failure(sim: "Engine", status: int) -> ConsistencyError | SimulationError:
    """Why there is no start; the workspace is where that was seen."""
    if status in (NO_POSITIONS, NO_VELOCITIES):
        return _far_from_constraints(sim, status == NO_VELOCITIES)
    if status == OVERLAPS:
        k = int(sim.beginning.found[MOVED_MOST])
        return ConsistencyError(
            f"contact '{sim.assembly.contacts[k].name}' starts with the shapes overlapping by {-sim.gap(k):.3g} "
            f"{sim.assembly.contacts[k].units[0]}; a constraint contact needs a gap >= 0 at the start"
        )
    if status == SINGULAR_START:
        try:
            prepare(sim.workspace)
        except ConsistencyError as error:
            return error
    if status == START_UNSOLVED:
        return sim.no_accelerations()
    return failure_of(sim, status)


def _far_from_constraints(sim: "Engine", rates: bool) -> ConsistencyError:
    """The refusal of positions (or velocities) that violate the constraints beyond repair."""
    assembly, arrays, found = sim.assembly, sim.workspace.arrays, sim.beginning.found
    x, residual, level = ("v", "phid", "velocities v0") if rates else ("q", "phi", "positions q0")
    moved, who = float(found[MOVED_RATES if rates else MOVED_POSITIONS]), int(found[MOVED_MOST])
    given, now = sim.beginning.record.arrays["mass"][: assembly.n], arrays[x][: assembly.n].copy()
    detail = "no consistent ones were found near by"
    if moved != -1.0:
        far = abs(now[who] - given[who])
        detail = f"the nearest consistent ones differ by {far:.3g} in {assembly.coordinate_names[who]}"
    arrays[x][: assembly.n] = given
    evaluate_residuals(sim.workspace.record)
    violated = _violations(sim, arrays[residual])
    return ConsistencyError(
        f"the given {level} violate the constraints beyond repair: {violated}; {detail}, and "
        f"start_tolerance = {sim.settings.start_tolerance:g} (relative) is allowed. Give consistent values, or raise "
        "start_tolerance."
    )


def _violations(sim: "Engine", residual: NDArray[np.float64]) -> str:
    """The worst violated constraints by name."""
    worst: dict[str, float] = {}
    for row in sim.workspace.structure.active:
        name = sim.assembly.row_names[row]
        worst[name] = max(worst.get(name, 0.0), abs(float(residual[row])))
    ordered = sorted(worst.items(), key=lambda item: -item[1])[:5]
    return ", ".join(f"'{name}' by {value:.3g}" for name, value in ordered if value > 0.0) or "none"
