"""Joints and forces in space: loads by Newton and Euler, work, turns, closed forms, and what is refused."""

import math

import numpy as np
import pytest
from tlismni.core import (
    AngleDriver3D,
    AppliedForce3D,
    AppliedTorque3D,
    Axes,
    AxialSpring3D,
    AxisAngles,
    Bushing3D,
    Constant,
    ConstantVelocity3D,
    Cylindrical3D,
    Distance3D,
    EulerParameters,
    Fixed3D,
    Gear3D,
    Input,
    InputSignal,
    Marker3D,
    MarkerOutput3D,
    Model,
    Planar3D,
    PointMass3D,
    PointOnLine3D,
    PointOnPlane3D,
    Polynomial,
    PositionDriver3D,
    Prismatic3D,
    RackAndPinion3D,
    Revolute3D,
    RevoluteSpherical3D,
    RigidBody3D,
    RotationVector,
    Screw3D,
    Simulation,
    Sine,
    Spherical3D,
    SpringDamper3D,
    TorsionSpring3D,
    Universal3D,
    simulate,
)
from tlismni.core.model.attitude import rotation_matrix

GRAVITY = (0.7, -0.4, -9.81)
BODY = RigidBody3D(
    name="body", mass=1.7, inertia=(0.4, 0.5, 0.7), inertia_products=(0.05, -0.08, 0.1), position=(0.4, -0.3, 0.5),
    attitude=RotationVector(vector=(0.4, -0.7, 0.3)),
)  # fmt: skip
PLACE = (0.1, 0.2, 0.3)
TURN = AxisAngles(sequence="zxz", angles=(0.3, 0.8, -0.4))
JOINTS = {
    "spherical": (Spherical3D, {}),
    "revolute": (Revolute3D, {}),
    "universal": (Universal3D, {}),
    "constant velocity": (ConstantVelocity3D, {}),
    "cylindrical": (Cylindrical3D, {}),
    "prismatic": (Prismatic3D, {}),
    "planar": (Planar3D, {}),
    "point on line": (PointOnLine3D, {}),
    "point on plane": (PointOnPlane3D, {}),
}


def hung(kind, **fields):
    """The body on the ground by a joint whose markers coincide."""
    joint = kind(name="joint", a=Marker3D(point=PLACE, attitude=TURN), b=BODY.marker_at(PLACE, TURN), **fields)
    return Model(gravity=GRAVITY, bodies=[BODY], joints=[joint])


def vectors(result, name):
    return np.stack([result[f"{name}_{axis}"] for axis in "xyz"], axis=1)


@pytest.mark.parametrize("case", JOINTS)
def test_reported_loads_move_the_body(case):
    """m x'' = m g + F and d(J w)/dt = r x F + T, with force and torque as the channels give them."""
    kind, fields = JOINTS[case]
    check_loads(hung(kind, **fields))


@pytest.mark.parametrize(
    "joint",
    [
        Distance3D(name="joint", a=Marker3D(), b=Marker3D(body="body", point=(0.2, 0.1, 0.0)), length=1.0),
        RevoluteSpherical3D(name="joint", a=Marker3D(attitude=TURN), b=Marker3D(body="body"), length=1.0),
    ],
)
def test_reported_loads_of_rods(joint):
    # the point of b is put where the rod allows it
    target = np.array(rotation_matrix(TURN.parameters())[:, 0])
    arm = rotation_matrix(BODY.attitude.parameters()) @ np.array(joint.b.point)
    place = tuple((target - arm).tolist())
    check_loads(Model(gravity=GRAVITY, bodies=[BODY.model_copy(update={"position": place})], joints=[joint]))


