"""End stops and ropes in space: exudyn goes the same way."""

import numpy as np
import pytest
from tlismni.core import (
    AngleStop3D,
    Axes,
    Cylindrical3D,
    Hertz,
    Marker3D,
    Model,
    Revolute3D,
    RigidBody3D,
    Rope3D,
    SlideStop3D,
    simulate,
)
from tlismni.validation import ExudynSettings, run_exudyn
from tlismni.validation.errors import NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")
AXIS = Axes(z=(0.3, 1.0, 0.2), x=(1.0, 0.0, 0.0))
MIDDLE = (0.25, 0.0, 0.0)


def pair(velocity=(0.0, 0.0, 0.0), spin=(0.0, 0.0, 0.0)):
    """Two bodies that fly and turn, side by side."""
    first = RigidBody3D(name="one", mass=2.0, inertia=(0.05, 0.08, 0.07), angular_velocity=(0.4, -0.3, 0.5))
    turn = np.array([0.4, -0.3, 0.5])
    speed = np.cross(turn, (0.5, 0.0, 0.0)) + velocity + np.cross(spin, (0.25, 0.0, 0.0))
    second = RigidBody3D(
        name="two", mass=1.0, inertia=(0.01, 0.03, 0.03), position=(0.5, 0.0, 0.0), velocity=tuple(speed),
        angular_velocity=tuple(turn + spin),
    )  # fmt: skip
    return first, second


def on_a_hinge():
    axis = np.array([0.3, 1.0, 0.2])
    axis /= np.linalg.norm(axis)
    bodies = pair(spin=6.0 * axis)
    ends = {"a": bodies[0].marker_at(MIDDLE, AXIS), "b": bodies[1].marker_at(MIDDLE, AXIS)}
    stop = AngleStop3D(name="stop", **ends, limit=0.05, law=Hertz(stiffness=2e4))
    return Model(bodies=bodies, joints=[Revolute3D(name="hinge", **ends)], contacts=[stop])


def on_a_sleeve():
    axis = np.array([0.3, 1.0, 0.2])
    axis /= np.linalg.norm(axis)
    bodies = pair(velocity=-2.0 * axis)
    ends = {"a": bodies[0].marker_at(MIDDLE, AXIS), "b": bodies[1].marker_at(MIDDLE, AXIS)}
    stop = SlideStop3D(name="stop", **ends, limit=-0.01, side="lower", law=Hertz(stiffness=1e6))
    return Model(bodies=bodies, joints=[Cylindrical3D(name="sleeve", **ends)], contacts=[stop])


def on_a_rope():
    bodies = pair(velocity=(3.0, 0.0, 0.0))
    ends = {"a": Marker3D(body="one", point=(0.1, 0.05, 0.0)), "b": Marker3D(body="two", point=(0.0, -0.02, 0.03))}
    length = float(np.linalg.norm([0.4, -0.07, 0.03])) + 0.01
    return Model(bodies=bodies, contacts=[Rope3D(name="stop", **ends, length=length, law=Hertz(stiffness=1e6))])


@pytest.mark.sampled(1)
@pytest.mark.parametrize("model", [on_a_hinge, on_a_sleeve, on_a_rope])
def test_a_blow_by_force_goes_the_same_way(model):
    given, end = model(), 0.03
    ours = simulate(given, end, "irk", 1e-10, 1e-12, t_eval=np.linspace(0.0, end, 31))
    assert [event.kind for event in ours.events] == ["close", "open"]
    coarse, fine = (run_exudyn(given, end, h, ExudynSettings(modified_newton=False)) for h in (5e-5, 2.5e-5))
    channels = [f"{name}.{axis}" for name in ("one", "two") for axis in ("x", "y", "z", "vx", "vy", "vz")]
    channels += [f"{name}.angular_velocity_{axis}" for name in ("one", "two") for axis in "xyz"]
    for channel in (*channels, "stop.gap", "stop.normal_force"):
        values = [np.interp(ours.t, r.t, r[channel]) for r in (coarse, fine)]
        limit = values[1] + (values[1] - values[0]) / 3.0
        unit = channel.split(".")[1].rstrip("xyz")
        scale = max(np.ptp(ours[other]) for other in channels if other.split(".")[1].rstrip("xyz") == unit) if (
            channel in channels
        ) else np.ptp(ours[channel])  # fmt: skip
        own = np.abs(values[1] - values[0]).max()
        assert own < 1e-2 * scale, channel
        assert np.abs(limit - ours[channel]).max() < 2.0 * own + 1e-5 * scale, channel


def test_a_stop_without_a_hinge_is_refused():
    given = on_a_hinge().model_copy(update={"joints": ()})
    with pytest.raises(NotTranslatable, match="not held together"):
        run_exudyn(given, 0.1, 1e-3)
