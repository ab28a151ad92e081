"""PID controllers: closed loops that are linear follow their exact solutions, whatever they sense and drive."""

import numpy as np
import pytest
from helpers import GROUND, on
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from tlismni.core import (
    Constant,
    Model,
    ModelError,
    PIDController2D,
    Prismatic2D,
    Revolute2D,
    RigidBody2D,
    Sine,
    SlideSpring2D,
    simulate,
)

TIGHT = {"rtol": 1e-10, "atol": 1e-12}
WEIGHTLESS = (0.0, 0.0)


def cart(name="cart", mass=2.0, x=0.0, **start):
    body = RigidBody2D(name=name, mass=mass, inertia=1.0, position=(x, 0.0), **start)
    return body, Prismatic2D(name=f"{name}_guide", a=GROUND, b=on(name))


def linear(matrix, start, times):
    """x' = A x, at these times, (times, states)."""
    return np.array([expm(np.asarray(matrix) * t) @ start for t in times])


@pytest.mark.parametrize("method", ["ebdf", "hht", "irk", "adams"])
def test_a_mass_on_a_pid_controller_is_a_linear_system_of_third_order(method):
    body, guide = cart(velocity=(0.3, 0.0))
    gain, integral, rate, target = 40.0, 25.0, 6.0, 0.7
    pid = PIDController2D(
        name="pid", a=GROUND, b=on("cart"), measure="slide", target=Constant(value=target), gain=gain,
        integral_gain=integral, rate_gain=rate,
    )  # fmt: skip
    model = Model(gravity=WEIGHTLESS, bodies=[body], joints=[guide], forces=[pid])
    times = np.linspace(0.0, 6.0, 40)
    tight = TIGHT if method != "hht" else {"rtol": 1e-7, "atol": 1e-9}
    result = simulate(model, 6.0, method=method, t_eval=times, **tight)
    # error, its rate, its integral
    loop = [[0.0, 1.0, 0.0], [-gain / 2.0, -rate / 2.0, -integral / 2.0], [1.0, 0.0, 0.0]]
    exact = linear(loop, [-target, 0.3, 0.0], times)
    size = 1e-8 if method != "hht" else 1e-4
    assert result["cart.x"] == pytest.approx(target + exact[:, 0], abs=size)
    assert np.abs(result["energy.balance"]).max() < 1e2 * size


def test_the_integral_takes_away_what_a_load_leaves():
    """A rod held level against its weight: the mean of the error goes to zero, and without the integral it does not."""
    rod = RigidBody2D(name="rod", mass=1.0, inertia=1.0 / 12.0, position=(0.5, 0.0))
    ends = {"name": "pid", "a": GROUND, "b": on("rod"), "target": Constant(value=0.0)}
    pin = Revolute2D(name="pin", a=GROUND, b=on("rod", -0.5))
    for integral in (0.0, 40.0):
        pid = PIDController2D(**ends, gain=50.0, rate_gain=10.0, integral_gain=integral)
        result = simulate(Model(bodies=[rod], joints=[pin], forces=[pid]), 40.0, **TIGHT)
        angle = result["rod.angle"][-1]
        left = 0.0 if integral else -0.5 * 9.81 * np.cos(angle) / 50.0
        assert angle == pytest.approx(left, abs=1e-8)


