"""Blocks on feet in a line and in an area, whose loads are the least weighted forces."""

import numpy as np
from tlismni.core import (
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
    Sphere3D,
    SphereOnHalfSpace3D,
)

G, MASS, HEIGHT = 9.81, 3.0, 0.3
DULL = NewtonImpact(restitution=0.0)
PLACES = (-0.3, 0.1, 0.4)
AREA = [(-0.2, -0.25), (0.2, -0.2), (-0.15, 0.2), (0.25, 0.2)]
ON_LINE = np.array([np.ones(3), PLACES])
ON_AREA = np.array([[1.0, x, y] for x, y in AREA]).T
"""Sums of forces and of their moments, of unit forces of the feet."""


def least(matrix, wanted, compliance):
    """Forces F of least sum c F^2 with matrix F = wanted."""
    root = 1.0 / np.sqrt(np.asarray(compliance, dtype=float))
    return root * np.linalg.lstsq(matrix * root, wanted, rcond=None)[0]


def line(
    compliance, order=range(3), mu=0.3, places=PLACES, law=DULL, velocity=(0.0, 0.0), forces=(),
    unit=1.0, above=0.0, **more,
):  # fmt: skip
    """A block on feet in a line; `mu`: of each foot, 0: without friction; `unit`: metres in a unit of length; `above`:
    height of its start over the ground, m, and by how much it leans there, rad."""
    body = RigidBody2D(
        name="b", mass=MASS, inertia=0.1 * unit**2, position=(0.0, (HEIGHT + above) * unit), velocity=velocity,
        angle=0.0 - above,
    )  # fmt: skip
    mu = [mu] * len(places) if np.ndim(mu) == 0 else mu
    feet = [
        DiskOnHalfPlane2D(
            name=f"f{i}", plane=HalfPlane2D(), law=law,
            disk=Disk2D(marker=Marker2D(body="b", point=(places[i] * unit, -HEIGHT * unit))),
            friction=CoulombFriction(coefficient=mu[i]) if mu[i] > 0.0 else None, compliance=compliance[i],
        )
        for i in order
    ]  # fmt: skip
    return Model(gravity=(0.0, -G * unit), bodies=[body], contacts=feet, forces=list(forces), **more)


def area(compliance, order=range(4), law=DULL, mu=0.3, **more):
    """A block on four feet; `mu`: of each, 0: without friction; `more`: of the body."""
    given = {"position": (0.0, 0.0, HEIGHT), **more}
    body = RigidBody3D(name="b", mass=MASS, inertia=(0.1, 0.1, 0.08), **given)
    feet = [
        SphereOnHalfSpace3D(
            name=f"f{i}", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="b", point=(*AREA[i], -HEIGHT))),
            law=law, friction=CoulombFriction(coefficient=mu) if mu > 0.0 else None, compliance=compliance[i],
        )
        for i in order
    ]  # fmt: skip
    return Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=feet)
