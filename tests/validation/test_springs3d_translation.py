"""Torsion springs of space in exudyn: the closed form of a balance wheel over several turns, two bodies that fly."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Cylindrical3D,
    Marker3D,
    Model,
    Revolute3D,
    RigidBody3D,
    RotationVector,
    TorsionSpring3D,
    simulate,
)
from tlismni.validation import ExudynSettings, run_exudyn
from tlismni.validation.errors import NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")
TILT = RotationVector(vector=(0.4, -0.7, 0.0))
SETTINGS = ExudynSettings(modified_newton=False)


def test_a_balance_wheel_goes_through_several_turns() -> None:
    """From 0 towards 9 rad and beyond, about an axis that leans: J x'' = -k (x - 9) - c x'."""
    inertia, k, c, free = 0.02, 0.5, 0.01, 9.0
    on_ground, on_wheel = Marker3D(attitude=TILT), Marker3D(body="wheel")
    model = Model(
        gravity=(0.0, 0.0, 0.0),
        bodies=[RigidBody3D(name="wheel", mass=1.0, inertia=(0.015, 0.012, inertia), attitude=TILT)],
        joints=[Revolute3D(name="hinge", a=on_ground, b=on_wheel)],
        forces=[
            TorsionSpring3D(name="spring", a=on_ground, b=on_wheel, stiffness=k, damping=c, natural_angle=free),
        ],
    )
    found = run_exudyn(model, 1.0, 2e-4, SETTINGS)
    decay = 0.5 * c / inertia
    omega = math.sqrt(k / inertia - decay**2)
    t = found.t
    exact = free * (1.0 - np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t)))
    assert exact.max() > 4.0 * math.pi
    assert np.abs(found["hinge.angle"] - exact).max() < 1e-4


def test_a_spring_between_two_bodies_that_fly_follows_the_solver() -> None:
    middle = Marker3D(body="first", point=(0.5, 0.0, 0.0), attitude=TILT)
    bodies = [
        RigidBody3D(name="first", mass=2.0, inertia=(0.1, 0.3, 0.25), angular_velocity=(0.3, 0.5, -1.0)),
        RigidBody3D(
            name="second", mass=1.0, inertia=(0.05, 0.2, 0.2), position=(1.0, 0.0, 0.0),
            velocity=tuple(np.cross((0.3, 0.5, -1.0), (1.0, 0.0, 0.0))), angular_velocity=(0.3, 0.5, -1.0),
        ),
    ]  # fmt: skip
    there = bodies[1].marker_at((0.5, 0.0, 0.0), TILT)
    model = Model(
        bodies=bodies,
        joints=[Cylindrical3D(name="sleeve", a=middle, b=there)],
        forces=[TorsionSpring3D(name="spring", a=middle, b=there, stiffness=6.0, damping=0.1, natural_angle=2.0)],
    )
    ours = simulate(model, 0.8, "irk", 1e-9, 1e-11, t_eval=np.linspace(0.0, 0.8, 41))
    coarse, fine = (run_exudyn(model, 0.8, h, SETTINGS) for h in (1e-3, 5e-4))
    assert np.ptp(ours["sleeve.angle"]) > 1.0
    for channel in ("sleeve.angle", "sleeve.position", "first.x", "second.z"):
        values = [np.interp(ours.t[1:], r.t, r[channel]) for r in (coarse, fine)]
        limit = values[1] + (values[1] - values[0]) / 3.0
        scale = np.ptp(ours[channel])
        assert np.abs(limit - ours[channel][1:]).max() < 1e-4 * scale, channel


def test_a_spring_without_a_hinge_is_refused() -> None:
    at = Marker3D(body="wheel")
    model = Model(
        bodies=[RigidBody3D(name="wheel", mass=1.0, inertia=(1.0, 1.0, 1.0))],
        forces=[TorsionSpring3D(name="spring", a=Marker3D(), b=at, stiffness=1.0)],
    )
    with pytest.raises(NotTranslatable, match=r"spring.*Revolute3D"):
        run_exudyn(model, 0.1, 1e-2, SETTINGS)
    across = Revolute3D(name="hinge", a=Marker3D(attitude=TILT), b=Marker3D(body="wheel", attitude=TILT))
    with pytest.raises(NotTranslatable, match=r"spring.*Revolute3D"):
        run_exudyn(Model(**{**dict(model), "joints": [across]}), 0.1, 1e-2, SETTINGS)
