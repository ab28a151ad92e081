"""Observed orders of the formulas with Euler parameters: a slow heavy top and a body on a universal joint."""

import numpy as np
import pytest
from helpers import order
from tlismni.core import simulate
from tlismni.models import load

SYSTEMS = {
    "top": (load("heavy_top", spin=12.0, precession=1.0).model, 0.4),
    "pendulum": (load("universal_pendulum", tilt=1.2).model, 0.5),
}


@pytest.fixture(scope="module")
def exact():
    """The state at the end, by a formula of order 5 with error control at its finest."""
    found = {}
    for name, (model, t_end) in SYSTEMS.items():
        result = simulate(model, t_end, "irk", rtol=1e-13, atol=1e-15, record=False)
        found[name] = np.concatenate([result.q[-1], result.v[-1]])
    return found


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize(
    "method, options, expected, steps",
    [
        ("newmark", {}, 2, (160, 320)),
        ("hht", {"alpha": -0.1}, 2, (160, 320)),
        ("bdf", {"order": 2}, 2, (320, 640)),
        ("bdf", {"order": 3}, 3, (240, 480)),
        ("bdf", {"order": 4}, 4, (160, 320)),
        ("ebdf", {"k": 2}, 3, (120, 240)),
        ("ebdf", {"k": 3}, 4, (200, 400)),
        ("mebdf", {"k": 3}, 4, (120, 240)),
        ("irk", {"tableau": "sdirk4"}, 4, (80, 160)),
        *((method, {"alpha": alpha}, 2, (160, 320)) for method in ("hht_i3", "hht_ggl") for alpha in (-0.1, -0.3)),
    ],
)
def test_observed_order(exact, name, method, options, expected, steps):
    model, t_end = SYSTEMS[name]
    errors = []
    for count in steps:
        result = simulate(model, t_end, method, step=t_end / count, newton_tolerance=1e-13, record=False, **options)
        errors.append(np.abs(np.concatenate([result.q[-1], result.v[-1]]) - exact[name]).max())
    assert errors[-1] > 1e-11, "rounding: choose larger steps"
    assert order(errors) == pytest.approx(expected, abs=0.3)


@pytest.mark.parametrize("name", SYSTEMS)
def test_adams_follows_its_tolerance(exact, name):
    """Its order is its own choice: a thousandth of the tolerance must bring a small part of the error."""
    model, t_end = SYSTEMS[name]
    errors = []
    for rtol in (1e-3, 1e-6, 1e-9):
        result = simulate(model, t_end, "adams", rtol=rtol, atol=0.01 * rtol, record=False)
        errors.append(np.abs(np.concatenate([result.q[-1], result.v[-1]]) - exact[name]).max())
        assert errors[-1] < 1e3 * rtol
    assert errors[1] < 0.02 * errors[0] and errors[2] < 0.02 * errors[1]
