"""Bytes of two states are equal exactly if their futures are: what decides nothing is not in them, what decides is."""

from dataclasses import replace

import numpy as np
import pytest
from tlismni.core import Simulation, SimulationError, State, TlismniError
from tlismni.core.events.progress import COUNTED_SINCE, EVENTS_COUNTED, IN_A_ROW
from tlismni.core.simulation.setup import HISTORY_ROWS
from tlismni.models import load

RARE = {
    "rate": "thresholds of renewed matrices and partitions, and of a singular position ahead",
    "watch": "follows from the newest row",
    "guard": "gives up a run that chatters: see the test of it",
    "method_parameters": "of the formula, the same in all states of a run",
    "method_weights": "tableau of the formula, or coefficients that are made anew for other nodes",
    "of old rows": "further back than the formula looks: the passage over a singular position may",
    **dict.fromkeys(("clock 7", "clock 8", "clock 10", "clock 13", "clock 14", "clock 15"), "a setting"),
    "memory 17": "which rows of a contact others imply: none of these models has redundant contacts",
    "method_choice 0": "a setting, unless the order is chosen",
    "clock 11": "whether the next step of one-step formulas has a past, by rounding only",
    "clock 12": "the same",
    "clock 17": "crowding instants of friction", "clock 18": "the same", "clock 19": "the same",
    "memory 9": "contacts by force and in space only", "memory 10": "the same",
    "memory 2": "asked for where bounces accumulate",
    **dict.fromkeys((f"clock {k}" for k in (21, 22, 25)), "steps of impulses of many contacts"),
    "clock 26": "the newest row, once a step from it has failed",
    **dict.fromkeys((f"clock {k}" for k in range(27, 32)), "divided steps of fixed size: see the tests of them"),
    "inputs": "of inputs, and of none where there is none",
}  # fmt: skip
"""What need not show in the futures of a few states, and why."""
SPAN = 0.2


def future(sim):
    """All that can be seen from now on: at the present time, within the newest step, and later."""
    known, start, seen = len(sim.events), sim.t, []
    try:
        seen += [sim.values(), sim.sample()]
        for t in start + SPAN * np.array([1e-9, 0.02, 0.3, 1.0]):
            sim.advance(float(t))
            seen += [sim.values(), sim.sample(), np.array([sim.horizon])]
    except (TlismniError, ArithmeticError) as error:
        return b"", str(error)
    return b"".join(x.tobytes() for x in seen), [event.to_dict() for event in sim.events[known:]]


def groups_of(sim):
    """The state's words in groups, by what they are: name to (field, places)."""
    buffer, groups = sim.workspace.state, {}
    ring, n_ext, n = buffer["method_ring"][0], sim.assembly.n_extended, sim.assembly.n
    deep = max(sim.formula.rows, 3)
    for field in buffer.dtype.names:
        array = buffer[field][0]
        places = np.arange(array.size).reshape(array.shape)
        if field == "method_history":
            for back in range(HISTORY_ROWS):
                row = places[(ring[0] - back) % HISTORY_ROWS]
                q, v, a, aux = (row[k * n_ext :][:n_ext] for k in range(4))
                v, a = (np.array([*x[:n], *x[n + 2 :]]) for x in (v, a))  # those between belong to the ground
                which = f"of row {back}" if back < deep else "of old rows"
                groups[f"motion {which}"] = field, np.array([*q[:n], *v, *a])
                groups[f"aux of row {back}"] = field, aux
                which = which if back < max(sim.formula.rows, 2) else "of old rows"
                groups[f"multipliers {which}"] = field, row[4 * n_ext : -1]
        elif field == "method_times":
            for back in range(ring[1]):
                which = f"{back}" if back < deep else "of old rows"
                groups[f"time {which}"] = field, places[[(ring[0] - back) % HISTORY_ROWS]]
        elif array.ndim == 2:
            groups |= {f"{field} {k}": (field, places[:, k]) for k in range(array.shape[1])}
        elif field in ("q", "v", "a", "aux", "lam"):
            groups[field] = field, places
        elif field != "method_ring":
            groups |= {f"{field} {k}": (field, places[[k]]) for k in range(array.size)}
    return {name: group for name, group in groups.items() if group[1].size}