def check_loads(model):
    result = simulate(model, 0.6, "irk", rtol=1e-10, atol=1e-12)
    joint = model.joints[0]
    axes = rotation_matrix(joint.a.attitude.parameters())
    force, torque = (vectors(result, f"joint.{what}") @ axes.T for what in ("force", "torque"))
    assert np.abs(BODY.mass * (result.a[:, :3] - GRAVITY) - force).max() < 1e-9 * BODY.mass * 10.0
    inertia = BODY.inertia_tensor()
    spin, growth = vectors(result, "body.angular_velocity"), vectors(result, "body.angular_acceleration")
    for k, q in enumerate(result.q):
        turn = rotation_matrix(q[3:7])
        in_space = turn @ inertia @ turn.T
        moment = in_space @ growth[k] + np.cross(spin[k], in_space @ spin[k])
        arm = turn @ np.array(joint.b.point)
        assert np.abs(moment - torque[k] - np.cross(arm, force[k])).max() < 1e-8
    assert np.abs(result["energy.balance"]).max() < 1e-7
    assert result["residual.position"].max() < 1e-12 and result["residual.velocity"].max() < 1e-12


def test_weld_carries_the_weight():
    result = simulate(hung(Fixed3D), 0.2)
    axes = rotation_matrix(TURN.parameters())
    weight = -BODY.mass * np.array(GRAVITY)
    assert vectors(result, "joint.force")[-1] @ axes.T == pytest.approx(weight, abs=1e-10)
    arm = np.array(BODY.position) - PLACE
    assert vectors(result, "joint.torque")[-1] @ axes.T == pytest.approx(np.cross(arm, weight), abs=1e-10)


def spun(speed, *more, inertia=0.5):
    """A body on a hinge along x through its centre, spinning."""
    body = RigidBody3D(name="rotor", mass=2.0, inertia=(inertia, 0.4, 0.3), angular_velocity=(speed, 0.0, 0.0))
    along = Axes(z=(1.0, 0.0, 0.0))
    hinge = Revolute3D(name="hinge", a=Marker3D(attitude=along), b=Marker3D(body="rotor", attitude=along))
    extra = [kind(name=name, a=hinge.a, b=hinge.b, **fields) for name, kind, fields in more]
    joints = [hinge, *(e for e in extra if not isinstance(e, TorsionSpring3D))]
    return Model(gravity=(0.0, 0.0, 0.0), bodies=[body], joints=joints, forces=[e for e in extra if e not in joints])


def test_angle_counts_turns():
    result = simulate(spun(30.0), 10.0, rtol=1e-10, t_eval=np.linspace(0.0, 10.0, 41))
    assert result["hinge.angle"] == pytest.approx(30.0 * result.t, abs=1e-5)
    assert result["hinge.angular_velocity"] == pytest.approx(30.0, abs=1e-5)


def test_torsion_spring_over_several_turns_swings_as_an_oscillator():
    stiffness, inertia, speed = 0.2, 0.5, 12.0
    rate = math.sqrt(stiffness / inertia)
    model = spun(speed, ("spring", TorsionSpring3D, {"stiffness": stiffness}), inertia=inertia)
    result = simulate(model, 12.0, "irk", rtol=1e-10, atol=1e-12, t_eval=np.linspace(0.0, 12.0, 25))
    assert result["hinge.angle"] == pytest.approx(speed / rate * np.sin(rate * result.t), abs=1e-6)
    assert np.abs(result["hinge.angle"]).max() > 2.0 * 2.0 * math.pi


def test_driven_angle_over_several_turns_and_its_work():
    motion = Polynomial(coefficients=(0.0, 0.0, 1.5))
    result = simulate(spun(0.0, ("motor", AngleDriver3D, {"angle": motion})), 4.0, t_eval=np.linspace(0.0, 4.0, 9))
    assert result["hinge.angle"] == pytest.approx(1.5 * result.t**2, abs=1e-6)
    assert result["motor.torque_z"] == pytest.approx(0.5 * 3.0, abs=1e-6)
    assert result["energy.input_work"] == pytest.approx(0.25 * (3.0 * result.t) ** 2, abs=1e-4)


