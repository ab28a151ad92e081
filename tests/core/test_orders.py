"""Observed orders on the planar pendulum as a constrained point, against the angle's own equation."""

import math

import numpy as np
import pytest
from helpers import G, circle_pendulum, order, pendulum_angles, point_pendulum
from linkages import slider_crank
from tlismni.core import Simulation, simulate
from tlismni.core.recovery.repartition import repair

ANGLE, RATE = -0.4, 1.5


def exact(t_end, angle=ANGLE, rate=RATE):
    """(q, v) of the bob at t_end."""
    (angle, rate) = pendulum_angles([t_end], angle, rate)[0]
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c, s, -s * rate, c * rate])


def global_errors(system, expected, t_end, steps, method, **options):
    """Errors of (q, v) at t_end with each number of fixed steps."""
    errors = []
    for count in steps:
        result = simulate(system, t_end, method, step=t_end / count, newton_tolerance=1e-13, record=False, **options)
        assert result.stats["steps"] == count
        errors.append(np.abs(np.concatenate([result.q[-1], result.v[-1]]) - expected).max())
    return errors


def swing(start, t_end):
    """A pendulum that swings about the x axis (gravity along it) from rest at `start`, and where it is at t_end.

    y stays the independent coordinate: nothing but the formula decides the error.
    """
    x, y, vx, vy = exact(t_end, start - math.pi / 2, 0.0)
    system = point_pendulum(start).model_copy(update={"gravity": (G, 0.0)})
    return system, np.array([-y, x, -vy, vx])


def slope(steps, errors):
    """Order from a straight line through all errors."""
    return -np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize(
    "method, options, expected, steps",
    [
        ("newmark", {}, 2, (160, 320)),
        ("newmark", {"gamma": 0.6, "beta": 0.3025}, 1, (640, 1280)),
        ("hht", {"alpha": -0.05}, 2, (160, 320)),
        ("hht", {"alpha": -0.3}, 2, (160, 320)),
        ("bdf", {"order": 1}, 1, (480, 960)),
        ("bdf", {"order": 2}, 2, (160, 320)),
        ("bdf", {"order": 3}, 3, (160, 320)),
        ("bdf", {"order": 4}, 4, (120, 240)),
        ("bdf", {"order": 5}, 5, (160, 320)),
        ("ebdf", {"k": 1}, 2, (160, 320)),
        ("ebdf", {"k": 2}, 3, (120, 240)),
        ("ebdf", {"k": 3}, 4, (120, 240)),
        ("ebdf", {"k": 4}, 5, (120, 240)),
        ("ebdf", {"k": 5}, 6, (120, 240)),
        *(("mebdf", {"k": k}, k + 1, (160 if k == 1 else 120, 320 if k == 1 else 240)) for k in range(1, 6)),
        ("irk", {"tableau": "sdirk4"}, 4, (80, 160)),
    ],
)
def test_observed_order(method, options, expected, steps):
    errors = global_errors(*swing(0.5, 1.5), 1.5, steps, method, **options)
    assert errors[-1] > 3e-11, "rounding: choose larger steps"
    assert order(errors) == pytest.approx(expected, abs=0.2)


@pytest.mark.parametrize("k, steps", [(6, (32, 64)), (7, (32, 64)), (8, (24, 48))])
def test_observed_order_of_the_highest_ebdf(k, steps):
    """Between coarse steps and rounding there is one halving: a small swing, a short time."""
    errors = global_errors(*swing(0.3, 0.75), 0.75, steps, "ebdf", k=k)
    assert errors[-1] > 2e-12, "rounding: choose larger steps"
    assert order(errors) == pytest.approx(k + 1, abs=0.35)


@pytest.mark.parametrize("k", range(1, 9))
def test_every_ebdf_beats_the_bdf_of_the_same_k(k):
    system = swing(0.5, 1.5)
    bdf, ebdf = (
        global_errors(*system, 1.5, (160,), method, **{name: min(k, most)})[0]
        for method, name, most in (("bdf", "order", 5), ("ebdf", "k", 8))
    )
    assert ebdf < 0.5 * bdf


def test_order_with_user_written_equations():
    errors = global_errors(circle_pendulum(ANGLE, RATE), exact(0.5), 0.5, (50, 100), "ebdf", k=3)
    assert order(errors) == pytest.approx(4.0, abs=0.2)


def test_elements_and_user_written_equations_give_the_same_numbers():
    """Distance2D and x^2 + y^2 - 1 differ by the factor 2 of Phi: the same motion, half the multipliers."""
    runs = [simulate(s, 0.5, step=0.01) for s in (point_pendulum(ANGLE, RATE), circle_pendulum(ANGLE, RATE))]
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-11
    assert runs[0].multipliers[:, 0] == pytest.approx(2.0 * runs[1].multipliers[:, 0], rel=1e-8)


