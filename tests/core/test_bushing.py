"""The bushing: closed forms, free motion of two bodies, and what it must leave alone."""

import math

import numpy as np
import pytest
from helpers import GROUND, integrate, on
from test_forces import oscillator
from tlismni.core import Bushing2D, Model, PointMass2D, RigidBody2D, simulate

TIGHT = {"rtol": 1e-10, "atol": 1e-12}


@pytest.mark.parametrize("zeta", [0.0, 0.1, 1.0, 2.5])
@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_point_mass_oscillates_alike_in_all_directions_and_through_zero_length(zeta, method):
    m, k = 0.8, 45.0
    w = math.sqrt(k / m)
    bushing = Bushing2D(name="s", a=GROUND, b=on("p"), stiffness=k, damping=2.0 * zeta * math.sqrt(k * m))
    body = PointMass2D(name="p", mass=m, position=(0.2, 0.0), velocity=(-3.0, 0.4))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body], forces=[bushing]), 1.5, method, **TIGHT)
    assert np.abs(result["p.x"] - oscillator(zeta, w, 0.2, -3.0, result.t)).max() < 1e-8
    assert np.abs(result["p.y"] - oscillator(zeta, w, 0.0, 0.4, result.t)).max() < 1e-8


def test_it_goes_straight_through_its_rest_point():
    """Along a line the distance of the markers is exactly zero on the way; nothing happens there."""
    bushing = Bushing2D(name="s", a=GROUND, b=on("p"), stiffness=4.0)
    body = PointMass2D(name="p", mass=1.0, velocity=(1.0, 0.0))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body], forces=[bushing]), 2.0, **TIGHT)
    assert result["p.x"][0] == result["p.y"].max() == 0.0
    assert np.abs(result["p.x"] - 0.5 * np.sin(2.0 * result.t)).max() < 1e-9


@pytest.mark.parametrize("zeta", [0.0, 0.3])
def test_rotational_part_turns_the_markers_onto_each_other(zeta):
    inertia, k, wind = 0.3, 12.0, 2.0 * math.pi
    w = math.sqrt(k / inertia)
    bushing = Bushing2D(
        name="s", a=on("ground", 0.0, 0.0, 0.5), b=on("b", 0.0, 0.0, -0.2), stiffness=0.0, rotational_stiffness=k,
        rotational_damping=2.0 * zeta * math.sqrt(k * inertia),
    )  # fmt: skip
    body = RigidBody2D(name="b", mass=1.0, inertia=inertia, angle=0.7 + wind, angular_velocity=1.0)
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body], forces=[bushing]), 1.0, **TIGHT)
    assert np.abs(result["b.angle"] - 0.7 - oscillator(zeta, w, wind, 1.0, result.t)).max() < 1e-8
    assert result["energy.strain"][0] == pytest.approx(0.5 * k * wind**2)


def two_bodies(**fields):
    bushing = Bushing2D(name="s", a=on("a", 0.3, 0.1, 0.2), b=on("b", -0.4, 0.2, -0.4), stiffness=80.0, **fields)
    bodies = [
        RigidBody2D(name="a", mass=1.0, inertia=0.1, velocity=(0.5, -0.2), angular_velocity=2.0),
        RigidBody2D(name="b", mass=2.5, inertia=0.2, position=(0.9, 0.3), angle=0.3, angular_velocity=-1.0),
    ]
    return Model(gravity=(0.0, 0.0), bodies=bodies, forces=[bushing])


FIELDS = {"damping": 1.5, "rotational_stiffness": 3.0, "rotational_damping": 0.2}


def two_bodies_reference(times, damping, rotational_stiffness, rotational_damping):
    """Newton and Euler for both bodies, with complex numbers for vectors."""
    u, w = complex(0.3, 0.1), complex(-0.4, 0.2)

    def rhs(t, y):
        za, zb, ta, tb = complex(y[0], y[1]), complex(y[3], y[4]), y[2], y[5]
        va, vb, wa, wb = complex(y[6], y[7]), complex(y[9], y[10]), y[8], y[11]
        ra, rb = u * np.exp(1j * ta), w * np.exp(1j * tb)
        force = -80.0 * (zb + rb - za - ra) - damping * (vb + 1j * wb * rb - va - 1j * wa * ra)
        torque = -rotational_stiffness * (tb - ta - 0.6) - rotational_damping * (wb - wa)
        on_b = ((rb.conjugate() * force).imag + torque) / 0.2
        on_a = (-(ra.conjugate() * force).imag - torque) / 0.1
        return [*y[6:], -force.real, -force.imag, on_a, force.real / 2.5, force.imag / 2.5, on_b]

    return integrate(rhs, [0.0, 0.0, 0.0, 0.9, 0.3, 0.3, 0.5, -0.2, 2.0, 0.0, 0.0, -1.0], times)


@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_two_free_bodies_follow_newton_and_euler(method):
    times = np.linspace(0.0, 2.0, 21)
    result = simulate(two_bodies(**FIELDS), 2.0, method, t_eval=times, **TIGHT)
    assert np.abs(np.hstack([result.q, result.v]) - two_bodies_reference(times, **FIELDS)).max() < 1e-7


def test_ledger_closes_and_the_dampers_take_energy():
    result = simulate(two_bodies(**FIELDS), 2.0, **TIGHT)
    assert np.abs(result["energy.balance"]).max() < 1e-8
    lost = result["energy.dissipation"]
    assert lost[-1] > 0.3 and np.all(np.diff(lost) >= -1e-12)


def test_momentum_is_kept_and_without_damping_the_angular_momentum_too():
    """The elastic force lies on the line of its two points; the damping force need not."""
    result = simulate(two_bodies(rotational_stiffness=3.0, rotational_damping=0.2), 2.0, **TIGHT)
    px = 1.0 * result["a.vx"] + 2.5 * result["b.vx"]
    spin = 0.1 * result["a.angular_velocity"] + 0.2 * result["b.angular_velocity"]
    for body, mass in (("a", 1.0), ("b", 2.5)):
        spin = spin + mass * (result[f"{body}.x"] * result[f"{body}.vy"] - result[f"{body}.y"] * result[f"{body}.vx"])
    assert np.abs(px - 0.5).max() < 1e-10
    assert np.abs(spin - spin[0]).max() < 1e-8


@pytest.mark.parametrize("turn", [0.7, 2.9])
def test_turned_and_shifted_it_moves_alike(turn):
    """Frame-indifference: the whole scene, turned, shifted and in uniform motion."""
    c, s = math.cos(turn), math.sin(turn)
    rotation = np.array([[c, -s], [s, c]])
    plain = two_bodies(**FIELDS)
    moved = plain.model_copy(
        update={
            "bodies": tuple(
                body.model_copy(
                    update={
                        "position": tuple(rotation @ body.position + [3.0, -2.0]),
                        "velocity": tuple(rotation @ body.velocity + [0.7, 0.4]),
                        "angle": body.angle + turn,
                    }
                )
                for body in plain.bodies
            )
        }
    )
    times = np.linspace(0.0, 1.0, 11)
    here, there = (simulate(m, 1.0, t_eval=times, **TIGHT) for m in (plain, moved))
    for body in ("a", "b"):
        expected = rotation @ np.array([here[f"{body}.x"], here[f"{body}.y"]])
        expected += np.outer([3.0, -2.0], np.ones(11)) + np.outer([0.7, 0.4], times)
        assert np.abs(np.array([there[f"{body}.x"], there[f"{body}.y"]]) - expected).max() < 1e-8
        assert np.abs(there[f"{body}.angle"] - turn - here[f"{body}.angle"]).max() < 1e-8
