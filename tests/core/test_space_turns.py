"""Whole turns at the start, which Euler parameters do not tell: who says them, and that all who count turns agree."""

import math

import numpy as np
import pytest
from tlismni.core import (
    AngleDriver3D,
    AngleStop2D,
    AngleStop3D,
    Axes,
    AxisAngles,
    EulerParameters,
    Input,
    InputSignal,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    Polynomial,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    RotationVector,
    Servo3D,
    Spherical3D,
    TorsionSpring3D,
    simulate,
)
from tlismni.core.elements.start_angle3d import start_angle
from tlismni.core.model.said_angle import SaidAngle

HARD = NewtonImpact(restitution=0.5)
ENDS = {"a": Marker3D(), "b": Marker3D(body="rotor")}
TURNED = EulerParameters(values=(math.cos(1.75), 0.0, 0.0, math.sin(1.75)))
"""By 3.5 rad about z, or -2.78."""
BY_ANGLES = {
    "rotation vector": RotationVector(vector=(0.0, 0.0, 3.5)),
    "named angles": AxisAngles(sequence="zxz", angles=(3.0, 0.0, 0.5)),
}


def rotor(attitude, speed=1.0, joints=(), **parts):
    body = RigidBody3D(
        name="rotor", mass=1.0, inertia=(1.0, 1.0, 1.0), attitude=attitude, angular_velocity=(0.0, 0.0, speed)
    )
    return Model(gravity=(0.0, 0.0, 0.0), bodies=[body], joints=joints, **parts)


def hinge(**fields):
    return Revolute3D(name="hinge", **{**ENDS, **fields})


def stop(limit=4.0, **fields):
    return AngleStop3D(name="stop", **{**ENDS, **fields}, limit=limit, law=HARD)


def strikes_as_in_the_plane(model, limit=4.0):
    body = RigidBody2D(name="rotor", mass=1.0, inertia=1.0, angle=3.5, angular_velocity=1.0)
    b = Marker2D(body="rotor")
    flat = Model(
        gravity=(0.0, 0.0), bodies=[body], joints=[Revolute2D(name="hinge", a=Marker2D(), b=b)],
        contacts=[AngleStop2D(name="stop", b=b, limit=limit, law=HARD)],
    )  # fmt: skip
    one, other = (simulate(m, 2.0, t_eval=[0.0, 0.3, 1.0, 2.0], rtol=1e-9, atol=1e-12) for m in (flat, model))
    assert [e.t for e in other.events] == pytest.approx([e.t for e in one.events], abs=1e-9) and one.events
    assert other["stop.gap"] == pytest.approx(one["stop.gap"], abs=1e-9)
    return other


@pytest.mark.parametrize("attitude", BY_ANGLES.values(), ids=BY_ANGLES)
def test_angles_of_attitudes_say_it(attitude):
    result = strikes_as_in_the_plane(rotor(attitude, joints=[hinge()], contacts=[stop()]))
    assert result["hinge.angle"][0] == pytest.approx(3.5, abs=1e-12)


def test_the_joint_says_it_to_all_about_its_axis():
    joint = hinge(start_angle=3.5)
    strikes_as_in_the_plane(rotor(TURNED, joints=[joint], contacts=[stop()]))
    # of a stop with a zero of its own, and of one seen from the other body: the angle is the joint's but for the offset
    ahead = Marker3D(attitude=RotationVector(vector=(0.0, 0.0, 1.0)))
    strikes_as_in_the_plane(rotor(TURNED, joints=[joint], contacts=[stop(limit=3.0, a=ahead)]))
    seen_back = {"a": ENDS["b"], "b": ENDS["a"], "side": "lower"}
    strikes_as_in_the_plane(rotor(TURNED, joints=[joint], contacts=[stop(limit=-4.0, **seen_back)]))


def test_the_stop_says_it_to_the_joint():
    result = strikes_as_in_the_plane(rotor(TURNED, joints=[hinge()], contacts=[stop(start_angle=3.5)]))
    assert result["hinge.angle"][0] == pytest.approx(3.5, abs=1e-12)


@pytest.mark.parametrize("turns", [-1, 0, 3])
def test_a_driver_says_it(turns):
    start = 3.5 + 2.0 * math.pi * turns
    driver = AngleDriver3D(name="driver", **ENDS, angle=Polynomial(coefficients=(start, 1.0)))
    result = simulate(rotor(TURNED, joints=[hinge(), driver]), 2.0)
    assert result["hinge.angle"] == pytest.approx(start + result.t, abs=1e-6)


