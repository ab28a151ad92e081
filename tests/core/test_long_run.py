"""A hundred thousand steps of closed loops: the constraints hold at all three levels, to the end as at the start."""

import math

import numpy as np
import pytest
from helpers import on
from tlismni.core import Model, Revolute2D, RigidBody2D, simulate
from tlismni.core.rounding import CONSTRAINT_TOLERANCES
from tlismni.models import load

STEPS = 100_000
LEVELS = ("position", "velocity", "acceleration")


def turning_slider_crank():
    """Weightless and slow enough that accelerations stay below 100: rounding of phi'' grows with them."""
    return load("slider_crank", crank_speed=6.0, gravity=0.0).model


def swinging_four_bar():
    """Four unequal bars (Grashof), released at rest: swings about its lowest position, never stretched out."""
    crank, coupler, rocker, ground = 0.5, 1.0, 0.8, 1.1
    pin = np.array([ground, 0.0])
    start = -0.4
    a = crank * np.array([math.cos(start), math.sin(start)])
    # the coupler's far end: where the circles about a and pin meet, lower side
    apart = pin - a
    d = float(np.hypot(*apart))
    along = (coupler**2 - rocker**2 + d**2) / (2.0 * d)
    aside = math.sqrt(coupler**2 - along**2)
    b = a + (along * apart + aside * np.array([apart[1], -apart[0]])) / d

    def bar(name, p, q):
        length = float(np.hypot(*(q - p)))
        return RigidBody2D(
            name=name, mass=length, inertia=length**3 / 12.0, position=tuple(0.5 * (p + q)),
            angle=math.atan2(q[1] - p[1], q[0] - p[0]),
        )  # fmt: skip

    def pinned(name, first, second):
        return Revolute2D(name=name, a=first, b=second)

    zero = np.zeros(2)
    return Model(
        bodies=[bar("crank", zero, a), bar("coupler", a, b), bar("rocker", pin, b)],
        joints=[
            pinned("j1", on("ground"), on("crank", -0.5 * crank)),
            pinned("j2", on("crank", 0.5 * crank), on("coupler", -0.5 * coupler)),
            pinned("j3", on("coupler", 0.5 * coupler), on("rocker", 0.5 * rocker)),
            pinned("j4", on("ground", ground), on("rocker", -0.5 * rocker)),
        ],
    )


def tenths(values):
    """Largest value in the first and in the last tenth."""
    part = len(values) // 10
    return values[:part].max(), values[-part:].max()


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method", ["ebdf", "hht"])
@pytest.mark.parametrize("build, moved", [(turning_slider_crank, 50.0), (swinging_four_bar, 0.5)])
def test_constraints_hold_without_drift_over_a_hundred_thousand_steps(build, moved, method):
    result = simulate(build(), 1e-4 * STEPS, method, step=1e-4)
    assert result.stats["steps"] >= STEPS and len(result) > STEPS
    assert np.ptp(result["crank.angle"]) > moved
    assert np.abs(result.a).max() < 100.0
    # rounding, and with it what the solver is content with, grows with the size of the coordinates (turns add up)
    size = np.maximum(1.0, np.abs(result.q).max(axis=1))
    for level in LEVELS:
        residual = result[f"residual.{level}"]
        assert residual.max() < 1e-10, level
        first, last = tenths(residual / size if level == "position" else residual)
        # a violation that the solver is content with (1e-12 here: rows are as large as the mechanism, and rates and
        # accelerations count by its own) is no drift: once it is passed, it is corrected
        assert last < max(2.0 * first, 10.0 * CONSTRAINT_TOLERANCES[0]), level


def test_energy_does_not_drift_either():
    result = simulate(swinging_four_bar(), 1e-4 * STEPS, step=1e-4)
    kinetic = result["energy.kinetic"].max()
    assert kinetic > 0.1
    assert np.abs(result["energy.balance"]).max() < 1e-9 * kinetic