CHANGES = (
    lambda x: 1.01 * x + 1e-3, np.zeros_like, lambda x: 0.0 * x - 1e3, lambda x: 0.0 * x + 2.0, lambda x: 0.0 * x + 1e6
)  # fmt: skip


def _is_rare(group):
    return any(group == rare or group.startswith(f"{rare} ") or group.endswith(f" {rare}") for rare in RARE)


def what_it_is(sim, state, known, group):
    """Whether other words there make another future ("decides"), or are not in the state at all ("absent")."""
    field, places = group
    found = "absent"
    for change in CHANGES:
        sim.restore(state)
        words = sim.workspace.state[field][0].reshape(-1)
        words[places] = change(words[places])
        if sim.state() == state:
            continue
        found = "silent"
        if future(sim) != known:
            return "decides"
    return found


@pytest.mark.parametrize("method", ["ebdf", "hht", "irk"])
def test_every_word_of_a_state_decides_or_is_not_in_it(method):
    found: dict[str, set[str]] = {}
    for name, t in (("pendulum_stop", 0.4), ("stick_slip", 0.3), ("impact_oscillator", 0.35)):
        sim = Simulation(load(name).model, method, max_steps=2000)
        sim.advance(t)
        state = sim.state()
        known = future(sim)
        sim.restore(state)
        for group, places in groups_of(sim).items():
            if "decides" not in found.setdefault(group, set()) and not _is_rare(group):
                found[group].add(what_it_is(sim, state, known, places))
    silent = [group for group, seen in found.items() if "silent" in seen and "decides" not in seen]
    assert not silent
    assert sum("decides" in seen for seen in found.values()) > 12
    assert {"absent"} == found["q"] == found["t 0"] == found["method_error 0"] == found["clock 4"]
    assert found["aux of row 0"] == ({"decides"} if method == "hht" else {"absent"})


@pytest.mark.parametrize("method", ["ebdf", "hht", "irk"])
@pytest.mark.parametrize("name, t", [("bouncing_ball", 0.6), ("woodpecker", 0.21), ("slider_crank_stop", 0.05)])
def test_looking_and_what_lies_behind_change_no_byte_of_a_state(name, t, method):
    """Ways to the same future: with and without looking, by a state from elsewhere, with other statistics."""
    sim, other = (Simulation(load(name).model, method) for _ in range(2))
    sim.advance(t)
    state = sim.state()
    for look in (sim.sample, sim.values, sim.state):
        look()
        assert sim.state().deciding_bytes() == state.deciding_bytes()
    past = replace(
        State.from_bytes(state.to_bytes()),
        events=(),
        past={"counters": [7] * len(state.past["counters"]), "fallbacks": []},
    )
    assert past == state and hash(past) == hash(state) and past.to_bytes() != state.to_bytes()
    other.advance(0.5 * t)
    other.sample()
    other.restore(past)
    assert other.state().deciding_bytes() == state.deciding_bytes()
    known = len(sim.events)
    assert future(other)[1] == future(sim)[1]
    assert other.state().deciding_bytes() == sim.state().deciding_bytes()
    assert other.events == sim.events[known:]
    sim.advance(sim.t + 0.01)
    assert sim.state() != other.state()


def test_a_restored_run_gives_up_where_the_first_one_does():
    """The guard against endless events counts on: a run that has counted much is near its end, wherever it goes on."""
    model = load("bouncing_ball").model
    sim, other = Simulation(model), Simulation(model)
    sim.advance(0.3)
    plain = sim.state()
    next_impact = 0.4515236409857309
    sim.guard.numbers[[COUNTED_SINCE, EVENTS_COUNTED]] = next_impact, IN_A_ROW
    state = sim.state()
    assert state != plain
    other.restore(State.from_bytes(state.to_bytes()))
    for run in (sim, other):
        with pytest.raises(SimulationError, match=f"{IN_A_ROW + 1} events"):
            run.advance(1.0)
    sim.restore(plain)
    sim.advance(1.0)
    assert len(sim.events) == 1
