"""Springs, dampers, applied forces and torques against closed forms."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, on
from scipy.interpolate import CubicSpline
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    Constant,
    Input,
    InputSignal,
    Model,
    PointMass2D,
    Polynomial,
    Ramp,
    RigidBody2D,
    Simulation,
    Sine,
    SpringDamper2D,
    Step,
    Table,
    simulate,
)

TIGHT = {"rtol": 1e-10, "atol": 1e-12}


def oscillator(zeta, w, x, v, t):
    """x'' + 2 zeta w x' + w^2 x = 0 from (x, v)."""
    root = np.sqrt(complex(zeta**2 - 1.0))
    p, q = w * (-zeta + root), w * (-zeta - root)
    if root == 0:
        return x * np.exp(p.real * t) + (v - p.real * x) * t * np.exp(p.real * t)
    a = (v - q * x) / (p - q)
    return (a * np.exp(p * t) + (x - a) * np.exp(q * t)).real


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.7, 1.0, 3.0])
@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_spring_and_damper_oscillate_as_the_closed_form(zeta, method):
    m, k, rest = 0.8, 45.0, 1.0
    w = math.sqrt(k / m)
    spring = SpringDamper2D(
        name="s", a=GROUND, b=on("p"), stiffness=k, damping=2.0 * zeta * math.sqrt(k * m), natural_length=rest
    )
    body = PointMass2D(name="p", mass=m, position=(rest + 0.2, 0.0), velocity=(-0.5, 0.0))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body], forces=[spring]), 2.0, method, **TIGHT)
    assert np.abs(result["p.x"] - rest - oscillator(zeta, w, 0.2, -0.5, result.t)).max() < 1e-8
    assert np.abs(result["p.y"]).max() == 0.0


def test_hanging_spring_swings_about_its_static_length():
    m, k = 0.5, 30.0
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=k, natural_length=1.0)
    static = 1.0 + m * G / k
    body = PointMass2D(name="p", mass=m, position=(0.0, -static - 0.1))
    result = simulate(Model(bodies=[body], forces=[spring]), 2.0, **TIGHT)
    assert np.abs(result["p.y"] + static + 0.1 * np.cos(math.sqrt(k / m) * result.t)).max() < 1e-8


def test_spring_between_two_bodies_moves_them_against_each_other():
    m1, m2, k, c = 1.0, 2.5, 60.0, 1.0
    spring = SpringDamper2D(name="s", a=on("a", 0.2), b=on("b", -0.1), stiffness=k, damping=c, natural_length=0.7)
    bodies = [
        RigidBody2D(name="a", mass=m1, inertia=0.1, velocity=(0.5, 0.0)),
        RigidBody2D(name="b", mass=m2, inertia=0.1, position=(1.1, 0.0)),
    ]
    result = simulate(Model(gravity=(0.0, 0.0), bodies=bodies, forces=[spring]), 2.0, **TIGHT)
    m = m1 * m2 / (m1 + m2)
    w = math.sqrt(k / m)
    stretch = oscillator(c / (2.0 * math.sqrt(k * m)), w, 0.1, -0.5, result.t)
    assert np.abs(result["b.x"] - result["a.x"] - 1.0 - stretch).max() < 1e-8
    assert np.abs(m1 * result["a.x"] + m2 * result["b.x"] - m2 * 1.1 - 0.5 * m1 * result.t).max() < 1e-9


