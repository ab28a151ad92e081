"""Friction where drivers and joints prescribe the motion along the tangent: mu F_N against it, from the start on.

Nothing that the contact can do changes that motion, so no equation of motion says what the friction is: the law does.
"""

import numpy as np
import pytest
from tlismni.core import (
    Box2D,
    ContactGroup2D,
    CoordinateDriver,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    MovingFrame2D,
    NewtonImpact,
    PointMass2D,
    PointMass3D,
    Prismatic2D,
    RigidBody2D,
    Sine,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)

G, MU, RATE = 9.81, 0.3, 10.0
LAW, FRICTION = NewtonImpact(restitution=0.0), CoulombFriction(coefficient=MU)
TIMES = np.linspace(0.0, 1.0, 201)
SWING = Sine(amplitude=0.1, angular_frequency=RATE)
FROM_REST = Sine(amplitude=0.1, angular_frequency=RATE, phase=-0.5 * np.pi, offset=0.1)
"""Their velocities are cos(10 t) and sin(10 t), m/s."""


def drive(body, motion):
    return CoordinateDriver(name="d", body=body, coordinate="x", motion=motion)


def shoe(name="f", plane=None, body="s"):
    return DiskOnHalfPlane2D(
        name=name, plane=plane or HalfPlane2D(), disk=Disk2D(marker=Marker2D(body=body)), law=LAW, friction=FRICTION
    )


def one_foot(motion, speed):
    block = PointMass2D(name="s", mass=1.0, velocity=(speed, 0.0))
    return Model(bodies=[block], joints=[drive("s", motion)], contacts=[shoe()])


def two_feet(motion, speed):
    box = RigidBody2D(name="s", mass=1.0, inertia=1e-2, position=(0.0, 0.05), velocity=(speed, 0.0))
    group = ContactGroup2D(
        name="g",
        boxes=[Box2D(marker=Marker2D(body="s"), width=0.3, height=0.1)],
        half_planes=[HalfPlane2D()],
        law=LAW,
        friction=FRICTION,
    )
    return Model(bodies=[box], joints=[drive("s", motion)], groups=[group])


def belt_below(motion, speed):
    """The floor moves: the block, which a guide holds, slides the other way over it."""
    held = RigidBody2D(name="s", mass=1.0, inertia=1e-2)
    guide = Prismatic2D(name="p", a=Marker2D(angle=np.pi / 2), b=Marker2D(body="s", angle=np.pi / 2))
    below = shoe(plane=HalfPlane2D(marker=Marker2D(body="belt")))
    return Model(bodies=[held, MovingFrame2D(name="belt", x=motion)], joints=[guide], contacts=[below])


def in_space(motion, speed):
    block = PointMass3D(name="s", mass=1.0, velocity=(speed, 0.0, 0.0))
    foot = SphereOnHalfSpace3D(
        name="f",
        plane=HalfSpace3D(),
        sphere=Sphere3D(marker=Marker3D(body="s"), radius=0.0),
        law=LAW,
        friction=FRICTION,
    )
    return Model(gravity=(0.0, 0.0, -G), bodies=[block], joints=[drive("s", motion)], contacts=[foot])


MODELS = [one_foot, two_feet, belt_below, in_space]


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf", "adams", "hht"])
@pytest.mark.parametrize("motion", [SWING, FROM_REST], ids=["moving", "from rest"])
@pytest.mark.parametrize("make", MODELS)
def test_friction_is_against_prescribed_sliding(make, motion, method):
    speed = np.cos(RATE * TIMES) if motion is SWING else np.sin(RATE * TIMES)
    result = simulate(make(motion, speed[0]), 1.0, method=method, t_eval=TIMES)
    force = sum(result[name] for name in result.channels if name.endswith("friction_force"))
    clear = np.abs(speed) > 1e-6
    # in space the channel is the size
    sign = -np.sign(speed) if make in (one_foot, two_feet) else (np.sign(speed) if make is belt_below else 1.0)
    np.testing.assert_allclose((force * sign)[clear], MU * G, rtol=1e-8)
    lost = MU * G * np.trapezoid(np.abs(np.cos(RATE * np.linspace(0, 1, 200001))), dx=5e-6)
    if motion is FROM_REST:
        lost = MU * G * np.trapezoid(np.abs(np.sin(RATE * np.linspace(0, 1, 200001))), dx=5e-6)
    assert result["energy.dissipation"][-1] == pytest.approx(lost, rel=1e-4)
    assert not [event for event in result.events if event.kind == "stick"]
