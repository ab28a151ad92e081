"""Linear systems with constant matrices against the matrix exponential, and loads and drivers on their coordinates."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, integrate, on
from scipy.linalg import eigh, expm
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    Constant,
    CoordinateDriver,
    CoordinateLoad,
    Input,
    InputSignal,
    LinearSystem,
    Model,
    ModelError,
    PointMass2D,
    RigidBody2D,
    Simulation,
    Sine,
    SpringDamper2D,
    simulate,
)

TIGHT = {"rtol": 1e-10, "atol": 1e-12}
M = ((2.0, 0.3, 0.1), (0.3, 1.0, 0.2), (0.1, 0.2, 0.7))
C = ((0.4, 0.3, 0.0), (-0.3, 0.2, 0.1), (0.0, 0.1, 0.5))
K = ((40.0, -10.0, 0.0), (-10.0, 30.0, 5.0), (0.0, 5.0, 20.0))
F = (1.0, -2.0, 0.3)
Q0, V0 = (0.1, 0.0, -0.2), (0.0, 1.0, 0.5)
NAMES = ("u", "w", "z")


def toy(**changes):
    fields = {"coordinates": NAMES, "mass": M, "damping": C, "stiffness": K, "force": F, "position": Q0, "velocity": V0}
    return LinearSystem(name="toy", **{**fields, **changes})


def exact(times, mass=M, damping=C, stiffness=K, force=F, q0=Q0, v0=V0):
    """(q, v) at `times` by the matrix exponential, (N, 2n)."""
    n, inverse = len(force), np.linalg.inv(mass)
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
    rest = np.concatenate([np.linalg.solve(stiffness, force), np.zeros(n)])
    return np.array([expm(a * t) @ (np.concatenate([q0, v0]) - rest) + rest for t in times])


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method", ["ebdf", "irk", "hht_i3"])
def test_motion_is_that_of_the_matrix_exponential(method):
    options = {"step": 2e-3} if method == "hht_i3" else TIGHT
    result = simulate(Model(bodies=[toy()]), 2.0, method, **options)
    tolerance = 1e-3 if method == "hht_i3" else 1e-8
    assert np.abs(np.hstack([result.q, result.v]) - exact(result.t)).max() < tolerance


def test_ledger_closes_and_the_skew_part_of_the_damping_does_no_work():
    result = simulate(Model(bodies=[toy()]), 2.0, **TIGHT)
    assert np.abs(result["energy.balance"]).max() < 1e-8
    q, v = result.q, result.v
    kinetic = 0.5 * np.einsum("ti,ij,tj->t", v, np.array(M), v)
    assert result["energy.kinetic"] == pytest.approx(kinetic, rel=1e-12)
    assert result["energy.strain"] == pytest.approx(0.5 * np.einsum("ti,ij,tj->t", q, np.array(K), q), rel=1e-12)
    assert result["energy.potential"] == pytest.approx(-q @ np.array(F), rel=1e-12)
    gyroscopic = ((0.0, 0.7, 0.0), (-0.7, 0.0, 0.2), (0.0, -0.2, 0.0))
    result = simulate(Model(bodies=[toy(damping=gyroscopic)]), 2.0, **TIGHT)
    assert np.abs(result["energy.dissipation"]).max() < 1e-15
    assert np.ptp(sum(result[f"energy.{part}"] for part in ("kinetic", "strain", "potential"))) < 1e-8


def test_each_mode_swings_with_its_frequency():
    squares, shapes = eigh(K, M)
    for square, shape in zip(squares, shapes.T, strict=True):
        system = toy(damping=None, force=None, position=tuple(shape), velocity=None)
        result = simulate(Model(bodies=[system]), 1.0, **TIGHT)
        assert np.abs(result.q - shape * np.cos(math.sqrt(square) * result.t)[:, None]).max() < 1e-8


def test_gravity_of_the_model_does_not_act_on_it():
    runs = [simulate(Model(gravity=g, bodies=[toy()]), 0.5).q.tobytes() for g in ((0.0, -9.81), (3.0, 1.0))]
    assert runs[0] == runs[1]


def test_systems_of_different_size_and_bodies_do_not_disturb_each_other():
    """Two sizes of linear system, a point mass and a rigid body, mixed: each moves as alone."""
    one = LinearSystem(name="one", coordinates=("s",), mass=((1.5,),), stiffness=((6.0,),), position=(0.3,))
    two = toy(position=(0.0, 0.1, 0.0)).model_copy(update={"name": "two"})
    bodies = [
        RigidBody2D(name="b", mass=1.0, inertia=0.2, angular_velocity=2.0), toy(), PointMass2D(name="p", mass=2.0),
        one, two,
    ]  # fmt: skip
    times = np.linspace(0.0, 1.0, 21)
    result = simulate(Model(bodies=bodies), 1.0, t_eval=times, **TIGHT)
    names = [f"toy.{part}{c}" for part in ("", "d_") for c in NAMES]
    assert np.abs(np.array([result[name] for name in names]).T - exact(times)).max() < 1e-8
    found = np.array([result[name.replace("toy", "two")] for name in names]).T
    assert np.abs(found - exact(times, q0=(0.0, 0.1, 0.0))).max() < 1e-8
    assert np.abs(result["one.s"] - 0.3 * np.cos(2.0 * times)).max() < 1e-8
    assert np.abs(result["b.angle"] - 2.0 * times).max() < 1e-9
    assert np.abs(result["p.y"] + 0.5 * G * times**2).max() < 1e-9


def test_channels_carry_the_units():
    units = {c.name: c.unit for c in simulate(Model(bodies=[toy(units=("m", "rad", "-"))]), 0.0).channel_records}
    assert [units[f"toy.{c}"] for c in ("u", "d_u", "dd_u")] == ["m", "m/s", "m/s2"]
    assert [units[f"toy.{c}"] for c in ("w", "d_w", "dd_w")] == ["rad", "rad/s", "rad/s2"]
    assert [units[f"toy.{c}"] for c in ("z", "d_z", "dd_z")] == ["-", "-", "-"]
    named = LinearSystem(name="s", coordinates=("y", "angle", "p"), mass=((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    assert [c.unit for c in named.coordinate_records()] == ["m", "rad", "-"]


# ---- drivers and loads on coordinates -------------------------------------------------------------------------------


def test_driven_coordinate_follows_and_the_others_answer():
    motion = Sine(amplitude=0.2, angular_frequency=3.0, offset=0.1)
    driver = CoordinateDriver(name="drive", body="toy", coordinate="w", motion=motion)
    system = toy(position=(0.1, 0.1, -0.2), velocity=(0.0, 0.6, 0.5))
    result = simulate(Model(bodies=[system], joints=[driver]), 2.0, **TIGHT)
    w, ddw = (
        0.1 + 0.2 * np.sin(3.0 * result.t), -1.8 * np.sin(3.0 * result.t),
    )  # fmt: skip
    assert np.abs(result["toy.w"] - w).max() < 1e-12 and np.abs(result["toy.dd_w"] - ddw).max() < 1e-10
    m, c, k = (np.array(x) for x in (M, C, K))
    free = [0, 2]

    def answer(t, y):
        given = np.array([0.1 + 0.2 * math.sin(3.0 * t), 0.6 * math.cos(3.0 * t), -1.8 * math.sin(3.0 * t)])
        load = np.array(F)[free] - m[free, 1] * given[2] - c[free, 1] * given[1] - k[free, 1] * given[0]
        load -= c[np.ix_(free, free)] @ y[2:] + k[np.ix_(free, free)] @ y[:2]
        return [*y[2:], *np.linalg.solve(m[np.ix_(free, free)], load)]

    found = integrate(answer, [0.1, -0.2, 0.0, 0.5], result.t)
    assert np.abs(result.q[:, free] - found[:, :2]).max() < 1e-8
    residual = m @ result.a.T + c @ result.v.T + k @ result.q.T - np.array(F)[:, None]
    assert np.abs(residual[1] + result["drive.reaction"]).max() < 1e-9
    assert np.abs(result["energy.balance"]).max() < 1e-8


def test_load_on_a_coordinate_forces_the_oscillation_of_the_closed_form():
    """x'' + w^2 x = f/m sin(p t) from rest: x = f/(m (w^2 - p^2)) (sin p t - p/w sin w t)."""
    m, k, f, p = 1.5, 24.0, 0.7, 2.5
    w = math.sqrt(k / m)
    system = LinearSystem(name="s", coordinates=("s",), mass=((m,),), stiffness=((k,),))
    load = CoordinateLoad(name="f", body="s", coordinate="s", load=Sine(amplitude=f, angular_frequency=p))
    result = simulate(Model(bodies=[system], forces=[load]), 3.0, **TIGHT)
    x = f / (m * (w**2 - p**2)) * (np.sin(p * result.t) - p / w * np.sin(w * result.t))
    assert np.abs(result["s.s"] - x).max() < 1e-8
    assert np.abs(result["energy.balance"]).max() < 1e-8
    assert np.ptp(result["energy.input_work"]) > 1e-2


@pytest.mark.parametrize("coordinate", ["x", "y", "angle"])
def test_load_on_a_planar_coordinate_is_the_force_or_torque_on_it(coordinate):
    """In the same step bit for bit where the same numbers are added in the same order; else to rounding."""
    body = RigidBody2D(name="b", mass=2.0, inertia=0.3, angle=0.4)
    signal = Sine(amplitude=1.3, angular_frequency=4.0, phase=0.2)
    load = CoordinateLoad(name="f", body="b", coordinate=coordinate, load=signal)
    same = (
        AppliedTorque2D(name="f", body="b", torque=signal)
        if coordinate == "angle"
        else AppliedForce2D(name="f", marker=on("b"), **{f"force_{coordinate}": signal})
    )
    runs = [simulate(Model(bodies=[body], forces=[force]), 1.0, **TIGHT) for force in (load, same)]
    assert np.abs(runs[0].q[-1] - runs[1].q[-1]).max() < 1e-9
    assert runs[0]["energy.input_work"][-1] == pytest.approx(runs[1]["energy.input_work"][-1], abs=1e-9)


def test_load_from_an_input_channel_holds_from_when_it_is_set():
    system = LinearSystem(name="s", coordinates=("s",), mass=((2.0,),))
    load = CoordinateLoad(name="f", body="s", coordinate="s", load=InputSignal(channel="push"))
    sim = Simulation(Model(bodies=[system], forces=[load], inputs=[Input(name="push")]))
    sim.advance(1.0)
    sim.set_inputs({"push": 3.0})
    sim.advance(2.0)
    values = dict(zip([c.name for c in sim.channels], sim.values(), strict=True))
    assert values["s.s"] == pytest.approx(0.75, abs=1e-9) and values["s.d_s"] == pytest.approx(1.5, abs=1e-9)


# ---- what is refused ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"coordinates": ("u", "u", "w")}, r"used twice: \['d_u', 'dd_u', 'u'\]"),
        ({"coordinates": ("u", "d_u", "w")}, r"used twice: \['d_u'\]"),
        ({"coordinates": ()}, "coordinates"),
        ({"coordinates": ("u", "w w", "z")}, "coordinates"),
        ({"mass": ((1.0,),)}, r"mass of 'toy' has rows of lengths \[1\]: 3 rows of 3 numbers"),
        ({"damping": (*C[:2], (1.0, 2.0))}, r"damping of 'toy' has rows of lengths \[3, 3, 2\]"),
        ({"force": (1.0,)}, "force of 'toy' has 1 entries"),
        ({"position": (1.0, 2.0)}, "position of 'toy' has 2 entries"),
        ({"scales": (1.0, 0.0, 2.0)}, "scales"),
        ({"coordinates": ("x", "w", "z"), "units": ("rad", "m", "m")}, "coordinate 'x' of 'toy' is in m everywhere"),
        ({"stiffness": (K[0], (-10.5, 30.0, 5.0), K[2])}, r"stiffness .* symmetric.*\(0, 1\) and \(1, 0\)"),
        ({"mass": ((1.0, 2.0, 0.0), (2.0, 1.0, 0.0), (0.0, 0.0, 1.0))}, "negative eigenvalue -1:"),
        ({"mass": ((1.0, "2", 0.0), *M[1:])}, "text '2'"),
        ({"mass": ((1.0, math.nan, 0.0), *M[1:])}, "mass"),
    ],
)
def test_what_is_no_linear_system_is_refused(changes, words):
    with pytest.raises(ModelError, match=words):
        toy(**changes)


@pytest.mark.parametrize(
    "parts, words",
    [
        ({"forces": [AppliedForce2D(name="f", marker=on("toy"))]}, "'f' needs a point of 'toy'.*LinearSystem.*u.*w.*z"),
        ({"forces": [SpringDamper2D(name="f", a=GROUND, b=on("toy"), stiffness=1.0, natural_length=1.0)]}, "point"),
        ({"forces": [AppliedTorque2D(name="f", body="toy", torque=Constant(value=1.0))]}, "CoordinateLoad"),
        ({"forces": [CoordinateLoad(name="f", body="toy", coordinate="x", load=Constant(value=1.0))]}, "only.*'u'"),
        ({"forces": [CoordinateLoad(name="f", body="tay", coordinate="u", load=Constant(value=1.0))]}, "'tay'"),
        ({"forces": [CoordinateLoad(name="f", body="ground", coordinate="x", load=Constant(value=1.0))]}, "ground"),
    ],
)
def test_what_needs_a_point_or_another_coordinate_is_refused(parts, words):
    with pytest.raises(ModelError, match=words):
        Model(bodies=[toy()], **parts)