def test_spring_at_an_arm_turns_the_body():
    """Small swings of a body on a pin-less spring couple: the force is along the line, its moment x F_y - y F_x."""
    spring = SpringDamper2D(name="s", a=on("ground", 0.3, 2.0), b=on("b", 0.3, 0.1), stiffness=20.0, natural_length=1.5)
    body = RigidBody2D(name="b", mass=2.0, inertia=0.4, angle=0.3)
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body], forces=[spring]), 1.0, **TIGHT)
    angle = result["b.angle"]
    px, py = 0.3 * np.cos(angle) - 0.1 * np.sin(angle), 0.3 * np.sin(angle) + 0.1 * np.cos(angle)
    dx, dy = 0.3 - result["b.x"] - px, 2.0 - result["b.y"] - py
    length = np.hypot(dx, dy)
    fx, fy = 20.0 * (length - 1.5) * dx / length, 20.0 * (length - 1.5) * dy / length
    assert np.abs(2.0 * result["b.ax"] - fx).max() < 1e-8
    assert np.abs(2.0 * result["b.ay"] - fy).max() < 1e-8
    assert np.abs(0.4 * result["b.angular_acceleration"] - (px * fy - py * fx)).max() < 1e-8
    assert result["energy.strain"] == pytest.approx(10.0 * (length - 1.5) ** 2, rel=1e-12)


SPLINE = CubicSpline([0.0, 0.4, 0.9, 1.3, 2.0], [0.0, 3.0, -1.0, 2.0, 0.5])
# f, and twice its integral from rest
SIGNALS = {
    "constant": (Constant(value=3.0), lambda t: 3.0 * t, lambda t: 1.5 * t**2),
    "sine": (
        Sine(amplitude=2.0, angular_frequency=5.0, phase=0.7, offset=0.3),
        lambda t: 0.3 * t + 0.4 * (np.cos(0.7) - np.cos(5.0 * t + 0.7)),
        lambda t: 0.15 * t**2 + 0.4 * (np.cos(0.7) * t - (np.sin(5.0 * t + 0.7) - np.sin(0.7)) / 5.0),
    ),
    "polynomial": (
        Polynomial(coefficients=(1.0, -2.0, 0.0, 4.0)),
        lambda t: t - t**2 + t**4,
        lambda t: t**2 / 2.0 - t**3 / 3.0 + t**5 / 5.0,
    ),
    "table": (
        Table(times=tuple(SPLINE.x), values=tuple(SPLINE(SPLINE.x))),
        SPLINE.antiderivative(),
        SPLINE.antiderivative(2),
    ),
    "step": (
        Step(time=0.37, before=-1.0, after=4.0),
        lambda t: np.where(t < 0.37, -t, -0.37 + 4.0 * (t - 0.37)),
        lambda t: np.where(t < 0.37, -0.5 * t**2, -0.5 * 0.37**2 - 0.37 * (t - 0.37) + 2.0 * (t - 0.37) ** 2),
    ),
    "ramp": (
        Ramp(start=0.21, duration=0.64, before=0.0, after=5.0),
        lambda t: np.where(
            t < 0.85, 2.5 / 0.64 * np.maximum(t - 0.21, 0.0) ** 2, 2.5 * 0.64 + 5.0 * np.maximum(t - 0.85, 0.0)
        ),
        lambda t: np.where(
            t < 0.85,
            2.5 / 1.92 * np.maximum(t - 0.21, 0.0) ** 3,
            2.5 * 0.64**2 / 3.0 + 1.6 * (t - 0.85) + 2.5 * (t - 0.85) ** 2,
        ),
    ),
}


@pytest.mark.parametrize("name", SIGNALS)
@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_applied_force_moves_a_free_mass_as_its_integrals(name, method):
    """Jumps and corners of the force are met exactly, so that they cost no accuracy."""
    signal, once, twice = SIGNALS[name]
    force = AppliedForce2D(name="f", marker=on("p"), force_x=signal)
    model = Model(bodies=[PointMass2D(name="p", mass=2.0)], forces=[force])
    times = np.linspace(0.0, 1.5, 31)
    result = simulate(model, 1.5, method, t_eval=times, **TIGHT)
    assert np.abs(result["p.vx"] - once(times) / 2.0).max() < 1e-9
    assert np.abs(result["p.x"] - twice(times) / 2.0).max() < 1e-9
    assert np.abs(result["p.y"] + 0.5 * G * times**2).max() < 1e-9


