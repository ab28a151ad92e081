"""Bodies that spin fast in space keep energy and momentum with every method at default tolerances."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import (
    AppliedForce3D,
    AppliedTorque3D,
    Constant,
    EulerParameters,
    Marker3D,
    Model,
    Revolute3D,
    RigidBody3D,
    Simulation,
    simulate,
)

ACROSS = EulerParameters(values=(0.5**0.5, -(0.5**0.5), 0.0, 0.0))
"""The z axis of a marker along the y axis."""
TURNS = 100
METHODS = ("ebdf", "mebdf", "bdf", "newmark", "hht", "park", "adams", "trapezoidal", "irk")
FORMULAS = [(method, {}) for method in METHODS] + [
    ("irk", {"tableau": tableau}) for tableau in ("gauss2", "gauss3", "sdirk4")
]
every_formula = pytest.mark.parametrize(
    "method, options", FORMULAS, ids=[options.get("tableau", method) for method, options in FORMULAS]
)


def rate_in_space(p: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """w = 2 E p', rad/s."""
    e0, e = p[0], p[1:]
    return 2.0 * (e0 * rate[1:] - rate[0] * e + np.cross(e, rate[1:]))


def momentum_in_space(body: RigidBody3D, p: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """A J A^T w, N m s."""
    e0, e = p[0], p[1:]
    skew = np.array([[0.0, -e[2], e[1]], [e[2], 0.0, -e[0]], [-e[1], e[0], 0.0]])
    turn = (2.0 * e0 * e0 - 1.0) * np.eye(3) + 2.0 * (np.outer(e, e) + e0 * skew)
    return turn @ (np.array(body.inertia) * (turn.T @ rate_in_space(p, rate)))


def spin(body: RigidBody3D, joints: list[Revolute3D], speed: float, method: str, **options: object) -> tuple:
    """By how much energy and angular velocity at the end differ from those at the start, relative, and steps a turn."""
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[body], joints=joints)
    result = simulate(model, TURNS * 2.0 * np.pi / speed, method=method, **options)
    energy = result["energy.kinetic"]
    before, after = (rate_in_space(result.q[k, 3:7], result.v[k, 3:7]) for k in (0, -1))
    off = np.linalg.norm(after - before) / np.linalg.norm(before)
    return energy[-1] / energy[0] - 1.0, off, result.stats["steps"] / TURNS


@every_formula
def test_a_free_body_that_spins_about_a_principal_axis_keeps_energy_and_momentum(method: str, options: dict) -> None:
    # 1e-11 in 100 turns is 1e-9 in 10 000
    body = RigidBody3D(name="body", mass=1.0, inertia=(0.1, 0.2, 0.25), angular_velocity=(0.0, 0.0, 200.0))
    gain, off, steps = spin(body, [], 200.0, method, **options)
    assert abs(gain) < 1e-11
    assert off < 1e-11
    assert steps <= 20.0


@pytest.mark.parametrize(
    "method, options", [("ebdf", {}), ("bdf", {}), ("hht", {}), *FORMULAS[METHODS.index("irk") :]], ids=str
)
def test_a_rotor_on_a_hinge_keeps_its_speed(method: str, options: dict) -> None:
    body = RigidBody3D(name="rotor", mass=2.0, inertia=(0.1, 0.2, 0.25), angular_velocity=(0.0, 0.0, -30.0))
    hinge = Revolute3D(name="hinge", a=Marker3D(), b=Marker3D(body="rotor"))
    gain, off, steps = spin(body, [hinge], 30.0, method, **options)
    assert abs(gain) < 1e-11
    assert off < 1e-11
    assert steps <= 20.0


@every_formula
def test_a_rotor_with_its_centre_of_mass_off_the_axis_keeps_its_speed(method: str, options: dict) -> None:
    # the start has one of its positions as the independent coordinate: the attitude is, from the second step on
    speed = 30.0
    rotor = RigidBody3D(
        name="rotor", mass=2.0, inertia=(0.1, 0.2, 0.25), position=(0.1, 0.0, 0.0), velocity=(0.0, 0.1 * speed, 0.0),
        angular_velocity=(0.0, 0.0, speed),
    )  # fmt: skip
    hinge = Revolute3D(name="hinge", a=Marker3D(), b=Marker3D(body="rotor", point=(-0.1, 0.0, 0.0)))
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[rotor], joints=[hinge])
    result = simulate(model, TURNS * 2.0 * np.pi / speed, method=method, **options)
    assert result.stats["steps"] / TURNS <= 22.0
    energy = result["energy.kinetic"]
    assert np.abs(energy / energy[0] - 1.0).max() < 1e-6
    begun = int(np.searchsorted(result.t, 0.1 * result.t[-1]))
    assert abs(energy[-1] / energy[begun] - 1.0) < 1e-10
    pull = np.hypot(result["hinge.force_x"], result["hinge.force_y"])[begun:]
    assert pull == pytest.approx(2.0 * 0.1 * speed**2, rel=1e-6)


