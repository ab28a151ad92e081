"""Planar models lifted into space: the same motion, with four more rows a hinge."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    BrownMcPheeFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    Distance2D,
    Distance3D,
    HalfPlane2D,
    HalfSpace3D,
    KelvinVoigt,
    Marker2D,
    Marker3D,
    Model,
    PointMass2D,
    PointMass3D,
    PointOnPlane3D,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    RotationVector,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)
from tlismni.models import load
from tlismni.models.laws import LAW_NAMES


def lifted(model: Model, turn: float = 0.0) -> Model:
    """The same mechanism in the xy plane of space; `turn` (rad) puts another direction into each body's z axis."""

    def marker(given: Marker2D) -> Marker3D:
        own = RotationVector(vector=(0.0, 0.0, given.angle))
        return Marker3D(body=given.body, point=(*given.point, 0.0), attitude=own)

    bodies, joints = [], []
    for body in model.bodies:
        place = {"position": (*body.position, 0.0), "velocity": (*body.velocity, 0.0)}
        if isinstance(body, PointMass2D):
            bodies.append(PointMass3D(name=body.name, mass=body.mass, **place))
            continue
        assert isinstance(body, RigidBody2D)
        bodies.append(
            RigidBody3D(
                name=body.name, mass=body.mass, inertia=(body.inertia, 0.5 * body.inertia, body.inertia), **place,
                attitude=RotationVector(vector=(0.0, 0.0, body.angle)),
                angular_velocity=(0.0, 0.0, body.angular_velocity),
            )
        )  # fmt: skip
    for joint in model.joints:
        pair = {"name": joint.name, "a": marker(joint.a), "b": marker(joint.b)}
        if isinstance(joint, Revolute2D):
            joints.append(Revolute3D(**pair))
        else:
            assert isinstance(joint, Distance2D)
            joints.append(Distance3D(**pair, length=joint.length))
    contacts = []
    for contact in model.contacts:
        assert isinstance(contact, DiskOnHalfPlane2D)
        plane, disk, turn = contact.plane.marker, contact.disk, contact.plane.marker.angle
        normal = (-math.sin(turn), math.cos(turn), 0.0)
        contacts.append(
            SphereOnHalfSpace3D(
                name=contact.name, law=contact.law, friction=contact.friction,
                plane=HalfSpace3D(
                    marker=Marker3D(body=plane.body, point=(*plane.point, 0.0), attitude=Axes(z=normal))
                ),
                sphere=Sphere3D(marker=marker(disk.marker), radius=disk.radius),
            )
        )  # fmt: skip
    planar = [] if any(isinstance(b, RigidBody3D) for b in bodies) else [_in_plane(b.name) for b in bodies]
    return Model(name=model.name, gravity=model.gravity, bodies=bodies, joints=[*joints, *planar], contacts=contacts)


def _in_plane(body):
    return PointOnPlane3D(name=f"{body}_plane", a=Marker3D(), b=Marker3D(body=body))


@pytest.mark.parametrize("method", ["ebdf", "irk", "adams"])
@pytest.mark.parametrize("name, t_end", [("pendulum", 2.0), ("four_bar", 0.5), ("chain", 1.0)])
def test_lifted_model_moves_as_the_planar_one(name, t_end, method):
    model = load(name).model if name != "chain" else load(name, links=3).model
    times = np.linspace(0.0, t_end, 9)
    # error control of Adams' formulas is no finer than differences of coordinates: fixed steps go further
    settings = {"rtol": 1e-13, "atol": 1e-15}
    if method == "adams":
        settings = {"order": 8, "step": t_end / 1000, "newton_tolerance": 1e-14}
    flat, spatial = (simulate(m, t_end, method, t_eval=times, **settings) for m in (model, lifted(model)))
    for body in model.bodies:
        for axis in "xy":
            assert np.abs(flat[f"{body.name}.{axis}"] - spatial[f"{body.name}.{axis}"]).max() < 1e-10
            speed = max(1.0, np.abs(flat.v).max())
            assert np.abs(flat[f"{body.name}.v{axis}"] - spatial[f"{body.name}.v{axis}"]).max() < 1e-10 * speed
        assert np.abs(spatial[f"{body.name}.z"]).max() < 1e-13
        if isinstance(body, RigidBody2D):
            angle = 2.0 * np.unwrap(np.arctan2(spatial[f"{body.name}.e3"], spatial[f"{body.name}.e0"]) * 2.0) / 2.0
            turned = (angle - flat[f"{body.name}.angle"] + math.pi) % (2.0 * math.pi) - math.pi
            assert np.abs(turned).max() < 1e-10


