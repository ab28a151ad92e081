"""Adams and Park formulas: coefficients on unequal grids, error constants, the trapezoidal rule."""

import numpy as np
import pytest
from helpers import point_pendulum
from hypothesis import given, settings
from hypothesis import strategies as st
from test_orders import ANGLE, RATE, exact
from tlismni.core import simulate
from tlismni.core.methods.adams import adams_coefficients
from tlismni.core.methods.park import park_coefficients

steps = st.floats(0.2, 5.0)


def adams(past, p):
    """Coefficients for a new step of size 1 after steps `past` (newest first)."""
    s = -1.0 - np.concatenate([[0.0], np.cumsum(past)])[:p]
    implicit, explicit, constants = np.zeros(p), np.zeros(p), np.zeros(2)
    adams_coefficients(s, p, implicit, explicit, constants)
    return s, implicit, explicit, constants


@settings(max_examples=50, deadline=None)
@given(st.lists(steps, min_size=7, max_size=7), st.integers(2, 8))
def test_adams_is_exact_for_polynomials_and_its_constants_are_its_errors(past, p):
    s, implicit, explicit, constants = adams(past, p)
    for degree in range(p + 1):
        integral = -((-1.0) ** (degree + 1)) / (degree + 1)
        am = implicit[0] * 0.0**degree + np.sum(implicit[1:] * s[: p - 1] ** degree)
        ab = np.sum(explicit * s**degree)
        scale = max(1.0, abs(s[-1])) ** degree
        if degree < p:
            assert am == pytest.approx(integral, abs=1e-10 * scale)
            assert ab == pytest.approx(integral, abs=1e-10 * scale)
        else:
            assert integral - am == pytest.approx(constants[0], abs=1e-9 * scale)
            assert integral - ab == pytest.approx(constants[1], abs=1e-9 * scale)


@settings(max_examples=50, deadline=None)
@given(steps, steps)
def test_third_and_fourth_order_have_the_classical_variable_step_forms(h1, h2):
    """The closed forms, h = 1."""
    h = 1.0
    _, third, _, constants = adams([h1, h2], 3)
    assert third == pytest.approx(
        [
            h * (2 * h + 3 * h1) / (6 * (h + h1)), h * (h + 3 * h1) / (6 * h1), -(h**3) / (6 * h1 * (h + h1)),
        ],
        rel=1e-11,
    )  # fmt: skip
    assert constants[0] / 6.0 == pytest.approx(-(h**3) * (h + 2 * h1) / 72.0, rel=1e-10)
    _, fourth, _, constants = adams([h1, h2, 1.0], 4)
    assert fourth[0] == pytest.approx(
        h * (3 * h**2 + 8 * h * h1 + 4 * h * h2 + 6 * h1**2 + 6 * h1 * h2) / (12 * (h + h1) * (h + h1 + h2)), rel=1e-11
    )
    expected = -(h**3) * (3 * h**2 + 10 * h * h1 + 5 * h * h2 + 10 * h1**2 + 10 * h1 * h2) / 1440.0
    assert constants[0] / 24.0 == pytest.approx(expected, rel=1e-9)


def test_milne_factors_of_equal_steps():
    for p, factor in ((3, 1.0 / 10.0), (4, 19.0 / 270.0)):
        constants = adams([1.0] * 5, p)[3]
        assert abs(constants[0] / (constants[1] - constants[0])) == pytest.approx(factor, rel=1e-10)


def test_park_is_the_classical_formula_for_equal_steps():
    out = np.zeros(12)
    park_coefficients(np.array([-1.0, -2.0, -3.0]), out, np.zeros(12))
    assert out[:4] == pytest.approx([1.5, -0.6, 0.1, 0.6], abs=1e-14)


@settings(max_examples=50, deadline=None)
@given(steps, steps)
def test_park_has_order_two_on_any_grid_and_the_error_that_it_estimates(h1, h2):
    s = np.array([-1.0, -1.0 - h1, -1.0 - h1 - h2])
    out = np.zeros(12)
    park_coefficients(s, out, np.zeros(12))
    for degree in range(3):
        value = np.sum(out[:3] * s**degree) + out[3] * (1.0 if degree == 1 else 0.0)
        assert value == pytest.approx(1.0 if degree == 0 else 0.0, abs=1e-12 * abs(s[2]) ** 2)
    # y = s^3: extrapolation through three points misses by s0 s1 s2, the formula by b/(2 |s2|) of that
    miss = abs(np.sum(out[:3] * s**3))
    assert miss == pytest.approx(0.5 * out[3] / abs(s[2]) * abs(np.prod(s)), rel=1e-9)


def test_trapezoidal_rule_and_average_acceleration_are_the_same_formula():
    """q and v as unknowns or a: the numbers agree but for the first step, which the starter makes."""
    runs = [
        simulate(point_pendulum(0.2, 1.0), 0.5, method, step=0.005, newton_tolerance=1e-13)
        for method in ("trapezoidal", "newmark")
    ]
    assert 0.0 < np.abs(runs[0].q - runs[1].q).max() < 1e-6
    # the difference is that of one step of order 2
    assert np.abs(runs[0].q[2] - runs[1].q[2]).max() < 1e-7


@pytest.mark.parametrize(
    "method, options, exponent",
    [("adams", {"order": 3}, 0.75), ("adams", {}, 0.8), ("park", {}, 2 / 3), ("trapezoidal", {}, 2 / 3)],
)
def test_error_control_follows_the_tolerance(method, options, exponent):
    errors = []
    for rtol in (1e-5, 1e-7, 1e-9) if method == "adams" else (1e-4, 1e-5, 1e-6):
        result = simulate(point_pendulum(ANGLE, RATE), 1.0, method, rtol, rtol * 1e-2, record=False, **options)
        errors.append(np.abs(np.concatenate([result.q[-1], result.v[-1]]) - exact(1.0)).max())
        assert 0.01 * rtol**exponent < errors[-1] < 30.0 * rtol**exponent
    assert errors[0] > errors[1] > errors[2]
