"""Motion along a surface costs no steps; own gaps, which nothing bounds, are named at the start."""

import logging
from typing import ClassVar

import pytest
from helpers import G, events, on
from tlismni.core import (
    Box2D,
    ContactGroup2D,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody2D,
    RigidBody3D,
    Rope2D,
    ScalarContact2D,
    Sphere3D,
    SphereOnHalfSpace3D,
    scalar_contact,
    simulate,
)

PLASTIC = NewtonImpact(restitution=0.0)
FEW = 100
"""Steps of a motion that is a polynomial of time."""


@pytest.mark.parametrize("speed", [1.0, 100.0, 1000.0])
@pytest.mark.parametrize("method", ["ebdf", "irk", "adams"])
def test_disk_slides_far_in_few_steps(speed, method):
    body = RigidBody2D(name="b", mass=1.0, inertia=1e-3, position=(0.0, 0.05), velocity=(speed, 0.0))
    contact = DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(), disk=Disk2D(marker=on("b"), radius=0.05), law=PLASTIC
    )  # fmt: skip
    result = simulate(Model(bodies=[body], contacts=[contact]), 1.0, method)
    assert result.stats["steps"] < FEW
    assert result["b.x"][-1] == pytest.approx(speed, rel=1e-9)
    assert abs(result["b.y"][-1] - 0.05) < 1e-12


def test_sphere_slides_far_in_few_steps():
    body = RigidBody3D(name="b", mass=1.0, inertia=(1e-3,) * 3, position=(0.0, 0.0, 0.05), velocity=(60.0, 80.0, 0.0))
    contact = SphereOnHalfSpace3D(
        name="c", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="b"), radius=0.05), law=PLASTIC
    )
    result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=[contact]), 1.0)
    assert result.stats["steps"] < FEW
    assert result["b.y"][-1] == pytest.approx(80.0, rel=1e-9)


def test_box_is_braked_from_a_thousand_metres_a_second():
    """It stops after v/(mu g), v^2/(2 mu g) away."""
    speed, friction = 1000.0, 0.5
    body = RigidBody2D(name="b", mass=1.0, inertia=2e-3, position=(0.0, 0.05), velocity=(speed, 0.0))
    group = ContactGroup2D(
        name="g", boxes=[Box2D(marker=Marker2D(body="b"), width=0.1, height=0.1)], half_planes=[HalfPlane2D()],
        law=PLASTIC, friction=CoulombFriction(coefficient=friction),
    )  # fmt: skip
    result = simulate(Model(bodies=[body], groups=[group]), 250.0)
    assert result["b.x"][-1] == pytest.approx(speed**2 / (2.0 * friction * G), rel=1e-6)
    assert abs(result["b.vx"][-1]) < 1e-9
    assert result.stats["steps"] < 10 * FEW


def test_low_obstacle_is_met_after_a_long_slide():
    """A disk slides at 100 m/s against a thin post: at the time that geometry says, however large the steps."""
    body = RigidBody2D(name="b", mass=1.0, inertia=1e-3, position=(0.0, 0.05), velocity=(100.0, 0.0))
    group = ContactGroup2D(
        name="g", disks=[Disk2D(marker=on("b"), radius=0.05)],
        boxes=[Box2D(marker=Marker2D(point=(73.0, 0.05)), width=1e-3, height=0.1)], half_planes=[HalfPlane2D()],
        law=PLASTIC,
    )  # fmt: skip
    result = simulate(Model(bodies=[body], groups=[group]), 1.0)
    hits = [event for event in events(result, "impact") if event.t > 0.0]
    assert hits[0].t == pytest.approx((73.0 - 5e-4 - 0.05) / 100.0, rel=1e-9)
    assert result.stats["steps"] < FEW


def parabola(centre, radius):
    return centre.y - 0.1 * centre.x * centre.x - radius


class DiskOnParabola(ScalarContact2D):
    formula: ClassVar = scalar_contact(parabola)
    centre: Marker2D
    radius: float


def test_own_gap_is_named_at_the_start(caplog):
    body = RigidBody2D(name="b", mass=1.0, inertia=1.0, position=(0.0, 2.0))
    own = DiskOnParabola(name="dish", centre=on("b"), radius=0.1, law=PLASTIC)
    rope = Rope2D(name="rope", b=on("b"), length=9.0, law=PLASTIC)
    with caplog.at_level(logging.WARNING):
        simulate(Model(bodies=[body], contacts=[own, rope]), 0.1)
    text = "\n".join(record.getMessage() for record in caplog.records)
    assert "'dish'" in text and "max_step" in text and "'rope'" not in text


def test_no_shape_of_the_library_is_named(caplog):
    body = RigidBody2D(name="b", mass=1.0, inertia=1.0, position=(0.0, 2.0))
    rope = Rope2D(name="rope", b=on("b"), length=9.0, law=PLASTIC)
    with caplog.at_level(logging.WARNING):
        simulate(Model(bodies=[body], contacts=[rope]), 0.1)
    assert not any("max_step" in record.getMessage() for record in caplog.records)
