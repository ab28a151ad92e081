"""Coulomb friction of spherical joints: one torque within a ball, against closed forms, hinges and scipy."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from tlismni.core import (
    AppliedTorque3D,
    Constant,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass3D,
    Ramp,
    Revolute3D,
    RevoluteFriction3D,
    RigidBody3D,
    RotationVector,
    Simulation,
    Sphere3D,
    SphereOnSphere3D,
    Spherical3D,
    SphericalFriction3D,
    State,
    simulate,
)

METHODS = {"ebdf": 1e-6, "irk": 1e-6, "bdf": 1e-4, "hht": 1e-3}
"""Of each method the error that its order leaves at default tolerances, relative."""
INERTIA, LIMIT = 0.5, 2.0
SPIN = np.array([0.3, -1.0, 2.0])
TURN = (0.7, -1.1, 0.4)
"""Axis times angle by which a whole model is turned, rad."""


def torque_of(result: Any) -> Any:
    """Friction torque on the ball, (N, 3), N m."""
    return np.stack([result[f"rub.friction_torque_{axis}"] for axis in "xyz"], axis=1)


def spin_of(result: Any, body: str = "ball") -> Any:
    """Angular velocity of a body in space, (N, 3), rad/s: w = 2 E(p) p'."""
    e0, e1, e2, e3 = (result[f"{body}.e{k}"] for k in range(4))
    d0, d1, d2, d3 = (result[f"{body}.e{k}_rate"] for k in range(4))
    x = -e1 * d0 + e0 * d1 - e3 * d2 + e2 * d3
    y = -e2 * d0 + e3 * d1 + e0 * d2 - e1 * d3
    return 2.0 * np.stack([x, y, -e3 * d0 - e2 * d1 + e1 * d2 + e0 * d3], axis=1)


def along_axes(torque: Any) -> dict[str, Any]:
    """Components of a torque, numbers or signals, as the fields of a load."""
    fields = zip(("torque_x", "torque_y", "torque_z"), torque, strict=True)
    return {name: Constant(value=x) if isinstance(x, float | int) else x for name, x in fields}


def ball(spin: Any, loads: Any, inertia: Any = (INERTIA,) * 3, turn: Any = (0, 0, 0), **friction: Any) -> Model:
    """A body on a spherical joint in its centre of mass, with a spin and a torque (three signals or numbers), all of it
    turned by `turn`."""
    rotation = Rotation.from_rotvec(turn)
    ends = {"a": Marker3D(point=tuple(rotation.apply((1, 0, 0)))), "b": Marker3D(body="ball")}
    body = RigidBody3D(
        name="ball", mass=1.0, inertia=inertia, angular_velocity=tuple(spin),
        position=ends["a"].point, attitude=RotationVector(vector=turn),
    )  # fmt: skip
    # (the marker's axes begin as those of the model that is not turned; the ball stays or its load turns with it)
    load = AppliedTorque3D(
        name="load", marker=Marker3D(body="ball"), follower=True,
        **along_axes(loads),
    )  # fmt: skip
    rub = SphericalFriction3D(name="rub", **ends, **friction)
    return Model(bodies=[body], joints=[Spherical3D(name="joint", **ends)], forces=[load, rub], gravity=(0, 0, 0))


@pytest.mark.parametrize("method", METHODS)
def test_what_is_loaded_below_its_friction_holds_for_ever(method: str) -> None:
    result = simulate(ball((0, 0, 0), (1.0, -1.2, 0.9), torque=LIMIT), 1000.0, method=method)
    for k in range(4):
        assert np.max(np.abs(result[f"ball.e{k}"] - (k == 0))) < 1e-15
    assert np.max(np.abs(spin_of(result))) < 1e-15
    assert torque_of(result) == pytest.approx(np.broadcast_to((-1.0, 1.2, -0.9), (len(result.t), 3)), rel=1e-12)
    assert result["rub.friction_torque"] == pytest.approx(math.hypot(1.0, 1.2, 0.9), rel=1e-12)
    assert result["rub.dissipation"][-1] == 0.0


