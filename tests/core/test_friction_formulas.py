"""Friction formulas alone: limits, symmetry, dissipation, derivatives."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter
from scipy.optimize import minimize_scalar
from tlismni.core.errors import ModelError
from tlismni.core.laws.friction import (
    FRICTION_LAWS,
    AmbrosioFriction,
    BrownMcPheeFriction,
    CoulombFriction,
    Friction,
    FrictionLaw,
    StepFriction,
    TanhFriction,
    ThrelfallFriction,
    friction_address,
)

quick = settings(deadline=None, max_examples=40, derandomize=True)
SPEED = 0.01
LAWS = [
    TanhFriction(coefficient=0.4, transition_speed=SPEED),
    ThrelfallFriction(coefficient=0.4, transition_speed=SPEED),
    AmbrosioFriction(coefficient=0.4, lower_speed=0.3 * SPEED, upper_speed=1.5 * SPEED),
    AmbrosioFriction(coefficient=0.4, upper_speed=SPEED),
    StepFriction(coefficient=0.4, static_coefficient=0.6, stiction_speed=SPEED, sliding_speed=2.0 * SPEED),
    BrownMcPheeFriction(coefficient=0.4, transition_speed=SPEED),
    BrownMcPheeFriction(coefficient=0.4, static_coefficient=0.6, transition_speed=SPEED),
]
each_law = pytest.mark.parametrize("law", LAWS, ids=lambda law: law.type)

# mu(x) as published, x = |v| over the law's speed, for complex x > 0: its slope by the complex step is exact
PUBLISHED = {
    "Tanh": lambda x: 0.4 * np.tanh(x),
    "Threlfall": lambda x: 0.4 * (1.0 - np.exp(-3.0 * x)),
    "BrownMcPhee": lambda x: 0.4 * np.tanh(4.0 * x) + 0.2 * x / (0.25 * x**2 + 0.75) ** 2,
}


@each_law
@quick
@given(v=st.floats(-5.0, 5.0), normal=st.floats(0.0, 1e4))
def test_friction_is_odd_dissipative_and_proportional_to_the_normal_force(law, v, normal):
    force, by_speed, by_normal = law.evaluate(v, normal)
    back = law.evaluate(-v, normal)
    assert back == (-force, by_speed, -by_normal)
    assert force * v <= 0.0
    assert force == pytest.approx(by_normal * normal, rel=1e-14)
    assert law.evaluate(0.0, normal)[0] == 0.0


@each_law
def test_fast_sliding_gives_the_kinetic_coefficient(law):
    assert law.evaluate(1e4, 10.0)[0] == pytest.approx(-10.0 * law.coefficient, rel=1e-6)


@each_law
@quick
@given(ratio=st.floats(-3.0, 3.0))
def test_slope_is_that_of_the_force(law, ratio):
    """Differences of sixth order away from corners of the force or its curvature, which differences cannot see."""
    corners = [0.0, 0.3, 1.0, 1.5, 2.0]
    if min(abs(abs(ratio) - corner) for corner in corners) < 4e-3:
        ratio += 1e-2
    v, h = SPEED * ratio, 1e-3 * SPEED

    def difference(k):
        return law.evaluate(v + k * h, 7.0)[0] - law.evaluate(v - k * h, 7.0)[0]

    slope = (45.0 * difference(1) - 9.0 * difference(2) + difference(3)) / (60.0 * h)
    assert law.evaluate(v, 7.0)[1] == pytest.approx(slope, rel=1e-8, abs=1e-7)


@pytest.mark.parametrize("law", [law for law in LAWS if law.type in PUBLISHED][::-1], ids=lambda law: law.type)
@quick
@given(x=st.floats(1e-3, 10.0))
def test_force_and_slope_are_those_of_the_published_formula(law, x):
    excess = 0.2 if getattr(law, "static_coefficient", None) else 0.0
    published = PUBLISHED[law.type]
    if law.type == "BrownMcPhee" and not excess:
        published = lambda z: 0.4 * np.tanh(4.0 * z)  # noqa: E731
    step = complex(x, 1e-30)
    force, slope, _ = law.evaluate(SPEED * x, 7.0)
    assert force == pytest.approx(-7.0 * published(step).real, rel=1e-13)
    assert slope == pytest.approx(-7.0 * published(step).imag / 1e-30 / SPEED, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("excess", [0.05, 0.2, 1.0])
def test_brown_mcphee_peaks_at_its_transition_speed_with_the_static_coefficient(excess):
    law = BrownMcPheeFriction(coefficient=0.4, static_coefficient=0.4 + excess, transition_speed=SPEED)
    peak = minimize_scalar(
        lambda x: law.evaluate(SPEED * x, 1.0)[0], bounds=(0.3, 3.0), method="bounded", options={"xatol": 1e-9}
    )
    # the kinetic term still rises with 4 mu (1 - tanh^2 4) where the other, of curvature -3 (mu_s - mu)/2, peaks
    shift = 4.0 * 0.4 * (1.0 - math.tanh(4.0) ** 2) / (1.5 * excess)
    assert peak.x == pytest.approx(1.0 + shift, abs=0.4 * shift)
    assert -law.evaluate(SPEED, 1.0)[0] == pytest.approx(0.4 * math.tanh(4.0) + excess, rel=1e-14)
    assert -peak.fun == pytest.approx(0.4 + excess, rel=1e-3)


def test_step_friction_goes_through_its_named_points():
    law = LAWS[4]
    assert -law.evaluate(SPEED, 1.0)[0] == pytest.approx(0.6, rel=1e-14)
    assert -law.evaluate(1.5 * SPEED, 1.0)[0] == pytest.approx(0.5, rel=1e-13)
    assert -law.evaluate(2.0 * SPEED, 1.0)[0] == pytest.approx(0.4, rel=1e-14)
    for corner in (SPEED, 2.0 * SPEED):
        assert law.evaluate(corner, 1.0)[1] == pytest.approx(0.0, abs=1e-10)
        assert law.evaluate(corner * (1.0 - 1e-9), 1.0)[1] == pytest.approx(0.0, abs=1e-5)


def test_ambrosio_has_no_friction_in_its_dead_band_and_a_ramp_above():
    law = LAWS[2]
    assert law.evaluate(0.29 * SPEED, 1.0) == (0.0, 0.0, 0.0)
    assert -law.evaluate(0.9 * SPEED, 1.0)[0] == pytest.approx(0.2, rel=1e-13)
    assert -law.evaluate(1.5 * SPEED, 1.0)[0] == pytest.approx(0.4, rel=1e-13)


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


def test_speeds_must_be_in_order():
    with pytest.raises(ModelError, match=r"0\.1 is not above lower_speed = 0\.2"):
        AmbrosioFriction(coefficient=0.3, lower_speed=0.2, upper_speed=0.1)
    with pytest.raises(ModelError, match=r"0\.1 is not above stiction_speed = 0\.1"):
        StepFriction(coefficient=0.3, stiction_speed=0.1, sliding_speed=0.1)


@pytest.mark.parametrize("law", [*LAWS, CoulombFriction(coefficient=0.3)], ids=lambda law: law.type)
def test_friction_is_data(law):
    adapter = TypeAdapter(Friction)
    assert type(law) in FRICTION_LAWS.values()
    assert adapter.validate_json(law.model_dump_json()) == law
    if isinstance(law, FrictionLaw):
        assert friction_address(law) != 0
