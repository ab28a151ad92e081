"""Springs, bushings, servos and friction in space: exudyn goes the same way, within the error bars of both."""

import numpy as np
import pytest
from exudyn_agreement import agree
from tlismni.core import (
    Axes,
    AxialSpring3D,
    Bushing3D,
    Cable3D,
    Cylindrical3D,
    Marker3D,
    MaterialPoint3D,
    Model,
    PIDController3D,
    Polynomial,
    Prismatic3D,
    RelativeLoad3D,
    Revolute3D,
    RevoluteFriction3D,
    RigidBody3D,
    RotationVector,
    Servo3D,
    Sine,
    SlideFriction3D,
    Spherical3D,
    SphericalFriction3D,
    SpringDamper3D,
    TableSpring3D,
)
from tlismni.validation import run_exudyn
from tlismni.validation.errors import NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")
AXIS = Axes(z=(0.3, 1.0, 0.2), x=(1.0, 0.0, 0.0))
TILT = RotationVector(vector=(0.4, -0.7, 0.2))
MIDDLE = (0.3, 0.05, -0.1)
MOTION = [f"{body}.{axis}" for body in ("one", "two") for axis in "xyz"]


def pair(along=0.0, about=0.0):
    """Two bodies that fly and turn; the second also moves (m/s) along and turns (rad/s) about an axis of the first."""
    axis = np.array([0.3, 1.0, 0.2]) / np.linalg.norm([0.3, 1.0, 0.2])
    turn = np.array([0.4, -0.3, 0.5])
    first = RigidBody3D(
        name="one", mass=2.0, inertia=(0.05, 0.08, 0.07), velocity=(0.4, 0.3, 0.5), angular_velocity=tuple(turn)
    )
    place = np.array([0.6, 0.0, 0.0])
    spin = turn + about * axis
    arm = place - MIDDLE
    velocity = np.array([0.4, 0.3, 0.5]) + np.cross(turn, MIDDLE) + along * axis + np.cross(spin, arm)
    second = RigidBody3D(
        name="two", mass=1.0, inertia=(0.01, 0.03, 0.025), position=tuple(place), velocity=tuple(velocity),
        angular_velocity=tuple(spin),
    )  # fmt: skip
    return first, second


def ends(bodies):
    return {"a": bodies[0].marker_at(MIDDLE, AXIS), "b": bodies[1].marker_at(MIDDLE, AXIS)}


@pytest.mark.sampled(1)
@needs_exudyn
@pytest.mark.parametrize(("on_ground", "coupled"), [(False, True), (True, False)])
def test_a_bushing_turns_by_more_than_a_radian(on_ground, coupled):
    bodies = pair(about=14.0)
    stiffness, damping = np.diag([900.0, 700.0, 1200.0, 3.0, 2.0, 4.0]), np.diag([3.0, 4.0, 2.0, 0.02, 0.01, 0.03])
    if coupled:
        stiffness[0, 4] = stiffness[4, 0] = 15.0
        damping[1, 2] = damping[2, 1] = 1.0
    a = Marker3D(point=MIDDLE, attitude=AXIS) if on_ground else Marker3D(body="one", point=MIDDLE, attitude=AXIS)
    there = bodies[1].marker_at((0.32, 0.03, -0.1), TILT)
    bushing = Bushing3D(
        name="bushing", a=a, b=there,
        stiffness=tuple(map(tuple, stiffness)), damping=tuple(map(tuple, damping)),
    )  # fmt: skip
    model = Model(bodies=bodies, forces=[bushing], gravity=(0.0, 0.0, -9.81))
    agree(model, (*MOTION, "two.angular_velocity_x", "two.angular_velocity_y"), 0.1, 1e-3)


@needs_exudyn
def test_an_axial_spring_in_a_slider_and_on_the_ground():
    bodies = pair(along=1.5)
    at = ends(bodies)
    springs = [
        AxialSpring3D(name="inside", **at, stiffness=300.0, damping=2.0, natural_position=0.05),
        AxialSpring3D(
            name="outside", a=Marker3D(point=(0.0, 0.1, 0.0), attitude=TILT), b=Marker3D(body="one", point=MIDDLE),
            stiffness=200.0, damping=3.0, natural_position=0.1,
        ),
    ]  # fmt: skip
    model = Model(bodies=bodies, joints=[Prismatic3D(name="slider", **at)], forces=springs)
    agree(model, (*MOTION, "slider.position"), 0.4, 2e-3)


@needs_exudyn
def test_an_axial_spring_beside_the_axis_of_a_body_that_turns():
    bodies = pair(along=1.0, about=2.0)
    spring = AxialSpring3D(
        name="spring", a=Marker3D(body="one", point=(0.1, 0.0, 0.0), attitude=TILT),
        b=Marker3D(body="two", point=(0.0, 0.1, 0.0)), stiffness=150.0, damping=2.0, natural_position=0.3,
    )  # fmt: skip
    agree(Model(bodies=bodies, forces=[spring]), MOTION, 0.2, 2e-3)


