"""Reduced bodies of space in exudyn: its floating frame of reference goes the same way, free and on joints."""

import sys
from pathlib import Path

import numpy as np
import pytest
from exudyn_limits import SETTINGS, compare
from tlismni.core import (
    AppliedForce3D,
    Constant,
    Fixed3D,
    InterfaceFrame3D,
    Marker3D,
    Model,
    ReducedBody3D,
    RigidBody3D,
    RotationVector,
    Spherical3D,
    simulate,
)
from tlismni.core.model.attitude import rotation_matrix
from tlismni.validation import run_exudyn
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.translation.reduced import cloud_of

sys.path.insert(0, str(Path(__file__).parents[1] / "core"))
from reduced_bodies import moments, points_with_modes

ATTITUDE = RotationVector(vector=(0.4, 0.2, -0.3))
WEIGHT = (0.3, -0.4, -9.0)
needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")


def body(seed: int, modes: int = 3, stiff: float = 50.0, **changes: object) -> ReducedBody3D:
    fields = points_with_modes(seed, 9, modes)
    stiffness = stiff * np.array(fields["stiffness"])
    return ReducedBody3D(name="r", **{**fields, "attitude": ATTITUDE, "stiffness": stiffness.tolist(), **changes})


@pytest.mark.parametrize("seed, modes", [(0, 1), (1, 2), (2, 3), (3, 5)])
def test_the_cloud_has_the_integrals_of_the_body(seed: int, modes: int) -> None:
    record = body(seed, modes)
    each, places, shapes = cloud_of(record)
    found = moments(np.full(len(places), each), places, shapes)
    for name, value in found.items():
        wanted = np.array(getattr(record, name))
        assert np.abs(np.array(value) - wanted).max() < 1e-13 * max(1.0, np.abs(wanted).max()), name


@needs_exudyn
def test_a_body_that_flies_and_vibrates_follows_the_solver() -> None:
    damping = [[0.2, 0.05, 0.0], [0.05, 0.3, 0.0], [0.0, 0.0, 0.1]]
    flying = body(
        3, position=(0.2, -0.1, 0.4), velocity=(0.3, 0.1, -0.2), angular_velocity=(1.0, -0.6, 0.8),
        amplitudes=(0.01, -0.02, 0.015), amplitude_rates=(0.1, 0.0, -0.1), damping=damping,
    )  # fmt: skip
    tips = [InterfaceFrame3D(name=name, body="r", interface=name) for name in ("turning", "node")]
    channels = ("r.x", "r.y", "r.z", "r.e1", "r.e3", "r.mode1", "r.mode2", "r.mode3", "turning.x", "node.z", "node.vy")
    compare(Model(gravity=WEIGHT, bodies=[flying, *tips]), 0.5, channels, 1e-6)


@needs_exudyn
def test_a_body_on_joints_at_its_interfaces_follows_the_solver() -> None:
    """It hangs from the point of one interface and carries a weight on the frame of the other, which turns; turns are
    small in both descriptions, so that they agree to third order."""
    hung = body(3, stiff=2000.0)
    by_name = {place.name: np.array(place.point) for place in hung.interfaces}
    axes = rotation_matrix(np.array(hung.initial_state()[0][3:7]))
    pin, end = tuple(axes @ by_name["node"]), tuple(axes @ by_name["turning"])
    weight = RigidBody3D(name="weight", mass=0.4, inertia=(0.02, 0.03, 0.04), position=end, attitude=ATTITUDE)
    frames = [InterfaceFrame3D(name=name, body="r", interface=name) for name in ("turning", "node")]
    model = Model(
        gravity=WEIGHT,
        bodies=[hung, *frames, weight],
        joints=[
            Spherical3D(name="pin", a=Marker3D(point=pin), b=Marker3D(body="node")),
            Fixed3D(name="weld", a=Marker3D(body="turning"), b=Marker3D(body="weight")),
        ],
    )
    compare(model, 0.4, ("weight.x", "weight.y", "weight.z", "r.e1", "r.e2", "r.mode1", "r.mode3"), 1e-5)


@needs_exudyn
def test_a_load_at_an_arm_of_an_interface_follows_the_solver_for_small_turns() -> None:
    """The arm turns with the modes' rotation there, and its torque works on them: to first order exudyn's does the same
    work. What is left falls with the square of the loads; with ours the energy is balanced."""
    hung = body(3, stiff=400.0)
    axes = rotation_matrix(np.array(hung.initial_state()[0][3:7]))
    pin = tuple(axes @ next(np.array(place.point) for place in hung.interfaces if place.name == "node"))
    frames = [InterfaceFrame3D(name=name, body="r", interface=name) for name in ("turning", "node")]
    arm = Marker3D(body="turning", point=(0.3, 0.2, -0.1))
    pinned = Spherical3D(name="pin", a=Marker3D(point=pin), b=Marker3D(body="node"))
    apart = []
    for share in (1.0, 0.5):
        pull = AppliedForce3D(
            name="pull", marker=arm, force_x=Constant(value=3.0 * share), force_z=Constant(value=2.0 * share)
        )
        weight = tuple(share * x for x in WEIGHT)
        model = Model(gravity=weight, bodies=[hung, *frames], joints=[pinned], forces=[pull])
        ours = simulate(model, 0.4, "irk", 1e-10, 1e-12, t_eval=np.linspace(0.0, 0.4, 21))
        coarse, fine = (run_exudyn(model, 0.4, h, SETTINGS) for h in (4e-4, 2e-4))
        for channel in ("r.e1", "r.mode1", "turning.x"):
            values = [np.interp(ours.t[1:], r.t, r[channel]) for r in (coarse, fine)]
            limit = values[1] + (values[1] - values[0]) / 3.0
            apart.append(np.abs(limit - ours[channel][1:]).max())
            assert apart[-1] < 1e-3 * np.ptp(ours[channel]), channel
        assert np.abs(ours["energy.balance"]).max() < 1e-8
    assert np.allclose(np.array(apart[:3]) / apart[3:], 4.0, rtol=0.05)