@pytest.mark.full
@every_formula
def test_a_body_keeps_energy_and_momentum_over_ten_thousand_turns(method: str, options: dict) -> None:
    body = RigidBody3D(name="body", mass=1.0, inertia=(0.1, 0.2, 0.25), angular_velocity=(0.0, 0.0, 200.0))
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[body])
    result = simulate(model, 1e4 * 2.0 * np.pi / 200.0, method=method, record=False, **options)
    before, after = (momentum_in_space(body, result.q[k, 3:7], result.v[k, 3:7]) for k in (0, -1))
    assert np.linalg.norm(after - before) < 1e-9 * np.linalg.norm(before)
    rate = rate_in_space(result.q[-1, 3:7], result.v[-1, 3:7])
    assert rate @ after == pytest.approx(200.0**2 * 0.25, rel=1e-9)
    assert result.stats["steps"] <= 20e4


@pytest.mark.parametrize("rtol", (1e-6, 1e-10))
@every_formula
def test_reactions_of_a_rotor_on_a_hinge_are_as_exact_as_its_motion(method: str, options: dict, rtol: float) -> None:
    """A torque across the axis, which stands in space: the hinge carries just that, whatever the attitude is.

    In turning frames coordinates are predicted to rounding, and tell nothing of the matrices that reactions take.
    """
    top = RigidBody3D(name="top", mass=2.0, inertia=(0.1, 0.2, 0.3), angular_velocity=(0.0, 0.0, 6.0))
    hinge = Revolute3D(name="hinge", a=Marker3D(), b=Marker3D(body="top"))
    loads = [
        AppliedForce3D(name="push", marker=Marker3D(body="top"), force_x=Constant(value=3.0)),
        AppliedTorque3D(name="tilt", marker=Marker3D(body="top"), torque_x=Constant(value=0.7)),
    ]
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[top], joints=[hinge], forces=loads)
    result = simulate(model, 2.0, method=method, rtol=rtol, **options)
    assert result.stats["steps"] < 100
    begun = result.t > 0.5
    for channel, load in (("hinge.force_x", -3.0), ("hinge.torque_x", -0.7)):
        assert result[channel] == pytest.approx(load, rel=1e-7)
        assert result[channel][begun] == pytest.approx(load, rel=1e-9)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("seed", range(16))
def test_balls_that_spin_about_any_axis_at_any_speed_keep_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    speed = 10.0 ** rng.uniform(-1.0, 4.0)
    axis = rng.normal(size=3)
    w = speed * axis / np.linalg.norm(axis)
    body = RigidBody3D(
        name="ball", mass=1.0, inertia=(0.4, 0.4, 0.4), velocity=tuple(rng.normal(size=3)), angular_velocity=tuple(w)
    )
    method, options = FORMULAS[seed % len(FORMULAS)]
    gain, off, steps = spin(body, [], speed, method, **options)
    assert abs(off) < 1e-11
    assert abs(gain) < 1e-11
    assert steps <= 20.0


@every_formula
def test_a_symmetrical_body_that_nutates_keeps_energy_and_momentum(method: str, options: dict) -> None:
    # its angular velocity turns about the angular momentum in space and about the axis in the body: regular precession
    body = RigidBody3D(name="top", mass=1.0, inertia=(0.15, 0.15, 0.25), angular_velocity=(60.0, -20.0, 180.0))
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[body])
    result = simulate(model, 1.0, method=method, **options)
    energy = result["energy.kinetic"]
    assert np.abs(energy / energy[0] - 1.0).max() < 1e-8
    begun = int(np.searchsorted(result.t, 0.05))
    assert abs(energy[-1] / energy[begun] - 1.0) < 1e-11
    momenta = [momentum_in_space(body, result.q[k, 3:7], result.v[k, 3:7]) for k in (begun, -1)]
    assert np.linalg.norm(momenta[1] - momenta[0]) < 1e-11 * np.linalg.norm(momenta[0])


