"""Contacts of spheres in space, with friction against a velocity of two components: exudyn goes the same way."""

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    BrownMcPheeFriction,
    CoulombFriction,
    HalfSpace3D,
    Hertz,
    HuntCrossley,
    LuGreFriction,
    Marker3D,
    Model,
    NewtonImpact,
    PointMass3D,
    RigidBody3D,
    RotationVector,
    Sphere3D,
    SphereOnHalfSpace3D,
    SphereOnSphere3D,
    TanhFriction,
    simulate,
)
from tlismni.validation import ExudynSettings, run_exudyn
from tlismni.validation.errors import NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")
SOFT = Hertz(stiffness=2e5)
RUBS = TanhFriction(coefficient=0.3, transition_speed=0.1)


def ball(name, position, velocity, spin=(0.0, 0.0, 0.0)):
    return RigidBody3D(
        name=name, mass=1.0, inertia=(0.004, 0.005, 0.006), position=position, velocity=velocity, angular_velocity=spin,
        attitude=RotationVector(vector=(0.4, -0.3, 0.2)),
    )  # fmt: skip


def sphere(name, *point):
    return Sphere3D(marker=Marker3D(body=name, point=point or (0.0, 0.0, 0.0)), radius=0.1)


def on_a_turning_board():
    """A ball with its centre of mass beside its middle on a half-space that a free body carries."""
    board = RigidBody3D(
        name="board", mass=3.0, inertia=(0.3, 0.4, 0.5), attitude=RotationVector(vector=(0.2, 0.1, 0.0)),
        angular_velocity=(0.3, -0.2, 1.0),
    )  # fmt: skip
    face = HalfSpace3D(marker=Marker3D(body="board", point=(0.0, 0.0, 0.05), attitude=Axes(z=(0.0, 0.1, 1.0))))
    contact = SphereOnHalfSpace3D(
        name="touch", plane=face, sphere=sphere("ball", 0.01, 0.02, 0.0),
        law=HuntCrossley(stiffness=2e5, restitution=0.6),
        friction=BrownMcPheeFriction(coefficient=0.3, static_coefficient=0.4, transition_speed=0.1),
    )  # fmt: skip
    thrown = ball("ball", (0.02, 0.01, 0.1415), (1.0, 0.5, -1.0), (10.0, -20.0, 5.0))
    return Model(gravity=(0.0, 0.0, -9.81), bodies=[board, thrown], contacts=[contact])


def two_balls():
    """One that spins strikes another aside of its middle."""
    pair = [
        ball("one", (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (5.0, 20.0, -30.0)),
        ball("two", (0.19, 0.055, 0.04), (0.0,) * 3),
    ]
    contact = SphereOnSphere3D(name="touch", a=sphere("one"), b=sphere("two"), law=SOFT, friction=RUBS)
    return Model(bodies=pair, contacts=[contact])


def on_a_point_mass():
    """A ball strikes a sphere whose mass is a point: no friction, and nothing that turns."""
    mass = PointMass3D(name="two", mass=0.5, position=(0.19, 0.065, 0.0))
    contact = SphereOnSphere3D(name="touch", a=sphere("one"), b=sphere("two"), law=SOFT)
    return Model(bodies=[ball("one", (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (1.0, 2.0, 3.0)), mass], contacts=[contact])


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "model, names",
    [(on_a_turning_board, ("board", "ball")), (two_balls, ("one", "two")), (on_a_point_mass, ("one", "two"))],
)
def test_a_blow_by_force_goes_the_same_way(model, names):
    given, end = model(), 0.02
    ours = simulate(given, end, "irk", 1e-10, 1e-12, t_eval=np.linspace(0.0, end, 21))
    assert [e.kind for e in ours.events].count("close") == 1 and ours["touch.normal_force"].max() > 50.0
    coarse, fine = (run_exudyn(given, end, h, ExudynSettings(modified_newton=True)) for h in (1e-4, 5e-5))
    channels = [f"{name}.{axis}" for name in names for axis in ("x", "y", "z", "vx", "vy", "vz")]
    channels += [f"{b.name}.angular_velocity_{axis}" for b in given.bodies if hasattr(b, "inertia") for axis in "xyz"]
    channels += ["touch.gap", "touch.normal_force"] + (["touch.friction_force"] if given.contacts[0].friction else [])
    moved = 0
    for channel in channels:
        values = [np.interp(ours.t, r.t, r[channel]) for r in (coarse, fine)]
        limit = values[1] + (values[1] - values[0]) / 3.0
        unit = channel.split(".")[1].rstrip("xyz")
        # figures of one kind have one scale
        scale = max(np.ptp(ours[other]) for other in channels if other.split(".")[1].rstrip("xyz") == unit)
        own = np.abs(values[1] - values[0]).max()
        assert own < 1e-3 * scale, channel
        assert np.abs(limit - ours[channel]).max() < 2.0 * own + 1e-5 * scale, channel
        moved += np.ptp(ours[channel]) > 0.05 * scale
    assert moved > 0.6 * len(channels)


@pytest.mark.parametrize("friction", [None, CoulombFriction(coefficient=0.3)])
def test_a_constraint_is_refused(friction):
    law = NewtonImpact(restitution=0.5)
    floor = SphereOnHalfSpace3D(
        name="floor", plane=HalfSpace3D(), sphere=sphere("one"), law=law, friction=friction
    )  # fmt: skip
    given = Model(bodies=[ball("one", (0.0, 0.0, 1.0), (0.0,) * 3)], contacts=[floor])
    with pytest.raises(NotTranslatable, match="contact 'floor' is a constraint"):
        run_exudyn(given, 0.1, 1e-3)


def test_bristles_are_refused():
    """Those of the plane are compared."""
    friction = LuGreFriction(coefficient=0.3, stribeck_speed=0.01, bristle_stiffness=1e4)
    floor = SphereOnHalfSpace3D(name="floor", plane=HalfSpace3D(), sphere=sphere("one"), law=SOFT, friction=friction)
    given = Model(bodies=[ball("one", (0.0, 0.0, 1.0), (0.0,) * 3)], contacts=[floor])
    with pytest.raises(NotTranslatable, match="contact 'floor' has LuGre friction in space"):
        run_exudyn(given, 0.1, 1e-3)
