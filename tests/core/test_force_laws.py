"""Continuous contact force laws without gravity, against their closed forms."""

import math

import numpy as np
import pytest
from helpers import G, ball_over_floor, events
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from strikes import hertz_contact, ratio, rebound, strike
from tlismni.core import Flores, Gonthier, Hertz, HuntCrossley, KelvinVoigt, LankaraniNikravesh, Tsuji, simulate
from tlismni.core.laws import LAWS, ForceLaw

quick = settings(deadline=None, max_examples=12, derandomize=True)

# rebound speed over approach speed (numerics.md, section 6) for the requested 0.3, 0.5, 0.8
TABLE = {
    HuntCrossley: (0.5813, 0.6630, 0.8329),
    LankaraniNikravesh: (0.6842, 0.7252, 0.8471),
    Flores: (0.2562, 0.4704, 0.7885),
    Gonthier: (0.3, 0.5, 0.8),
}
DAMPING_FACTOR = {
    HuntCrossley: lambda e: 3.0 * (1.0 - e) / 2.0,
    LankaraniNikravesh: lambda e: 3.0 * (1.0 - e * e) / 4.0,
    Flores: lambda e: 8.0 * (1.0 - e) / (5.0 * e),
}
FAMILY = [(law, e, out) for law, row in TABLE.items() for e, out in zip((0.3, 0.5, 0.8), row, strict=True)]


@pytest.mark.parametrize("law, e, out", FAMILY)
def test_rebound_is_that_of_the_table(law, e, out):
    assert ratio(strike(law(stiffness=1e6, restitution=e))) == pytest.approx(out, abs=5.1e-5)


@pytest.mark.parametrize("law", DAMPING_FACTOR)
@pytest.mark.parametrize("e", [0.3, 0.5, 0.8])
def test_rebound_is_the_root_of_the_exact_relation(law, e):
    found = ratio(strike(law(stiffness=1e6, restitution=e)))
    assert found == pytest.approx(rebound(DAMPING_FACTOR[law](e)), rel=1e-7)


@quick
@given(
    st.sampled_from(FAMILY),
    st.floats(3.0, 10.0),
    st.floats(-3.0, 3.0),
    st.floats(1.0, 3.0),
    st.floats(-2.0, 1.0),
)
def test_rebound_does_not_depend_on_stiffness_mass_exponent_or_speed(case, stiffness, mass, exponent, speed):
    law, e, out = case
    law = law(stiffness=10.0**stiffness, restitution=e, exponent=exponent)
    found = ratio(strike(law, mass=10.0**mass, speed=10.0**speed, exponent=exponent))
    assert found == pytest.approx(out, abs=5.1e-5)


@quick
@given(st.floats(0.05, 1.0))
def test_gonthier_with_the_exact_root_gives_what_was_asked(e):
    assert ratio(strike(Gonthier(stiffness=1e5, restitution=e))) == pytest.approx(e, rel=1e-6)


@pytest.mark.parametrize("law, e, out", FAMILY[::2])
def test_hunt_crossley_force_is_never_tensile_and_starts_and_ends_at_zero(law, e, out):
    result = strike(law(stiffness=1e6, restitution=e))
    force = result["floor.normal_force"]
    assert force.min() >= -1e-9 * force.max()
    (opened,) = events(result, "open")
    assert result["floor.gap"][result.t == opened.t] == pytest.approx(0.0, abs=1e-15)
    assert np.abs(force[result.t == opened.t]).max() < 1e-9 * force.max()


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
def test_hertz_contact_depth_force_and_duration(exponent):
    mass, speed, stiffness = 0.3, 2.0, 1e5
    depth, force, duration = hertz_contact(mass, stiffness, exponent, speed)
    law = Hertz(stiffness=stiffness, exponent=exponent)
    result = strike(law, mass, speed, exponent)
    begin, end = events(result, "close")[0].t, events(result, "open")[0].t
    assert begin == pytest.approx(0.5 * depth / speed, rel=1e-9)
    assert end - begin == pytest.approx(duration, rel=1e-6)
    at_turn = strike(law, mass, speed, exponent, t_eval=[begin + 0.5 * duration])
    assert -at_turn["floor.gap"] == pytest.approx(depth, rel=1e-7)
    assert at_turn["floor.normal_force"] == pytest.approx(force, rel=1e-6)
    assert result["floor.normal_force"].max() <= force * (1.0 + 1e-6)
    assert ratio(result) == pytest.approx(1.0, rel=1e-7)