def test_redundant_rows_of_a_planar_loop_in_space_are_named():
    """Each loop of four hinges with parallel axes says three things twice."""
    model = load("four_bar", loops=1).model
    found = simulate(lifted(model), 0.1).redundant
    assert len(found) == 3 and all(row.constraint in {j.name for j in model.joints} for row in found)
    assert not simulate(model, 0.1).redundant


@pytest.mark.parametrize(
    "name, t_end, parameters",
    [
        ("bouncing_ball", 4.0, {}), ("bouncing_ball", 2.0, {"law": "gonthier"}),
        ("bouncing_ball", 2.0, {"law": "hertz"}),
        ("pendulum_stop", 4.0, {"driven": False}),
        *(("bouncing_ball", 2.0, {"law": law}) for law in LAW_NAMES if law not in ("newton", "hertz", "gonthier")),
        *(("pendulum_stop", 4.0, {"driven": False, "law": law, "stiffness": 1e5, "restitution": 0.6})
          for law in ("kelvin_voigt_gap", "lankarani_nikravesh", "flores")),
    ],
)  # fmt: skip
def test_lifted_contact_strikes_as_the_planar_one(name, t_end, parameters):
    model = load(name, **parameters).model
    times = np.linspace(0.0, t_end, 41)
    flat, spatial = (
        simulate(m, t_end, rtol=1e-13, atol=1e-15, t_eval=times) for m in (model, lifted(model))
    )  # fmt: skip
    body = model.bodies[0].name
    for axis in "xy":
        assert np.abs(flat[f"{body}.{axis}"] - spatial[f"{body}.{axis}"]).max() < 1e-10
    kinds = [[(event.kind, event.contact) for event in result.events] for result in (flat, spatial)]
    assert kinds[0] == kinds[1] and len(kinds[0]) > 3
    for one, other in zip(flat.events, spatial.events, strict=True):
        assert abs(one.t - other.t) < 1e-10
        assert abs(one.impulse - other.impulse) < 1e-9


def test_lifted_friction_of_a_force_slides_as_the_planar_one():
    """A disk with back spin on a springy floor; in space a sphere with the same moment about the axis."""
    disk = RigidBody2D(
        name="disk", mass=1.0, inertia=0.004, position=(0.0, 0.0999), velocity=(1.0, 0.0), angular_velocity=20.0
    )
    floor = DiskOnHalfPlane2D(
        name="floor", plane=HalfPlane2D(), disk=Disk2D(marker=Marker2D(body="disk"), radius=0.1),
        law=KelvinVoigt(stiffness=1e5, damping=300.0),
        friction=BrownMcPheeFriction(coefficient=0.3, static_coefficient=0.4, transition_speed=0.05),
    )  # fmt: skip
    model = Model(gravity=(0.0, -9.81), bodies=[disk], contacts=[floor])
    times = np.linspace(0.0, 1.5, 31)
    flat, spatial = (simulate(m, 1.5, rtol=1e-12, atol=1e-14, t_eval=times) for m in (model, lifted(model)))
    assert np.abs(flat["disk.x"] - spatial["disk.x"]).max() < 1e-8
    assert np.abs(flat["disk.angular_velocity"] - spatial["disk.angular_velocity_z"]).max() < 1e-7
    assert np.abs(np.abs(flat["floor.friction_force"]) - spatial["floor.friction_force"]).max() < 1e-5
    assert np.abs(np.abs(flat["floor.sliding_velocity"]) - spatial["floor.sliding_velocity"]).max() < 1e-8
    # back spin: it came back
    assert flat["disk.vx"][-1] < 0.5