@pytest.mark.parametrize("method", METHODS)
def test_a_ball_stops_along_its_axis(method: str) -> None:
    """J w' = -T w/|w|: the direction stays, t = J |w|/T, and the torque has done T times the angle."""
    result = simulate(ball(SPIN, (0, 0, 0), torque=LIMIT), 2.0, method=method)
    speed, error = float(np.linalg.norm(SPIN)), METHODS[method]
    (stop,) = [event for event in result.events if event.kind == "stick"]
    assert stop.contact == "rub" and stop.t == pytest.approx(INERTIA * speed / LIMIT, rel=error)
    w, moving = spin_of(result), result.t < 0.99 * stop.t
    rate = speed - LIMIT / INERTIA * result.t[moving]
    assert w[moving] == pytest.approx(rate[:, None] * SPIN / speed, abs=error * speed)
    assert torque_of(result)[moving] == pytest.approx(
        np.broadcast_to(-LIMIT * SPIN / speed, w[moving].shape), abs=error
    )
    assert result["rub.sliding_velocity"][moving] == pytest.approx(rate, abs=error * speed)
    assert result["rub.friction_torque"][-1] == pytest.approx(0.0, abs=1e-12)
    angle = 0.5 * speed * stop.t
    assert result["rub.dissipation"][-1] == pytest.approx(LIMIT * angle, rel=error)
    assert np.max(np.abs(result["energy.balance"])) < error * 0.5 * INERTIA * speed**2
    end = Rotation.from_quat([result[f"ball.e{k}"][-1] for k in (1, 2, 3, 0)]).as_rotvec()
    assert end == pytest.approx(angle * SPIN / speed, rel=10.0 * error)


@pytest.mark.parametrize("seed", range(4))
def test_it_breaks_away_where_its_torque_reaches_the_limit_in_any_direction(seed: int) -> None:
    way = np.random.default_rng(seed).normal(size=3)
    way /= np.linalg.norm(way)
    load = [Ramp(start=0.0, duration=1.0, after=float(3.0 * x)) for x in way]
    result = simulate(ball((0, 0, 0), load, torque=1.5, static_ratio=1.4), 1.5, rtol=1e-8)
    slip = next(event for event in result.events if event.kind == "slip")
    assert slip.contact == "rub" and slip.t == pytest.approx(0.7, abs=1e-9)
    # (3 t - 1.5)/J up to t = 1 and 1.5/J from there on; about one axis
    rate = ((1.5 * 1.0 - 1.5) - (1.5 * 0.49 - 1.5 * 0.7) + 1.5 * 0.5) / INERTIA
    assert spin_of(result)[-1] == pytest.approx(rate * way, rel=1e-6)


@pytest.mark.parametrize("static_ratio", [1.0, 1.3])
def test_where_it_slides_to_follows_from_all_three_inertias(static_ratio: float) -> None:
    """A load above the limit at once: J a = M - T d with a along d, |d| = 1, which is not along M."""
    inertia, load = np.array([0.2, 0.5, 0.7]), np.array([3.0, -2.0, 2.5])
    result = simulate(ball((0, 0, 0), load, inertia, torque=LIMIT, static_ratio=static_ratio), 1e-3)

    def off(size: float) -> float:
        return float(np.linalg.norm(load / (LIMIT + inertia * size)) - 1.0)

    low, high = 0.0, 100.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if off(middle) > 0.0 else (low, middle)
    way = load / (LIMIT + inertia * low)
    assert torque_of(result)[-1] == pytest.approx(-LIMIT * way, rel=1e-3)
    assert spin_of(result)[-1] == pytest.approx(1e-3 * low * way, rel=2e-3)


def test_it_is_the_same_in_any_frame() -> None:
    """The whole model turned: spins, slides, stops, holds and breaks away alike."""
    load = (0.5, Ramp(start=0.5, duration=2.0, after=4.0), -0.7)
    tight: dict[str, Any] = {"rtol": 1e-10, "atol": 1e-12, "t_eval": np.linspace(0.0, 3.0, 31)}
    first = simulate(ball(SPIN, load, (0.3, 0.5, 0.7), torque=LIMIT, static_ratio=1.1), 3.0, **tight)
    other = simulate(ball(SPIN, load, (0.3, 0.5, 0.7), turn=TURN, torque=LIMIT, static_ratio=1.1), 3.0, **tight)
    rotation = Rotation.from_rotvec(TURN)
    assert [e.kind for e in first.events] == [e.kind for e in other.events]
    assert {e.kind for e in first.events} >= {"stick", "slip"}
    assert [e.t for e in other.events] == pytest.approx([e.t for e in first.events], abs=1e-8)
    assert spin_of(other) == pytest.approx(rotation.apply(spin_of(first)), abs=1e-8)
    assert torque_of(other) == pytest.approx(rotation.apply(torque_of(first)), abs=1e-7)