def test_driven_position():
    body = PointMass3D(name="mass", mass=2.0)
    along = Axes(z=(1.0, 2.0, 2.0))
    motion = Sine(amplitude=0.3, angular_frequency=2.0)
    driver = PositionDriver3D(name="motor", a=Marker3D(attitude=along), b=Marker3D(body="mass"), position=motion)
    line = PointOnLine3D(name="line", a=Marker3D(attitude=along), b=Marker3D(body="mass"))
    start = body.model_copy(update={"velocity": (0.2, 0.4, 0.4)})
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[start], joints=[line, driver])
    result = simulate(model, 1.0, rtol=1e-9, t_eval=[0.0, 0.4, 1.0])
    assert result["mass.x"] == pytest.approx(0.1 * np.sin(2.0 * result.t), abs=1e-8)
    assert result["motor.force_z"] == pytest.approx(-2.0 * 1.2 * np.sin(2.0 * result.t), abs=1e-6)


def test_axial_spring_is_an_oscillator():
    body = RigidBody3D(name="block", mass=2.0, inertia=(1.0, 1.0, 1.0), position=(0.0, 0.3, 0.0))
    along = Axes(z=(0.0, 1.0, 0.0))
    pair = {"a": Marker3D(attitude=along), "b": Marker3D(body="block", attitude=along)}
    model = Model(
        gravity=(0.0, 0.0, -9.81), bodies=[body], joints=[Prismatic3D(name="guide", **pair)],
        forces=[AxialSpring3D(name="spring", stiffness=8.0, natural_position=0.1, **pair)],
    )  # fmt: skip
    result = simulate(model, 3.0, "irk", rtol=1e-10, atol=1e-12, t_eval=[0.0, 1.0, 3.0])
    assert result["guide.position"] == pytest.approx(0.1 + 0.2 * np.cos(2.0 * result.t), abs=1e-8)
    assert result["guide.velocity"] == pytest.approx(-0.4 * np.sin(2.0 * result.t), abs=1e-8)


def test_spring_between_two_masses_beats_about_their_centre():
    bodies = [
        PointMass3D(name="a", mass=1.0, velocity=(0.0, 0.0, 0.2)),
        PointMass3D(name="b", mass=3.0, position=(1.0, 2.0, 2.0), velocity=(0.0, 0.0, 0.2)),
    ]
    spring = SpringDamper3D(
        name="spring", a=Marker3D(body="a"), b=Marker3D(body="b"), stiffness=12.0, natural_length=2.5
    )
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=bodies, forces=[spring])
    result = simulate(model, 2.0, "irk", rtol=1e-10, atol=1e-12, t_eval=[0.0, 0.7, 2.0])
    length = np.linalg.norm(result.q[:, 3:] - result.q[:, :3], axis=1)
    assert length == pytest.approx(2.5 + 0.5 * np.cos(4.0 * result.t), abs=1e-8)


@pytest.mark.parametrize("damping", [0.0, 0.4])
def test_bushing_balances_energy_far_from_its_rest(damping):
    stiffness = np.diag([30.0, 20.0, 40.0, 25.0, 35.0, 30.0])
    stiffness[0, 4] = stiffness[4, 0] = 2.0
    bushing = Bushing3D(
        name="bushing", a=Marker3D(attitude=TURN), b=Marker3D(body="body", point=(0.1, 0.0, 0.2)),
        stiffness=tuple(map(tuple, stiffness.tolist())), damping=(damping,) * 6,
    )  # fmt: skip
    model = Model(gravity=GRAVITY, bodies=[BODY], forces=[bushing])
    result = simulate(model, 3.0, "irk", rtol=1e-10, atol=1e-12)
    assert np.abs(result["energy.balance"]).max() < 1e-7
    assert (result["energy.dissipation"][-1] > 0.1) == (damping > 0.0)


