"""Friction formulas alone: limits, symmetry, dissipation, derivatives."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter
from tlismni.core.contact.friction import (
    FRICTION_LAWS,
    CoulombFriction,
    Friction,
    FrictionLaw,
    TanhFriction,
    friction_address,
)
from tlismni.core.errors import ModelError

quick = settings(deadline=None, max_examples=40, derandomize=True)
LAWS = [TanhFriction(coefficient=0.4, transition_speed=0.01)]
speeds = st.floats(-5.0, 5.0)


def difference(f, h):
    """f'(0) to O(h^6)."""
    return (45.0 * (f(h) - f(-h)) - 9.0 * (f(2 * h) - f(-2 * h)) + (f(3 * h) - f(-3 * h))) / (60.0 * h)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.type)
@quick
@given(v=speeds, normal=st.floats(0.0, 1e4))
def test_friction_is_odd_dissipative_and_proportional_to_the_normal_force(law, v, normal):
    force, by_speed, by_normal = law.evaluate(v, normal)
    back = law.evaluate(-v, normal)
    assert (back[0], back[1], back[2]) == (-force, by_speed, -by_normal)
    assert force * v <= 0.0
    assert force == pytest.approx(by_normal * normal, rel=1e-14)
    assert law.evaluate(0.0, normal)[0] == 0.0


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.type)
def test_fast_sliding_gives_the_kinetic_coefficient(law):
    assert law.evaluate(1e4, 10.0)[0] == pytest.approx(-10.0 * law.coefficient, rel=1e-6)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.type)
@quick
@given(ratio=st.floats(-4.0, 4.0))
def test_slope_is_that_of_the_force(law, ratio):
    v = 0.01 * ratio
    slope = difference(lambda x: law.evaluate(v + x, 7.0)[0], 1e-5)
    assert law.evaluate(v, 7.0)[1] == pytest.approx(slope, rel=1e-6, abs=1e-6)


def test_tanh_creeps_in_stick_with_the_speed_of_its_inverse():
    law = TanhFriction(coefficient=0.3, transition_speed=1e-3)
    creep = 1e-3 * math.atanh(0.5)
    assert law.evaluate(creep, 20.0)[0] == pytest.approx(-0.5 * 0.3 * 20.0, rel=1e-14)


def test_static_friction_is_at_least_the_kinetic():
    assert CoulombFriction(coefficient=0.3).sticking_coefficient == 0.3
    assert CoulombFriction(coefficient=0.3, static_coefficient=0.4).sticking_coefficient == 0.4
    with pytest.raises(ModelError, match=r"0\.2 is below coefficient = 0\.3"):
        CoulombFriction(coefficient=0.3, static_coefficient=0.2)
    with pytest.raises(ModelError, match="coefficient"):
        CoulombFriction(coefficient=-0.1)


@pytest.mark.parametrize("law", [*LAWS, CoulombFriction(coefficient=0.3)], ids=lambda law: law.type)
def test_friction_is_data(law):
    adapter = TypeAdapter(Friction)
    assert type(law) in FRICTION_LAWS
    assert adapter.validate_json(law.model_dump_json()) == law
    if isinstance(law, FrictionLaw):
        assert friction_address(law) != 0
