"""Constraints that depend on time, from user functions and from drivers, against closed forms."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, integrate, on, residuals
from scipy.interpolate import CubicSpline
from tlismni.core import (
    ConsistencyError,
    CoordinateDriver,
    EquationSystem,
    Model,
    ModelError,
    PointMass2D,
    Polynomial,
    Prismatic2D,
    Ramp,
    Revolute2D,
    RigidBody2D,
    Sine,
    Step,
    Table,
    simulate,
)

TIGHT = {"rtol": 1e-10, "atol": 1e-12}


def test_bead_on_a_breathing_circle_keeps_its_angular_momentum():
    """R(t) = (c + d sin w t)^(-1/2) without gravity: R^2 theta' = L, so theta' = L (c + d sin w t)."""
    c, d, w, momentum = 1.0, 0.4, 3.0, 2.0

    def radius(t):
        return (c + d * np.sin(w * t)) ** -0.5

    system = EquationSystem(
        mass=np.eye(2),
        force=np.zeros(2),
        constraint=lambda t, q: q[0] ** 2 + q[1] ** 2 - 1.0 / (c + d * np.sin(w * t)),
        q0=[1.0, 0.0],
        v0=[-0.5 * d * w, momentum],
    )
    result = simulate(system, 3.0, **TIGHT)
    t = result.t
    angle = momentum * (c * t + d / w * (1.0 - np.cos(w * t)))
    expected = radius(t)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    assert np.abs(result.q - expected).max() < 1e-8
    (x, y), (vx, vy) = result.q.T, result.v.T
    assert np.abs(x * vy - y * vx - momentum).max() < 1e-8
    # R R' = x vx + y vy: velocity level; and all levels as reported
    s = c + d * np.sin(w * t)
    assert np.abs(x * vx + y * vy + 0.5 * d * w * np.cos(w * t) / s**2).max() < 1e-10
    assert max(residuals(result)) < 1e-10


def test_multiplier_of_a_growing_circle_is_the_centripetal_force():
    """R = 1 + u t: the radial acceleration is -R theta'^2 = -2 R lambda / m with Phi = r^2 - R^2."""
    u, momentum = 0.5, 1.5
    system = EquationSystem(
        mass=2.0 * np.eye(2),
        force=np.zeros(2),
        constraint=lambda t, q: q[0] * q[0] + q[1] * q[1] - (1.0 + u * t) ** 2,
        q0=[1.0, 0.0],
        v0=[u, momentum],
    )
    result = simulate(system, 2.0, **TIGHT)
    radius = 1.0 + u * result.t
    assert result.multipliers[:, 0] == pytest.approx(2.0 * 0.5 * (momentum / radius**2) ** 2, rel=1e-7)
    angle = momentum / u * (1.0 - 1.0 / radius)
    assert np.abs(np.arctan2(*result.q.T[::-1]) - angle).max() < 1e-8


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method, bound", [("ebdf", 1e-7), ("irk", 1e-7), ("bdf", 1e-6), ("hht", 2e-3)])
def test_bead_on_a_rotating_rod_flies_outwards(method, bound):
    """r = r0 cosh(w t); the rod pushes with 2 m w r'."""
    w, r0 = 1.5, 0.2
    system = EquationSystem(
        mass=np.eye(2),
        force=np.zeros(2),
        constraint=lambda t, q: -math.sin(w * t) * q[0] + math.cos(w * t) * q[1],
        q0=[r0, 0.0],
        v0=[0.0, w * r0],
    )
    rtol = 1e-6 if method == "hht" else 1e-9
    result = simulate(system, 2.0, method, rtol=rtol, atol=rtol * 1e-3)
    r = r0 * np.cosh(w * result.t)
    expected = np.stack([r * np.cos(w * result.t), r * np.sin(w * result.t)], axis=1)
    assert np.abs(result.q - expected).max() < bound
    force = 2.0 * w * r0 * w * np.sinh(w * result.t)
    assert np.abs(result.multipliers[:, 0] + force).max() < 100.0 * bound
    assert max(residuals(result)) < 1e-10


