"""Coulomb friction of joints: what holds, holds for ever; what slides, stops where closed forms say."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import (
    Axes,
    Constant,
    CoordinateLoad,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    Prismatic2D,
    Prismatic3D,
    Ramp,
    RelativeLoad2D,
    RelativeLoad3D,
    RelativeMotor2D,
    Revolute2D,
    Revolute3D,
    RevoluteFriction2D,
    RevoluteFriction3D,
    RigidBody2D,
    RigidBody3D,
    RotationVector,
    Sine,
    SlideFriction2D,
    SlideFriction3D,
    simulate,
)

METHODS = {"ebdf": 1e-6, "irk": 1e-6, "bdf": 1e-4, "adams": 1e-5, "hht": 1e-3}
"""Of each method the error that its order leaves at default tolerances, relative."""
INERTIA = 0.5


def wheel(space: bool, rate: float, load: Any, length: float = 1.0, **friction: Any) -> Model:
    """A wheel of inertia 0.5 length^2 on a fixed bearing at (length, 0), driven by a torque `load` about it."""
    inertia = INERTIA * length**2
    if space:
        ends = {"a": Marker3D(point=(length, 0, 0)), "b": Marker3D(body="wheel")}
        body: Any = RigidBody3D(
            name="wheel", mass=1.0, inertia=(0.6 * inertia, 0.6 * inertia, inertia), angular_velocity=(0, 0, rate),
            position=(length, 0, 0),
        )  # fmt: skip
        joint: Any = Revolute3D(name="bearing", **ends)
        drive: Any = RelativeLoad3D(name="drive", **ends, measure="angle", load=load)
        rub: Any = RevoluteFriction3D(name="rub", **ends, **friction)
    else:
        flat = {"a": Marker2D(point=(length, 0)), "b": Marker2D(body="wheel")}
        body = RigidBody2D(name="wheel", mass=1.0, inertia=inertia, position=(length, 0), angular_velocity=rate)
        joint = Revolute2D(name="bearing", **flat)
        drive = RelativeLoad2D(name="drive", **flat, measure="angle", load=load)
        rub = RevoluteFriction2D(name="rub", **flat, **friction)
    return Model(bodies=[body], joints=[joint], forces=[drive, rub], gravity=(0.0, 0.0))


def slider(space: bool, angle: float, speed: float, **friction: Any) -> Model:
    """A block of 2 kg on a guide that falls by `angle`; `speed` is down the guide."""
    c, s = math.cos(angle), math.sin(angle)
    velocity = (speed * c, -speed * s)
    if space:
        # z axes along the guide
        turned = RigidBody3D(name="block", mass=2.0, inertia=(0.1, 0.1, 0.1), velocity=(*velocity, 0.0))
        axes = Axes(x=(s, c, 0.0), z=(c, -s, 0.0))
        a, b = Marker3D(attitude=axes), Marker3D(body="block", attitude=axes)
        return Model(
            bodies=[turned], joints=[Prismatic3D(name="guide", a=a, b=b)],
            forces=[SlideFriction3D(name="rub", a=a, b=b, **friction)], gravity=(0.0, -9.81, 0.0),
        )  # fmt: skip
    body = RigidBody2D(name="block", mass=2.0, inertia=0.1, velocity=velocity)
    ends = {"a": Marker2D(angle=-angle), "b": Marker2D(body="block", angle=-angle)}
    return Model(
        bodies=[body], joints=[Prismatic2D(name="guide", **ends)],
        forces=[SlideFriction2D(name="rub", **ends, **friction)], gravity=(0.0, -9.81),
    )  # fmt: skip


def angle_of(result: Any, space: bool) -> Any:
    return result["bearing.angle" if space else "wheel.angle"]


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("method", METHODS)
def test_what_is_loaded_below_its_friction_does_not_move(space: bool, method: str) -> None:
    result = simulate(wheel(space, 0.0, Constant(value=1.68), torque=2.0), 100.0, method=method)
    assert np.max(np.abs(angle_of(result, space))) < 1e-15
    assert result["rub.friction_torque"] == pytest.approx(-1.68, rel=1e-12)
    assert result["rub.dissipation"][-1] == 0.0


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("method", METHODS)
def test_a_wheel_stops_and_stays(space: bool, method: str) -> None:
    result = simulate(wheel(space, 3.0, Constant(value=1.0), torque=2.0), 4.0, method=method)
    error = METHODS[method]
    (stop,) = [event for event in result.events if event.kind == "stick"]
    assert stop.contact == "rub" and stop.t == pytest.approx(3.0 * INERTIA / 1.0, rel=error)
    assert angle_of(result, space)[-1] == pytest.approx(0.5 * 3.0 * stop.t, rel=error)
    assert result["rub.friction_torque"][[0, -1]] == pytest.approx([-2.0, -1.0], rel=1e-9)
    assert result["rub.dissipation"][-1] == pytest.approx(2.0 * 0.5 * 3.0 * stop.t, rel=error)


@pytest.mark.parametrize("space", [False, True])
def test_it_breaks_away_at_its_static_friction(space: bool) -> None:
    load = Ramp(start=0.0, duration=1.0, after=3.0)
    result = simulate(wheel(space, 0.0, load, torque=1.5, static_ratio=1.4), 2.0, rtol=1e-8)
    slip = next(event for event in result.events if event.kind == "slip")
    assert slip.t == pytest.approx(0.7, abs=1e-9)
    # (3 t - 1.5)/J up to t = 1 and 1.5/J from there on
    rate = ((1.5 * 1.0 - 1.5) - (1.5 * 0.49 - 1.5 * 0.7) + 1.5) / INERTIA
    assert result["rub.sliding_velocity"][-1] == pytest.approx(rate, rel=1e-6)


@pytest.mark.parametrize("length", [1e-6, 1e3])
def test_units_do_not_matter(length: float) -> None:
    square = length**2
    usual = simulate(wheel(False, 3.0, Constant(value=1.0), torque=2.0), 4.0)
    other = simulate(wheel(False, 3.0, Constant(value=square), length, torque=2.0 * square), 4.0)
    assert other["wheel.angle"][-1] == pytest.approx(usual["wheel.angle"][-1], rel=1e-10)


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_friction_of_a_guide_follows_its_normal_force(space: bool, method: str) -> None:
    """A block on a guide at 20 degrees: it holds with mu = 0.4, and slides with g (sin - mu cos) with 0.3."""
    angle = math.radians(20.0)
    held = simulate(slider(space, angle, 0.0, joint="guide", coefficient=0.4), 10.0, method=method)
    assert np.hypot(held["block.x"], held["block.y"]).max() < 1e-15
    assert held["rub.friction_force"][-1] == pytest.approx(-2.0 * 9.81 * math.sin(angle), rel=1e-12)
    sliding = simulate(slider(space, angle, 0.0, joint="guide", coefficient=0.3), 1.0, method=method)
    way = 0.5 * 9.81 * (math.sin(angle) - 0.3 * math.cos(angle))
    assert math.hypot(sliding["block.x"][-1], sliding["block.y"][-1]) == pytest.approx(way, rel=1e-8)


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf"])
def test_a_preload_adds_to_what_the_joint_carries(method: str) -> None:
    """Up the guide at 2 m/s: it comes to rest, and stays."""
    angle, mu, preload = math.radians(20.0), 0.35, 1.0
    model = slider(False, angle, -2.0, joint="guide", coefficient=mu, force=preload)
    result = simulate(model, 2.0, method=method)
    braking = 9.81 * (math.sin(angle) + mu * math.cos(angle)) + preload / 2.0
    assert math.hypot(result["block.x"][-1], result["block.y"][-1]) == pytest.approx(2.0**2 / (2.0 * braking), rel=1e-5)


MASS, ARM, CENTRAL, MU, RADIUS = 2.0, 0.5, 0.06, 0.3, 0.05


def pendulum(space: bool, angle: float, rate: float) -> Model:
    """A bar on a bearing with friction; its centre of mass is ARM below at angle 0."""
    c, s = math.cos(angle), math.sin(angle)
    place, velocity = (ARM * s, -ARM * c), (ARM * c * rate, ARM * s * rate)
    of = {"joint": "bearing", "coefficient": MU, "radius": RADIUS}
    if space:
        body: Any = RigidBody3D(
            name="bar", mass=MASS, inertia=(CENTRAL,) * 3, position=(*place, 0.0), velocity=(*velocity, 0.0),
            attitude=RotationVector(vector=(0.0, 0.0, angle)), angular_velocity=(0.0, 0.0, rate),
        )  # fmt: skip
        ends: Any = {"a": Marker3D(), "b": Marker3D(body="bar", point=(0.0, ARM, 0.0))}
        return Model(
            bodies=[body], joints=[Revolute3D(name="bearing", **ends)],
            forces=[RevoluteFriction3D(name="rub", **ends, **of)], gravity=(0.0, -9.81, 0.0),
        )  # fmt: skip
    body = RigidBody2D(
        name="bar", mass=MASS, inertia=CENTRAL, position=place, angle=angle, velocity=velocity, angular_velocity=rate
    )
    ends = {"a": Marker2D(), "b": Marker2D(body="bar", point=(0.0, ARM))}
    return Model(
        bodies=[body], joints=[Revolute2D(name="bearing", **ends)],
        forces=[RevoluteFriction2D(name="rub", **ends, **of)], gravity=(0.0, -9.81),
    )  # fmt: skip


def acceleration(angle: float, rate: float, sign: float) -> float:
    """Of the pendulum while it turns: J a = -m g l sin - sign mu R |F|, |F| = m |(l a - ..., ...)| solved for a."""
    s, c, weight = math.sin(angle), math.cos(angle), -MASS * 9.81 * ARM * math.sin(angle)
    found = weight / (CENTRAL + MASS * ARM**2)
    for _ in range(60):
        x, y = ARM * (found * c - rate**2 * s), ARM * (found * s + rate**2 * c) + 9.81
        found = (weight - sign * MU * RADIUS * MASS * math.hypot(x, y)) / (CENTRAL + MASS * ARM**2)
    return found


def swings(angle: float, rate: float, t_end: float) -> tuple[float, list[float]]:
    """(angle at the end, times at which it turns back), from half swing to half swing."""
    t, turns, sign = 0.0, [], math.copysign(1.0, rate or -angle)
    while t < t_end:

        def turned(_: float, y: Any, sign: float = sign) -> float:
            return float(y[1] + sign * 1e-9)

        turned.terminal = True  # type: ignore[attr-defined]
        turned.direction = -sign  # type: ignore[attr-defined]
        run = solve_ivp(
            lambda _, y, sign=sign: [y[1], acceleration(y[0], y[1], sign)], (t, t_end), [angle, rate],
            events=turned, rtol=1e-12, atol=1e-13,
        )  # fmt: skip
        t, angle, rate = float(run.t[-1]), float(run.y[0, -1]), 0.0
        if t < t_end:
            turns.append(t)
            sign = -sign
    return angle, turns


@pytest.mark.sampled(1)
@pytest.mark.parametrize("space", [False, True])
def test_a_pendulum_in_a_bearing_against_an_integration_of_its_own(space: bool) -> None:
    """The friction follows the force of the bearing, centrifugal part and all: mu R |F|."""
    result = simulate(pendulum(space, 0.4, 3.0), 3.0, method="irk", rtol=1e-8, atol=1e-11)
    angle, turns = swings(0.4, 3.0, 3.0)
    assert [event.t for event in result.events if event.kind == "slip"] == pytest.approx(turns, abs=2e-7)
    found = result["bearing.angle" if space else "bar.angle"][-1]
    assert found == pytest.approx(angle, abs=2e-7)
    force = np.sqrt(sum(result[f"bearing.force_{x}"] ** 2 for x in ("xyz" if space else "xy")))
    inside = np.abs(result["rub.sliding_velocity"]) > 1e-3
    assert np.abs(result["rub.friction_torque"])[inside] == pytest.approx(MU * RADIUS * force[inside], rel=1e-8)
    assert np.abs(result["energy.balance"]).max() < 1e-6


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("angle", [0.0299, 0.0301, -0.0299, -0.0301])
def test_a_pendulum_stays_within_its_angle_of_friction(space: bool, angle: float) -> None:
    """It holds while m g ARM sin(angle) < mu R m g."""
    result = simulate(pendulum(space, angle, 0.0), 1.0)
    moves = abs(result["bearing.angle" if space else "bar.angle"][-1] - angle)
    if abs(math.sin(angle)) < MU * RADIUS / ARM:
        assert moves < 1e-15
    else:
        assert moves > 1e-6


def test_of_a_driven_joint_friction_is_against_the_motion() -> None:
    """Its rate is prescribed: the motor has to overcome the friction, at reversals too."""
    model = wheel(False, 2.0, Constant(value=0.0), torque=0.7)
    motion = Sine(amplitude=0.2, angular_frequency=10.0)
    ends = {"a": Marker2D(point=(1.0, 0.0)), "b": Marker2D(body="wheel")}
    motor = RelativeMotor2D(name="motor", **ends, measure="angle", motion=motion)
    model = model.model_copy(update={"joints": (*model.joints, motor)})
    t = np.linspace(0.05, 0.95, 10)
    result = simulate(model, 1.0, t_eval=t)
    rate = np.cos(10.0 * t)
    assert result["rub.friction_torque"] == pytest.approx(-0.7 * np.sign(rate), rel=1e-9)


def test_friction_is_the_limit_of_the_regularised_law() -> None:
    stops = [
        simulate(wheel(False, 3.0, Constant(value=0.0), torque=2.0, **law), 1.0)["wheel.angle"][-1]
        for law in ({}, {"transition_rate": 1e-2}, {"transition_rate": 1e-3})
    ]
    assert abs(stops[2] - stops[0]) < 0.2 * abs(stops[1] - stops[0]) and abs(stops[2] - stops[0]) < 1e-3


def chain(space: bool, rng: Any, length: float) -> Model:
    """Up to four bars on hinges from the ground on, level at the start, with friction of both kinds in each hinge."""
    bars: list[Any] = []
    joints: list[Any] = []
    rubs: list[Any] = []
    x, last, weight = 0.0, 0.0, 9.81
    for k in range(int(rng.integers(2, 5))):
        size, mass = length * rng.uniform(0.5, 1.5), rng.uniform(0.3, 3.0)
        inertia = mass * size**2 / 12.0
        share: dict[str, Any] = {"torque": weight * length * rng.uniform(0.1, 0.8)}
        if rng.random() < 0.6:
            share = {"torque": 0.05 * weight * length, "joint": f"hinge{k}"}
            share |= {"coefficient": rng.uniform(0.1, 0.8), "radius": length * rng.uniform(0.02, 0.2)}
        share["static_ratio"] = float(rng.choice([1.0, 1.3]))
        place, tip = (x + 0.5 * size, 0.0), 0.5 * last
        if space:
            bars.append(RigidBody3D(name=f"bar{k}", mass=mass, inertia=(inertia,) * 3, position=(*place, 0.0)))
            a: Any = Marker3D() if k == 0 else Marker3D(body=f"bar{k - 1}", point=(tip, 0.0, 0.0))
            ends = {"a": a, "b": Marker3D(body=f"bar{k}", point=(-0.5 * size, 0.0, 0.0))}
            joints.append(Revolute3D(name=f"hinge{k}", **ends))
            rubs.append(RevoluteFriction3D(name=f"rub{k}", **ends, **share))
        else:
            bars.append(RigidBody2D(name=f"bar{k}", mass=mass, inertia=inertia, position=place))
            a = Marker2D() if k == 0 else Marker2D(body=f"bar{k - 1}", point=(tip, 0.0))
            ends = {"a": a, "b": Marker2D(body=f"bar{k}", point=(-0.5 * size, 0.0))}
            joints.append(Revolute2D(name=f"hinge{k}", **ends))
            rubs.append(RevoluteFriction2D(name=f"rub{k}", **ends, **share))
        x, last = x + size, size
    return Model(bodies=bars, joints=joints, forces=rubs, gravity=(0.0, -9.81, 0.0) if space else (0.0, -9.81))


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_hinges_of_random_chains_hold_or_slide(space: bool, seed: int) -> None:
    """Friction is within its limit at all times, against any motion, and takes what energy is lost."""
    rng = np.random.default_rng(seed)
    length = 10.0 ** rng.uniform(-3.0, 2.0)
    model = chain(space, rng, length)
    result = simulate(model, 5.0 * math.sqrt(length / 9.81), method=("ebdf", "irk", "adams")[seed % 3], rtol=1e-7)
    energy = 9.81 * length * sum(body.mass for body in model.bodies)
    assert np.abs(result["energy.balance"]).max() < 1e-4 * energy
    for k, rub in enumerate(model.forces):
        force = np.sqrt(sum(result[f"hinge{k}.force_{i}"] ** 2 for i in ("xyz" if space else "xy")))
        kinetic = rub.torque + rub.coefficient * (rub.radius or 0.0) * force
        torque, rate = result[f"rub{k}.friction_torque"], result[f"rub{k}.sliding_velocity"]
        assert np.all(np.abs(torque) <= rub.static_ratio * kinetic * (1.0 + 1e-6))
        fast = np.abs(rate) > 1e-3 * math.sqrt(9.81 / length)
        assert torque[fast] == pytest.approx(-np.sign(rate[fast]) * kinetic[fast], rel=1e-6)
        assert np.all(np.diff(result[f"rub{k}.dissipation"]) >= -1e-9 * energy)


def test_a_chain_comes_to_rest_in_any_order_of_its_frictions() -> None:
    bars, joints, rubs = [], [], []
    for k in range(2):
        bars.append(RigidBody2D(name=f"bar{k}", mass=1.0, inertia=0.02, position=(0.25 + 0.5 * k, 0.0)))
        a = Marker2D() if k == 0 else Marker2D(body=f"bar{k - 1}", point=(0.25, 0.0))
        ends = {"a": a, "b": Marker2D(body=f"bar{k}", point=(-0.25, 0.0))}
        joints.append(Revolute2D(name=f"hinge{k}", **ends))
        rubs.append(RevoluteFriction2D(name=f"rub{k}", **ends, torque=2.0 - k, static_ratio=1.2))
    orders: list[Callable[[list[Any]], list[Any]]] = [lambda x: x, lambda x: x[::-1]]
    found = []
    for order in orders:
        result = simulate(Model(bodies=bars, joints=joints, forces=order(rubs)), 4.0, rtol=1e-8, atol=1e-10)
        found.append([result[f"bar{k}.angle"][-1] for k in range(2)])
        for k in range(2):
            assert abs(result[f"rub{k}.sliding_velocity"][-1]) < 1e-9
            assert abs(result[f"rub{k}.friction_torque"][-1]) <= 1.2 * (2.0 - k) * (1.0 + 1e-9)
    assert found[1] == pytest.approx(found[0], abs=1e-8)


ENDS = {"a": Marker2D(), "b": Marker2D(body="wheel")}


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"coefficient": 0.3, "radius": 0.1}, "name the `joint`"),
        ({"joint": "bearing", "coefficient": 0.3}, "give `radius`"),
        ({"torque": 1.0, "radius": 0.1}, "no `joint` whose force"),
        ({"torque": 1.0, "static_ratio": 1.2, "transition_rate": 1.0}, "leave one of them out"),
        ({"joint": "bearing", "coefficient": 0.3, "radius": 0.1, "transition_rate": 1.0}, "leave one of them out"),
        ({"torque": 1.0, "static_ratio": 0.9}, "static_ratio"),
    ],
)
def test_what_does_not_fit_is_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(ModelError, match=said):
        RevoluteFriction2D(name="rub", **ENDS, **given)


def test_a_joint_that_is_none_is_refused() -> None:
    with pytest.raises(ModelError, match="joint 'hinge', which does not exist"):
        wheel(False, 0.0, Constant(value=0.0), joint="hinge", coefficient=0.3, radius=0.1)
    body = RigidBody2D(name="wheel", mass=1.0, inertia=1.0)
    motor = RelativeMotor2D(name="motor", **ENDS, measure="angle", motion=Constant(value=0.0))
    rub = RevoluteFriction2D(name="rub", **ENDS, joint="motor", coefficient=0.3, radius=0.1)
    with pytest.raises(ModelError, match="says no force between its bodies"):
        Model(bodies=[body], joints=[motor], forces=[rub])


def test_no_friction_at_all_is_nothing() -> None:
    load = CoordinateLoad(name="load", body="wheel", coordinate="angle", load=Constant(value=1.0))
    model = Model(
        bodies=[RigidBody2D(name="wheel", mass=1.0, inertia=1.0)],
        forces=[load, RevoluteFriction2D(name="rub", **ENDS)], gravity=(0.0, 0.0),
    )  # fmt: skip
    result = simulate(model, 1.0)
    assert result["wheel.angle"][-1] == pytest.approx(0.5, rel=1e-9) and "rub.friction_torque" not in result.channels
