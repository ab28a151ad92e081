"""Bodies that slide, roll and stick: models for the tests of friction, and what their closed forms need."""

import math

import numpy as np
from helpers import G, on
from tlismni.core import (
    AppliedForce2D,
    CoordinateDriver,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    Polynomial,
    RigidBody2D,
    SpringDamper2D,
)

PLASTIC = NewtonImpact(restitution=0.0)
FAR = 100.0
"""m; length of a spring that is to act along x."""


def kinds(result):
    """(kind, contact) of all events."""
    return [(event.kind, event.contact) for event in result.events]


def foot(name, body, x=0.0, y=0.0, mu=0.3, static=None, radius=0.0, plane=None, law=PLASTIC):
    """Contact of a disk (a point) of `body` with a floor, or with `plane`; mu None: without friction."""
    friction = None if mu is None else CoulombFriction(coefficient=mu, static_coefficient=static)
    return DiskOnHalfPlane2D(
        name=name, plane=plane or HalfPlane2D(), disk=Disk2D(marker=on(body, x, y), radius=radius), law=law,
        friction=friction,
    )  # fmt: skip


def slider(speed=0.0, mu=0.3, static=None, mass=2.0, push=None, angle=0.0, law=PLASTIC, **parts):
    """A point mass on a floor (or a slope of `angle`), with a force `push` (a signal) along it."""
    c, s = math.cos(angle), math.sin(angle)
    body = PointMass2D(name="b", mass=mass, velocity=(speed * c, speed * s))
    plane = HalfPlane2D(marker=Marker2D(angle=angle))
    forces = [AppliedForce2D(name="push", marker=on("b"), force_x=push)] if push is not None else []
    contact = foot("c", "b", mu=mu, static=static, plane=plane, law=law)
    return Model(bodies=[body], forces=forces, contacts=[contact], **parts)


def roller(speed=0.0, rate=0.0, factor=0.5, mu=0.3, radius=0.1, mass=2.0, law=PLASTIC, height=0.0):
    """A disk of inertia factor m R^2 on a floor, with a speed along it and an angular velocity."""
    body = RigidBody2D(
        name="b", mass=mass, inertia=factor * mass * radius**2, position=(0.0, radius + height), velocity=(speed, 0.0),
        angular_velocity=rate,
    )  # fmt: skip
    return Model(bodies=[body], contacts=[foot("c", "b", mu=mu, radius=radius, law=law)])


class Belt:
    """A block on a driven belt, held by a spring: its stick-slip cycle in closed form.

    Forces over the spring's stiffness are lengths: the spring's force is F = k (rest - x), friction mu N.
    """

    def __init__(self, belt_speed=0.3, static=0.5, mu=0.3, mass=1.5, stiffness=60.0):
        self.u, self.static, self.mu, self.mass, self.k = belt_speed, static, mu, mass, stiffness
        self.w = math.sqrt(stiffness / mass)
        self.reach, self.slide = static * mass * G / stiffness, mu * mass * G / stiffness

    def model(self, position=0.0, speed=None):
        block = PointMass2D(
            name="b", mass=self.mass, position=(position, 0.0), velocity=(self.u if speed is None else speed, 0.0)
        )
        belt = RigidBody2D(name="belt", mass=3.0, inertia=1.0, velocity=(self.u, 0.0))
        drive = [
            CoordinateDriver(name="drive", body="belt", coordinate="x", motion=Polynomial(coefficients=(0.0, self.u))),
            *(
                CoordinateDriver(
                    name=f"fix_{name}", body="belt", coordinate=name, motion=Polynomial(coefficients=(0.0,))
                )
                for name in ("y", "angle")
            ),
        ]
        spring = SpringDamper2D(
            name="s", a=Marker2D(point=(-FAR, 0.0)), b=on("b"), stiffness=self.k, damping=0.0, natural_length=FAR
        )
        contact = foot("c", "b", mu=self.mu, static=self.static, plane=HalfPlane2D(marker=on("belt")))
        return Model(bodies=[block, belt], joints=drive, forces=[spring], contacts=[contact])

    def times(self, count):
        """The first `count` times at which it slips, sticks, slips ... when it starts unstretched with the belt."""
        lead = self.reach - self.slide
        speed = abs(self.u)
        slip = 2.0 * (math.pi - math.atan(lead * self.w / speed)) / self.w
        stick = 2.0 * lead / speed
        t, found = self.reach / speed, []
        for i in range(count):
            found.append(t)
            t += slip if i % 2 == 0 else stick
        return np.array(found)

    def position(self, t):
        """Of the block in the first slip phase, t from its start."""
        sign, lead = math.copysign(1.0, self.u), self.reach - self.slide
        return sign * (self.slide + lead * np.cos(self.w * t)) + self.u / self.w * np.sin(self.w * t)