def test_an_input_that_drives_says_it():
    driver = AngleDriver3D(name="driver", **ENDS, angle=InputSignal(channel="u"))
    model = rotor(TURNED, 0.0, [hinge(), driver], inputs=[Input(name="u", unit="rad", start=3.5 + 4.0 * math.pi)])
    result = simulate(model, 0.1)
    assert result["hinge.angle"][-1] == pytest.approx(3.5 + 4.0 * math.pi, abs=1e-9)


def test_a_torsion_spring_rests_where_it_is_natural():
    spring = TorsionSpring3D(name="spring", **ENDS, stiffness=1.0, natural_angle=3.5 - 2.0 * math.pi)
    for attitude, fields, swing in ((TURNED, {}, 0.0), (TURNED, {"start_angle": 3.5}, 2.0 * math.pi)):
        result = simulate(rotor(attitude, 0.0, [hinge(**fields)], forces=[spring]), math.pi, rtol=1e-9)
        assert np.ptp(result["hinge.angle"]) == pytest.approx(2.0 * swing, abs=1e-6)


def test_a_servo_goes_to_the_turn_that_is_meant():
    servo = Servo3D(name="servo", **ENDS, target=Polynomial(coefficients=(3.5,)), gain=40.0, rate_gain=12.0)
    result = simulate(rotor(TURNED, 0.0, [hinge(start_angle=3.5 + 4.0 * math.pi)], forces=[servo]), 12.0)
    assert result["hinge.angle"][0] == pytest.approx(3.5 + 4.0 * math.pi)
    assert result["hinge.angle"][-1] == pytest.approx(3.5, abs=1e-3)


def test_what_contradicts_is_refused():
    with pytest.raises(ModelError, match=r"start_angle = 3 rad, but.*-2\.78.*0\.5 rad away: say 3\.5"):
        rotor(TURNED, joints=[hinge(start_angle=3.0)])
    both = rotor(TURNED, joints=[hinge(start_angle=3.5)], contacts=[stop(start_angle=3.5 - 2.0 * math.pi)])
    with pytest.raises(ModelError, match=r"'hinge' says.*'stop' that"):
        simulate(both, 0.1)
    body = RigidBody3D(name="rotor", mass=1.0, inertia=(1.0, 1.0, 1.0), attitude=BY_ANGLES["rotation vector"])
    ends = {"a": Marker3D(), "b": body.marker_at((0.0, 0.0, 0.0))}
    model = Model(bodies=[body], joints=[Revolute3D(name="hinge", **ends)], contacts=[stop(**ends)])
    with pytest.raises(ModelError, match=r"nobody knows which is meant: say it by `start_angle`, 0 or 6.28"):
        simulate(model, 0.1)
    said = Model(bodies=[body], joints=[Revolute3D(name="hinge", **ends, start_angle=0.0)], contacts=[stop(**ends)])
    assert simulate(said, 0.1)["stop.gap"][0] == pytest.approx(4.0)


def test_a_said_angle_is_seen_from_any_pair_about_the_axis():
    """Against markers that are turned by hand, about an axis askew."""
    axis = np.array([0.6, 0.0, 0.8])
    rng = np.random.default_rng(5)

    def at(body, angle, sign=1.0):
        x = np.array([0.0, 1.0, 0.0]) * math.cos(angle) + np.cross(axis, [0.0, 1.0, 0.0]) * math.sin(angle)
        return Marker3D(body=body, attitude=Axes(z=tuple(sign * axis), x=tuple(x)))

    for _ in range(40):
        turned, turns = rng.uniform(-3.0, 3.0), int(rng.integers(-3, 4))
        first, second, third, fourth = rng.uniform(-0.7, 0.7, 4)
        body = RigidBody3D(
            name="rotor", mass=1.0, inertia=(1.0, 1.0, 1.0), attitude=RotationVector(vector=tuple(turned * axis))
        )
        bodies, whole = {"rotor": body}, 2.0 * math.pi * turns
        said = SaidAngle(at("ground", first), at("rotor", second), turned + second - first + whole, "it")
        for sign in (1.0, -1.0):
            a, b = at("ground", third, sign), at("rotor", fourth, sign)
            expected = sign * (turned + fourth - third + whole)
            assert start_angle(a, b, bodies, [said]) == pytest.approx(expected, abs=1e-9)
            assert start_angle(b, a, bodies, [said]) == pytest.approx(-expected, abs=1e-9)
        aside = Marker3D(attitude=Axes(z=(0.0, 1.0, 0.0)))
        assert abs(start_angle(aside, at("rotor", 0.1), bodies, [said])) <= math.pi


