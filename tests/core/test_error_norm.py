"""All methods control coordinates and velocities in the same norm: no tolerance is met by positions alone."""

import numpy as np
import pytest
from tlismni.core import Model, Result, simulate
from tlismni.core.elements import PointMass2D, SpringDamper2D
from tlismni.core.model.markers import Marker2D
from tlismni.models import load

HEAVY, LIGHT, FREQUENCY, LENGTH, SPEED = 1.0, 0.01, 2000.0, 1.0, 1.0
AMPLITUDE = 2e-8
"""m: of the order of the tolerance of positions; the velocities that belong to it are 4000 times that of velocities."""
METHODS = {
    "newmark": ("newmark", {}),
    "hht": ("hht", {}),
    "hht damped": ("hht", {"alpha": -0.3}),
    "trapezoidal": ("trapezoidal", {}),
    "park": ("park", {}),
    "bdf": ("bdf", {}),
    "ebdf": ("ebdf", {}),
    "adams": ("adams", {}),
    "irk": ("irk", {}),
    "baumgarte": ("baumgarte", {}),
    "baumgarte trapezoidal": ("baumgarte", {"scheme": "trapezoidal"}),
    "projection": ("projection", {}),
    "hht_i3": ("hht_i3", {}),
    "hht_ggl": ("hht_ggl", {}),
    "generalized_alpha": ("generalized_alpha", {}),
    "generalized_alpha index3": ("generalized_alpha", {"form": "index3"}),
}


def vibrating_pair() -> Model:
    """Two masses that fly at 1 m/s, tied by a spring on which they vibrate against each other."""
    reduced = HEAVY * LIGHT / (HEAVY + LIGHT)
    spring = SpringDamper2D(
        name="spring", a=Marker2D(body="a"), b=Marker2D(body="b"), stiffness=reduced * FREQUENCY**2,
        natural_length=LENGTH,
    )  # fmt: skip
    bodies = (
        PointMass2D(name="a", mass=HEAVY, velocity=(SPEED, 0.0)),
        PointMass2D(name="b", mass=LIGHT, position=(LENGTH + AMPLITUDE, 0.0), velocity=(SPEED, 0.0)),
    )
    return Model(name="pair", gravity=(0.0, 0.0), bodies=bodies, forces=(spring,))


@pytest.mark.parametrize("name", METHODS)
def test_a_small_fast_vibration_on_a_large_slow_motion_keeps_its_velocity(name: str) -> None:
    method, options = METHODS[name]
    found = simulate(vibrating_pair(), 0.02, method, rtol=3e-9, atol=3e-11, **options)
    relative = found["b.vx"] - found["a.vx"]
    exact = -AMPLITUDE * FREQUENCY * np.sin(FREQUENCY * found.t)
    assert np.max(np.abs(relative - exact)) < 0.15 * AMPLITUDE * FREQUENCY


def most_rejected(found: Result) -> float:
    return found.stats["rejected"] / found.stats["steps"]


@pytest.mark.parametrize("name", ["newmark", "hht", "hht_ggl", "generalized_alpha"])
def test_formulas_of_order_2_change_their_step_without_an_error_of_order_1(name: str) -> None:
    """Else every larger step is rejected: the acceleration that is carried over belongs to the step before."""
    assert most_rejected(simulate(load("pendulum").model, 3.0, name, rtol=1e-6, atol=1e-8)) < 0.1


def test_velocities_are_judged_beyond_what_the_constraints_leave_open() -> None:
    """Where dependent velocities are sensitive and one passes zero, its weight is as small as the tolerance allows."""
    assert most_rejected(simulate(load("slider_crank").model, 0.5, "newmark", rtol=1e-8, atol=1e-10)) < 0.1


@pytest.mark.parametrize("name", ["hht_i3", "generalized_alpha index3"])
def test_index_3_is_not_stopped_by_its_velocities_off_the_constraints(name: str) -> None:
    """They are off by O(h^2), more or less as the step changes: that is no error that adds up."""
    method, options = METHODS[name]
    model = load("pendulum").model
    exact = simulate(model, 1.0, "irk", rtol=1e-11, atol=1e-12)
    errors = []
    for rtol in (1e-5, 1e-7):
        found = simulate(model, 1.0, method, rtol=rtol, atol=0.01 * rtol, **options)
        errors.append(float(np.abs(found.q[-1] - exact.q[-1]).max()))
        assert most_rejected(found) < 1.0
    assert errors[1] < 0.2 * errors[0]
