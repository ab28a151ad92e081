"""Motions that inputs lead by positions alone: every driver, along courses and stepped from outside."""

import logging
import math

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from tlismni.core import (
    AngleDriver3D,
    Clamp2D,
    ConsistencyError,
    CoordinateDriver,
    Courses,
    Distance3D,
    Input,
    InputSignal,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    MovingFrame2D,
    PointMass2D,
    PointMass3D,
    PositionDriver3D,
    Prismatic2D,
    Prismatic3D,
    RelativeMotor2D,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    Simulation,
    simulate,
)
from tlismni.fmu_wrapper import Slave

LED, WITH_RATE = InputSignal(channel="x"), InputSignal(channel="x", rate="v")
INPUTS = (Input(name="x", unit="m"), Input(name="v", unit="m/s"))
TIGHT = {"rtol": 1e-10, "atol": 1e-12}


def coordinate(motion):
    body = PointMass2D(name="p", mass=2.0)
    return [body], [CoordinateDriver(name="d", body="p", coordinate="x", motion=motion)]


def motor(motion):
    body = RigidBody2D(name="p", mass=2.0, inertia=0.5, position=(0.3, 0.0))
    a, b = Marker2D(), Marker2D(body="p", point=(-0.3, 0.0))
    return [body], [Revolute2D(name="h", a=a, b=b), RelativeMotor2D(name="d", a=a, b=b, motion=motion)]


def slide(motion):
    body = RigidBody2D(name="p", mass=2.0, inertia=0.5)
    a, b = Marker2D(), Marker2D(body="p")
    drive = RelativeMotor2D(name="d", a=a, b=b, measure="slide", motion=motion)
    return [body], [Prismatic2D(name="h", a=a, b=b), drive]


def frame(motion):
    """A body clamped to a frame that moves along x."""
    body = RigidBody2D(name="p", mass=2.0, inertia=0.5)
    return [MovingFrame2D(name="f", x=motion), body], [
        Clamp2D(name="d", a=Marker2D(body="f"), b=Marker2D(body="p")),
    ]


def turned_frame(motion):
    body = RigidBody2D(name="p", mass=2.0, inertia=0.5, position=(0.3, 0.0))
    clamp = Clamp2D(name="d", a=Marker2D(body="f", point=(0.3, 0.0)), b=Marker2D(body="p"))
    return [MovingFrame2D(name="f", angle=motion), body], [clamp]


def angle_in_space(motion):
    body = RigidBody3D(name="p", mass=2.0, inertia=(0.1, 0.2, 0.3), position=(0.3, 0.0, 0.0))
    a, b = Marker3D(), Marker3D(body="p", point=(-0.3, 0.0, 0.0))
    return [body], [Revolute3D(name="h", a=a, b=b), AngleDriver3D(name="d", a=a, b=b, angle=motion)]


def place_in_space(motion):
    body = RigidBody3D(name="p", mass=2.0, inertia=(0.1, 0.2, 0.3))
    a, b = Marker3D(), Marker3D(body="p")
    return [body], [Prismatic3D(name="h", a=a, b=b), PositionDriver3D(name="d", a=a, b=b, position=motion)]


def position(result, case):
    """What the motion leads, and its rate."""
    if case is angle_in_space:
        x, y = result["p.x"], result["p.y"]
        return np.arctan2(y, x), (x * result["p.vy"] - y * result["p.vx"]) / (x * x + y * y)
    names = {
        coordinate: ("p.x", "p.vx"), motor: ("p.angle", "p.angular_velocity"), slide: ("p.x", "p.vx"),
        frame: ("p.x", "p.vx"), turned_frame: ("p.angle", "p.angular_velocity"), place_in_space: ("p.z", "p.vz"),
    }  # fmt: skip
    return tuple(result[name] for name in names[case])


CASES = (coordinate, motor, slide, frame, turned_frame, angle_in_space, place_in_space)
cases = pytest.mark.parametrize("case", CASES, ids=lambda case: case.__name__)


def model_of(case, motion=LED):
    bodies, joints = case(motion)
    gravity = (0.0, 0.0, 0.0) if case in (angle_in_space, place_in_space) else (0.0, 0.0)
    inputs = INPUTS if motion.rate else INPUTS[:1]
    return Model(name="led", gravity=gravity, bodies=bodies, joints=joints, inputs=inputs)


def table(seed, start=0.0, count=6):
    """Times that differ, and positions from `start` on."""
    draw = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(draw.uniform(0.05, 0.25, count - 1))])
    return times, start + np.concatenate([[0.0], np.cumsum(draw.normal(0.0, 0.1, count - 1))])


@cases
@pytest.mark.parametrize("rate", [False, True])
def test_positions_alone_lead_along_straight_lines(case, rate, caplog):
    """Also where the start's velocity does not fit, and where a channel for the rate is there but not given."""
    times, values = table(CASES.index(case), start=0.2)
    at = np.sort(np.concatenate([times, np.linspace(0.0, times[-1], 13)]))
    given = {"x": (times, values)}
    with caplog.at_level(logging.WARNING):
        result = simulate(model_of(case, WITH_RATE if rate else LED), times[-1], t_eval=at, inputs=given, **TIGHT)
    x, v = position(result, case)
    slopes = np.diff(values) / np.diff(times)
    k = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(slopes) - 1)
    np.testing.assert_allclose(x, np.interp(at, times, values), atol=1e-9)
    np.testing.assert_allclose(v, slopes[k], atol=1e-8)
    assert np.max(np.abs(result["energy.balance"])) < 1e-8
    assert sum("the velocity jumps" in record.message for record in caplog.records) == 1