def test_energy_is_kept_where_the_direction_turns() -> None:
    """About the middle axis of inertia the ball tumbles, and the torque is against its turning all the time."""
    result = simulate(ball((0.1, 4.0, 0.1), (0, 0, 0), (0.5, 0.3, 0.2), torque=0.2), 8.0, rtol=1e-9, atol=1e-11)
    assert np.max(np.abs(result["energy.balance"])) < 1e-7
    w, moving = spin_of(result), result["rub.sliding_velocity"] > 1e-3
    size = np.linalg.norm(w[moving], axis=1)
    assert torque_of(result)[moving] == pytest.approx(-0.2 * w[moving] / size[:, None], abs=1e-6)
    cosines = w[moving] @ w[0] / np.linalg.norm(w[0]) / size
    assert np.min(cosines) < 0.95


MASS, ARM, CENTRAL, MU, RADIUS = 2.0, 0.5, 0.06, 0.3, 0.05


def pendulum(spherical: bool, unit: float = 1.0, weight: float = 1.0, **friction: Any) -> Model:
    """A bar let go at 1 rad, with its centre of mass ARM below; lengths in units of `unit` m, masses of `weight` kg."""
    angle, length, mass = 1.0, 1.0 / unit, 1.0 / weight
    arm, inertia = ARM * length, CENTRAL * mass * length**2
    place = (arm * math.sin(angle), -arm * math.cos(angle), 0.0)
    body = RigidBody3D(
        name="bar", mass=MASS * mass, inertia=(inertia,) * 3, position=place,
        attitude=RotationVector(vector=(0.0, 0.0, angle)),
    )  # fmt: skip
    ends: Any = {"a": Marker3D(), "b": Marker3D(body="bar", point=(0.0, arm, 0.0))}
    of: Any = {"name": "rub", **ends, **friction}
    joint: Any = Spherical3D(name="bearing", **ends) if spherical else Revolute3D(name="bearing", **ends)
    rub: Any = SphericalFriction3D(**of) if spherical else RevoluteFriction3D(**of)
    return Model(bodies=[body], joints=[joint], forces=[rub], gravity=(0.0, -9.81 * length, 0.0))


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf"])
@pytest.mark.parametrize(
    "friction",
    [{"torque": 0.7}, {"torque": 0.5, "joint": "bearing", "coefficient": MU, "radius": RADIUS, "static_ratio": 1.2}],
)
def test_a_pendulum_in_a_plane_is_that_on_a_hinge(method: str, friction: dict[str, Any]) -> None:
    t = np.linspace(0.0, 6.0, 61)
    on_ball, on_hinge = (
        simulate(pendulum(spherical, **friction), 6.0, method=method, rtol=1e-8, atol=1e-10, t_eval=t)
        for spherical in (True, False)
    )
    for channel in ("bar.x", "bar.y", "rub.dissipation"):
        assert on_ball[channel] == pytest.approx(on_hinge[channel], abs=2e-6)
    assert np.max(np.abs(on_ball["bar.z"])) < 1e-12
    assert on_ball["rub.friction_torque_z"][:-1] == pytest.approx(on_hinge["rub.friction_torque"][:-1], abs=1e-4)
    kinds = [[e.kind for e in result.events] for result in (on_ball, on_hinge)]
    assert kinds[0] == kinds[1] and "stick" in kinds[0]


def test_units_do_not_matter() -> None:
    """In mm and g."""
    of: dict[str, Any] = {"joint": "bearing", "coefficient": MU}
    tight: dict[str, Any] = {"rtol": 1e-10, "atol": 1e-12}
    usual = simulate(pendulum(True, torque=0.1, radius=RADIUS, **of), 4.0, **tight)
    other = simulate(pendulum(True, 1e-3, 1e-3, torque=0.1e9, radius=1e3 * RADIUS, **of), 4.0, **tight)
    assert other["bar.x"][-1] == pytest.approx(1e3 * usual["bar.x"][-1], rel=1e-8)
    assert other["rub.friction_torque"][-1] == pytest.approx(1e9 * usual["rub.friction_torque"][-1], rel=1e-8)


