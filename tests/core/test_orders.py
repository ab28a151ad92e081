"""Observed orders on the planar pendulum as a constrained point, against the angle's own equation."""

import math

import numpy as np
import pytest
from helpers import circle_pendulum, order, pendulum_angles, point_pendulum
from tlismni.core import simulate

T_END = 1.0
ANGLE, RATE = -0.4, 1.5


def exact(t_end=T_END, angle=ANGLE, rate=RATE):
    (angle, rate) = pendulum_angles([t_end], angle, rate)[0]
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c, s, -s * rate, c * rate])


def global_errors(steps, method, model=None, t_end=T_END, angle=ANGLE, rate=RATE, **options):
    """Errors of (q, v) at t_end with each number of fixed steps."""
    system = point_pendulum(angle, rate) if model is None else model
    errors = []
    for count in steps:
        result = simulate(system, t_end, method, step=t_end / count, newton_tolerance=1e-13, record=False, **options)
        assert result.stats["steps"] == count
        errors.append(np.abs(np.concatenate([result.q[-1], result.v[-1]]) - exact(t_end, angle, rate)).max())
    return errors


@pytest.mark.parametrize(
    "method, options, expected, steps",
    [
        ("newmark", {}, 2, (200, 400, 800)),
        ("newmark", {"gamma": 0.6, "beta": 0.3025}, 1, (400, 800, 1600)),
        ("hht", {"alpha": -0.05}, 2, (400, 800, 1600)),
        ("hht", {"alpha": -0.3}, 2, (400, 800, 1600)),
        ("bdf", {"order": 1}, 1, (1000, 2000, 4000)),
        ("bdf", {"order": 2}, 2, (400, 800, 1600)),
        ("bdf", {"order": 3}, 3, (200, 400, 800)),
        ("bdf", {"order": 4}, 4, (100, 200, 400)),
        ("bdf", {"order": 5}, 5, (100, 200, 400)),
        ("ebdf", {"k": 1}, 2, (200, 400, 800)),
        ("ebdf", {"k": 2}, 3, (100, 200, 400)),
        ("ebdf", {"k": 3}, 4, (100, 200, 400)),
        ("ebdf", {"k": 4}, 5, (80, 160, 320)),
        ("ebdf", {"k": 5}, 6, (60, 120, 240)),
        ("ebdf", {"k": 6}, 7, (60, 120, 240)),
        ("ebdf", {"k": 7}, 8, (50, 80, 128)),
        ("ebdf", {"k": 8}, 9, (40, 60, 90)),
        ("irk", {}, 4, (50, 100, 200)),
    ],
)
def test_observed_order(method, options, expected, steps):
    errors = global_errors(steps, method, **options)
    print(method, options, errors, order(errors, steps[-1] / steps[-2]))
    assert errors[-1] > 1e-13, "rounding: choose larger steps"
    assert order(errors, steps[-1] / steps[-2]) == pytest.approx(expected, abs=0.2)


def test_order_with_user_written_equations():
    errors = global_errors((80, 160), "ebdf", circle_pendulum(ANGLE, RATE), k=3)
    assert order(errors) == pytest.approx(4.0, abs=0.2)


def test_elements_and_user_written_equations_give_the_same_numbers():
    """Distance2D and x^2 + y^2 - 1 differ by the factor 2 of Phi: the same motion, half the multipliers."""
    runs = [simulate(s, 0.5, step=0.01) for s in (point_pendulum(ANGLE, RATE), circle_pendulum(ANGLE, RATE))]
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-11
    assert runs[0].multipliers[:, 0] == pytest.approx(2.0 * runs[1].multipliers[:, 0], rel=1e-8)


@pytest.mark.parametrize("method, options, expected", [("ebdf", {"k": 4}, 5), ("irk", {}, 4), ("hht", {}, 2)])
def test_order_survives_full_turns_and_the_new_partitions_that_they_need(method, options, expected):
    """Fast turns about the pin: x and y take turns as dependent coordinate; the history is kept."""
    angle, rate, t_end = -math.pi / 2, 8.0, 2.0
    turns = (pendulum_angles([t_end], angle, rate)[0][0] - angle) / (2.0 * math.pi)
    assert turns > 2.0
    steps = (4000, 8000) if method == "hht" else (800, 1600)
    errors = global_errors(steps, method, t_end=t_end, angle=angle, rate=rate, **options)
    result = simulate(point_pendulum(angle, rate), t_end, method, step=t_end / steps[0], record=False, **options)
    assert result.stats["partitions"] >= 4.0 * turns / 2.0
    print(errors, order(errors), result.stats["partitions"], turns)
    assert order(errors) == pytest.approx(expected, abs=0.2)


@pytest.mark.parametrize("method, options", [("ebdf", {}), ("irk", {}), ("bdf", {"order": 5}), ("hht", {})])
def test_error_control_follows_the_tolerance(method, options):
    """Ten times the accuracy asked for gives about ten times the accuracy, and never much less than asked for."""
    tolerances = (1e-5, 1e-6, 1e-7) if method == "hht" else (1e-6, 1e-8, 1e-10)
    errors = []
    for rtol in tolerances:
        result = simulate(point_pendulum(ANGLE, RATE), T_END, method, rtol, rtol * 1e-2, record=False, **options)
        errors.append(np.abs(np.concatenate([result.q[-1], result.v[-1]]) - exact()).max())
    assert errors[0] > errors[1] > errors[2]
    assert all(error < 100.0 * rtol for error, rtol in zip(errors, tolerances, strict=True))


def test_fixed_steps_end_exactly_at_t_end_even_if_they_do_not_divide_it():
    result = simulate(point_pendulum(ANGLE, RATE), 1.0, "irk", step=0.03)
    assert result.t[-1] == 1.0
    assert np.diff(result.t)[:-1] == pytest.approx(0.03, rel=1e-12)
