"""Planar models lifted into space: the same motion, with four more rows a hinge."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Distance2D,
    Distance3D,
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
    simulate,
)
from tlismni.models import load


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
    planar = [] if any(isinstance(b, RigidBody3D) for b in bodies) else [_in_plane(b.name) for b in bodies]
    return Model(name=model.name, gravity=model.gravity, bodies=bodies, joints=[*joints, *planar])


def _in_plane(body):
    return PointOnPlane3D(name=f"{body}_plane", a=Marker3D(), b=Marker3D(body=body))


@pytest.mark.parametrize("method", ["ebdf", "irk", "adams"])
@pytest.mark.parametrize("name, t_end", [("pendulum", 2.0), ("four_bar", 0.5), ("chain", 1.0)])
def test_lifted_model_moves_as_the_planar_one(name, t_end, method):
    model = load(name).model if name != "chain" else load(name, links=3).model
    times = np.linspace(0.0, t_end, 9)
    rtol = {"ebdf": 1e-13, "irk": 1e-13, "adams": 1e-14}[method]
    flat, spatial = (simulate(m, t_end, method, rtol=rtol, atol=1e-15, t_eval=times) for m in (model, lifted(model)))
    for body in model.bodies:
        for axis in "xy":
            assert np.abs(flat[f"{body.name}.{axis}"] - spatial[f"{body.name}.{axis}"]).max() < 1e-10
            assert np.abs(flat[f"{body.name}.v{axis}"] - spatial[f"{body.name}.v{axis}"]).max() < 1e-9
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