def test_a_conical_pendulum_follows_scipy() -> None:
    """Friction that follows the joint's force, in space: J w' = -r x m g - mu R |F| w/|w|, F = m (a - g) with
    a = w' x r + w x (w x r), solved for w' by iteration; the body is a sphere, which turns about itself too."""
    gravity, spin = np.array([0.0, 0.0, -9.81]), np.array([0.5, 2.0, 5.0])
    start = np.array([0.3, 0.0, -0.4])
    inertia = CENTRAL

    def accelerates(w: Any, r: Any) -> Any:
        found = np.zeros(3)
        whole = inertia * np.eye(3) + MASS * (r @ r * np.eye(3) - np.outer(r, r))
        for _ in range(100):
            force = MASS * (np.cross(found, r) + np.cross(w, np.cross(w, r)) - gravity)
            rub = -MU * RADIUS * np.linalg.norm(force) * w / np.linalg.norm(w)
            # about the fixed point; J of a sphere beside the point mass
            turn = np.cross(w, whole @ w)
            found = np.linalg.solve(whole, np.cross(r, MASS * gravity) + rub - turn)
        return found

    def rates(_: float, y: Any) -> Any:
        r, w = y[:3], y[3:]
        return np.concatenate([np.cross(w, r), accelerates(w, r)])

    t = np.linspace(0.0, 1.0, 11)
    wanted = solve_ivp(rates, (0.0, 1.0), [*start, *spin], rtol=1e-10, atol=1e-12, t_eval=t).y
    body = RigidBody3D(
        name="bar", mass=MASS, inertia=(inertia,) * 3, position=tuple(start), velocity=tuple(np.cross(spin, start)),
        angular_velocity=tuple(spin),
    )  # fmt: skip
    ends: Any = {"a": Marker3D(), "b": Marker3D(body="bar", point=tuple(-start))}
    rub = SphericalFriction3D(name="rub", **ends, joint="bearing", coefficient=MU, radius=RADIUS)
    model = Model(
        bodies=[body], joints=[Spherical3D(name="bearing", **ends)], forces=[rub], gravity=tuple(gravity)
    )  # fmt: skip
    result = simulate(model, 1.0, rtol=1e-9, atol=1e-11, t_eval=t)
    found = np.stack([result[f"bar.{axis}"] for axis in "xyz"])
    assert found == pytest.approx(wanted[:3], abs=1e-7)
    assert spin_of(result, "bar").T == pytest.approx(wanted[3:], abs=1e-6)
    force = np.sqrt(sum(result[f"bearing.force_{axis}"] ** 2 for axis in "xyz"))
    assert result["rub.friction_torque"] == pytest.approx(MU * RADIUS * force, rel=1e-8)


@pytest.mark.parametrize("angle", [0.0299, 0.0301])
def test_a_pendulum_stays_within_its_angle_of_friction(angle: float) -> None:
    """In any vertical plane it hangs while m g ARM sin(angle) < mu R m g."""
    way = np.array([0.6, 0.0, 0.8])
    axis = np.cross([0.0, -1.0, 0.0], way)
    place = ARM * (math.sin(angle) * way + math.cos(angle) * np.array([0.0, -1.0, 0.0]))
    body = RigidBody3D(
        name="bar", mass=MASS, inertia=(CENTRAL,) * 3, position=tuple(place),
        attitude=RotationVector(vector=tuple(angle * axis)),
    )  # fmt: skip
    ends: Any = {"a": Marker3D(), "b": Marker3D(body="bar", point=(0.0, ARM, 0.0))}
    rub = SphericalFriction3D(name="rub", **ends, joint="bearing", coefficient=MU, radius=RADIUS)
    model = Model(
        bodies=[body], joints=[Spherical3D(name="bearing", **ends)], forces=[rub], gravity=(0.0, -9.81, 0.0)
    )  # fmt: skip
    result = simulate(model, 1.0)
    moved = math.dist([result[f"bar.{n}"][-1] for n in "xyz"], place)
    if math.sin(angle) < MU * RADIUS / ARM:
        assert moved < 1e-15
    else:
        assert moved > 1e-6


@pytest.mark.parametrize("order", [1, -1])
def test_a_rod_on_two_balls_turns_about_its_line(order: int) -> None:
    """Two spherical joints leave one turn free; both frictions have a torque along it alone, in any direction of space,
    and hold together what one of them could not."""
    line = np.array([1.0, 2.0, -1.5]) / np.linalg.norm([1.0, 2.0, -1.5])
    body = RigidBody3D(name="rod", mass=1.0, inertia=(0.2, 0.2, 0.2))
    joints, rubs = [], []
    for k, place in enumerate((line, -line)):
        ends = {"a": Marker3D(point=tuple(place)), "b": Marker3D(body="rod", point=tuple(place))}
        joints.append(Spherical3D(name=f"joint{k}", **ends))
        rubs.append(SphericalFriction3D(name=f"rub{k}", **ends, torque=1.0 + 0.5 * k))
    ramps = along_axes([Ramp(start=0.0, duration=1.0, after=float(5.0 * x)) for x in line])
    load = AppliedTorque3D(name="load", marker=Marker3D(body="rod"), **ramps)
    model = Model(bodies=[body], joints=joints, forces=[load, *rubs[::order]], gravity=(0, 0, 0))
    result = simulate(model, 1.0, rtol=1e-8)
    slip = max(event.t for event in result.events if event.kind == "slip")
    assert slip == pytest.approx(0.5, abs=1e-6)
    assert float(spin_of(result, "rod")[-1] @ line) == pytest.approx((5.0 * 0.375 - 2.5 * 0.5) / 0.2, rel=1e-5)


