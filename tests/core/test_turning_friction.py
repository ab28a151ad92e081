"""Friction against rolling and spinning of contacts in space: closed forms."""

import math

import numpy as np
import pytest
from tlismni.core import (
    CoulombFriction,
    HalfSpace3D,
    HuntCrossley,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    TanhFriction,
    TurningFriction,
    simulate,
)

G, RADIUS, MASS = 9.81, 0.05, 0.7
HARD = {"law": NewtonImpact(restitution=0.4), "friction": CoulombFriction(coefficient=0.5)}


def ball(velocity, spin, turning, *, depth=0.0, gravity=(0.0, 0.0, -G), inertia=0.4 * MASS * RADIUS**2, **contact):
    """A ball on the floor, with its turning friction."""
    body = RigidBody3D(
        name="ball", mass=MASS, inertia=(inertia,) * 3, position=(0.0, 0.0, RADIUS - depth), velocity=velocity,
        angular_velocity=spin,
    )  # fmt: skip
    touch = SphereOnHalfSpace3D(
        name="touch", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="ball"), radius=RADIUS),
        turning=turning, **(contact or HARD),
    )  # fmt: skip
    return Model(gravity=gravity, bodies=[body], contacts=[touch])


def stopping(speed, slow, brake):
    """(time until the speed is a tenth of `slow`, way until rest) of v' = -brake v/sqrt(v^2 + slow^2)."""
    time = lambda v: math.hypot(v, slow) + slow * math.log(v / (slow + math.hypot(v, slow)))  # noqa: E731
    way = 0.5 * (speed * math.hypot(speed, slow) + slow**2 * math.asinh(speed / slow))
    return (time(speed) - time(0.1 * slow)) / brake, way / brake


@pytest.mark.parametrize("direction", [0.0, 0.7, 2.5])
def test_a_ball_rolls_out_to_where_its_friction_stops_it(direction):
    """(7/5) m R v' = -rho m g: by Coulomb's law of rolling after v^2 (7/5) R/(2 rho g)."""
    speed, rho, slow = 0.3, 0.004, 1e-3
    c, s = math.cos(direction), math.sin(direction)
    model = ball((speed * c, speed * s, 0.0), (-speed * s / RADIUS, speed * c / RADIUS, 0.0),
                 TurningFriction(rolling=rho, transition_speed=slow))  # fmt: skip
    brake = rho * G / (1.4 * RADIUS)
    _, way = stopping(speed, slow * RADIUS, brake)
    assert way == pytest.approx(speed**2 / (2.0 * brake), rel=1e-6)
    result = simulate(model, 1.5 * speed / brake, "ebdf", rtol=1e-9, atol=1e-12)
    assert [result["ball.x"][-1], result["ball.y"][-1]] == pytest.approx([way * c, way * s], abs=1e-9)
    assert np.hypot(result["ball.vx"][-1], result["ball.vy"][-1]) < 1e-12
    lost = 0.7 * MASS * speed**2
    assert result["touch.dissipation"][-1] == pytest.approx(lost, rel=1e-8)
    assert np.abs(result["energy.balance"]).max() < 1e-9 * lost


def test_a_spinning_ball_stops_as_its_friction_against_spinning_says():
    """J w' = -sigma m g: w = w0 - sigma m g t/J, at rest after w0^2 J/(2 sigma m g) radians."""
    spin, sigma, slow = 30.0, 0.002, 0.01
    inertia = 0.4 * MASS * RADIUS**2
    model = ball((0.0, 0.0, 0.0), (0.0, 0.0, spin), TurningFriction(spinning=sigma, transition_speed=slow))
    brake = sigma * MASS * G / inertia
    time, _ = stopping(spin, slow, brake)
    result = simulate(model, time, "ebdf", rtol=1e-9, atol=1e-12)
    assert result["ball.angular_velocity_z"][-1] == pytest.approx(0.1 * slow, rel=1e-4)
    halfway = simulate(model, 0.5 * spin / brake, "ebdf", rtol=1e-9, atol=1e-12)
    assert halfway["ball.angular_velocity_z"][-1] == pytest.approx(0.5 * spin, rel=1e-6)
    assert np.abs([result["ball.x"], result["ball.y"]]).max() < 1e-12


