"""A planar model with Coulomb friction lifted into space: stick and slip as in the plane, to 1e-10."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    HalfSpace3D,
    Marker3D,
    Model,
    PointMass3D,
    PointOnPlane3D,
    Polynomial,
    PositionDriver3D,
    Prismatic3D,
    RigidBody3D,
    RotationVector,
    Sphere3D,
    SphereOnHalfSpace3D,
    SpringDamper3D,
    simulate,
)
from tlismni.models import load

G = 9.81


def in_space(marker, normal=None):
    attitude = RotationVector(vector=(0.0, 0.0, marker.angle)) if normal is None else Axes(z=normal)
    return Marker3D(body=marker.body, point=(*marker.point, 0.0), attitude=attitude)


def rigid(body):
    return RigidBody3D(
        name=body.name, mass=body.mass, inertia=(body.inertia, 0.5 * body.inertia, body.inertia),
        position=(*body.position, 0.0), velocity=(*body.velocity, 0.0),
        attitude=RotationVector(vector=(0.0, 0.0, body.angle)), angular_velocity=(0.0, 0.0, body.angular_velocity),
    )  # fmt: skip


def touching(contact):
    plane = contact.plane.marker
    normal = (-math.sin(plane.angle), math.cos(plane.angle), 0.0)
    return SphereOnHalfSpace3D(
        name=contact.name, law=contact.law, friction=contact.friction,
        plane=HalfSpace3D(marker=in_space(plane, normal)), sphere=Sphere3D(marker=in_space(contact.disk.marker)),
    )  # fmt: skip


def same_events(flat, spatial, places):
    kinds = [[(event.kind, event.contact) for event in result.events] for result in (flat, spatial)]
    assert kinds[0] == kinds[1]
    for one, other in zip(flat.events, spatial.events, strict=True):
        assert one.t == pytest.approx(other.t, abs=places)
        assert one.impulse == pytest.approx(other.impulse, abs=places)
    return kinds[0]


def test_lifted_stick_slip():
    scenario = load("stick_slip")
    model = scenario.model
    (block, belt), (contact,), (spring,) = model.bodies, model.contacts, model.forces
    speed = model.joints[1].motion.coefficients[1]
    slide = {"a": Marker3D(point=(0.0, *belt.position[1:], 0.0), attitude=Axes(z=(1.0, 0.0, 0.0)))}
    slide |= {"b": Marker3D(body="belt", attitude=Axes(z=(1.0, 0.0, 0.0)))}
    lifted = Model(
        gravity=(0.0, -G, 0.0),
        bodies=[
            PointMass3D(name="block", mass=block.mass, velocity=(*block.velocity, 0.0)),
            rigid(belt),
        ],
        joints=[
            Prismatic3D(name="guide", **slide),
            PositionDriver3D(name="drive", **slide, position=Polynomial(coefficients=(0.0, speed))),
            PointOnPlane3D(name="plane", a=Marker3D(), b=Marker3D(body="block")),
        ],
        forces=[
            SpringDamper3D(
                name="spring", a=Marker3D(point=(*spring.a.point, 0.0)), b=Marker3D(body="block"),
                stiffness=spring.stiffness, damping=spring.damping, natural_length=spring.natural_length,
            )
        ],
        contacts=[touching(contact)],
    )  # fmt: skip
    times = np.linspace(0.0, scenario.t_end, 101)
    flat, spatial = (simulate(m, scenario.t_end, rtol=1e-13, atol=1e-15, t_eval=times) for m in (model, lifted))
    kinds = [kind for kind, _ in same_events(flat, spatial, 1e-10)]
    assert kinds.count("slip") >= 3 and kinds.count("stick") >= 2
    for name in ("block.x", "block.vx"):
        assert np.abs(flat[name] - spatial[name]).max() < 1e-10
