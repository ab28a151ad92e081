"""Drivers, gears, racks and screws in space: exudyn goes the same way, within the error bars of both."""

import math

import numpy as np
import pytest
from exudyn_agreement import agree
from tlismni.core import (
    AngleDriver3D,
    Axes,
    ConstantVelocity3D,
    Cylindrical3D,
    Distance3D,
    Gear3D,
    Marker3D,
    Model,
    Polynomial,
    PositionDriver3D,
    Prismatic3D,
    RackAndPinion3D,
    Revolute3D,
    RevoluteSpherical3D,
    RigidBody3D,
    RotationVector,
    Screw3D,
    SpringDamper3D,
    simulate,
)
from tlismni.validation import ExudynSettings, run_exudyn
from tlismni.validation.errors import NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")
TILT = RotationVector(vector=(0.4, -0.7, 0.0))
AXIS = Axes(z=(0.3, 1.0, 0.2), x=(1.0, 0.0, 0.0))
SPEED = (0.4, 0.3, 0.5)
SPIN = np.array([0.4, -0.3, 0.5])
MIDDLE = np.array([0.3, 0.05, -0.1])


def pair(along: float = 0.0, about: float = 0.0) -> tuple[tuple[RigidBody3D, RigidBody3D], dict[str, Marker3D]]:
    """Two bodies that fly and turn, the second also along (m/s) and about (rad/s) an axis; its markers on both."""
    axis = np.array([0.3, 1.0, 0.2]) / np.linalg.norm([0.3, 1.0, 0.2])
    place, spin = np.array([0.6, 0.0, 0.0]), SPIN + about * axis
    velocity = np.array(SPEED) + np.cross(SPIN, MIDDLE) + along * axis + np.cross(spin, place - MIDDLE)
    first = RigidBody3D(name="one", mass=2.0, inertia=(0.05, 0.08, 0.07), velocity=SPEED, angular_velocity=tuple(SPIN))
    second = RigidBody3D(
        name="two", mass=1.0, inertia=(0.01, 0.03, 0.025), position=tuple(place), velocity=tuple(velocity),
        angular_velocity=tuple(spin),
    )  # fmt: skip
    point = tuple(MIDDLE)
    return (first, second), {"a": first.marker_at(point, AXIS), "b": second.marker_at(point, AXIS)}


MOTION = [f"{body}.{axis}" for body in ("one", "two") for axis in "xyz"]


def test_a_driver_turns_a_hinge_between_bodies_that_fly() -> None:
    """Through a whole turn and more."""
    bodies, at = pair(about=5.0)
    driver = AngleDriver3D(name="driver", **at, angle=Polynomial(coefficients=(0.0, 5.0, 10.0)))
    model = Model(bodies=bodies, joints=[Revolute3D(name="hinge", **at), driver])
    agree(model, (*MOTION, "hinge.angle", "one.angular_velocity_x"), 0.6, 3e-3)


def test_a_driver_moves_a_slider_between_bodies_that_fly() -> None:
    bodies, at = pair(along=0.5)
    driver = PositionDriver3D(name="driver", **at, position=Polynomial(coefficients=(0.0, 0.5, 1.0)))
    model = Model(bodies=bodies, joints=[Prismatic3D(name="slider", **at), driver])
    agree(model, (*MOTION, "slider.position", "one.angular_velocity_x"), 0.5, 2.5e-3)


def test_a_screw_between_bodies_that_fly() -> None:
    bodies, at = pair(along=0.12 * 9.0 / (2.0 * math.pi), about=9.0)
    pull = SpringDamper3D(
        name="pull", a=Marker3D(body="one"), b=Marker3D(body="two", point=(0.1, 0.0, 0.0)), stiffness=50.0,
        natural_length=0.4,
    )  # fmt: skip
    joints = [Cylindrical3D(name="sleeve", **at), Screw3D(name="screw", **at, lead=0.12)]
    model = Model(bodies=bodies, joints=joints, forces=[pull])
    agree(model, (*MOTION, "sleeve.angle", "screw.angle", "screw.position"), 0.5, 2.5e-3)