@pytest.mark.parametrize(
    "method, options, expected, steps",
    [
        ("ebdf", {"k": 4}, 5, (400, 600, 900, 1350)),
        ("bdf", {"order": 3}, 3, (400, 600, 900, 1350)),
        ("irk", {"tableau": "sdirk4"}, 4, (400, 600, 900, 1350)),
        ("hht", {}, 2, (1000, 2000, 4000)),
    ],
)
def test_order_survives_full_turns_and_the_new_partitions_that_they_need(method, options, expected, steps):
    """Fast turns about the pin: x and y take turns as dependent coordinate; the history is kept. The error depends
    on where in a step the partition changes: a line through several step sizes, which may be steeper."""
    angle, rate, t_end = -math.pi / 2, 8.0, 2.0
    turns = (pendulum_angles([t_end], angle, rate)[0][0] - angle) / (2.0 * math.pi)
    assert turns > 2.0
    system = point_pendulum(angle, rate)
    errors = global_errors(system, exact(t_end, angle, rate), t_end, steps, method, **options)
    assert slope(steps, errors) > expected - 0.3
    result = simulate(system, t_end, method, step=t_end / steps[0], record=False, **options)
    assert result.stats["partitions"] >= 4.0 * turns - 1.0


@pytest.mark.parametrize(
    "method, options, tolerances, exponent, bound",
    [
        ("ebdf", {}, (1e-6, 1e-8, 1e-10), 1.0, 10.0),
        ("irk", {"tableau": "sdirk4"}, (1e-6, 1e-8, 1e-10), 1.0, 10.0),
        ("bdf", {"order": 5}, (1e-6, 1e-8, 1e-10), 1.0, 50.0),
        ("hht", {}, (1e-5, 1e-6, 1e-7), 2.0 / 3.0, 20.0),
    ],
)
def test_error_control_follows_the_tolerance(method, options, tolerances, exponent, bound):
    """The error of each step is held: with order p of the formula and of the estimate the global error goes as
    rtol^(p / (p + 1)) (hht), and as rtol where the estimate is that of a formula of one order less."""
    errors = []
    for rtol in tolerances:
        result = simulate(point_pendulum(ANGLE, RATE), 1.0, method, rtol, rtol * 1e-2, record=False, **options)
        errors.append(np.abs(np.concatenate([result.q[-1], result.v[-1]]) - exact(1.0)).max())
    assert errors[0] > errors[1] > errors[2]
    assert all(error < bound * rtol**exponent for error, rtol in zip(errors, tolerances, strict=True))
    # and not needlessly exact: the steps are as large as the tolerance allows
    assert all(error > 1e-2 * rtol**exponent for error, rtol in zip(errors, tolerances, strict=True))


def test_fixed_steps_end_exactly_at_t_end_even_if_they_do_not_divide_it():
    result = simulate(point_pendulum(ANGLE, RATE), 1.0, "irk", step=0.03)
    assert result.t[-1] == 1.0
    assert np.diff(result.t)[:-1] == pytest.approx(0.03, rel=1e-12)


def test_order_of_a_closed_loop_survives_new_partitions():
    """A slider-crank that turns several times. Its crank angle could stay independent for ever: scales that change with
    time make it choose others, twenty times a second. The history of all coordinates is kept."""
    t_end, names = 2.0, ("crank", "rod", "slider")

    def run(count, switch=True):
        system = slider_crank(0.5, 9.0, 0.5, 1.2, gravity=G)
        assert tuple(body.name for body in system.bodies) == names
        sim = Simulation(system, "ebdf", k=4, step=t_end / count, newton_tolerance=1e-13)
        scale, seen = sim.workspace.arrays["scale"].copy(), set()
        for k in range(1, 41):
            sim.run_to(t_end, until=0.05 * k)
            if switch:
                # in turn angles and the crank are the less welcome as independent coordinates
                sim.workspace.arrays["scale"][:] = scale
                sim.workspace.arrays["scale"][[2, 5, 8]] = 5.0 if k % 2 else 1.0
                sim.workspace.arrays["scale"][[0, 1, 2]] *= 1.0 if k % 2 else 0.01
                repair(sim)
            seen.add(tuple(sim.workspace.structure.dependent.tolist()))
        sample = sim.sample()
        return np.concatenate([sample[sim.table.layout.q], sample[sim.table.layout.v]]), len(seen)

    reference, partitions = run(9600, switch=False)
    assert partitions == 1 and reference[2] - 0.5 > 4.0 * math.pi
    steps = (900, 1350, 2000, 3000)
    found = [run(count) for count in steps]
    assert all(partitions >= 4 for _, partitions in found)
    assert slope(steps, [np.abs(end - reference).max() for end, _ in found]) > 4.7
