"""The scenarios with ANCF cables: convergence in the elements, energies, impacts, and contact at the end."""

import math

import numpy as np
import pytest
from tlismni.core import deformed_shape, simulate
from tlismni.models import load


def run(name, **parameters):
    s = load(name, **parameters)
    return s, simulate(s.model, s.t_end, s.method, s.rtol, s.atol, **s.options)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["cantilever", "cable_pendulum"])
def test_the_tip_converges_with_the_elements(name):
    """At 0.3 s, before waves of all lengths have mixed: each mesh comes nearer to the finest one, with damping with the
    order 4 of the elements."""
    tips = []
    for elements in (2, 4, 8, 32):
        s = load(name, elements=elements)
        result = simulate(s.model, 0.3, s.method, **s.options)
        tips.append((result["tip.x"][-1], result["tip.y"][-1]))
    errors = [math.dist(tip, tips[-1]) for tip in tips[:-1]]
    assert errors[2] < 0.3 * errors[0]
    assert errors[2] < 2e-3
    tips = []
    for elements in (4, 8, 16, 32):
        s = load(name, elements=elements, damping_time=0.01)
        result = simulate(s.model, 0.3, s.method, **s.options)
        tips.append((result["tip.x"][-1], result["tip.y"][-1]))
    damped = [math.dist(tip, tips[-1]) for tip in tips[:-1]]
    assert damped[0] > 8.0 * damped[1] > 64.0 * damped[2]
    assert 0.5 * math.log2(damped[0] / damped[2]) > 3.5


@pytest.mark.parametrize("name", ["cantilever", "cable_pendulum"])
def test_energy_is_kept_without_material_damping_and_lost_with_it(name):
    _, result = run(name)
    swing = np.ptp(result["energy.potential"])
    assert np.abs(result["energy.balance"]).max() < 1e-4 * swing
    assert result["energy.dissipation"][-1] == 0.0
    _, damped = run(name, damping_time=0.01)
    assert damped["energy.dissipation"][-1] > 1e-3 * swing
    assert np.abs(damped["energy.balance"]).max() < 1e-3 * swing


def test_a_damped_cantilever_comes_to_rest_where_statics_say():
    """Stiff and light: m g L^4/(8 EI) down, F L^3/(3 EI) up; half the critical damping of the first mode."""
    diameter, modulus, density, force = 0.02, 2e9, 1000.0, 0.4
    stiffness, line = modulus * math.pi * diameter**4 / 64.0, density * math.pi * diameter**2 / 4.0
    omega = 3.516 * math.sqrt(stiffness / line)
    fields = {"diameter": diameter, "youngs_modulus": modulus, "density": density, "tip_force": force}
    s = load("cantilever", elements=4, damping_time=1.0 / omega, **fields)
    result = simulate(s.model, 40.0 / omega, s.method, step=0.02 / omega)
    expected = force / (3.0 * stiffness) - line * 9.81 / (8.0 * stiffness)
    assert abs(result["tip.y"][-1] / expected - 1.0) < 2e-3
    assert abs(result["clamp.torque"][-1] / (0.5 * line * 9.81 - force) - 1.0) < 2e-3


def test_the_pendulum_turns_about_its_pin():
    s, result = run("cable_pendulum", elements=4)
    shape = deformed_shape(result, s.model.bodies[0], [0.0])
    assert np.abs(shape).max() < 1e-12
    # the pin carries what accelerates the whole rope: its force is the rate of the momentum and the weight
    assert np.abs(result["pin.force_x"]).max() > 1.0


def test_energy_of_the_rope_on_the_ground_is_lost_at_impacts_and_in_the_material_only():
    _, result = run("cable_ground")
    total = result["energy.kinetic"] + result["energy.potential"] + result["energy.strain"]
    impacts = [e for e in result.events if e.kind == "impact"]
    assert len(impacts) >= 8
    assert all(e.energy_loss > -1e-9 for e in impacts)
    assert abs(sum(e.energy_loss for e in impacts) - result["energy.impact_loss"][-1]) < 1e-3
    assert np.abs(result["energy.balance"]).max() < 2e-3 * total[0]
    assert np.all(np.diff(result["energy.dissipation"]) > -1e-9)
    # plastic impacts: nothing penetrates, nothing pulls
    for k in range(1, 9):
        assert result[f"ground{k}.gap"].min() > -1e-8
        assert result[f"ground{k}.normal_force"].min() > -1e-6


def test_the_first_touch_converges_and_at_the_end_rope_lies_on_the_ground():
    first = []
    for elements in (8, 12):
        _, result = run("cable_ground", elements=elements)
        first.append(next(e for e in result.events if e.kind == "impact").t)
        lying = sum(result[f"ground{k}.in_contact"][-1] for k in range(1, elements + 1))
        assert lying >= elements / 4
    assert abs(first[1] - first[0]) < 0.02


def test_ground_as_a_force_agrees_with_the_constraint_before_and_with_its_loss():
    """The same first touch; a stiff, strongly damped ground takes about what plastic impacts take."""
    _, hard = run("cable_ground")
    s = load("cable_ground", law="flores", restitution=0.1, stiffness=1e5)
    soft = simulate(s.model, s.t_end, s.method, s.rtol, s.atol)
    touches = [next(e.t for e in r.events if e.kind in ("impact", "close")) for r in (hard, soft)]
    assert abs(touches[0] - touches[1]) < 1e-4
    end_hard, end_soft = (r["energy.potential"][-1] for r in (hard, soft))
    start = hard["energy.potential"][0]
    assert abs(end_hard - end_soft) < 0.1 * abs(start - end_hard)
