"""The planar slider-crank with a bushing of 1e8 N/m: steps are those of the slow motion, not of the bushing."""

import logging

import numpy as np
import pytest
from helpers import residuals
from tlismni.core import SimulationError, simulate
from tlismni.models import load

SLOWEST = 5e-5
"""2/omega of the bushing, s: between 4e-5 and 6e-5 over a turn."""
T_END = 0.3


@pytest.fixture(scope="module")
def mechanism():
    return load("slider_crank", bushing_stiffness=1e8).model


@pytest.fixture(scope="module")
def reference(mechanism):
    return simulate(mechanism, T_END, "ebdf", 1e-10, 1e-12, record=False)


@pytest.mark.parametrize("outer", ["newton", "jfnk"])
@pytest.mark.parametrize(
    "method, options, rtol, times, most",
    [
        ("ebdf", {}, 1e-6, 10.0, 1e-3),
        ("ebdf", {"k": "auto"}, 1e-6, 15.0, 1e-3),
        ("mebdf", {"k": "auto"}, 1e-6, 15.0, 1e-3),
        # with the tolerances of a step that others are told: 1e-6, 1e-4 and 1e-4
        ("hht", {"alpha": -0.3}, 1e-4, 10.0, 1e-3),
        ("bdf", {"order": 2}, 1e-4 ** (2.0 / 3.0), 3.0, 2e-2),
        ("park", {}, 1e-4 ** (2.0 / 3.0), 5.0, 2e-2),
    ],
)
def test_steps_are_far_beyond_the_limit_of_explicit_methods(
    mechanism, reference, method, options, rtol, times, most, outer
):
    result = simulate(mechanism, T_END, method, rtol, rtol, outer=outer, step_records=True, **options)
    assert np.median(result.steps["h"]) > times * SLOWEST
    assert np.abs(result.q[-1] - reference.q[-1]).max() < most
    assert max(residuals(result)) < 1e-9  # accelerations are of the order of 1e3 m/s^2


@pytest.mark.parametrize("method", ["newmark", "hht", "ebdf", "mebdf", "bdf", "park"])
def test_the_simple_iteration_refuses_with_the_reason_and_the_limit(mechanism, method):
    with pytest.raises(SimulationError, match=r"contracts only if c_q omega\^2 < 1") as caught:
        simulate(mechanism, T_END, method, step=1e-3, outer="simple")
    limit = float(str(caught.value).split("largest step here is about ")[1].split(" s")[0])
    assert 0.3 * SLOWEST < limit < 3.0 * SLOWEST
    # and the limit is one (of the stage that failed: the other stages of a step have other coefficients)
    assert simulate(mechanism, 20 * limit, method, step=0.25 * limit, outer="simple").t[-1] == 20 * limit
    with pytest.raises(SimulationError):
        simulate(mechanism, 20 * limit, method, step=2.5 * limit, outer="simple")


def test_falling_back_makes_the_same_run_pass(mechanism, caplog):
    with caplog.at_level(logging.WARNING):
        result = simulate(mechanism, T_END, "mebdf", step=1e-3, outer="simple", fallback=True)
    assert result.t[-1] == T_END and len(result.fallbacks) == 1
    assert "limit is about" in caplog.text