FORCES = {
    "servo of the angle": lambda at: Servo3D(
        name="f", **at, target=Sine(amplitude=4.0, angular_frequency=8.0), gain=2.0, rate_gain=0.05, largest=1.0
    ),
    "servo of a rate": lambda at: Servo3D(
        name="f", **at, measure="slide", target=Polynomial(coefficients=(0.5, 1.0)), rate_gain=20.0, of_rate=True
    ),
    "torque": lambda at: RelativeLoad3D(name="f", **at, load=Sine(amplitude=0.3, angular_frequency=9.0)),
    "thrust": lambda at: RelativeLoad3D(name="f", **at, measure="slide", load=Polynomial(coefficients=(2.0, 3.0))),
    "table of an angle": lambda at: TableSpring3D(
        name="f", **at, measure="angle", lengths_table=(-9.0, -3.0, 0.0, 3.0, 9.0), forces=(-2.0, -0.5, 0.0, 0.9, 3.0),
        damping=0.01,
    ),
    "table of a place": lambda at: TableSpring3D(
        name="f", **at, measure="slide", lengths_table=(-1.0, -0.3, 0.3, 1.0), forces=(-40.0, -9.0, 7.0, 50.0),
    ),
    "friction of a turn": lambda at: RevoluteFriction3D(name="f", **at, torque=0.1, transition_rate=1.0),
    "friction of a way": lambda at: SlideFriction3D(name="f", **at, force=2.0, transition_speed=0.3),
}  # fmt: skip


@pytest.mark.sampled(3)
@needs_exudyn
@pytest.mark.parametrize("force", FORCES)
def test_forces_on_a_sleeve(force):
    bodies = pair(along=1.0, about=9.0)
    at = ends(bodies)
    model = Model(bodies=bodies, joints=[Cylindrical3D(name="sleeve", **at)], forces=[FORCES[force](at)])
    # the angle passes half a turn, and a kink of its table, at 0.33 s
    end = 0.5 if force == "table of an angle" else 0.25
    agree(model, (*MOTION, "sleeve.angle", "sleeve.position"), end, 2.5e-3)


@needs_exudyn
def test_friction_of_a_ball_joint():
    bodies = pair(about=9.0)
    at = ends(bodies)
    rub = SphericalFriction3D(name="f", **at, torque=0.05, transition_rate=2.0)
    model = Model(bodies=bodies, joints=[Spherical3D(name="ball", **at)], forces=[rub])
    agree(model, (*MOTION, "two.angular_velocity_x", "two.angular_velocity_y"), 0.1, 2.5e-3)


def test_set_valued_friction_of_a_ball_joint_has_no_equal():
    bodies = pair(about=9.0)
    at = ends(bodies)
    rub = SphericalFriction3D(name="f", **at, torque=0.05)
    with pytest.raises(NotTranslatable, match="is set-valued"):
        run_exudyn(Model(bodies=bodies, joints=[Spherical3D(name="ball", **at)], forces=[rub]), 0.1, 1e-3)


@needs_exudyn
def test_forces_between_points():
    bodies = pair(along=1.0)
    at = {"a": Marker3D(body="one", point=(0.1, 0.05, 0.0)), "b": Marker3D(body="two", point=(0.0, -0.02, 0.03))}
    forces = [
        SpringDamper3D(
            name="driven", **at, stiffness=400.0, damping=1.0, natural_length=Sine(amplitude=0.1, angular_frequency=9.0,
                                                                                   offset=0.4),
        ),
        RelativeLoad3D(name="load", **at, measure="distance", load=Polynomial(coefficients=(3.0, 5.0))),
    ]  # fmt: skip
    agree(Model(bodies=bodies, forces=forces), MOTION, 0.2, 2e-3)


@needs_exudyn
def test_what_exudyn_has_not_is_refused():
    bodies = pair()
    at = ends(bodies)
    hinge = Revolute3D(name="hinge", **at)
    controller = PIDController3D(name="control", **at, target=Polynomial(coefficients=(1.0,)), gain=1.0)
    with pytest.raises(NotTranslatable, match=r"control.*Servo3D"):
        run_exudyn(Model(bodies=bodies, joints=[hinge], forces=[controller]), 0.1, 1e-2)


@needs_exudyn
def test_a_force_on_a_point_of_a_cable_is_refused():
    cable = Cable3D(
        name="rope", elements=2, length=1.0, mass_per_length=0.3, axial_stiffness=4e3, bending_stiffness=0.2
    )
    tip = MaterialPoint3D(name="tip", body="rope", s=1.0)
    load = RelativeLoad3D(
        name="push", a=Marker3D(point=(0.0, 0.0, 1.0)), b=Marker3D(body="tip"), measure="distance",
        load=Polynomial(coefficients=(3.0,)),
    )  # fmt: skip
    with pytest.raises(NotTranslatable, match=r"'push' is on 'tip', neither a RigidBody3D"):
        run_exudyn(Model(bodies=[cable, tip], forces=[load]), 0.1, 1e-2)
