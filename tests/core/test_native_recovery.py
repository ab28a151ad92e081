"""Runs without Python where steps cannot be made: what follows is what follows in Python, bit for bit."""

import numpy as np
import pytest
from stacks import stack
from test_repair_memory import with_torque
from tlismni.core import Simulation
from tlismni.core.compiled.library import LIBRARY
from tlismni.core.native import image_of
from tlismni.models import load

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")

FIXED = {"method": "hht", "step": 1e-3}
CASES = {
    "a block tips over the edge of another": (lambda: stack(2, 1, 20.0), 1.0, FIXED),
    "blocks of a higher stack do": (lambda: stack(3, 1, 20.0), 1.15, FIXED),
    "a cable reaches the ground": (lambda: load("cable_ground").model, 0.3, FIXED),
    "a mass on a rod strikes": (lambda: load("mass_on_rod").model, 1.5e-3, FIXED),
    "other pivots in the middle of a motion": (lambda: with_torque("lower"), 1.0, {}),
}
"""Models, ends of their runs (s) and settings; all but the last divide steps."""


def pair(name):
    """A run without Python, and one with it."""
    from tlismni.core.native.in_process import NativeModel, NativeRun

    make, end, settings = CASES[name]
    model = make()
    return NativeRun(NativeModel(image_of(model, end, **settings), LIBRARY)), Simulation(model, **settings), end


@pytest.mark.parametrize("name", CASES)
def test_the_same_bits(name):
    run, sim, end = pair(name)
    inputs = [x.start for x in sim.system.inputs]
    for t in [*np.sort(np.random.default_rng(3).uniform(0.0, end, 40)).tolist(), end]:
        found = run.step(t, inputs)
        sim.advance(t)
        assert found.tobytes() == sim.values().tobytes(), t
    assert (run.events, run.steps) == (len(sim.events), sim.stats["steps"])
    assert sim.stats["divided_steps"] > 0 or sim.stats["partitions"] > 5


@pytest.mark.parametrize("name", list(CASES)[:3])
def test_the_same_from_event_to_event(name):
    """And a state that is taken on the way leads to the same end, within a divided step too."""
    run, sim, end = pair(name)
    states = []
    while run.step_to_event(end):
        assert sim.advance_to_event(end) and run.t == sim.t
        states.append(run.save())
        while run.happen():
            assert sim.handle_event()
        sim.handle_event()
    sim.advance(end)
    last = run.look().tobytes()
    assert last == sim.values().tobytes()
    for saved in states[:: max(1, len(states) // 20)]:
        run.restore(saved)
        assert run.step(end).tobytes() == last