SPLINE = CubicSpline([0.0, 0.3, 0.7, 1.2, 2.0], [0.0, 0.2, -0.1, 0.4, 0.3])
MOTIONS = {
    "sine": (
        Sine(amplitude=0.5, angular_frequency=3.0, phase=0.4, offset=0.1),
        lambda t: 0.1 + 0.5 * np.sin(3.0 * t + 0.4),
        lambda t: 1.5 * np.cos(3.0 * t + 0.4),
        lambda t: -4.5 * np.sin(3.0 * t + 0.4),
    ),
    "polynomial": (
        Polynomial(coefficients=(0.2, -1.0, 0.5, 2.0, -0.7)),
        lambda t: 0.2 - t + 0.5 * t**2 + 2.0 * t**3 - 0.7 * t**4,
        lambda t: -1.0 + t + 6.0 * t**2 - 2.8 * t**3,
        lambda t: 1.0 + 12.0 * t - 8.4 * t**2,
    ),
    "table": (
        Table(times=tuple(SPLINE.x), values=tuple(SPLINE(SPLINE.x))),
        SPLINE,
        SPLINE.derivative(),
        SPLINE.derivative(2),
    ),
}


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("coordinate", ["x", "y", "angle"])
def test_driven_coordinate_follows_its_time_function_at_every_level(name, coordinate):
    motion, f, rate, acceleration = MOTIONS[name]
    velocity = (float(rate(0.0)), 0.0) if coordinate == "x" else (0.0, float(rate(0.0)) * (coordinate == "y"))
    position = (float(f(0.0)), 0.0) if coordinate == "x" else (0.0, float(f(0.0)) * (coordinate == "y"))
    turning = coordinate == "angle"
    body = RigidBody2D(
        name="b", mass=2.0, inertia=0.3, position=position, velocity=velocity,
        angle=float(f(0.0)) * turning, angular_velocity=float(rate(0.0)) * turning,
    )  # fmt: skip
    driver = CoordinateDriver(name="drive", body="b", coordinate=coordinate, motion=motion)
    result = simulate(Model(gravity=(0.0, -G), bodies=[body], joints=[driver]), 1.5, rtol=1e-8, atol=1e-11)
    t = result.t
    names = {"angle": ("angle", "angular_velocity", "angular_acceleration")}
    q, v, a = names.get(coordinate, (coordinate, f"v{coordinate}", f"a{coordinate}"))
    assert np.abs(result[f"b.{q}"] - f(t)).max() < 1e-11
    assert np.abs(result[f"b.{v}"] - rate(t)).max() < 1e-10
    assert np.abs(result[f"b.{a}"] - acceleration(t)).max() < 1e-10
    # reaction of the body on the driver: weight less inertia
    inertia = 0.3 if turning else 2.0
    weight = -2.0 * G if coordinate == "y" else 0.0
    assert np.abs(result["drive.reaction"] - (weight - inertia * acceleration(t))).max() < 1e-9
    assert max(residuals(result)) < 1e-10


def test_ramp_driver_jumps_in_velocity_at_its_corners_and_keeps_to_the_ramp():
    driver = CoordinateDriver(
        name="drive", body="p", coordinate="x", motion=Ramp(start=0.3, duration=0.5, before=0.1, after=0.6)
    )
    model = Model(bodies=[PointMass2D(name="p", mass=1.0, position=(0.1, 0.0))], joints=[driver])
    times = np.linspace(0.0, 1.0, 41)
    result = simulate(model, 1.0, t_eval=times)
    assert np.abs(result["p.x"] - np.interp(times, [0.3, 0.8], [0.1, 0.6])).max() < 1e-12
    inside = (times > 0.3) & (times < 0.8)
    assert np.abs(result["p.vx"] - inside)[(times != 0.3) & (times != 0.8)].max() < 1e-12
    assert np.abs(result["p.y"] + 0.5 * G * times**2).max() < 1e-8