@cases
@pytest.mark.parametrize("rate", [False, True])
def test_a_spline_leads_smoothly(case, rate, caplog):
    """Position, rate and the driver's work are those of scipy's spline through the same positions."""
    times, values = table(10 + CASES.index(case), start=-0.1, count=7)
    model = model_of(case, WITH_RATE if rate else LED)
    with caplog.at_level(logging.WARNING):
        result = simulate(model, times[-1], inputs=Courses(times, {"x": values}, "spline"), **TIGHT)
    x, v = position(result, case)
    exact = CubicSpline(times, values)
    np.testing.assert_allclose(x, exact(result.t), atol=1e-9)
    np.testing.assert_allclose(v, exact(result.t, 1), atol=1e-8)
    assert np.max(np.abs(result["energy.balance"])) < 1e-7
    assert not caplog.records


def test_the_acceleration_is_that_of_the_spline():
    times, values = table(3, count=8)
    for motion in (LED, WITH_RATE):
        result = simulate(
            model_of(coordinate, motion), times[-1], inputs=Courses(times, {"x": values}, "spline"), **TIGHT
        )
        exact = CubicSpline(times, values)(result.t, 2)
        np.testing.assert_allclose(result["p.ax"], exact, atol=1e-9 * np.max(np.abs(exact)))


def test_positions_with_rates_are_met_both():
    times, values = table(5)
    rates = np.random.default_rng(6).normal(0.0, 0.5, len(times))
    result = simulate(
        model_of(motor, WITH_RATE), times[-1], inputs={"x": (times, values), "v": (times, rates)}, **TIGHT
    )
    exact = CubicHermiteSpline(times, values, rates)
    x, v = position(result, motor)
    np.testing.assert_allclose(x, exact(result.t), atol=1e-9)
    np.testing.assert_allclose(v, exact(result.t, 1), atol=1e-8)


@pytest.mark.parametrize("between", ["linear", "hold"])
def test_rates_alone_lead_by_their_integral(between):
    times, rates = table(7, start=0.5)
    result = simulate(
        model_of(slide, WITH_RATE), times[-1], inputs=Courses(times, {"v": rates}, between), t_eval=times, **TIGHT
    )
    mean = 0.5 * (rates[:-1] + rates[1:]) if between == "linear" else rates[:-1]
    expected = np.concatenate([[0.0], np.cumsum(mean * np.diff(times))])
    np.testing.assert_allclose(position(result, slide)[0], expected, atol=1e-10)


@cases
def test_held_positions_are_joined_at_the_next_time(case, caplog):
    """As an FMU follows a step table: a time later, at rest there; and said once, not at each step."""
    times = np.linspace(0.0, 1.0, 6)
    values = np.array([0.1, 0.3, 0.3, -0.2, 0.1, 0.1])
    course = Courses(times, {"x": values}, "hold")
    with caplog.at_level(logging.WARNING):
        result = simulate(model_of(case), 1.2, t_eval=[*times, 1.1, 1.2], inputs=course, **TIGHT)
    x, v = position(result, case)
    np.testing.assert_allclose(x[[0, *range(2, 6), 7]], [0.1, 0.3, 0.3, -0.2, 0.1, 0.1], atol=1e-9)
    np.testing.assert_allclose(v[[*range(6), 7]], 0.0, atol=1e-8)
    assert sum("the motion is" in record.message for record in caplog.records) == 1


@cases
def test_a_slave_and_a_run_follow_the_same_steps(case, caplog):
    """A master that sets positions alone, and a course that holds them."""
    times = np.linspace(0.0, 1.0, 6)
    values = np.array([0.1, 0.3, 0.3, -0.2, 0.1, 0.1])
    slave = Slave(model_of(case), t_end=1.0, **TIGHT)
    slave.setup(stop_time=1.0)
    slave.enter_initialization()
    slave.set_by_name({"x": values[0]})
    slave.exit_initialization()
    course = Courses(times, {"x": values}, "hold")
    result = simulate(model_of(case), 1.0, t_eval=times[1:], inputs=course, **TIGHT)
    names = [c for c in result.channels if c.endswith((".x", ".y", ".z", ".vx", ".vz", ".angle", ".angular_velocity"))]
    caplog.clear()
    with caplog.at_level(logging.WARNING):
        for k, (t, x) in enumerate(zip(times[:-1], values[:-1], strict=True)):
            slave.set_by_name({"x": x})
            slave.do_step(t, 0.2)
            np.testing.assert_allclose([slave[name] for name in names], [result[name][k] for name in names], atol=1e-7)
    assert sum("the motion is" in record.message for record in caplog.records) == 1