def test_steel_sphere_on_steel_half_space():
    """The worked number of the reference: R = 10 mm, E = 210 GPa, nu = 0.3, 1 m/s."""
    effective = 2.1e11 / (2.0 * (1.0 - 0.3**2))
    stiffness, mass = 4.0 / 3.0 * effective * math.sqrt(0.01), 7800.0 * 4.0 / 3.0 * math.pi * 0.01**3
    result = strike(Hertz(stiffness=stiffness), mass, rtol=1e-10)
    begin, end = events(result, "close")[0].t, events(result, "open")[0].t
    at_turn = strike(Hertz(stiffness=stiffness), mass, rtol=1e-10, t_eval=[0.5 * (begin + end)])
    assert end - begin == pytest.approx(6.893400e-5, rel=1e-6)
    assert -at_turn["floor.gap"] == pytest.approx(2.342085e-5, rel=1e-6)
    assert at_turn["floor.normal_force"] == pytest.approx(1743.776, rel=1e-6)


def test_impulse_and_loss_of_a_contact_are_those_of_the_speeds():
    mass, speed = 2.0, 1.5
    result = strike(Flores(stiffness=1e6, restitution=0.5), mass, speed)
    (opened,) = events(result, "open")
    out = opened.separation_speed
    assert opened.impulse == pytest.approx(mass * (speed + out), rel=1e-7)
    assert opened.energy_loss == pytest.approx(0.5 * mass * (speed**2 - out**2), rel=1e-7)
    assert result["floor.dissipation"][-1] == pytest.approx(opened.energy_loss, rel=1e-7)
    assert result["floor.impulse"][-1] == pytest.approx(opened.impulse, rel=1e-7)


def kelvin_voigt_end(zeta, w):
    """(end, restitution): the force k d + c d' with d = v exp(-zeta w t) sin(wd t)/wd becomes zero."""

    def motion(t):
        decay, root = math.exp(-zeta * w * t), zeta * zeta - 1.0
        s = math.sqrt(abs(root)) * w
        if abs(root) < 1e-12:
            return t * decay, (1.0 - zeta * w * t) * decay
        sine, cosine = (math.sinh(s * t), math.cosh(s * t)) if root > 0 else (math.sin(s * t), math.cos(s * t))
        return decay * sine / s, decay * (cosine - zeta * w / s * sine)

    def force(t):
        d, rate = motion(t)
        return w * w * d + 2.0 * zeta * w * rate

    times = np.linspace(0.0, 20.0 * (1.0 + zeta) / w, 20001)
    (first, *_) = np.flatnonzero([force(t) < 0.0 for t in times])
    end = brentq(force, times[first - 1], times[first], xtol=1e-16, rtol=1e-15)
    return end, -motion(end)[1]


