"""LuGre's equation alone: partial derivatives, steady state, pre-sliding stiffness, bounds."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from tlismni.core.errors import ModelError
from tlismni.core.laws.friction.lugre import LuGreFriction

quick = settings(deadline=None, max_examples=40, derandomize=True)
LAW = LuGreFriction(
    coefficient=0.3, static_coefficient=0.5, stribeck_speed=0.01, bristle_stiffness=1e5, bristle_damping=200.0,
    viscous_damping=3.0,
)  # fmt: skip
NORMAL = 50.0


def published(z, v, normal):
    """(z', F_t) for complex arguments, |v| continued analytically from the real part's sign."""
    speed = v if v.real >= 0.0 else -v
    g = normal * (0.3 + 0.2 * np.exp(-((v / 0.01) ** 2)))
    rate = v - 1e5 * speed * z / g
    return rate, -(1e5 * z + 200.0 * rate + 3.0 * v)


@quick
@given(z=st.floats(-3e-4, 3e-4), v=st.floats(-0.1, 0.1), normal=st.floats(1e-3, 1e3))
def test_values_and_partial_derivatives_are_those_of_the_complex_step(z, v, normal):
    result = LAW.evaluate(z, v, normal)
    at, h = [complex(z), complex(v), complex(normal)], 1e-40
    for offset, value in zip((0, 4), published(*at), strict=True):
        assert result[offset] == pytest.approx(value.real, rel=1e-12, abs=1e-12)
    for k in range(3):
        moved = list(at)
        moved[k] += 1j * h
        for offset, value in zip((0, 4), published(*moved), strict=True):
            assert result[offset + 1 + k] == pytest.approx(value.imag / h, rel=1e-10, abs=1e-10)


@quick
@given(v=st.floats(1e-4, 1.0), sign=st.sampled_from([-1.0, 1.0]))
def test_steady_sliding_lies_on_the_stribeck_curve(v, sign):
    v *= sign
    z = LAW.steady_deflection(v, NORMAL)
    rate, *_, force, _, _, _ = LAW.evaluate(z, v, NORMAL)
    assert rate == pytest.approx(0.0, abs=1e-13 * max(1.0, abs(v)))
    g = NORMAL * (0.3 + 0.2 * math.exp(-((v / 0.01) ** 2)))
    assert force == pytest.approx(-(math.copysign(g, v) + 3.0 * v), rel=1e-12)


def test_bristles_bend_exponentially_towards_the_steady_state():
    """z = z_s (1 - exp(-v t/z_s)) at constant speed, and never more than static friction bends them."""
    v, times = 2e-3, np.linspace(0.0, 1.0, 21)
    run = solve_ivp(
        lambda t, z: [LAW.evaluate(z[0], v, NORMAL)[0]], (0.0, 1.0), [0.0], "Radau", times, rtol=1e-10, atol=1e-14
    )
    steady = LAW.steady_deflection(v, NORMAL)
    assert run.y[0] == pytest.approx(steady * (1.0 - np.exp(-v * times / steady)), rel=1e-7, abs=1e-12)
    assert run.y[0].max() <= 0.5 * NORMAL / 1e5


def test_small_motions_feel_a_spring_and_a_damper():
    """In stick z follows the displacement: F_t = -s0 x - (s1 + s2) v."""
    rate, *_, force, stiffness, damping, _ = LAW.evaluate(0.0, 1e-9, NORMAL)
    assert rate == pytest.approx(1e-9, rel=1e-12)
    assert force == pytest.approx(-(200.0 + 3.0) * 1e-9, rel=1e-12)
    assert stiffness == pytest.approx(-1e5, rel=1e-6)
    assert damping == pytest.approx(-203.0, rel=1e-12)


@pytest.mark.parametrize("normal", [0.0, -5.0])
def test_no_friction_without_normal_force(normal):
    assert LAW.evaluate(1e-5, 0.3, normal) == (0.0,) * 8


def test_friction_without_limit_is_refused():
    with pytest.raises(ModelError, match="coefficient"):
        LuGreFriction(coefficient=0.0, stribeck_speed=0.01, bristle_stiffness=1e5)