def test_bushing_turns_back_as_its_stiffness_says():
    """Small turns about one axis: an oscillator with k/J, seen from the markers' common frame."""
    body = RigidBody3D(name="body", mass=1.0, inertia=(0.5, 0.5, 0.8), attitude=RotationVector(vector=(0.0, 0.0, 1e-4)))
    bushing = Bushing3D(name="bushing", a=Marker3D(), b=Marker3D(body="body"), stiffness=(9.0, 9.0, 9.0, 1.0, 1.0, 3.2))
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[body], forces=[bushing])
    result = simulate(model, 2.0, "irk", rtol=1e-11, atol=1e-15, t_eval=[0.0, 1.0, 2.0])
    assert 2.0 * result["body.e3"] == pytest.approx(1e-4 * np.cos(2.0 * result.t), abs=1e-11)


@pytest.mark.parametrize("follower", [False, True])
def test_applied_loads_do_the_work_that_they_are_booked_with(follower):
    loads = [
        AppliedForce3D(
            name="push", marker=Marker3D(body="body", point=(0.3, 0.1, 0.0), attitude=TURN), follower=follower,
            force_x=Sine(amplitude=2.0, angular_frequency=3.0), force_z=Constant(value=1.0),
        ),
        AppliedTorque3D(
            name="turn", marker=Marker3D(body="body", attitude=TURN), follower=follower, torque_y=Constant(value=0.7)
        ),
    ]  # fmt: skip
    result = simulate(Model(gravity=GRAVITY, bodies=[BODY], forces=loads), 1.5, "irk", rtol=1e-10, atol=1e-12)
    assert np.abs(result["energy.balance"]).max() < 1e-7 and abs(result["energy.input_work"][-1]) > 0.1


def test_constant_torque_in_the_body_spins_it_up_evenly():
    body = RigidBody3D(name="body", mass=1.0, inertia=(1.0, 2.0, 1.5), attitude=RotationVector(vector=(0.3, 0.2, 0.1)))
    torque = AppliedTorque3D(name="turn", marker=Marker3D(body="body"), follower=True, torque_y=Constant(value=3.0))
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[body], forces=[torque])
    result = simulate(model, 2.0, "irk", rtol=1e-10, atol=1e-12)
    assert result["body.body_angular_velocity_y"] == pytest.approx(1.5 * result.t, abs=1e-9)


def test_constant_velocity_joint_passes_spin_on_through_a_bend():
    """Two shafts in bearings, bent by 50 degrees: the driven one turns evenly, by a universal joint it would not."""
    bend = math.radians(50.0)
    second = (math.cos(bend), math.sin(bend), 0.0)
    shafts, joints = [], []
    for name, axis in (("first", (1.0, 0.0, 0.0)), ("second", second)):
        turn = Axes(z=axis, x=(0.0, 0.0, 1.0))
        shaft = RigidBody3D(name=name, mass=1.0, inertia=(0.3, 0.3, 0.2), attitude=turn)
        shafts.append(shaft)
        joints.append(Cylindrical3D(name=f"bearing_{name}", a=Marker3D(attitude=turn), b=Marker3D(body=name)))
    pair = {"a": Marker3D(body="first"), "b": Marker3D(body="second")}
    shafts = [s.model_copy(update={"angular_velocity": (0.0, 0.0, 5.0)}) for s in shafts]
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=shafts, joints=[*joints, ConstantVelocity3D(name="joint", **pair)])
    result = simulate(model, 3.0, rtol=1e-9)
    assert result["bearing_second.angle"] == pytest.approx(result["bearing_first.angle"], abs=1e-9)
    assert result["bearing_first.angular_velocity"] == pytest.approx(5.0, abs=1e-7)