def test_both_frictions_leave_each_other_alone():
    """Rolling and spinning at once: each part of the turning has its own torque."""
    speed, spin, turning = 0.4, 20.0, TurningFriction(rolling=0.003, spinning=0.001, transition_speed=1e-3)
    model = ball((speed, 0.0, 0.0), (0.0, speed / RADIUS, spin), turning)
    result = simulate(model, 0.5, "ebdf", rtol=1e-9, atol=1e-12)
    assert result["ball.vx"][-1] == pytest.approx(speed - 0.003 * G / (1.4 * RADIUS) * 0.5, abs=1e-7)
    assert result["ball.angular_velocity_z"][-1] == pytest.approx(spin - 0.001 * G / (0.8 * RADIUS**2), abs=1e-5)


def test_sliding_ends_in_rolling_as_without_but_for_the_torque():
    """While it slides, the torque turns it: 2.5 mu g R w' = ... so that |slip| falls with 3.5 mu g - 2.5 rho g/R."""
    speed, mu, rho = 0.5, 0.2, 0.002
    model = ball((speed, 0.0, 0.0), (0.0, 0.0, 0.0), TurningFriction(rolling=rho, transition_speed=1e-5),
                 law=NewtonImpact(restitution=0.0), friction=CoulombFriction(coefficient=mu))  # fmt: skip
    result = simulate(model, 0.3, "ebdf", rtol=1e-10, atol=1e-13)
    (end,) = [event.t for event in result.events if event.kind == "stick"]
    assert end == pytest.approx(speed / (3.5 * mu * G - 2.5 * rho * G / RADIUS), rel=1e-6)


@pytest.mark.parametrize("slope", [0.0999, 0.1001])
def test_a_ball_on_a_slope_rolls_where_its_weight_has_the_longer_lever(slope):
    """tan(slope) R against rho: below it creeps as the law says, above it rolls off."""
    angle, slow = math.atan(slope), 1e-4
    turning = TurningFriction(rolling=0.1 * RADIUS, transition_speed=slow)
    gravity = (G * math.sin(angle), 0.0, -G * math.cos(angle))
    result = simulate(ball((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), turning, gravity=gravity), 2.0, "ebdf")
    share = slope / 0.1
    if share < 1.0:
        assert result["ball.angular_velocity_y"][-1] == pytest.approx(
            slow * share / math.sqrt(1.0 - share**2), rel=1e-4
        )
    else:
        assert result["ball.angular_velocity_y"][-1] > 100.0 * slow


def test_friction_that_the_ball_needs_to_roll_counts_its_torque():
    """On a slope a rolling ball needs F_T = (2/7) m g sin + (5/7) rho N/R: with less it slides from the start on."""
    angle, rho = 0.5, 0.01
    needed = 2.0 / 7.0 * math.tan(angle) + 5.0 / 7.0 * rho / RADIUS
    gravity = (G * math.sin(angle), 0.0, -G * math.cos(angle))
    turning, speed = TurningFriction(rolling=rho, transition_speed=1e-6), 0.1
    for factor in (0.999, 1.001):
        friction = CoulombFriction(coefficient=factor * needed)
        model = ball((speed, 0.0, 0.0), (0.0, speed / RADIUS, 0.0), turning, gravity=gravity,
                     law=NewtonImpact(restitution=0.0), friction=friction)  # fmt: skip
        result = simulate(model, 0.1, "ebdf", rtol=1e-9)
        slip = result["ball.vx"][-1] - RADIUS * result["ball.angular_velocity_y"][-1]
        assert (slip > 1e-5) == (factor < 1.0)
        assert len(result.events) < 5


def test_a_ball_on_a_soft_floor_rolls_out_too():
    speed, rho, slow = 0.3, 0.004, 1e-3
    law = HuntCrossley(stiffness=1e6, exponent=1.5, restitution=0.5)
    depth = (MASS * G / 1e6) ** (2.0 / 3.0)
    model = ball((speed, 0.0, 0.0), (0.0, speed / RADIUS, 0.0), TurningFriction(rolling=rho, transition_speed=slow),
                 depth=depth, law=law, friction=TanhFriction(coefficient=0.5, transition_speed=1e-3))  # fmt: skip
    _, way = stopping(speed, slow * RADIUS, rho * G / (1.4 * RADIUS))
    result = simulate(model, 0.8, "ebdf", rtol=1e-7)
    # the floor gives way: friction creeps with a little slip
    assert result["ball.x"][-1] == pytest.approx(way, rel=2e-3)
    assert abs(result["ball.vx"][-1]) < 1e-6
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_refused():
    with pytest.raises(ModelError, match="rolling, spinning or"):
        TurningFriction()
    with pytest.raises(ModelError, match="slides without any"):
        ball((0, 0, 0), (0, 0, 0), TurningFriction(rolling=0.1), law=NewtonImpact(restitution=0.0))