def test_a_rod_that_is_driven_between_bodies_that_fly() -> None:
    bodies, _ = pair(along=0.3, about=1.0)
    at = {"a": Marker3D(body="one", point=(0.1, 0.05, 0.0)), "b": Marker3D(body="two", point=(0.0, -0.02, 0.03))}
    ends = [np.array(body.position) + at[k].point for body, k in zip(bodies, "ab", strict=True)]
    way = ends[1] - ends[0]
    length = float(np.linalg.norm(way))
    speeds = [
        np.array(body.velocity) + np.cross(body.angular_velocity, at[k].point)
        for body, k in zip(bodies, "ab", strict=True)
    ]
    rate = float(way @ (speeds[1] - speeds[0])) / length
    rod = Distance3D(name="rod", **at, length=Polynomial(coefficients=(length, rate, 2.0)))
    agree(Model(bodies=bodies, joints=[rod]), (*MOTION, "two.angular_velocity_y"), 0.5, 2.5e-3)


def test_a_rod_with_a_hinge_at_one_end() -> None:
    """Its foot turns about a vertical axis; a weight hangs from its ball joint."""
    base = RigidBody3D(name="base", mass=3.0, inertia=(0.1, 0.1, 0.08), angular_velocity=(0.0, 0.0, 4.0))
    weight = RigidBody3D(
        name="weight", mass=1.0, inertia=(0.01, 0.02, 0.03), position=(0.6, 0.0, 0.0), velocity=(0.0, 2.4, 0.0),
        angular_velocity=(1.0, 2.0, 0.0),
    )  # fmt: skip
    foot = Axes(z=(0.0, 1.0, 0.0), x=(1.0, 0.0, 0.0))
    joints = [
        Revolute3D(name="column", a=Marker3D(), b=Marker3D(body="base")),
        RevoluteSpherical3D(
            name="rod",
            a=Marker3D(body="base", point=(0.1, 0.0, 0.0), attitude=foot),
            b=Marker3D(body="weight"),
            length=0.5,
        ),
    ]
    model = Model(bodies=[base, weight], joints=joints, gravity=(0.0, 0.0, -9.81))
    agree(model, ("column.angle", "weight.x", "weight.y", "weight.z"), 0.5, 2.5e-3)


def test_a_homokinetic_joint_that_bends() -> None:
    bodies = (
        RigidBody3D(name="one", mass=1.0, inertia=(0.02, 0.02, 0.03), angular_velocity=(0.0, 0.0, 20.0)),
        RigidBody3D(
            name="two", mass=1.0, inertia=(0.03, 0.04, 0.02), position=(0.0, 0.0, 0.3),
            angular_velocity=(2.0, 1.0, 20.0),
            velocity=tuple(np.cross((2.0, 1.0, 20.0), (0.0, 0.0, 0.15))),
        ),
    )  # fmt: skip
    joints = [
        Revolute3D(name="shaft", a=Marker3D(), b=Marker3D(body="one")),
        ConstantVelocity3D(
            name="joint",
            a=Marker3D(body="one", point=(0.0, 0.0, 0.15)),
            b=Marker3D(body="two", point=(0.0, 0.0, -0.15)),
        ),
    ]
    model = Model(bodies=bodies, joints=joints, gravity=(0.0, 1.0, -9.81))
    tilt = simulate(model, 0.4, "irk", 1e-8, 1e-10)
    assert max(abs(tilt["two.x"])) > 0.05
    agree(model, ("shaft.angle", "two.x", "two.y", "two.z"), 0.4, 2e-3)


def same_force(model: Model, channel: str) -> None:
    """The multiplier, from exudyn's method of index 3, after a start that is not smooth there."""
    times = np.linspace(0.2, 1.0, 17)
    ours = simulate(model, 1.0, "irk", 1e-9, 1e-11, t_eval=times)[channel]
    first, second = (run_exudyn(model, 1.0, h, ExudynSettings()) for h in (1e-3, 5e-4))
    of_step = [np.interp(times, r.t, r[channel]) for r in (first, second)]
    limit = of_step[1] + (of_step[1] - of_step[0]) / 3.0
    assert np.abs(ours).max() > 0.5
    assert np.abs(limit - ours).max() < 1e-5 * np.abs(ours).max()


