"""State of a simulation as a value, and going on from one."""

import hashlib
import json
from typing import TYPE_CHECKING

import numpy as np

from ..errors import ModelError, SimulationError
from ..events import Fallback
from ..methods.history import recall
from ..stage.accelerations import solve_accelerations
from ..state import State
from ..system.records import FACTOR_AGE, OK
from .dense_output import query
from .records import HANDLED_AT, HERE
from .state_check import check_state

if TYPE_CHECKING:
    from .simulation import Simulation

_WORKSPACE = ("memory", "inputs", "counters", "rate", "t", "q", "v", "a", "aux", "lam")


def model_hash(sim: "Simulation") -> str:
    """Hash of the model and the settings: a state fits only these."""
    text = json.dumps([sim.system.identity(), repr(sim.settings)])
    return hashlib.sha256(text.encode()).hexdigest()


def get_state(sim: "Simulation") -> State:
    """Copy everything that decides the future."""
    workspace, structure = sim.workspace, sim.workspace.structure
    arrays = {name: workspace.arrays[name].copy() for name in _WORKSPACE}
    arrays |= {f"method_{name}": x.copy() for name, x in sim.method_arrays.items()}
    arrays["clock"], arrays["watch"] = sim.clock.copy(), sim.watch.copy()
    if structure.dependent is None or structure.lu_d is None:
        raise RuntimeError("a simulation always has a partition once it is built")
    arrays["dependent"] = structure.dependent.copy()
    arrays["probe"] = workspace.arrays["probe"].copy()
    for name in ("kkt", "lu_d", "kkt_query"):
        factorization = getattr(structure, name)
        perm_r, perm_c = factorization.analysis()
        arrays[f"{name}_perm_r"], arrays[f"{name}_perm_c"] = perm_r.copy(), perm_c.copy()
        arrays[f"{name}_values"] = factorization.lu_values.copy()
        arrays[f"{name}_pivots"] = factorization.pivots.copy()
    closed, engaged, sticking = workspace.key
    if len(sim.stored_events) != len(sim.events):
        sim.stored_events = tuple(sim.events)
    facts = {
        "t": sim.t,
        "closed": sorted(closed),
        "dropped": sorted(workspace.dropped),
        "engaged": sorted(engaged),
        "sticking": sorted(sticking),
        "pending": list(sim.pending),
        "open_accounts": {str(k): list(v) for k, v in sim.open_accounts.items()},
        "handled": [repr(float(sim.drive.goals[HANDLED_AT])), sim.events_here],
        "outer": sim.outer,
        "start_open": sim.start_open,
        "input_times": [repr(x) for x in sim.input_times],
        "initial_energy": repr(sim.table.initial_energy),
        "fallbacks": [[f.t, f.outer, f.reason] for f in sim.fallbacks],
    }
    return State(arrays, facts, sim.model_hash, sim.stored_events)


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
    if not state.foreign:
        _take(sim, state)
        return
    own = get_state(sim)
    check_state(sim, state, own)
    try:
        _take(sim, state)
    except BaseException as error:  # what is left may be half of each
        _take(sim, own)
        if isinstance(error, ValueError):
            raise ModelError(f"the solver state does not fit this simulation: {error}") from error
        raise


def _take(sim: "Simulation", state: State) -> None:
    workspace, facts, arrays = sim.workspace, state.facts, state.arrays
    if sim.outer != facts["outer"]:
        sim.use_outer_loop(facts["outer"])
    sim.fallbacks = [Fallback(*entry) for entry in facts["fallbacks"]]
    key = (frozenset(facts["closed"]), frozenset(facts["engaged"]), frozenset(facts["sticking"]))
    dropped = frozenset(facts["dropped"])
    if workspace.key != key or workspace.dropped != dropped:
        workspace.drop(dropped)
        workspace.engage(*key)
    structure, dependent = workspace.structure, arrays["dependent"]
    # most ways back are short, and patterns are dear: what fits is kept
    analysed = structure.dependent is not None and np.array_equal(structure.dependent, dependent)
    if not analysed:
        workspace.set_partition(dependent)
    workspace.set_probe(arrays["probe"].copy())
    for name in ("kkt", "lu_d", "kkt_query"):
        factorization = getattr(structure, name)
        wanted = arrays[f"{name}_perm_r"], arrays[f"{name}_perm_c"]
        if not (analysed and all(map(np.array_equal, factorization.analysis(), wanted))):
            factorization.analyze_with(*wanted)
        for own, stored in ((factorization.lu_values, "values"), (factorization.pivots, "pivots")):
            if own.shape != arrays[f"{name}_{stored}"].shape:
                raise ModelError(f"'{name}_{stored}' of the solver state has not {len(own)} entries")
            own[:] = arrays[f"{name}_{stored}"]
    for name in _WORKSPACE:
        workspace.arrays[name][...] = arrays[name]
    for name, x in sim.method_arrays.items():
        x[...] = arrays[f"method_{name}"]
    sim.clock[:], sim.watch[:] = arrays["clock"], arrays["watch"]
    sim.t = float(facts["t"])
    sim.pending = [int(k) for k in facts["pending"]]
    sim.open_accounts = {int(k): (v[0], v[1]) for k, v in facts["open_accounts"].items()}
    sim.start_open = bool(facts["start_open"])
    sim.input_times = (float(facts["input_times"][0]), float(facts["input_times"][1]))
    sim.table.initial_energy = float(facts["initial_energy"])
    sim.drive.goals[HANDLED_AT], sim.drive.counts[HERE] = float(facts["handled"][0]), int(facts["handled"][1])
    sim.events, sim.stored_events = list(state.events), state.events


def restart_here(sim: "Simulation") -> None:
    """Start anew from the present time `sim.t`: what was computed beyond it is dropped (an input has changed)."""
    ws, ms = sim.workspace.record, sim._method.record
    if sim.t == sim.t_internal:
        recall(ws, ms, 0)
    elif query(ws, ms, sim.t) != OK:
        raise SimulationError(
            f"at t = {sim.t:.9g} s no state meets the constraints and the equations of motion with the inputs set: "
            "they ask for a position out of reach, or make a force that is not finite",
            t=sim.t,
            loop="inner",
        )
    if sim.t != sim.t_internal:
        sim.pending = []
        _drop_records(sim)
        # the newest row itself, where that is nearer than a step can be: what is due at once is due at this time
        sim.workspace.arrays["t"][0] = sim.t
    # the modes are the same and the structure fits them; only pivots that have degraded call for a new one
    if solve_accelerations(ws) == OK:
        sim.begin_rates()
        sim.workspace.arrays["rate"][FACTOR_AGE] = -1.0
    else:
        sim.use_modes()
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
