"""Random scenes as users write them: a few bodies of random shapes thrown into a trough, some of them tied."""

from typing import NamedTuple

import numpy as np
from tlismni.core import (
    Axes,
    Box2D,
    Box3D,
    Capsule3D,
    ContactGroup2D,
    ContactGroup3D,
    CoulombFriction,
    Disk2D,
    Distance2D,
    Distance3D,
    EulerParameters,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    PoissonImpact,
    RigidBody2D,
    RigidBody3D,
    Sphere3D,
)

G = 9.81
METHODS = ("ebdf", "irk", "hht", "bdf")


class ThrownScene(NamedTuple):
    """A model and the method that it is drawn for; `may_gain`: impacts by Newton's law with friction may add energy."""

    model: Model
    method: str
    may_gain: bool


def thrown_scene(seed):
    """Two to five bodies; in the plane where `seed` is even, in space where it is odd."""
    rng = np.random.default_rng(seed)
    count, friction = int(rng.integers(2, 6)), float(rng.choice([0.0, 0.1, 0.3, 0.6, 0.9]))
    restitution = float(rng.choice([0.0, 0.2, 0.5, 0.9, 1.0]))
    law = (NewtonImpact if rng.random() < 0.7 else PoissonImpact)(restitution=restitution)
    contact = {"law": law, "friction": CoulombFriction(coefficient=friction) if friction > 0.0 else None}
    model = (_planar if seed % 2 == 0 else _spatial)(rng, count, contact)
    return ThrownScene(model, METHODS[seed // 2 % len(METHODS)], isinstance(law, NewtonImpact) and friction > 0.0)


def _planar(rng, count, contact):
    bodies, disks, boxes, joints = [], [], [], []
    for i in range(count):
        place, velocity = (float(rng.uniform(-0.4, 0.4)), 0.3 + 0.45 * i), tuple(map(float, rng.uniform(-1.0, 1.0, 2)))
        kind, size, mass = (
            rng.choice(["disk", "box"]),
            float(rng.uniform(0.1, 0.2)),
            float(10.0 ** rng.uniform(-1.0, 1.0)),
        )
        angle = float(rng.uniform(-3.0, 3.0)) if rng.random() < 0.7 else 0.0
        bodies.append(
            RigidBody2D(
                name=f"b{i}", mass=mass, inertia=0.4 * mass * size**2, position=place, velocity=velocity, angle=angle,
                angular_velocity=float(rng.uniform(-5.0, 5.0)),
            )
        )  # fmt: skip
        marker = Marker2D(body=f"b{i}")
        if kind == "disk":
            disks.append(Disk2D(marker=marker, radius=size))
        else:
            boxes.append(Box2D(marker=marker, width=2.0 * size, height=1.5 * size))
    walls = [Marker2D(), *(Marker2D(point=(0.8 * side, 0.0), angle=side * np.pi / 2.0) for side in (-1.0, 1.0))]
    if rng.random() < 0.4:
        joints = [Distance2D(name="rod", a=Marker2D(body="b0"), b=Marker2D(body="b1"), length=_tie(bodies))]
    group = ContactGroup2D(
        name="g", disks=disks, boxes=boxes, half_planes=[HalfPlane2D(marker=wall) for wall in walls], **contact
    )
    return Model(bodies=bodies, joints=joints, groups=[group], gravity=(0.0, -G))


def _spatial(rng, count, contact):
    bodies, spheres, boxes, capsules, joints = [], [], [], [], []
    for i in range(count):
        place = (float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-0.3, 0.3)), 0.3 + 0.5 * i)
        velocity = tuple(map(float, rng.uniform(-1.0, 1.0, 3)))
        size, mass, kind = (
            float(rng.uniform(0.1, 0.2)),
            float(10.0 ** rng.uniform(-1.0, 1.0)),
            rng.choice(["s", "b", "c"]),
        )
        inertia, attitude = 0.4 * mass * size**2, np.array([1.0, 0.0, 0.0, 0.0])
        if rng.random() < 0.7:
            attitude = rng.normal(size=4)
        bodies.append(
            RigidBody3D(
                name=f"b{i}", mass=mass, inertia=(inertia, 1.2 * inertia, 0.9 * inertia), position=place,
                velocity=velocity, angular_velocity=tuple(map(float, rng.uniform(-5.0, 5.0, 3))),
                attitude=EulerParameters(values=tuple(map(float, attitude / np.linalg.norm(attitude)))),
            )
        )  # fmt: skip
        marker = Marker3D(body=f"b{i}")
        if kind == "s":
            spheres.append(Sphere3D(marker=marker, radius=size))
        elif kind == "b":
            sides = (2.0 * size, 1.5 * size, 1.2 * size)
            boxes.append(Box3D(marker=marker, size=sides, edge_radius=0.02 * size))
        else:
            capsules.append(Capsule3D(marker=marker, radius=0.6 * size, length=1.5 * size))
    if rng.random() < 0.4:
        joints = [Distance3D(name="rod", a=Marker3D(body="b0"), b=Marker3D(body="b1"), length=_tie(bodies))]
    walls = [
        Marker3D(point=(0.7 * side, 0.0, 0.0), attitude=Axes(z=(-side, 0.0, 0.0))) for side in (-1.0, 1.0)
    ]  # fmt: skip
    group = ContactGroup3D(
        name="g", spheres=spheres, boxes=boxes, capsules=capsules,
        half_spaces=[HalfSpace3D(), *(HalfSpace3D(marker=wall) for wall in walls)], **contact,
    )  # fmt: skip
    return Model(bodies=bodies, joints=joints, groups=[group], gravity=(0.0, 0.0, -G))


def _tie(bodies):
    """Distance of the first two bodies, which stop: a rod holds it from the start."""
    for i in range(2):
        still = {"velocity": type(bodies[i].velocity)([0.0] * len(bodies[i].velocity))}
        turn = 0.0 if isinstance(bodies[i], RigidBody2D) else (0.0, 0.0, 0.0)
        bodies[i] = bodies[i].model_copy(update={**still, "angular_velocity": turn})
    return float(np.linalg.norm(np.subtract(bodies[0].position, bodies[1].position)))