def test_motion_of_a_marker_and_its_attitude():
    """Channels against those that follow from the body's own by hand, and rates against differences."""
    marker = Marker3D(body="body", point=(0.3, -0.1, 0.2), attitude=TURN)
    outputs = [
        MarkerOutput3D(name="tip", marker=marker, attitude="matrix"),
        MarkerOutput3D(name="angles", marker=marker, attitude="zyx"),
    ]
    body = BODY.model_copy(update={"angular_velocity": (0.5, 1.0, -0.7), "velocity": (0.1, 0.2, 0.3)})
    times = 0.5 + 1e-3 * np.arange(-2, 3)
    result = simulate(
        Model(gravity=GRAVITY, bodies=[body], outputs=outputs), times[-1], "irk", rtol=1e-12, atol=1e-14, t_eval=times
    )
    place = np.stack([result[f"tip.{axis}"] for axis in "xyz"], axis=1)
    for k, q in enumerate(result.q):
        turn = rotation_matrix(q[3:])
        assert place[k] == pytest.approx(q[:3] + turn @ np.array(marker.point), abs=1e-13)
        axes = turn @ marker.axes()
        assert [[result[f"tip.axis_{i}{j}"][k] for j in "xyz"] for i in "xyz"] == pytest.approx(axes, abs=1e-13)
        again = AxisAngles(sequence="zyx", angles=tuple(result[f"angles.angle_{i}"][k] for i in (1, 2, 3)))
        assert rotation_matrix(again.parameters()) == pytest.approx(axes, abs=1e-12)
    for axis in "xyz":
        for below, above in ((f"tip.{axis}", f"tip.v{axis}"), (f"tip.v{axis}", f"tip.a{axis}")):
            x = result[below]
            slope = (x[0] - 8.0 * x[1] + 8.0 * x[3] - x[4]) / 12e-3
            assert result[above][2] == pytest.approx(slope, abs=1e-8)


def test_start_by_three_kinds_of_attitude_and_two_frames_of_angular_velocity():
    vector = (0.2, -0.5, 0.9)
    p = RotationVector(vector=vector).parameters()
    turn = rotation_matrix(p)
    w = np.array([0.3, 0.7, -0.2])
    by_body = RigidBody3D(name="b", mass=1.0, inertia=(1, 1, 1), attitude=EulerParameters(values=p), angular_velocity=w)
    by_space = RigidBody3D(
        name="b", mass=1.0, inertia=(1, 1, 1), attitude=RotationVector(vector=vector),
        angular_velocity=tuple((turn @ w).tolist()), angular_velocity_in="space",
    )  # fmt: skip
    assert by_body.initial_state()[0] == pytest.approx(by_space.initial_state()[0], abs=1e-15)
    assert by_body.initial_state()[1] == pytest.approx(by_space.initial_state()[1], abs=1e-15)


# gears, racks, screws


def wheel(name, axis, place, inertia, speed):
    turn = Axes(z=axis)
    body = RigidBody3D(
        name=name, mass=1.0, inertia=(0.8 * inertia, 0.8 * inertia, inertia), position=place, attitude=turn,
        angular_velocity=(0.0, 0.0, speed),
    )  # fmt: skip
    return body, Revolute3D(name=f"{name}_pin", a=Marker3D(point=place, attitude=turn), b=Marker3D(body=name))