@pytest.mark.parametrize("rtol", (1e-7, 1e-8, 1e-9))
@pytest.mark.parametrize("method", ("newmark", "hht", "trapezoidal", "park"))
def test_formulas_of_order_two_find_the_frame_with_fine_tolerances_too(method: str, rtol: float) -> None:
    # their steps are so short first that errors in space look negligible; what they carry belongs to a frame
    body = RigidBody3D(name="top", mass=1.0, inertia=(0.15, 0.15, 0.25), angular_velocity=(60.0, -20.0, 180.0))
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=[body]), 0.3, method=method, rtol=rtol)
    assert result.stats["steps"] < 600
    energy = result["energy.kinetic"]
    assert np.abs(energy / energy[0] - 1.0).max() < 1e-2 * rtol


TUMBLING = {
    "three": ((0.1, 0.2, 0.25), (1.0, 2.0, 1.5)),
    "any": ((0.73, 0.41, 0.52), (-0.4, 0.7, 1.1)),
    "nearly two": ((0.15, 0.15 * (1.0 + 1e-6), 0.25), (0.3, -0.1, 0.9)),
    "hardly not two": ((0.15, 0.15 * (1.0 + 1e-10), 0.25), (0.3, -0.1, 0.9)),
    "flips": ((0.1, 0.2, 0.25), (1e-6, 1.0, 1e-6)),
    "disk": ((0.1, 0.11, 0.21), (1.0, 0.3, 1.0)),
    "rod": ((0.002, 0.2, 0.2005), (1.0, 1.0, 0.2)),
}
"""Moments of inertia and axes of the angular velocity at the start, in the body."""


def tumble(kind: str, turns: float, method: str, **options: object) -> tuple[float, float, float]:
    """By how much energy and angular momentum at the end differ from those at the start, relative, and steps a turn."""
    moments, axis = TUMBLING[kind]
    w = 200.0 * np.array(axis) / np.linalg.norm(axis)
    body = RigidBody3D(
        name="body", mass=1.0, inertia=moments, angular_velocity=tuple(w), velocity=(1.0, 0.0, 3.0),
        attitude=EulerParameters(values=(0.5, -0.1, 0.7, 0.5)),
    )  # fmt: skip
    # with gravity: a body that flies is as free
    model = Model(gravity=(0.0, 0.0, -9.81), bodies=[body])
    result = simulate(model, turns * 2.0 * np.pi / 200.0, method=method, record=False, **options)
    before, after = (momentum_in_space(body, result.q[k, 3:7], result.v[k, 3:7]) for k in (0, -1))
    energies = [
        momentum @ rate_in_space(result.q[k, 3:7], result.v[k, 3:7]) for k, momentum in ((0, before), (-1, after))
    ]
    off = np.linalg.norm(after - before) / np.linalg.norm(before)
    return energies[1] / energies[0] - 1.0, off, result.stats["steps"] / turns


@pytest.mark.parametrize("kind", TUMBLING)
@every_formula
def test_a_body_that_tumbles_keeps_energy_and_momentum(method: str, options: dict, kind: str) -> None:
    # 1e-11 in 100 turns is 1e-9 in 10 000
    gain, off, steps = tumble(kind, TURNS, method, **options)
    assert abs(gain) < 1e-11
    assert off < 1e-11
    assert steps <= 20.0


@pytest.mark.full
@pytest.mark.parametrize("kind", TUMBLING)
@every_formula
def test_a_body_that_tumbles_keeps_them_over_ten_thousand_turns(method: str, options: dict, kind: str) -> None:
    gain, off, steps = tumble(kind, 1e4, method, **options)
    assert abs(gain) < 1e-9
    assert off < 1e-9
    assert steps <= 20.0


@pytest.mark.parametrize(
    "method, options", (("adams", {"order": 2}), ("adams", {"order": 4}), ("bdf", {"order": 4})), ids=str
)
def test_formulas_of_other_orders_keep_it(method: str, options: dict) -> None:
    # higher ones err at the start, whose steps grow: in energy by 2e-9 with bdf of order 5, 3e-10 with adams of order 6
    gain, off, steps = tumble("three", TURNS, method, **options)
    assert abs(gain) < 1e-11
    assert off < 1e-11
    assert steps <= 20.0


def motion_in_space(moments: tuple, torque: Callable[[np.ndarray, np.ndarray], np.ndarray], times: np.ndarray) -> tuple:
    """Euler parameters and angular velocity in the body at `times`, from those of `TUMBLING`'s start at rest in space.

    `torque`: in the body, N m, of the Euler parameters and the angular velocity.
    """
    inertia = np.array(moments)

    def equations(t: float, y: np.ndarray) -> np.ndarray:
        p, w = y[:4], y[4:]
        change = 0.5 * np.concatenate([[-p[1:] @ w], p[0] * w + np.cross(p[1:], w)])
        return np.concatenate([change, (torque(p, w) - np.cross(w, inertia * w)) / inertia])

    start = np.array([1.0, 0.0, 0.0, 0.0, 12.0, 24.0, 18.0])
    solved = solve_ivp(equations, (0.0, times[-1]), start, method="DOP853", rtol=1e-13, atol=1e-14, t_eval=times)
    return solved.y[:4].T, solved.y[4:].T


