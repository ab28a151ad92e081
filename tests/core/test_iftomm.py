"""Problems A01 and A02 of the IFToMM library of multibody benchmarks (Gonzalez, Dopico, Lugris and Cuadrado, 2006).

The reference solutions are integrations in one coordinate.
"""

import math

import numpy as np
import pytest
from helpers import G, integrate
from tlismni.core import simulate
from tlismni.models import load

METHODS = ["ebdf", "mebdf", "irk"]
TIGHT = {"rtol": 1e-11, "atol": 1e-13}
A01 = np.array(
    [
        (0.986291751132, -0.165010853126), (-0.793566195343, -0.608483930444), (0.176651789923, -0.984273409738),
        (0.577563628249, -0.816345671468), (-0.942305435044, -0.334754338414), (0.999497539939, -0.031696492790),
        (-0.998618779175, -0.052540782998), (0.919857983108, -0.392251565852), (-0.498373709057, -0.866962309516),
        (-0.275087462576, -0.961419205099),
    ]
)  # fmt: skip
"""x, y of the bob at t = 1, 2 ... 10 s."""
A02 = (0.328458111533, 0.944518538181, 1.423051470190, -0.494868845469)
"""Position and velocity of B_0 at t = 10 s, two loops."""


def test_references_are_those_of_the_reduced_equations():
    times = np.arange(1.0, 11.0)
    angle = integrate(lambda t, y: [y[1], -G * math.cos(y[0])], [math.pi, 0.0], times, max_step=0.02)[:, 0]
    assert np.abs(np.stack([np.cos(angle), np.sin(angle)], axis=1) - A01).max() < 1e-10
    angle, rate = level_cranks([10.0])[0]
    found = (math.cos(angle), math.sin(angle), -rate * math.sin(angle), rate * math.cos(angle))
    assert found == pytest.approx(A02, abs=1e-9)


def level_cranks(times):
    """(angle, rate) of the cranks of the four-bar with two loops."""
    return integrate(lambda t, y: [y[1], -7.0 / 6.0 * G * math.cos(y[0])], [math.pi / 2, -1.0], times, max_step=0.02)


@pytest.mark.parametrize("method", METHODS)
def test_a01_pendulum(method):
    scenario = load("pendulum")
    result = simulate(scenario.model, scenario.t_end, method, t_eval=np.arange(1.0, 11.0), **TIGHT)
    assert np.abs(np.stack([result["bob.x"], result["bob.y"]], axis=1) - A01).max() < 1e-8
    assert np.abs(result["energy.balance"]).max() < 1e-8 * result["energy.kinetic"].max()


@pytest.mark.parametrize("method", METHODS)
def test_a02_up_to_its_singular_position(method):
    """The cranks are level at 0.7144 s; here until 0.04 rad before."""
    times = np.linspace(0.0, 0.706, 21)
    result = simulate(load("four_bar").model, 0.706, method, t_eval=times, **TIGHT)
    exact = level_cranks(times)
    for k in range(3):
        assert np.abs(result[f"crank{k}.angle"] - exact[:, 0]).max() < 1e-8
        assert np.abs(result[f"crank{k}.angular_velocity"] - exact[:, 1]).max() < 1e-7
    assert np.abs(result["energy.balance"]).max() < 1e-8 * result["energy.kinetic"].max()


@pytest.mark.parametrize("method", METHODS)
def test_a02_four_bar_through_its_singular_positions(method):
    scenario = load("four_bar")
    result = simulate(scenario.model, 0.72, method, **TIGHT)
    # once past it; else the long way to t_end is not worth going
    assert result["crank0.angle"][-1] == pytest.approx(level_cranks([0.72])[0, 0], abs=1e-6)
    result = simulate(scenario.model, scenario.t_end, method, **TIGHT)
    end = [2.0 * result[f"crank0.{name}"][-1] for name in ("x", "y", "vx", "vy")]
    assert end == pytest.approx(A02, abs=1e-6)
    drift = np.abs(result["energy.balance"]).max() / result["energy.kinetic"].max()
    assert drift < 1e-7
