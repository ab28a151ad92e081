"""One model with everything that can be drawn."""

import math
from typing import Any

from tlismni.core import (
    AppliedForce2D,
    Cable2D,
    Constant,
    CoulombFriction,
    Disk2D,
    DiskOnCable2D,
    DiskOnHalfPlane2D,
    DiskOnLine2D,
    DiskOnSegment2D,
    Gear2D,
    HalfPlane2D,
    HuntCrossley,
    Line2D,
    Marker2D,
    MarkerOutput2D,
    MaterialPoint2D,
    Model,
    MovingFrame2D,
    NewtonImpact,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    Segment2D,
    Sine,
    SpringDamper2D,
)

HARD = NewtonImpact(restitution=0.3)
SOFT = HuntCrossley(stiffness=2e4, restitution=0.5)
RIM = [((0.65 if k % 2 else 0.5) * math.cos(k * math.pi / 4), 0.5 * math.sin(k * math.pi / 4)) for k in range(8)]


def on(body: str, x: float = 0.0, y: float = 0.0) -> Marker2D:
    return Marker2D(body=body, point=(x, y))


def at(x: float, y: float, angle: float = 0.0) -> Marker2D:
    return Marker2D(point=(x, y), angle=angle)


def disk(body: str, radius: float) -> Disk2D:
    return Disk2D(marker=on(body), radius=radius)


def kinds() -> Model:
    """Gears, a dashpot, a spring on a hand that moves, balls on a ledge, a cam and a rope, a marker that is watched."""
    ground = HalfPlane2D(marker=at(0.0, -0.6))
    bodies: list[Any] = [
        RigidBody2D(name="sun", mass=1, inertia=0.1, position=(-2, 1), angular_velocity=3),
        RigidBody2D(name="planet", mass=1, inertia=0.05, position=(-1.1, 1), angular_velocity=-6),
        PointMass2D(name="ball", mass=1, position=(0.8, 2.0)),
        PointMass2D(name="rider", mass=1, position=(2.5, 1.6)),
        PointMass2D(name="drop", mass=0.3, position=(4.4, 1.6)),
        RigidBody2D(name="cam", mass=1, inertia=0.2, position=(2.5, 0.3), angular_velocity=2.0),
        MovingFrame2D(name="hand", x=Sine(amplitude=0.3, angular_frequency=5.0), y=Constant(value=2.6)),
        RigidBody2D(name="held", mass=0.5, inertia=0.02, position=(0.0, 2.2)),
        Cable2D(
            name="rope", elements=8, length=1.6, mass_per_length=0.5, axial_stiffness=500, bending_stiffness=0.05,
            axial_damping=0.5, bending_damping=1e-3, position=(3.6, 0.8),
        ),
        MaterialPoint2D(name="left", body="rope", point=(0, 0)),
        MaterialPoint2D(name="right", body="rope", point=(1.6, 0)),
    ]  # fmt: skip
    return Model(
        name="kinds",
        bodies=bodies,
        joints=[
            Revolute2D(name="pin1", a=at(-2, 1), b=on("sun")),
            Revolute2D(name="pin2", a=at(-1.1, 1), b=on("planet")),
            Gear2D(name="gear", a=on("sun"), b=on("planet"), radius_a=0.6, radius_b=0.3),
            Revolute2D(name="pin3", a=at(2.5, 0.3), b=on("cam")),
            Revolute2D(name="pin4", a=at(3.6, 0.8), b=on("left")),
            Revolute2D(name="pin5", a=at(5.2, 0.8), b=on("right")),
        ],
        forces=[
            SpringDamper2D(
                name="spring", a=on("hand"), b=on("held", 0, 0.1), stiffness=60, damping=1, natural_length=0.2
            ),
            SpringDamper2D(
                name="dashpot", a=at(-2.6, 1.9), b=on("sun", 0, 0.5), stiffness=0, damping=1, natural_length=1
            ),
            AppliedForce2D(name="push", marker=on("held"), force_x=Sine(amplitude=3, angular_frequency=7)),
        ],
        contacts=[
            DiskOnSegment2D(
                name="ledge", segment=Segment2D(marker=at(0.2, 1.2, -0.4), length=1.4, radius=0.03),
                disk=disk("ball", 0.12), law=HARD,
            ),
            DiskOnHalfPlane2D(
                name="floor", plane=ground, disk=disk("ball", 0.12), law=HARD, friction=CoulombFriction(coefficient=0.3)
            ),
            DiskOnHalfPlane2D(name="floor2", plane=ground, disk=disk("rider", 0.1), law=HARD),
            DiskOnLine2D(
                name="profile", line=Line2D(nodes=[on("cam", *p) for p in (*RIM, RIM[0])], radius=0.02),
                disk=disk("rider", 0.1), law=SOFT,
            ),
            DiskOnCable2D(name="catch", cable="rope", thickness=0.01, disk=disk("drop", 0.08), law=SOFT),
        ],
        outputs=[MarkerOutput2D(name="tip", marker=on("held", 0.3, -0.2))],
    )  # fmt: skip
