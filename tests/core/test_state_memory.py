"""The state is one buffer that decides everything, and what else a run works with decides nothing."""

import numpy as np
import pytest
from tlismni.core import Simulation
from tlismni.models import load


@pytest.mark.parametrize("name", ["pendulum_stop", "woodpecker"])
def test_state_is_one_buffer_without_gaps(name):
    sim = Simulation(load(name).model)
    buffer = sim.workspace.state
    assert set(buffer.dtype.names) == {
        "memory", "inputs", "rate", "t", "q", "v", "a", "aux", "lam", "slot_pair", "method_history",
        "method_times", "method_ring", "method_parameters", "method_weights", "method_error", "method_choice",
        "clock", "watch", "guard",
    }  # fmt: skip
    at = 0
    for field in buffer.dtype.names:
        kind, start = buffer.dtype.fields[field]
        assert start == at
        at += kind.itemsize
    assert at == buffer.nbytes
    own = {n: x for n, x in sim.workspace.arrays.items() if n in buffer.dtype.names}
    own |= {f"method_{n}": x for n, x in sim.method_arrays.items()}
    own |= {"clock": sim.clock.numbers, "watch": sim.watch, "guard": sim.guard.numbers}
    assert own.keys() == set(buffer.dtype.names)
    for field, array in own.items():
        assert array.ctypes.data == buffer.ctypes.data + buffer.dtype.fields[field][1]
        assert array.nbytes == buffer.dtype.fields[field][0].itemsize


SCRATCH = (
    "r", "q_star", "v_star", "base_q", "base_v", "base_a", "weight_q", "weight_v", "offset", "phi", "phid", "phidd",
    "values", "coef", "energy", "monitor", "stage_v", "stage_a", "stage_rows", "rhs", "scratch", "basis",
)  # fmt: skip
OF_LOOP = (
    *(f"probe_{name}" for name in ("q", "v", "a", "r", "lam", "phi", "phid", "phidd", "monitor")),
    "travel", "brackets", "samples",
)  # fmt: skip
OF_DRIVE = ("found", "events", "nearest", "last_trial")


def spoil(sim):
    """Fill working memory with NaN."""
    for arrays, names in (
        (sim.workspace.arrays, SCRATCH),
        (sim._loop.arrays, OF_LOOP),
        (sim.drive.record.arrays, OF_DRIVE),
    ):
        for name in names:
            arrays[name][...] = np.nan
    for scratch in sim.drive.instant.scratch():
        scratch[:] = np.nan
    sim.workspace.slots.scratch.numbers[:] = np.nan


def run(name, end, method, between):
    sim = Simulation(load(name).model, method)
    for t in np.linspace(0.0, end, 12)[1:]:
        sim.advance(float(t))
        between(sim)
    return sim


@pytest.mark.sampled(10)
@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
@pytest.mark.parametrize(
    "name, end",
    [
        ("bouncing_ball", 2.5), ("pendulum_stop", 2.0), ("woodpecker", 0.4), ("stick_slip", 2.0),
        ("slider_crank_stop", 0.3), ("impact_oscillator", 1.0), ("newtons_cradle", 0.5), ("rocking_block", 1.0),
        ("tippe_top", 1.5),
    ],
)  # fmt: skip
def test_nan_in_all_working_memory_changes_no_bit(name, end, method):
    plain, spoilt = (run(name, end, method, between) for between in (lambda sim: None, spoil))
    assert spoilt.state().to_bytes() == plain.state().to_bytes()
    assert spoilt.values().tobytes() == plain.values().tobytes()
    assert np.all(np.isfinite(plain.values()))


def test_a_state_stays_as_it_is_while_its_run_goes_on():
    """Nothing that it holds is written into, nor what it shares with the run."""
    sim = Simulation(load("woodpecker").model)
    sim.advance(0.1)
    state, later = sim.state(), sim.state()
    data = state.to_bytes()
    sim.advance(0.4)
    assert later.to_bytes() == data
    sim.restore(state)
    assert sim.state() == later
    sim.advance(0.2)
    assert state.to_bytes() == data


@pytest.mark.parametrize("method", ["ebdf", "irk"])
@pytest.mark.parametrize("name", ["bouncing_ball", "woodpecker", "stick_slip", "slider_crank_stop", "chain"])
def test_ways_that_meet_in_a_state_have_the_same_bytes_from_there_on(name, method):
    """Straight on, back and again, in a run that was further, in a run that has not begun: one state, one future."""
    model = load(name).model
    straight = Simulation(model, method)
    straight.advance(0.2)
    middle = straight.state()
    straight.advance(0.4)
    end = straight.state().to_bytes()
    straight.restore(middle)
    elsewhere, fresh = Simulation(model, method), Simulation(model, method)
    elsewhere.advance(0.5)
    for sim in (straight, elsewhere, fresh):
        sim.restore(middle)
        assert sim.state().to_bytes() == middle.to_bytes()
        sim.advance(0.4)
        assert sim.state().to_bytes() == end
    fresh.advance(0.45)
    assert fresh.state().to_bytes() != end