@pytest.mark.parametrize("method, options", (("ebdf", {}), ("irk", {}), ("hht", {}), ("adams", {})), ids=str)
@pytest.mark.parametrize("kind", ("three", "disk", "rod"))
def test_what_is_asked_for_between_steps_is_as_exact(method: str, options: dict, kind: str) -> None:
    moments, times = TUMBLING[kind][0], np.linspace(0.0, 1.0, 101)
    body = RigidBody3D(name="body", mass=1.0, inertia=moments, angular_velocity=(12.0, 24.0, 18.0))
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=[body]), 1.0, method=method, t_eval=times, **options)
    exact, _ = motion_in_space(moments, lambda p, w: np.zeros(3), times)
    assert np.abs(result.q[:, 3:7] - exact).max() < 3e-10


@pytest.mark.parametrize("method, options", FORMULAS[-4:] + FORMULAS[:5], ids=str)
@pytest.mark.parametrize("load", (0.02, 2.0))
def test_a_body_with_a_torque_tumbles_to_the_tolerance(method: str, options: dict, load: float) -> None:
    """A torque that stands in space: a hundredth of the inertia's own torques, which leaves the frame of a free body,
    and as much as these, which does not."""
    moments, times = (0.1, 0.2, 0.25), np.array([0.0, 1.0])
    body = RigidBody3D(name="body", mass=1.0, inertia=moments, angular_velocity=(12.0, 24.0, 18.0))
    torque = AppliedTorque3D(name="torque", marker=Marker3D(body="body"), torque_x=Constant(value=load))
    model = Model(gravity=(0.0, 0.0, 0.0), bodies=[body], forces=[torque])
    result = simulate(model, 1.0, method=method, record=False, **options)

    def in_body(p: np.ndarray, w: np.ndarray) -> np.ndarray:
        e0, x, y, z = p
        return load * np.array([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - e0 * z), 2.0 * (x * z + e0 * y)])

    exact, _ = motion_in_space(moments, in_body, times)
    assert np.abs(result.q[-1, 3:7] - exact[-1]).max() < (1e-5 if load < 1.0 else 3e-5)


@pytest.mark.parametrize("outer, method", (("simple", "ebdf"), ("jfnk", "ebdf"), ("simple", "irk")))
def test_the_other_outer_loops_keep_it_too(outer: str, method: str) -> None:
    body = RigidBody3D(name="body", mass=1.0, inertia=(0.1, 0.1, 0.1), angular_velocity=(30.0, -20.0, 5.0))
    gain, off, _ = spin(body, [], 36.0, method, outer=outer)
    assert abs(gain) < 1e-8
    assert off < 1e-8


def test_a_heavy_rotor_turns_as_its_torque_says() -> None:
    # a pendulum on a hinge that swings over: what is not uniform is integrated to the tolerance, whatever the frame
    body = RigidBody3D(
        name="bob", mass=1.0, inertia=(0.02, 0.03, 0.04), position=(0.0, 0.0, -0.3), angular_velocity=(0.0, 25.0, 0.0),
        velocity=(-7.5, 0.0, 0.0),
    )  # fmt: skip
    hinge = Revolute3D(
        name="hinge", a=Marker3D(attitude=ACROSS), b=Marker3D(body="bob", point=(0.0, 0.0, 0.3), attitude=ACROSS)
    )
    model = Model(gravity=(0.0, 0.0, -9.81), bodies=[body], joints=[hinge])
    result = simulate(model, 2.0, method="ebdf", rtol=1e-9, atol=1e-11)
    total = result["energy.kinetic"] + result["energy.potential"]
    assert np.abs(total / total[0] - 1.0).max() < 1e-6


def test_going_back_and_on_gives_the_same_bits() -> None:
    body = RigidBody3D(name="body", mass=1.0, inertia=(0.1, 0.15, 0.22), angular_velocity=(5.0, 2.0, 20.0))
    run = Simulation(Model(gravity=(0.0, 0.0, 0.0), bodies=[body]), "hht")
    run.run_to(0.2)
    kept = run.state()
    run.run_to(0.4)
    first = run.state()
    run.restore(kept)
    run.run_to(0.4)
    assert run.state() == first
