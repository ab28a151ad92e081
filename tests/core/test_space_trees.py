"""Open chains and trees in space never meet a singular position: their runs do not stop, and keep their energy."""

import numpy as np
import pytest
from helpers import residuals
from space_trees import space_tree
from tlismni.core import Simulation, simulate


@pytest.mark.parametrize("method", ["ebdf", "irk"])
@pytest.mark.parametrize("seed", range(8))
def test_runs_keep_energy_and_constraints(seed, method):
    model, _ = space_tree(seed)
    result = simulate(model, 0.2, method, 1e-7, 1e-9)
    largest = np.abs(result["energy.kinetic"]).max()
    assert np.abs(result["energy.balance"]).max() < 1e-4 * largest
    assert residuals(result)[0] < 1e-9


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "seed, kinds, t, method",
    [
        (293, "RRP", 3.5, "ebdf"),
        (351, "SCURRCSU", 1.7, "ebdf"),
        (179, "CRRSSUSPCCRC", 2.2, "ebdf"),
        (179, "CRRSSUSPCCRC", 3.1, "irk"),
    ],
)
def test_sliders_that_leave_their_joints_far_behind(seed, kinds, t, method):
    """Their joints are long levers by then. Rounding of their rows was above what the velocities are solved to, which
    is a part of how large the row was at the start: corrections that could not halve it were taken for divergence, and
    steps shrank to nothing."""
    model, letters = space_tree(seed)
    assert letters == kinds
    sim = Simulation(model, method, 1e-6, 1e-8, record=False)
    sim.run_to(t)
    assert sim.t == t