def test_run_to_joins_what_inputs_say():
    """`set_inputs` and `run_to`, without `advance`."""
    sim = Simulation(model_of(coordinate), **TIGHT)
    sim.run_to(0.1)
    sim.set_inputs({"x": 0.05})
    sim.run_to(0.3)
    found = dict(zip([c.name for c in sim.channels], sim.values(), strict=True))
    assert found["p.x"] == pytest.approx(0.05, abs=1e-12) and abs(found["p.vx"]) < 1e-10


def test_a_mechanism_goes_along_to_its_start():
    """A four-bar whose crank an input turns by 1.2 rad at the start keeps the way it is put together."""
    lengths = {"crank": 0.2, "coupler": 0.7, "rocker": 0.6}
    ground = 0.7

    def closed(angle):
        """Angles of coupler and rocker, the loop above the ground."""
        tip = lengths["crank"] * np.array([math.cos(angle), math.sin(angle)])
        d = np.array([ground, 0.0]) - tip
        r, a, b = np.hypot(*d), lengths["coupler"], lengths["rocker"]
        coupler = math.atan2(d[1], d[0]) + math.acos((a * a + r * r - b * b) / (2.0 * a * r))
        knee = tip + a * np.array([math.cos(coupler), math.sin(coupler)])
        return tip, coupler, knee, math.atan2(knee[1], knee[0] - ground)

    def bar(name, end, angle):
        length = lengths[name]
        middle = end + 0.5 * length * np.array([math.cos(angle), math.sin(angle)])
        return RigidBody2D(name=name, mass=1.0, inertia=length**2 / 12.0, position=tuple(middle), angle=angle)

    def end(name, side):
        return Marker2D(body=name, point=(0.5 * side * lengths[name], 0.0))

    tip, coupler, _, rocker = closed(0.3)
    bodies = [
        bar("crank", np.zeros(2), 0.3),
        bar("coupler", tip, coupler),
        bar("rocker", np.array([ground, 0.0]), rocker),
    ]
    base = Marker2D()
    joints = [
        Revolute2D(name="h1", a=base, b=end("crank", -1)),
        Revolute2D(name="h2", a=end("crank", 1), b=end("coupler", -1)),
        Revolute2D(name="h3", a=end("coupler", 1), b=end("rocker", 1)),
        Revolute2D(name="h4", a=Marker2D(point=(ground, 0.0)), b=end("rocker", -1)),
        RelativeMotor2D(name="d", a=base, b=end("crank", -1), motion=LED),
    ]
    model = Model(bodies=bodies, joints=joints, inputs=[Input(name="x", unit="rad")])
    result = simulate(model, 0.1, inputs={"x": ([0.0, 0.1], [1.5, 1.6])}, t_eval=[0.0, 0.1], **TIGHT)
    for k, angle in enumerate((1.5, 1.6)):
        _, coupler, _, rocker = closed(angle)
        assert result["crank.angle"][k] == pytest.approx(angle, abs=1e-10)
        assert result["coupler.angle"][k] == pytest.approx(coupler, abs=1e-9)
        assert result["rocker.angle"][k] == pytest.approx(rocker, abs=1e-9)


def test_a_driven_length_in_space():
    times, values = table(8, start=1.0)
    masses = [PointMass3D(name="p", mass=1.0, position=(0.7, 0.0, 0.0))]
    rod = Distance3D(name="d", a=Marker3D(), b=Marker3D(body="p"), length=LED)
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=masses, joints=[rod], inputs=[Input(name="x", unit="m", start=0.7)])
    result = simulate(model, times[-1], t_eval=times, inputs={"x": (times, values)}, **TIGHT)
    assert result["p.x"] == pytest.approx(values, abs=1e-9)


def test_what_no_values_of_the_inputs_mend_is_refused():
    """The hinge is apart by 0.1 m, whatever the motor's angle."""
    body = RigidBody2D(name="p", mass=2.0, inertia=0.5, position=(0.3, 0.1))
    a, b = Marker2D(), Marker2D(body="p", point=(-0.3, 0.0))
    joints = [Revolute2D(name="h", a=a, b=b), RelativeMotor2D(name="d", a=a, b=b, motion=LED)]
    model = Model(bodies=[body], joints=joints, inputs=INPUTS[:1])
    with pytest.raises(ConsistencyError, match=r"'h' by 0\.1"):
        simulate(model, 1.0, inputs={"x": 0.2})


def test_one_rate_for_two_positions_is_refused():
    bodies = [PointMass2D(name="p", mass=1.0)]
    signals = (WITH_RATE, InputSignal(channel="y", rate="v"))
    joints = [
        CoordinateDriver(name=f"d{c}", body="p", coordinate=c, motion=s) for c, s in zip("xy", signals, strict=True)
    ]
    model = Model(bodies=bodies, joints=joints, inputs=[*INPUTS, Input(name="y", unit="m")])
    with pytest.raises(ModelError, match="input 'v' leads two motions"):
        simulate(model, 1.0, inputs={"x": ([0.0, 1.0], [0.0, 1.0]), "y": ([0.0, 1.0], [0.0, 2.0])})
