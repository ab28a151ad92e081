"""The outer loop of Shabana and Hussein: a fixed point that contracts with c_q omega^2."""

import math

import numpy as np
import pytest
from helpers import GROUND, on, point_pendulum
from tlismni.core import Model, PointMass2D, SimulationError, SpringDamper2D, simulate

METHODS = ("newmark", "hht", "bdf", "ebdf", "irk")


def oscillator(stiffness, mass=1.0):
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=stiffness, natural_length=1.0)
    body = PointMass2D(name="p", mass=mass, position=(1.01, 0.0))
    return Model(gravity=(0.0, 0.0), bodies=[body], forces=[spring])


@pytest.mark.parametrize("method", METHODS)
def test_simple_and_newton_iteration_give_the_same_solution_for_small_steps(method):
    runs = [
        simulate(point_pendulum(0.2, 1.0), 0.3, method, step=0.002, newton_tolerance=1e-12, outer=outer)
        for outer in ("simple", "newton")
    ]
    assert np.array_equal(runs[0].t, runs[1].t)
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-10
    assert np.abs(runs[0].v - runs[1].v).max() < 1e-9


def test_simple_iteration_takes_more_iterations_the_stiffer_the_spring():
    """Contraction c_q w^2 = h^2 w^2 / 4 for Newmark: the iterations grow as 1 / log of it."""
    h, counts = 0.01, []
    for contraction in (0.01, 0.1, 0.4):
        run = simulate(oscillator(4.0 * contraction / h**2), 0.2, "newmark", step=h, outer="simple")
        counts.append(run.stats["outer_iterations"] / run.stats["stages"])
    assert counts[0] < counts[1] < counts[2]


@pytest.mark.parametrize("method", METHODS)
def test_simple_iteration_fails_for_a_stiff_spring_and_says_why(method):
    h = 0.01
    stiff = oscillator((20.0 / h) ** 2)
    with pytest.raises(SimulationError, match=r"simple iteration contracts only if c_q omega\^2 < 1") as caught:
        simulate(stiff, 1.0, method, step=h, outer="simple")
    assert caught.value.loop == "outer"
    assert caught.value.t < 0.05
    assert "newton" in str(caught.value) and "smaller step" in str(caught.value)
    assert len(caught.value.partial) >= 1 and caught.value.partial.t[-1] == pytest.approx(caught.value.t)
    newton = simulate(stiff, 1.0, method, step=h)
    assert newton.t[-1] == 1.0


def test_measured_factor_in_the_message_is_the_contraction():
    """h^2 w^2 / 4 of Newmark's average acceleration, above one."""
    h, contraction = 0.01, 1.7
    with pytest.raises(SimulationError) as caught:
        simulate(oscillator(4.0 * contraction / h**2), 1.0, "newmark", step=h, outer="simple")
    factor = float(str(caught.value).split("its factor was ")[1].split(";")[0])
    assert factor == pytest.approx(contraction, rel=0.1)


def test_error_controlled_steps_shrink_until_the_simple_iteration_converges():
    w = 2000.0
    result = simulate(oscillator(w**2), 0.01, "ebdf", outer="simple", rtol=1e-4, atol=1e-7)
    assert result.t[-1] == 0.01
    assert np.abs(result["p.x"] - 1.0 - 0.01 * np.cos(w * result.t)).max() < 1e-3
    assert np.diff(result.t).max() < 2.5 / w


def test_newton_needs_one_iteration_a_step_for_a_linear_problem():
    """Vertical free fall and a linear spring along a line: the tangent is exact."""
    run = simulate(oscillator(math.pi**2), 1.0, "newmark", step=0.02)
    assert run.stats["outer_iterations"] <= 2.2 * run.stats["stages"]
