"""The outer loop keeps its matrices over many stages: what it accepts must be solved all the same."""

import numpy as np
import pytest
from tlismni.core import Simulation, simulate
from tlismni.core.methods.history import recall
from tlismni.core.stage.accelerations import solve_accelerations
from tlismni.models import load

UNSOLVED = 0.5
"""What an outer loop with a tolerance of 0.01 error weights may leave in 99 of 100 steps, measured without its
matrices."""


def unsolved(sim: Simulation) -> float:
    """Step times what is missing to the accelerations that belong to the newest row's q and v, in error weights (rms).
    Leaves the workspace at that row."""
    arrays, n = sim.workspace.arrays, sim.assembly.n
    kept = {name: arrays[name].copy() for name in ("q", "v", "a", "lam", "t", "rate")}
    recall(sim.workspace.record, sim._method.record, 0)
    stored = arrays["a"][:n].copy()
    solved = solve_accelerations(sim.workspace.record) == 0  # not with pivots that are far from this position's
    missing = float(sim.clock.trial_step) * (arrays["a"][:n] - stored) / arrays["weight_v"][:n]
    for name, values in kept.items():
        arrays[name][:] = values
    return float(np.sqrt(np.mean(missing**2))) if solved else np.nan


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method", ["ebdf", "bdf", "irk"])
def test_accelerations_belong_to_their_coordinates(method: str) -> None:
    """Links that crack like a whip: increments that old matrices make too small may hide behind others that shrink
    fast. What is missing grows from step to step by the prediction, and drives the steps to nothing."""
    sim = Simulation(load("chain", links=10).model, method=method, rtol=1e-6)
    found = []
    for t in np.arange(1, 10001) * 2e-3:
        sim.advance(t)
        found.append(unsolved(sim))
    assert np.mean(np.isfinite(found)) > 0.9
    assert np.nanquantile(found, 0.99) < UNSOLVED


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("links", "method", "rtol", "t_end"),
    [(10, "ebdf", 1e-6, 25.0), (10, "bdf", 1e-8, 10.0), (10, "mebdf", 1e-8, 20.0), (20, "ebdf", 1e-8, 12.0)],
)
def test_whips_crack_without_end(links: int, method: str, rtol: float, t_end: float) -> None:
    """With matrices kept as long as the iteration seemed to converge, each of these runs came to a halt."""
    model = load("chain", links=links).model
    result = simulate(model, t_end, method=method, rtol=rtol, atol=1e-3 * rtol, max_steps=1_000_000)
    assert result.t[-1] == t_end
    assert result["residual.position"].max() < 1e-10
