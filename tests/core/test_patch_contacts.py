"""Friction on a patch in contacts of other shapes, and in several at once."""

import numpy as np
import pytest
from test_patch_friction import INERTIA, MASS, MU, RADIUS, G, ball, slip, soft
from tlismni.core import (
    Axes,
    Box3D,
    CoulombFriction,
    Ellipsoid3D,
    HalfSpace3D,
    Marker3D,
    Model,
    NewtonImpact,
    PoissonImpact,
    RigidBody3D,
    SmoothOnHalfSpace3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    TurningFriction,
    contacts_between,
    simulate,
)


@pytest.mark.parametrize("contact", [{}, soft(1e-4)], ids=["constraint", "force"])
def test_other_shapes_rub_alike(contact):
    """A ball as an ellipsoid, and a ball on a box's face, whose points of contact move on them."""
    speed, spin, ends = (0.4, 0.2, 0.0), (3.0, 0.0, 25.0), []
    model = ball(speed, spin, **contact)
    (touch,) = model.contacts
    rubs = {"name": "touch", "law": touch.law, "friction": touch.friction, "turning": touch.turning}
    shapes = (
        touch,
        SmoothOnHalfSpace3D(
            plane=HalfSpace3D(), shape=Ellipsoid3D(marker=Marker3D(body="ball"), half_axes=(RADIUS,) * 3), **rubs
        ),
        *contacts_between("c", [Box3D(marker=Marker3D(point=(0.0, 0.0, -0.5)), size=(9.0, 9.0, 1.0))], [touch.sphere],
                          **{key: value for key, value in rubs.items() if key != "name"}),
    )  # fmt: skip
    for shape in shapes:
        result = simulate(model.model_copy(update={"contacts": (shape,)}), 0.08, "ebdf", rtol=1e-9, atol=1e-12)
        ends.append(slip(result))
        assert np.abs(result["energy.balance"]).max() < 1e-7
    assert ends[1] == pytest.approx(ends[0], rel=1e-6) and ends[2] == pytest.approx(ends[0], rel=1e-6)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("radius", [5e-3, 5e-2])
@pytest.mark.parametrize("seed", range(4))
def test_a_box_that_spins_on_its_corners_comes_to_rest(seed, radius):
    """Several patches at once, in impacts, sliding and at rest: energy never grows, the ledger closes."""
    random = np.random.default_rng(seed)
    body = RigidBody3D(
        name="box", mass=2.0, inertia=(0.02, 0.03, 0.04), position=(0.0, 0.0, 0.5), velocity=(0.3, 0.1, 0.0),
        attitude=Axes(z=(*random.uniform(-0.5, 0.5, 2), 1.0)), angular_velocity=tuple(random.uniform(-9.0, 9.0, 3)),
    )  # fmt: skip
    floor = contacts_between(
        "floor", [HalfSpace3D()], [Box3D(marker=Marker3D(body="box"), size=(0.4, 0.3, 0.2))],
        law=PoissonImpact(restitution=0.2, rest_ratio=1e-3), friction=CoulombFriction(coefficient=0.4),
        turning=TurningFriction(friction_radius=radius),
    )  # fmt: skip
    result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=floor), 2.0)
    total = result["energy.kinetic"] + result["energy.potential"]
    assert np.all(np.diff(total) < 1e-7 * total[0])
    assert result["energy.kinetic"][-1] < 1e-10
    assert np.abs(result["energy.balance"]).max() < 1e-6 * total[0]


def test_a_ball_between_floor_and_wall_loses_its_spin_to_both():
    """Their normals differ: each takes what spins about its own. Both blows are at one instant."""
    body = RigidBody3D(
        name="ball", mass=MASS, inertia=(INERTIA,) * 3, position=(RADIUS + 0.01, 0.0, RADIUS),
        velocity=(-0.5, 0.3, 0.0), angular_velocity=(20.0, 5.0, 30.0),
    )  # fmt: skip
    sides = [
        SphereOnHalfSpace3D(
            name=name, plane=HalfSpace3D(marker=Marker3D(attitude=Axes(z=normal))),
            sphere=Sphere3D(marker=Marker3D(body="ball"), radius=RADIUS), law=NewtonImpact(restitution=0.0),
            friction=CoulombFriction(coefficient=MU), turning=TurningFriction(friction_radius=0.02),
        )
        for name, normal in (("floor", (0.0, 0.0, 1.0)), ("wall", (1.0, 0.0, 0.0)))
    ]  # fmt: skip
    gravity = (-0.3 * G, 0.0, -G)
    result = simulate(Model(gravity=gravity, bodies=[body], contacts=sides), 4.0, rtol=1e-8, atol=1e-11)
    total = result["energy.kinetic"] + result["energy.potential"]
    assert np.all(np.diff(total) < 1e-8)
    assert result["energy.kinetic"][-1] < 1e-12
    assert np.abs(result["energy.balance"]).max() < 1e-7
