"""State of a simulation as a value, and going on from one."""

import hashlib
import json
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import ConsistencyError, ModelError, SimulationError
from ..events import Event, Fallback
from ..methods.history import recall
from ..stage.accelerations import solve_accelerations
from ..state.workspace_records import OK, convergence_of
from .snapshot import Snapshot, snapshot_of, take_snapshot
from .state import State

if TYPE_CHECKING:
    from .simulation import Simulation


def model_hash(sim: "Simulation") -> str:
    """Hash of the model and the settings: a state fits only these."""
    text = json.dumps([sim.system.identity(), repr(sim.settings)])
    return hashlib.sha256(text.encode()).hexdigest()


def get_state(sim: "Simulation") -> State:
    """Copy everything that decides the future."""
    if len(sim.stored_events) != len(sim.events):
        sim.stored_events = tuple(sim.events)
    return State.of_parts(take_snapshot(sim), sim.model_hash, sim.stored_events)


def set_state(sim: "Simulation", state: State) -> None:
    """Make `sim` what it was when `state` was taken."""
    if not isinstance(state, State):
        raise ModelError(f"a State is needed to restore, not {type(state).__name__}; bytes go through State.from_bytes")
    expected = sim.model_hash
    if state.model_hash != expected:
        raise ModelError(
            f"the state belongs to another model, method or tolerance (hash {state.model_hash[:12]}, this simulation "
            f"has {expected[:12]}): restore it into a simulation built the same way"
        )
    if state.parts is not None:
        _take(sim, state.parts, state.events)
        return
    from .state_check import check_state  # of states from outside this process alone

    own = get_state(sim)
    check_state(sim, state, own)
    try:
        _take(
            sim, snapshot_of(state.arrays, state.facts, state.past, sim.workspace.state.dtype, Fallback), state.events
        )
    except BaseException as error:  # what is left may be half of each
        _take(sim, own.parts, own.events)
        if isinstance(error, ValueError):
            raise ModelError(f"the solver state does not fit this simulation: {error}") from error
        raise


def _take(sim: "Simulation", parts: Snapshot, events: tuple[Event, ...]) -> None:
    workspace = sim.workspace
    if sim.outer != parts.outer:
        sim.use_outer_loop(parts.outer)
    sim.fallbacks = list(parts.fallbacks)
    if sim.assembly.pool is not None:
        # structures of the slots as they are bound now are of no use
        workspace.engage(frozenset(), frozenset())
        workspace.state["slot_pair"][0] = parts.buffer.view(workspace.state.dtype)["slot_pair"][0]
        sim.drive.bind()
    if workspace.key != parts.key or workspace.dropped != parts.dropped:
        workspace.drop(parts.dropped)
        workspace.engage(*parts.key)
    structure = workspace.structure
    # most ways back are short, and patterns are dear: what fits is kept
    present = structure.present
    if present is None or not _same(present.dependent, parts.dependent):
        workspace.set_partition(parts.dependent)
        present = structure.present
    workspace.set_probe(parts.probe)
    if parts.compatibility.shape != structure.compatibility.shape:
        raise ModelError(
            f"the rows of compatibility of the solver state are not {len(structure.compatibility)} numbers but "
            f"{len(parts.compatibility)}"
        )
    structure.compatibility[:] = parts.compatibility
    if present is None:
        raise RuntimeError("a structure has a partition once one was chosen")
    factorizations = (structure.kkt, structure.kkt_query, *present.factorizations)
    for factorization, factors in zip(factorizations, parts.factors, strict=True):
        own = factorization.parts()
        if not (_same(own[0], factors.perm_r) and _same(own[1], factors.perm_c)):
            factorization.analyze_with(factors.perm_r, factors.perm_c)
            own = factorization.parts()
        for mine, stored in ((own[2], factors.values), (own[3], factors.pivots)):
            if mine.shape != stored.shape:
                raise ModelError(f"the factors of the solver state are not {len(mine)} numbers but {len(stored)}")
            mine[:] = stored
    workspace.state_bytes[:] = parts.buffer
    workspace.arrays["counters"][:] = parts.counters
    sim.t, sim.pending = parts.t, list(parts.pending)
    sim.start_open, sim.input_times = parts.start_open, parts.input_times
    sim.table.initial_energy = parts.initial_energy
    sim.drive.goals.handled_at, sim.drive.counts.here = parts.handled
    if sim.stored_events is not events or len(sim.events) != len(events):  # events are only ever added
        sim.events, sim.stored_events = list(events), events


def _same(a: NDArray[np.int64], b: NDArray[np.int64]) -> bool:
    # of one type as a rule; a tenth of the time of numpy's comparison
    return a is b or a.tobytes() == b.tobytes()


def _no_state(sim: "Simulation") -> SimulationError:
    return SimulationError(
        f"at t = {sim.t:.9g} s no state meets the constraints and the equations of motion with the inputs set: "
        "they ask for a position out of reach, or make a force that is not finite",
        t=sim.t,
        loop="inner",
    )


def go_to_present(sim: "Simulation") -> None:
    """Let the present time `sim.t` be that of the workspace's point. Raises SimulationError where no state is found."""
    workspace, method = sim.workspace.record, sim._method.record
    if sim.t == sim.t_internal:
        recall(workspace, method, 0)
    elif sim.query() != OK:
        raise _no_state(sim)


def restart_here(sim: "Simulation", is_present: bool = False) -> None:
    """Start anew from the present time `sim.t`: what was computed beyond it is dropped (an input has changed).
    is_present : the workspace's point is that of the present time already.
    Raises SimulationError where no accelerations fit it."""
    workspace = sim.workspace.record
    if not is_present:
        go_to_present(sim)
    if sim.t != sim.t_internal:
        sim.pending = []
        _drop_records(sim)
        # the newest row itself, where that is nearer than a step can be: what is due at once is due at this time
        sim.workspace.arrays["t"][0] = sim.t
    # the modes are the same and the structure fits them; only pivots that have degraded call for a new one
    if solve_accelerations(workspace) == OK:
        sim.begin_rates()
        convergence_of(sim.workspace.arrays["rate"]).factor_age = -1.0
    else:
        try:
            sim.use_modes()
        except ConsistencyError as error:
            raise _no_state(sim) from error
    sim._new_history()
    sim.pending += [k for k in sim.unsettled() if k not in sim.pending]


def _drop_records(sim: "Simulation") -> None:
    """Forget what was recorded beyond the present time `sim.t`."""
    sim.flush()
    for records in (sim.samples, sim.step_logs):
        while records and records[-1][-1, 0] > sim.t:
            kept = records.pop()
            kept = kept[kept[:, 0] <= sim.t]
            if len(kept):
                records.append(kept)