@pytest.mark.parametrize("zeta", [0.05, 0.3, 0.7, 0.75, 0.95, 1.0, 1.5])
def test_kelvin_voigt_is_released_at_zero_force_with_the_restitution_of_its_closed_form(zeta):
    mass, stiffness = 0.5, 2e4
    w = math.sqrt(stiffness / mass)
    law = KelvinVoigt(stiffness=stiffness, damping=2.0 * zeta * math.sqrt(stiffness * mass))
    result = strike(law, mass, 1.0, 1.0)
    end, e = kelvin_voigt_end(zeta, w)
    (opened,) = events(result, "open")
    assert opened.t - events(result, "close")[0].t == pytest.approx(end, rel=1e-7)
    assert ratio(result) == pytest.approx(e, rel=1e-7)
    assert result["floor.normal_force"].min() >= -1e-9 * math.sqrt(stiffness * mass)
    # the initial jump c v, which is the law's
    assert result["floor.normal_force"][result.t == events(result, "close")[0].t][-1] == pytest.approx(
        law.damping * 1.0, rel=1e-7
    )
    # numerics.md 6.1, in its own form
    if zeta < 1.0:
        s = math.sqrt(1.0 - zeta**2)
        turn = math.pi - math.atan(2.0 * zeta * s / (1.0 - 2.0 * zeta**2)) if zeta < math.sqrt(0.5) else math.atan(
            2.0 * zeta * s / (2.0 * zeta**2 - 1.0)
        )  # fmt: skip
        assert ratio(result) == pytest.approx(math.exp(-zeta * turn / s), rel=1e-7)


def test_kelvin_voigt_keeps_no_energy_after_release():
    """What the spring holds at release is lost, not given back: the ledger closes afterwards too."""
    result = strike(KelvinVoigt(stiffness=1e4, damping=60.0), 1.0, 1.0, 1.0)
    out = result["ball.vy"][-1]
    lost = result["energy.dissipation"][-1] + result["energy.impact_loss"][-1]
    assert lost == pytest.approx(0.5 * (1.0 - out**2), rel=1e-7)
    assert np.abs(result["energy.balance"]).max() < 1e-7


@pytest.mark.parametrize(
    "law",
    [
        Hertz(stiffness=1e5),
        KelvinVoigt(stiffness=1e4, damping=20.0),
        HuntCrossley(stiffness=1e5, restitution=0.6),
        Gonthier(stiffness=1e5, restitution=0.6),
    ],
)
def test_penetration_under_weight_of_a_ball_laid_down_softly(law):
    """Long after a soft landing a damped ball lies at the depth whose force is the weight; Hertz swings about it."""
    power = getattr(law, "exponent", 1.0)
    depth = (G / law.stiffness) ** (1.0 / power)
    result = simulate(ball_over_floor(law, height=0.0), 2.0, rtol=1e-8, atol=1e-12)
    late = result.t > 1.0
    if isinstance(law, KelvinVoigt):
        assert result["ball.y"][-1] == pytest.approx(-depth, rel=1e-4)
    force = np.trapezoid(result["floor.normal_force"], result.t) / result.t[-1]
    assert force == pytest.approx(G, rel=5e-2)
    assert result["ball.y"][late].min() < 0.0


@quick
@given(
    st.sampled_from([law for law in LAWS.values() if issubclass(law, ForceLaw)]),
    st.floats(0.1, 3.0),
    st.floats(-1.0, 1.0),
)
def test_law_derivatives_are_those_of_its_force(law, depth, rate):
    """dF/dd, dF/dd' and the elastic part against central differences of third-order-exact span."""
    fields = law.model_fields
    values = {"stiffness": 2.0, "restitution": 0.6, "damping": 0.3, "exponent": 1.5, "relaxation_time": 0.1}
    left_out = {Tsuji: "restitution"}.get(law)
    law = law(**{name: value for name, value in values.items() if name in fields and name != left_out})
    force, by_depth, by_rate, elastic, energy = law.evaluate(depth, rate, 0.8)

    def difference(f, h=1e-3):
        return (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12.0 * h)

    assert by_depth == pytest.approx(difference(lambda x: law.evaluate(depth + x, rate, 0.8)[0]), rel=1e-7, abs=1e-9)
    assert by_rate == pytest.approx(difference(lambda x: law.evaluate(depth, rate + x, 0.8)[0]), rel=1e-7, abs=1e-9)
    assert elastic == pytest.approx(law.evaluate(depth, 0.0, 0.8)[0], rel=1e-14)
    assert elastic == pytest.approx(difference(lambda x: law.elastic_energy(depth + x)), rel=1e-7)
    assert energy == pytest.approx(law.elastic_energy(depth), rel=1e-14)
    assert force > 0.0 or rate < 0.0