def test_jump_of_a_ramp_driver_is_reported_with_its_name_time_and_size(caplog):
    ramp = Ramp(start=0.25, duration=0.5, before=0.0, after=1.5)
    smooth = CoordinateDriver(
        name="hold", body="cart", coordinate="y", motion=Sine(amplitude=0.1, angular_frequency=2.0)
    )
    drive = CoordinateDriver(name="drive", body="cart", coordinate="x", motion=ramp)
    model = Model(
        bodies=[PointMass2D(name="cart", mass=2.0, velocity=(0.0, 0.2))], joints=[drive, smooth], gravity=(0.0, 0.0)
    )
    with caplog.at_level("WARNING", logger="tlismni.core"):
        result = simulate(model, 1.0)
    begin, end = (record.getMessage() for record in caplog.records)
    assert "t = 0.25 s" in begin and "driver 'drive' by 3" in begin and "hold" not in begin
    assert "t = 0.75 s" in end and "driver 'drive' by -3" in end
    assert result.events == []  # events are of contacts
    jump = np.flatnonzero(np.diff(result["energy.input_work"]) > 8.9)
    assert len(jump) == 1 and result.t[jump[0]] == pytest.approx(0.25)  # m v^2/2 = 9 J at once


def crane(motion, angle=-math.pi / 2):
    """A rod on a pin of a slider whose place is driven."""
    c, s = 0.5 * math.cos(angle), 0.5 * math.sin(angle)
    return Model(
        bodies=[
            RigidBody2D(name="slider", mass=2.0, inertia=0.1),
            RigidBody2D(name="rod", mass=1.0, inertia=1.0 / 12.0, position=(c, s), angle=angle),
        ],
        joints=[
            Prismatic2D(name="rail", a=GROUND, b=on("slider")),
            Revolute2D(name="pin", a=on("slider"), b=on("rod", -0.5)),
            CoordinateDriver(name="drive", body="slider", coordinate="x", motion=motion),
        ],
    )


@pytest.mark.parametrize("angle", [-math.pi / 2, -0.9, -0.2])
def test_rod_on_a_pin_that_starts_with_a_jerk_gets_the_velocity_of_the_impact(angle):
    """The pin's velocity jumps from 0 to u: J_O w = m (L/2) sin(angle) u is what the impulse at the pin gives,
    whichever coordinates happen to be independent; then theta'' = -(3 g / 2 L) cos(theta)."""
    u, start = 0.8, 0.1
    model = crane(Ramp(start=start, duration=2.0, before=0.0, after=2.0 * u), angle)
    times = np.array([start, 0.4, 0.7])
    result = simulate(model, 0.7, t_eval=times, **TIGHT)

    def rhs(t, y):
        return [y[1], -1.5 * G * math.cos(y[0])]

    angle, rate = integrate(rhs, [angle, 0.0], [start])[0]
    rate += 1.5 * math.sin(angle) * u
    expected = integrate(rhs, [angle, rate], times[1:] - start)
    assert np.abs(result["slider.x"][1:] - u * (times[1:] - start)).max() < 1e-10
    assert np.abs(result["rod.angle"][1:] - expected[:, 0]).max() < 1e-7
    assert np.abs(result["rod.angular_velocity"][1:] - expected[:, 1]).max() < 1e-7


def test_step_is_refused_as_a_motion():
    with pytest.raises((ModelError, ConsistencyError), match="drive"):
        simulate(crane(Step(time=0.5, after=0.1)), 1.0)


def test_pendulum_on_a_shaken_pin_follows_minimal_coordinates():
    """theta'' = -(3/2L) (g cos theta - x'' sin theta) for a rod whose pin moves with x(t)."""
    motion = MOTIONS["sine"][0].model_copy(update={"phase": 0.0, "offset": 0.0})

    def rhs(t, y):
        shake = -4.5 * math.sin(3.0 * t)
        return [y[1], -1.5 * (G * math.cos(y[0]) - shake * math.sin(y[0]))]

    model = crane(motion, -1.0)
    model = model.model_copy(
        update={"bodies": tuple(body.model_copy(update={"velocity": (1.5, 0.0)}) for body in model.bodies)}
    )
    times = np.linspace(0.0, 2.0, 21)
    result = simulate(model, 2.0, t_eval=times, **TIGHT)
    expected = integrate(rhs, [-1.0, 0.0], times)
    assert np.abs(result["rod.angle"] - expected[:, 0]).max() < 1e-8
    assert np.abs(result["rod.angular_velocity"] - expected[:, 1]).max() < 1e-7
    assert max(residuals(result)) < 1e-10