def bevel() -> Model:
    """Two wheels on the ground with axes across each other, one of which carries a weight beside its axis."""
    first, second = Axes(z=(0.0, 0.0, 1.0)), Axes(z=(1.0, 0.0, 0.0))
    wheels = [
        RigidBody3D(name="small", mass=1.0, inertia=(0.02, 0.02, 0.03), attitude=first),
        RigidBody3D(name="large", mass=2.0, inertia=(0.1, 0.1, 0.2), position=(0.5, 0.2, 0.0), attitude=TILT),
    ]
    frames = Marker3D(attitude=first), Marker3D(point=(0.5, 0.0, 0.0), attitude=second)
    on = wheels[0].marker_at((0.0, 0.0, 0.0), first), wheels[1].marker_at((0.5, 0.0, 0.0), second)
    return Model(
        bodies=wheels, gravity=(0.0, 0.0, -9.81),
        joints=[
            Revolute3D(name="hinge_a", a=frames[0], b=on[0]),
            Revolute3D(name="hinge_b", a=frames[1], b=on[1]),
            Gear3D(
                name="gear", frame_a=frames[0], wheel_a=on[0], frame_b=frames[1], wheel_b=on[1], radius_a=0.1,
                radius_b=0.25,
            ),
        ],
    )  # fmt: skip


def test_bevel_gears_and_the_force_between_their_teeth() -> None:
    model = bevel()
    agree(model, ("hinge_a.angle", "hinge_b.angle", "large.z"), 1.0, 2.5e-3)
    same_force(model, "gear.tooth_force")


def test_a_rack_on_a_wheel() -> None:
    wheel = RigidBody3D(name="wheel", mass=1.0, inertia=(0.02, 0.02, 0.03), attitude=TILT)
    rack = RigidBody3D(name="rack", mass=0.5, inertia=(0.02, 0.02, 0.03), position=(0.0, 0.3, 0.1))
    along = Axes(z=(0.2, 0.0, -1.0), x=(1.0, 0.0, 0.2))
    frame, guide = Marker3D(attitude=TILT), Marker3D(point=(0.0, 0.3, 0.1), attitude=along)
    on = wheel.marker_at((0.0, 0.0, 0.0), TILT), rack.marker_at((0.0, 0.3, 0.1), along)
    joints = [
        Revolute3D(name="hinge", a=frame, b=on[0]),
        Prismatic3D(name="slider", a=guide, b=on[1]),
        RackAndPinion3D(name="mesh", frame=frame, wheel=on[0], guide=guide, rack=on[1], radius=0.15),
    ]
    model = Model(bodies=[wheel, rack], joints=joints, gravity=(0.0, 0.0, -9.81))
    agree(model, ("hinge.angle", "slider.position", "rack.x"), 1.0, 5e-3)
    same_force(model, "mesh.tooth_force")


def test_gears_on_a_carrier_that_moves_are_refused() -> None:
    carrier = RigidBody3D(name="carrier", mass=1.0, inertia=(0.1, 0.1, 0.1))
    wheels = [
        RigidBody3D(name=f"wheel{k}", mass=1.0, inertia=(0.1, 0.1, 0.1), position=(0.3 * k, 0.0, 0.0)) for k in range(2)
    ]
    frames = [Marker3D(body="carrier", point=(0.3 * k, 0.0, 0.0)) for k in range(2)]
    on = [Marker3D(body=f"wheel{k}") for k in range(2)]
    joints = [
        Revolute3D(name="shaft", a=Marker3D(), b=Marker3D(body="carrier")),
        *(Revolute3D(name=f"hinge{k}", a=frames[k], b=on[k]) for k in range(2)),
        Gear3D(
            name="gear", frame_a=frames[0], wheel_a=on[0], frame_b=frames[1], wheel_b=on[1], radius_a=0.1, radius_b=0.2
        ),
    ]
    with pytest.raises(NotTranslatable, match=r"'gear' acts on 3"):
        run_exudyn(Model(bodies=[carrier, *wheels], joints=joints), 0.1, 1e-2)