def spinning():
    """Two hinges in a row that go round, a stop and a spring about the second, which no joint tells of."""
    outer = RigidBody3D(name="outer", mass=1.0, inertia=(1.0, 1.0, 1.0), angular_velocity=(0.0, 0.0, 5.0))
    inner = RigidBody3D(name="inner", mass=1.0, inertia=(1.0, 1.0, 1.0), angular_velocity=(0.0, 0.0, 12.0))
    ends = {"a": Marker3D(body="outer"), "b": Marker3D(body="inner")}
    joints = [
        Revolute3D(name="hinge", a=Marker3D(), b=Marker3D(body="outer"), start_angle=2.0 * math.pi),
        Spherical3D(name="ball", **ends),
    ]
    return Model(
        gravity=(0.0,) * 3, bodies=[outer, inner], joints=joints,
        contacts=[AngleStop3D(name="stop", **ends, limit=11.0, law=HARD)],
        forces=[TorsionSpring3D(name="spring", **ends, stiffness=0.02, start_angle=0.0)],
    )  # fmt: skip


@pytest.mark.parametrize("way", ["model", "start values"])
@pytest.mark.parametrize("t", [0.5, 1.3, 2.5])
def test_runs_that_go_on_know_the_turns(way, t):
    model = spinning()
    whole = simulate(model, 3.0, t_eval=[0.0, t, 3.0], rtol=1e-10, atol=1e-12)
    assert whole["hinge.angle"][1] > 2.0 * math.pi + 2.0 and whole.events
    if way == "model":
        rest = simulate(whole.model_at(t), 3.0 - t, rtol=1e-10, atol=1e-12)
    else:
        rest = simulate(model, 3.0, t0=t, start_values=whole.start_at(t), rtol=1e-10, atol=1e-12)
    assert rest["hinge.angle"][0] == pytest.approx(whole["hinge.angle"][1], abs=1e-9)
    for name in ("hinge.angle", "stop.gap", "energy.strain", "inner.angular_velocity_z"):
        assert rest[name][-1] == pytest.approx(whole[name][-1], abs=1e-6), name


def test_start_values_at_half_a_turn_do_not_flip():
    """The angle is of the turn nearest to the model's, all the way from there, or as a start value says."""
    model = rotor(RotationVector(vector=(0.0, 0.0, 0.0)), 1.0, [hinge()])
    for angle in (math.pi - 1e-13, math.pi, math.pi + 1e-13):
        place = {"rotor.e0": math.cos(0.5 * angle), "rotor.e3": math.sin(0.5 * angle), "rotor.e0_rate": -0.5,
                 "rotor.e3_rate": 0.0}  # fmt: skip
        found = simulate(model, 3.0, start_values=place)
        assert np.abs(np.diff(found["hinge.angle"])).max() < 1.0 and abs(found["hinge.angle"][0]) < 3.2
        found = simulate(model, 3.0, start_values={**place, "hinge.angle": angle + 4.0 * math.pi}, rtol=1e-9)
        assert found["hinge.angle"] == pytest.approx(angle + 4.0 * math.pi + found.t, abs=1e-6)


def test_a_driven_run_goes_on_or_starts_late():
    """The driver says the turn at the time when the run starts; what the joint says counts more."""
    driver = AngleDriver3D(name="driver", **ENDS, angle=Polynomial(coefficients=(3.5, 1.0, 2.0)))
    model = rotor(TURNED, 1.0, joints=[hinge(), driver])
    whole = simulate(model, 4.0, t_eval=[0.0, 3.0, 4.0], rtol=1e-9)
    expected = 3.5 + 4.0 + 2.0 * 16.0
    assert whole["hinge.angle"][-1] == pytest.approx(expected, abs=1e-6)
    late = whole.model_at(3.0)
    assert late.joints[0].start_angle == pytest.approx(3.5 + 3.0 + 18.0, abs=1e-6)
    unsaid = late.model_copy(update={"joints": (hinge(), driver)})
    for going_on in (late, unsaid):
        result = simulate(going_on, 4.0, t0=3.0, rtol=1e-9)
        assert result["hinge.angle"][-1] == pytest.approx(expected, abs=1e-6)