def test_bevel_gears_share_a_torque_as_their_radii_say():
    """Axes across each other, over many turns: (J_a + J_b (r_a/r_b)^2) a'' = T, and the force between the teeth."""
    first, pin_a = wheel("first", (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.4, 6.0)
    second, pin_b = wheel("second", (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), 0.3, -9.0)
    gear = Gear3D(
        name="gear", frame_a=pin_a.a, wheel_a=pin_a.b, frame_b=pin_b.a, wheel_b=pin_b.b, radius_a=0.3, radius_b=0.2
    )
    torque = AppliedTorque3D(name="push", marker=Marker3D(body="first"), follower=True, torque_z=Constant(value=2.0))
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[first, second], joints=[pin_a, pin_b, gear], forces=[torque])
    result = simulate(model, 4.0, "irk", rtol=1e-10, atol=1e-12, t_eval=np.linspace(0.0, 4.0, 9))
    growth = 2.0 / (0.4 + 0.3 * 1.5**2)
    assert result["first_pin.angle"] == pytest.approx(6.0 * result.t + 0.5 * growth * result.t**2, abs=1e-7)
    assert result["second_pin.angle"] == pytest.approx(-1.5 * result["first_pin.angle"], abs=1e-9)
    assert -0.2 * result["gear.tooth_force"] == pytest.approx(0.3 * -1.5 * growth, abs=1e-7)
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_rack_falls_as_its_pinion_lets_it():
    pinion, pin = wheel("pinion", (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), 0.02, 0.0)
    rack = RigidBody3D(name="rack", mass=2.0, inertia=(1.0, 1.0, 1.0), position=(0.2, 0.0, 0.0))
    guide = Prismatic3D(name="guide", a=Marker3D(point=(0.2, 0.0, 0.0)), b=Marker3D(body="rack"))
    teeth = RackAndPinion3D(name="teeth", frame=pin.a, wheel=pin.b, guide=guide.a, rack=guide.b, radius=0.1)
    model = Model(gravity=(0.0, 0.0, -9.81), bodies=[pinion, rack], joints=[pin, guide, teeth])
    result = simulate(model, 2.0, "irk", rtol=1e-10, atol=1e-12, t_eval=[0.0, 1.0, 2.0])
    fall = 2.0 * 9.81 / (2.0 + 0.02 / 0.1**2)
    assert result["guide.position"] == pytest.approx(-0.5 * fall * result.t**2, abs=1e-8)
    assert result["pinion_pin.angle"] == pytest.approx(10.0 * result["guide.position"], abs=1e-8)


def test_nut_falls_down_its_screw():
    """Energy: m v^2/2 + J w^2/2 with v = lead w/(2 pi)."""
    nut = RigidBody3D(name="nut", mass=0.5, inertia=(0.01, 0.01, 0.015))
    pair = {"a": Marker3D(), "b": Marker3D(body="nut")}
    screw = Screw3D(name="thread", lead=0.2, **pair)
    model = Model(gravity=(0.0, 0.0, -9.81), bodies=[nut], joints=[Cylindrical3D(name="rod", **pair), screw])
    result = simulate(model, 3.0, "irk", rtol=1e-10, atol=1e-12, t_eval=[0.0, 1.0, 3.0])
    per_turn = 0.2 / (2.0 * math.pi)
    fall = 9.81 / (1.0 + 0.015 / (0.5 * per_turn**2))
    assert result["rod.position"] == pytest.approx(-0.5 * fall * result.t**2, abs=1e-8)
    assert result["rod.angle"] == pytest.approx(result["rod.position"] / per_turn, abs=1e-7)
    assert abs(result["rod.angle"][-1]) > 2.0 * 2.0 * math.pi


def test_driver_by_an_input_follows_it():
    """The angle of a motor comes from outside, with its rate: the hinge goes along at all levels."""
    body = RigidBody3D(name="rotor", mass=2.0, inertia=(0.5, 0.4, 0.3), angular_velocity=(0.0, 0.0, 1.0))
    hinge = Revolute3D(name="hinge", a=Marker3D(), b=Marker3D(body="rotor"))
    motor = AngleDriver3D(name="motor", a=hinge.a, b=hinge.b, angle=InputSignal(channel="angle", rate="speed"))
    inputs = [Input(name="angle", unit="rad"), Input(name="speed", unit="rad/s", start=1.0)]
    sim = Simulation(Model(gravity=(0.0, 0.0, 0.0), bodies=[body], joints=[hinge, motor], inputs=inputs))
    place = [channel.name for channel in sim.channels].index("hinge.angle")
    for k in range(40):
        t = 0.1 * k
        sim.set_inputs({"angle": math.sin(t), "speed": math.cos(t)})
        sim.advance(t + 0.1)
        assert abs(sim.values()[place] - math.sin(t + 0.1)) < 0.02
    residuals = [channel.name for channel in sim.channels].index("residual.position")
    assert sim.values()[residuals] < 1e-12