@pytest.mark.parametrize("name", SIGNALS)
def test_applied_torque_turns_a_free_body_as_its_integrals(name):
    signal, once, twice = SIGNALS[name]
    model = Model(
        bodies=[RigidBody2D(name="b", mass=2.0, inertia=0.5)],
        forces=[AppliedTorque2D(name="t", body="b", torque=signal)],
    )
    result = simulate(model, 1.5, "ebdf", **TIGHT)
    assert np.abs(result["b.angular_velocity"] - 2.0 * once(result.t)).max() < 1e-9
    assert np.abs(result["b.angle"] - 2.0 * twice(result.t)).max() < 1e-9
    assert np.abs(result["b.x"]).max() < 1e-12


def test_step_and_ramp_are_met_by_steps():
    step, ramp = SIGNALS["step"][0], SIGNALS["ramp"][0]
    force = AppliedForce2D(name="f", marker=on("p"), force_x=step, force_y=ramp)
    result = simulate(Model(bodies=[PointMass2D(name="p", mass=1.0)], forces=[force]), 1.5)
    for t in (0.21, 0.37, 0.85):
        assert np.abs(result.t - t).min() < 1e-15


def test_force_out_of_centre_accelerates_and_turns():
    """Momentum balance at every recorded time, for a force of the inertial frame and one that follows the body."""
    forces = [
        AppliedForce2D(name="f", marker=on("b", 0.2, -0.1), force_x=Constant(value=1.0), force_y=Constant(value=2.0)),
        AppliedForce2D(
            name="g", marker=on("b", -0.3, 0.2), force_x=Constant(value=-0.5),
            force_y=Sine(amplitude=1.0, angular_frequency=2.0), follower=True,
        ),
    ]  # fmt: skip
    body = RigidBody2D(name="b", mass=1.5, inertia=0.4, angle=0.3)
    r = simulate(Model(gravity=(0.0, 0.0), bodies=[body], forces=forces), 1.5, **TIGHT)
    c, s = np.cos(r["b.angle"]), np.sin(r["b.angle"])
    gx, gy = -0.5 * c - np.sin(2.0 * r.t) * s, -0.5 * s + np.sin(2.0 * r.t) * c
    assert np.abs(1.5 * r["b.ax"] - 1.0 - gx).max() < 1e-9
    assert np.abs(1.5 * r["b.ay"] - 2.0 - gy).max() < 1e-9
    moment = (0.2 * c + 0.1 * s) * 2.0 - (0.2 * s - 0.1 * c) * 1.0
    moment = moment + (-0.3) * np.sin(2.0 * r.t) - 0.2 * (-0.5)
    assert np.abs(0.4 * r["b.angular_acceleration"] - moment).max() < 1e-9


def test_input_channel_holds_between_communication_points():
    """Zero-order hold: each interval is a parabola of its own."""
    force = AppliedForce2D(name="f", marker=on("p"), force_x=InputSignal(channel="u"))
    model = Model(bodies=[PointMass2D(name="p", mass=2.0)], forces=[force], inputs=[Input(name="u", unit="N")])
    sim = Simulation(model, rtol=1e-9, atol=1e-12)
    x = v = 0.0
    for k, u in enumerate([1.0, -3.0, 0.0, 5.0]):
        sim.set_inputs({"u": u})
        sim.advance(0.25 * (k + 1))
        x, v = x + 0.25 * v + 0.5 * u / 2.0 * 0.25**2, v + u / 2.0 * 0.25
        values = dict(zip((c.name for c in sim.channels), sim.values(), strict=True))
        assert values["p.x"] == pytest.approx(x, abs=1e-10)
        assert values["p.vx"] == pytest.approx(v, abs=1e-10)


def test_gravity_in_any_direction():
    model = Model(gravity=(1.5, -2.5), bodies=[PointMass2D(name="p", mass=3.0, velocity=(0.2, 0.4))])
    r = simulate(model, 2.0, **TIGHT)
    assert np.abs(r["p.x"] - 0.2 * r.t - 0.75 * r.t**2).max() < 1e-9
    assert np.abs(r["p.y"] - 0.4 * r.t + 1.25 * r.t**2).max() < 1e-9
