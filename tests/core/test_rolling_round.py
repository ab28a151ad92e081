"""Balls that roll round on round shapes, by more than a whole turn of the normal: no place where tangents end."""

import numpy as np
import pytest
from tlismni.core import (
    CoulombFriction,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Simulation,
    Sphere3D,
    SphereInSphere3D,
    SphereOnSphere3D,
    SpringDamper3D,
)

RADIUS, LARGE, SPEED = 0.1, 1.0, 8.0
HOW = {"law": NewtonImpact(restitution=0.0), "friction": CoulombFriction(coefficient=2.0)}


def rolling(direction, inside):
    """A ball that rolls without gravity round in a hollow sphere, or round on a sphere to which a spring pulls it, from
    the lowest point into this horizontal direction; and the radius of its circle."""
    ahead = np.array([np.cos(direction), np.sin(direction), 0.0])
    side = -1.0 if inside else 1.0
    circle = LARGE + side * RADIUS
    # no slip: v + w x (arm to the point that touches) = 0, that arm being side RADIUS along z
    spin = -side * SPEED / RADIUS * np.cross([0.0, 0.0, 1.0], ahead)
    ball = RigidBody3D(
        name="ball", mass=1.0, inertia=(0.4 * RADIUS**2,) * 3, position=(0.0, 0.0, -circle),
        velocity=tuple(SPEED * ahead), angular_velocity=tuple(spin),
    )  # fmt: skip
    small, large = Sphere3D(marker=Marker3D(body="ball"), radius=RADIUS), Sphere3D(marker=Marker3D(), radius=LARGE)
    if inside:
        contact = SphereInSphere3D(name="c", hollow=large, sphere=small, **HOW)
        return Model(gravity=(0.0, 0.0, 0.0), bodies=[ball], contacts=[contact]), circle
    spring = SpringDamper3D(name="pull", a=Marker3D(), b=Marker3D(body="ball"), natural_length=0.0, stiffness=100.0)
    contact = SphereOnSphere3D(name="c", a=large, b=small, **HOW)
    return Model(gravity=(0.0, 0.0, 0.0), bodies=[ball], forces=[spring], contacts=[contact]), circle


@pytest.mark.sampled(5)
@pytest.mark.parametrize("inside", [True, False], ids=["in a hollow sphere", "on a sphere"])
@pytest.mark.parametrize("direction", [0.0, 0.5, 0.5 * np.pi, 2.0, 4.0])
@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_a_ball_rolls_round_and_round(method, direction, inside):
    model, circle = rolling(direction, inside)
    sim = Simulation(model, method, rtol=1e-9)
    index = {c.name: k for k, c in enumerate(sim.channels)}
    ahead = np.array([np.cos(direction), np.sin(direction), 0.0])
    for t in np.linspace(0.0, 1.5, 7)[1:]:
        sim.advance(float(t))
        values, angle = sim.values(), SPEED / circle * float(t)
        found = np.array([values[index[f"ball.{x}"]] for x in "xyz"])
        exact = circle * (np.sin(angle) * ahead - np.cos(angle) * np.array([0.0, 0.0, 1.0]))
        np.testing.assert_allclose(found, exact, atol=2e-6 * circle)
        assert values[index["c.mode"]] == 1.0  # it sticks
        assert abs(values[index["energy.balance"]]) < 1e-5 * 0.5 * SPEED**2
        assert values[index["residual.position"]] < 1e-10
    assert SPEED / circle * 1.5 > 2.0 * np.pi