def test_it_drives_one_body_by_what_another_does():
    """Two carts on a spring: the force acts on the first one, the second one is sensed."""
    (first, guide_1), (second, guide_2) = cart("first"), cart("second", mass=1.0, x=1.0, velocity=(0.2, 0.0))
    spring = SlideSpring2D(name="k", a=on("first"), b=on("second"), stiffness=30.0, damping=4.0, natural_position=1.0)
    gain, integral, rate = 3.0, 0.5, 2.0
    pid = PIDController2D(
        name="pid", a=GROUND, b=on("first"), measure="slide", sensor_a=GROUND, sensor_b=on("second"),
        target=Constant(value=1.5), gain=gain, integral_gain=integral, rate_gain=rate,
    )  # fmt: skip
    model = Model(gravity=WEIGHTLESS, bodies=[first, second], joints=[guide_1, guide_2], forces=[spring, pid])
    times = np.linspace(0.0, 10.0, 30)
    result = simulate(model, 10.0, t_eval=times, **TIGHT)
    # x1, x2 - 1, their rates, integral of x2 - 1.5
    k, c = 30.0, 4.0
    loop = np.array(
        [
            [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [-k / 2, (k - gain) / 2, -c / 2, (c - rate) / 2, -integral / 2, 0.5 * gain / 2],
            [k, -k, c, -c, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, 0.0, -0.5],
            [0.0] * 6,
        ]
    )
    exact = linear(loop, [0.0, 0.0, 0.0, 0.2, 0.0, 1.0], times)
    assert result["first.x"] == pytest.approx(exact[:, 0], abs=1e-8)
    assert result["second.x"] == pytest.approx(1.0 + exact[:, 1], abs=1e-8)


def balanced(angle, **numbers):
    """A cart that keeps a pole upright, which starts at `angle` (rad) from the vertical."""
    body, guide = cart(mass=1.0)
    pole = RigidBody2D(
        name="pole", mass=0.2, inertia=0.2 / 12.0, angle=0.5 * np.pi - angle,
        position=(0.5 * np.sin(angle), 0.5 * np.cos(angle)),
    )  # fmt: skip
    hinge = Revolute2D(name="hinge", a=on("cart"), b=on("pole", -0.5))
    pid = PIDController2D(
        name="pid", a=GROUND, b=on("cart"), measure="slide", sensor_a=GROUND, sensor_b=on("pole"), sensed="angle",
        target=Constant(value=0.5 * np.pi), **numbers,
    )  # fmt: skip
    return Model(bodies=[body, pole], joints=[guide, hinge], forces=[pid])


def test_a_cart_keeps_a_pole_upright():
    """The force on the cart follows the pole's angle; without it the pole falls."""
    result = simulate(balanced(0.2, gain=60.0, integral_gain=60.0, rate_gain=12.0), 12.0, **TIGHT)
    assert abs(result["pole.angle"][-1] - 0.5 * np.pi) < 1e-4
    assert np.abs(result["pole.angle"] - 0.5 * np.pi).max() < 0.25
    assert np.abs(result["energy.balance"]).max() < 1e-6
    weak = simulate(balanced(0.2, gain=0.1, rate_gain=0.1), 2.0, **TIGHT)
    assert np.abs(weak["pole.angle"] - 0.5 * np.pi).max() > 1.0


def saturating(t, x, mass, gain, integral, limit, target):
    error = x[0] - target
    asked = gain * error + integral * x[2]
    spare = 1.0 / (1.0 + (asked / limit) ** 8)
    return [x[1], -asked * spare**0.125 / mass - 1.5 * x[1] / mass, spare**1.125 * error]


def test_a_controller_that_saturates_does_not_wind_up():
    """Against scipy, and the way back begins much earlier than with an integral that goes on."""
    body, guide = cart()
    gain, integral, limit, target = 40.0, 20.0, 3.0, 5.0
    brake = SlideSpring2D(name="brake", a=GROUND, b=on("cart"), stiffness=0.0, damping=1.5)
    pid = PIDController2D(
        name="pid", a=GROUND, b=on("cart"), measure="slide", target=Constant(value=target), gain=gain,
        integral_gain=integral, largest=limit,
    )  # fmt: skip
    model = Model(gravity=WEIGHTLESS, bodies=[body], joints=[guide], forces=[pid, brake])
    times = np.linspace(0.0, 6.0, 60)
    result = simulate(model, 6.0, t_eval=times, **TIGHT)
    arguments = (body.mass, gain, integral, limit, target)
    exact = solve_ivp(saturating, (0.0, 6.0), [0.0] * 3, "DOP853", times, args=arguments, rtol=1e-12, atol=1e-12)
    assert result["cart.x"] == pytest.approx(exact.y[0], abs=1e-7)
    force = body.mass * result["cart.ax"] + 1.5 * result["cart.vx"]
    assert np.abs(force).max() <= limit * (1.0 + 1e-9)
    assert np.abs(exact.y[2]).max() < 0.5 < 0.1 * np.trapezoid(np.abs(exact.y[0] - target), times)


@pytest.mark.parametrize(("metre", "second"), [(1e3, 1.0), (1.0, 1e3), (1e-3, 1e-3)])
def test_other_units_give_the_same_motion(metre, second):
    """`metre` and `second`: how many units of length and time they are."""

    def angle_of(metre, second):
        per_s2, force = metre / second**2, metre / second**2
        rod = RigidBody2D(name="rod", mass=1.0, inertia=metre**2 / 12.0, position=(0.5 * metre, 0.0))
        pin = Revolute2D(name="pin", a=GROUND, b=on("rod", -0.5 * metre))
        torque = force * metre
        pid = PIDController2D(
            name="pid", a=GROUND, b=on("rod"), target=Sine(amplitude=0.4, angular_frequency=3.0 / second),
            gain=30.0 * torque, integral_gain=20.0 * torque / second, rate_gain=4.0 * torque * second,
        )  # fmt: skip
        model = Model(gravity=(0.0, -9.81 * per_s2), bodies=[rod], joints=[pin], forces=[pid])
        return simulate(model, 2.0 * second, t_eval=np.linspace(0.0, 2.0, 20) * second, rtol=1e-9)

    here, there = angle_of(1.0, 1.0), angle_of(metre, second)
    assert there["rod.angle"] == pytest.approx(here["rod.angle"], abs=1e-8)
    assert there.stats["steps"] == here.stats["steps"]


def test_what_is_no_controller_is_refused():
    ends = {"name": "pid", "a": GROUND, "b": on("rod"), "target": Constant(value=0.0)}
    for numbers, said in (
        ({}, "no gain"),
        ({"integral_gain": 2.0}, "needs a gain beside it"),
        ({"integral_gain": -2.0, "gain": 1.0}, "must have one sign"),
        ({"gain": 1.0, "sensor_a": GROUND}, "one sensor marker"),
        ({"gain": float("nan")}, "gain"),
        ({"gain": 1.0, "largest": 0.0}, "largest"),
    ):
        with pytest.raises(ModelError, match=said):
            PIDController2D(**ends, **numbers)