def test_friction_is_the_limit_of_the_regularised_law() -> None:
    ends = []
    for law in ({}, {"transition_rate": 1e-2}, {"transition_rate": 1e-3}):
        result = simulate(ball(SPIN, (0, 0, 0), torque=LIMIT, **law), 1.0)
        ends.append(Rotation.from_quat([result[f"ball.e{k}"][-1] for k in (1, 2, 3, 0)]).as_rotvec())
        assert np.max(np.abs(result["energy.balance"])) < 1e-5
    near, nearer = np.linalg.norm(ends[1] - ends[0]), np.linalg.norm(ends[2] - ends[0])
    assert nearer < 0.2 * near and nearer < 1e-3


@pytest.mark.parametrize("t", [0.2, 0.56, 1.2, 1.9])
def test_a_restored_run_goes_on_to_the_same_bytes(t: float) -> None:
    """While it slides, holds, and slides again."""
    load = (0.5, Ramp(start=0.5, duration=2.0, after=4.0), -0.7)
    model = ball(SPIN, load, (0.3, 0.5, 0.7), torque=LIMIT, static_ratio=1.1)
    sim, other = Simulation(model), Simulation(model)
    sim.advance(t)
    other.advance(0.3 * t)
    other.restore(State.from_bytes(sim.state().to_bytes()))
    known, before = len(sim.events), len(other.events)
    for run in (sim, other):
        run.advance(2.5)
    assert other.state().deciding_bytes() == sim.state().deciding_bytes()
    assert other.events[before:] == sim.events[known:]


def test_a_blow_finds_no_friction_of_the_joint() -> None:
    """An impact takes no time, and a friction whose size does not grow with it gives no impulse: what holds is struck
    as without friction, and is braked from then on."""

    def struck(*rubs: Any) -> Any:
        bar = RigidBody3D(name="bar", mass=2.0, inertia=(0.06, 0.06, 0.06), position=(0.0, 0.0, -0.5))
        shot = RigidBody3D(
            name="shot", mass=0.5, inertia=(0.01, 0.01, 0.01), position=(-0.5, 0.0, -0.9), velocity=(4.0, 0.0, 0.0)
        )  # fmt: skip
        shapes = (Sphere3D(marker=Marker3D(body="bar", point=(0.0, 0.0, -0.4)), radius=0.1),
                  Sphere3D(marker=Marker3D(body="shot"), radius=0.1))  # fmt: skip
        hit = SphereOnSphere3D(name="hit", a=shapes[0], b=shapes[1], law=NewtonImpact(restitution=0.5))
        model = Model(
            bodies=[bar, shot], joints=[Spherical3D(name="joint", **JOINED)], forces=rubs, contacts=[hit],
            gravity=(0, 0, 0),
        )  # fmt: skip
        return simulate(model, 0.5, rtol=1e-9, atol=1e-11)

    free, braked = struck(), struck(SphericalFriction3D(name="rub", **JOINED, torque=6.0))
    (blow,), (other,) = ([e for e in result.events if e.kind == "impact"] for result in (free, braked))
    assert other.t == pytest.approx(blow.t, abs=1e-10) and other.impulse == pytest.approx(blow.impulse, rel=1e-10)
    (stop,) = [event for event in braked.events if event.kind == "stick"]
    rate = abs(spin_of(free, "bar")[-1][1])
    assert stop.t - other.t == pytest.approx((0.06 + 2.0 * 0.5**2) * rate / 6.0, rel=1e-6)
    assert np.max(np.abs(braked["energy.balance"])) < 1e-7


JOINED = {"a": Marker3D(), "b": Marker3D(body="bar", point=(0.0, 0.0, 0.5))}
ENDS = {"a": Marker3D(), "b": Marker3D(body="ball")}


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"coefficient": 0.3, "radius": 0.1}, "name the `joint`"),
        ({"joint": "joint", "coefficient": 0.3}, "give `radius`"),
        ({"torque": 1.0, "static_ratio": 1.2, "transition_rate": 1.0}, "leave one of them out"),
    ],
)
def test_what_does_not_fit_is_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(ModelError, match=said):
        SphericalFriction3D(name="rub", **ENDS, **given)


def test_a_point_has_no_turns() -> None:
    with pytest.raises(ModelError, match="is a point"):
        Model(
            bodies=[PointMass3D(name="ball", mass=1.0)], forces=[SphericalFriction3D(name="rub", **ENDS, torque=1.0)]
        )  # fmt: skip
