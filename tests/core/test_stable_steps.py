"""The default formula does not let vibrations that nobody asks for hold its steps (`k="stable"`)."""

import numpy as np
import pytest
from tlismni.core import Simulation
from tlismni.models import load

ROUGH = {"rtol": 1e-3, "atol": 1e-5, "record": False}


def last_k(run: Simulation) -> float:
    """Number of steps of the formula that the run has now."""
    return float(run.method_arrays["choice"][0])


@pytest.mark.sampled(2)
@pytest.mark.parametrize("method", ("ebdf", "mebdf"))
@pytest.mark.parametrize("elements", (24, 64))
def test_axial_waves_of_a_cable_do_not_hold_the_default(method: str, elements: int) -> None:
    model = load("cable_pendulum", elements=elements).model
    steps = {}
    for k in ("stable", 3):
        run = Simulation(model, method, k=k, **ROUGH)
        run.run_to(0.03)
        steps[k] = run.stats["steps"]
        assert last_k(run) == 3.0
    assert steps["stable"] < 1.5 * steps[3]


@pytest.mark.parametrize(
    "name, parameters",
    (("chain", {}), ("slider_crank", {}), ("universal_pendulum", {}), ("slider_crank", {"bushing_stiffness": 1e8})),
)
def test_mechanisms_of_rigid_bodies_are_solved_with_four_steps(name: str, parameters: dict[str, float]) -> None:
    # a stiff spring too: both formulas damp a vibration far beyond the step
    model, ends = load(name, **parameters).model, []
    for options in ({}, {"k": 4}):
        run = Simulation(model, "ebdf", **ROUGH, **options)
        run.run_to(0.3)
        assert last_k(run) == 4.0
        ends.append((run.stats["steps"], run.sample().tobytes()))
    assert ends[0] == ends[1]


def test_a_vibration_that_is_resolved_keeps_four_steps() -> None:
    run = Simulation(load("impact_oscillator").model, "ebdf", rtol=1e-8, atol=1e-10, record=False)
    run.run_to(0.5)
    assert last_k(run) == 4.0
    assert np.isfinite(run.sample()).all()
