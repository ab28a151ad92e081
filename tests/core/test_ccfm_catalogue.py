"""Every law of the catalogue in an impact without gravity, integrated by the solver, against closed forms."""

import math

import numpy as np
import pytest
from helpers import events
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import beta
from strikes import hertz_contact, ratio, rebound, scipy_rebound, strike
from tlismni.core import (
    CarvalhoMartins,
    Flores,
    Gonthier,
    HerbertMcWhannell,
    Hertz,
    HuGuo,
    HuntCrossley,
    KelvinVoigt,
    KuwabaraKono,
    LankaraniNikravesh,
    LeeWang,
    Material,
    ModelError,
    Tsuji,
    ZhiyingQishao,
    sphere_on_plane,
)

quick = settings(deadline=None, max_examples=12, derandomize=True)


def gonthier_approximate(**fields):
    return Gonthier(variant="approximate", **fields)


REQUESTED = (0.05, 0.10, 0.20, 0.30, 0.50, 0.70, 0.80, 0.90, 0.95)
# rebound speed over approach speed, from an independent integration (numerics.md, section 6)
TABLE = {
    HuntCrossley: (0.5014, 0.5158, 0.5469, 0.5813, 0.6630, 0.7680, 0.8329, 0.9090, 0.9524),
    HerbertMcWhannell: (0.4884, 0.4907, 0.5008, 0.5200, 0.5936, 0.7227, 0.8070, 0.9009, 0.9501),
    LeeWang: (0.6746, 0.6867, 0.7120, 0.7390, 0.7992, 0.8693, 0.9090, 0.9524, 0.9756),
    LankaraniNikravesh: (0.6635, 0.6653, 0.6723, 0.6842, 0.7252, 0.7960, 0.8471, 0.9132, 0.9535),
    gonthier_approximate: (0.0501, 0.1010, 0.2046, 0.3042, 0.4877, 0.6696, 0.7680, 0.8764, 0.9359),
    ZhiyingQishao: (0.1969, 0.2175, 0.2664, 0.3267, 0.4826, 0.6796, 0.7874, 0.8959, 0.9489),
    Flores: (0.0329, 0.0694, 0.1555, 0.2562, 0.4704, 0.6832, 0.7885, 0.8939, 0.9468),
    HuGuo: (0.0351, 0.0741, 0.1656, 0.2707, 0.4877, 0.6973, 0.7992, 0.8999, 0.9500),
    Gonthier: REQUESTED,
}
ROWS = [(law, e, out) for law, row in TABLE.items() for e, out in zip(REQUESTED, row, strict=True)]
FAMILY = (*TABLE, CarvalhoMartins)


@pytest.mark.parametrize("law, e, out", ROWS)
def test_every_row_of_the_table(law, e, out):
    """To the table's four digits, and to seven the root of (1 + D)/(1 - D e_out) = exp(D (1 + e_out))."""
    law = law(stiffness=1e6, restitution=e)
    found = ratio(strike(law))
    assert found == pytest.approx(out, abs=5.1e-5)
    assert found == pytest.approx(rebound(law.damping_factor()), rel=1e-7)


@pytest.mark.parametrize("e, out", [(0.9, 0.90000), (0.7, 0.69997), (0.5, 0.50017), (0.3, 0.30422), (0.1, 0.10099)])
def test_carvalho_martins_is_impact_model_2_of_exudyn(e, out):
    """Five digits of its own runs; the two branches meet at e = 1/3."""
    assert ratio(strike(CarvalhoMartins(stiffness=1e6, restitution=e))) == pytest.approx(out, abs=1.1e-5)
    above, below = (
        CarvalhoMartins(stiffness=1.0, restitution=1.0 / 3.0 + shift).damping_factor() for shift in (1e-12, -1e-12)
    )
    assert above == pytest.approx(below, rel=1e-10)


@pytest.mark.parametrize(
    "e, factor",
    [(0.05, 20.0), (0.1, 9.998159), (0.2, 4.919167), (0.3, 3.087082), (0.5, 1.432751), (0.7, 0.634828),
     (0.8, 0.373146), (0.9, 0.166482), (0.95, 0.078927)],
)  # fmt: skip
def test_exact_damping_factors_are_those_of_the_table(e, factor):
    assert Gonthier(stiffness=1.0, restitution=e).damping_factor() == pytest.approx(factor, abs=5.1e-7)


@pytest.mark.parametrize("law", FAMILY)
def test_damping_factors_for_small_loss(law):
    """D = 3 (1 - e)/2 + O((1 - e)^2) where e_out is e to first order; three laws differ even there."""
    slope = {LeeWang: 0.75, gonthier_approximate: 2.0, Flores: 1.6}.get(law, 1.5)
    factor = law(stiffness=1.0, restitution=1.0 - 1e-4).damping_factor()
    assert factor == pytest.approx(slope * 1e-4, rel=3e-4)


# laws that say that they never pull: the family always, the others when released at zero force
UNTENSILE = st.one_of(
    st.builds(
        lambda law, e, n: law(stiffness=1e6, restitution=e, exponent=n),
        st.sampled_from(FAMILY), st.floats(0.05, 1.0), st.floats(1.0, 3.0),
    ),
    st.builds(lambda c: KelvinVoigt(stiffness=1e6, damping=c), st.floats(0.0, 4e3)),
    st.builds(
        lambda e: Tsuji(stiffness=1e6, mass=1.0, restitution=e), st.floats(0.02, 1.0)
    ),
    st.builds(lambda a: KuwabaraKono(stiffness=1e6, relaxation_time=a), st.floats(0.0, 1e-2)),
)  # fmt: skip
PULLING = st.one_of(
    st.builds(lambda c: KelvinVoigt(stiffness=1e6, damping=c, release_rule="gap"), st.floats(1.0, 1.5e3)),
    st.builds(
        lambda e: Tsuji(stiffness=1e6, mass=1.0, restitution=e, release_rule="gap"), st.floats(0.05, 0.95)
    ),
    st.builds(
        lambda a: KuwabaraKono(stiffness=1e6, relaxation_time=a, release_rule="gap"), st.floats(1e-5, 3e-3)
    ),
)  # fmt: skip


def span(law):
    """Depth and force of the same spring without loss."""
    exponent = 1.0 if isinstance(law, KelvinVoigt) else getattr(law, "exponent", 1.5)
    return hertz_contact(1.0, law.stiffness, exponent, 1.0)[:2]


@settings(deadline=None, max_examples=40, derandomize=True)
@given(UNTENSILE)
def test_force_is_never_tensile_where_the_law_says_so(law):
    depth, force = span(law)
    result = strike(law, exponent=getattr(law, "exponent", 1.5))
    assert result["floor.normal_force"].min() >= -1e-9 * force
    (opened,) = events(result, "open")
    at_end = result.t == opened.t
    if law.release == "gap":
        assert np.abs(result["floor.gap"][at_end]).max() < 1e-9 * depth
        assert np.abs(result["floor.normal_force"][at_end]).max() < 1e-6 * force
    else:
        assert result["floor.gap"][at_end].max() <= 1e-9 * depth


@quick
@given(PULLING)
def test_contact_released_at_zero_penetration_pulls_before(law):
    depth, _ = span(law)
    result = strike(law)
    (opened,) = events(result, "open")
    assert np.abs(result["floor.gap"][result.t == opened.t]).max() < 1e-9 * depth
    assert result["floor.normal_force"].min() < 0.0


@settings(deadline=None, max_examples=24, derandomize=True)
@given(st.one_of(UNTENSILE, PULLING))
def test_energy_loss_is_that_of_the_speeds(law):
    result = strike(law, exponent=getattr(law, "exponent", 1.5))
    (opened,) = events(result, "open")
    expected = 0.5 * (1.0 - ratio(result) ** 2)
    assert opened.energy_loss == pytest.approx(expected, rel=1e-6, abs=1e-7)
    lost = result["energy.dissipation"][-1] + result["energy.impact_loss"][-1]
    assert lost == pytest.approx(expected, rel=1e-6, abs=1e-7)
    assert opened.impulse == pytest.approx(1.0 + ratio(result), rel=1e-7)
    assert np.abs(result["energy.balance"]).max() < 1e-7


@quick
@given(
    st.floats(0.05, 1.0), st.floats(3.0, 8.0), st.floats(-2.0, 2.0), st.floats(-1.0, 1.0),
    st.sampled_from(["force", "gap"]),
)  # fmt: skip
def test_tsuji_gives_what_was_asked_at_any_speed(e, stiffness, mass, speed, rule):
    law = Tsuji(stiffness=10.0**stiffness, mass=10.0**mass, restitution=e, release_rule=rule)
    assert ratio(strike(law, 10.0**mass, 10.0**speed)) == pytest.approx(e, rel=1e-6)


@quick
@given(st.floats(0.01, 0.9))
def test_kelvin_voigt_released_at_zero_penetration_has_the_restitution_of_a_half_period(zeta):
    law = KelvinVoigt(stiffness=4e4, damping=2.0 * zeta * 200.0, release_rule="gap")
    s = math.sqrt(1.0 - zeta**2)
    options = {"exponent": 1.0} if zeta < 0.8 else {"exponent": 1.0, "speed": 2.0}
    result = strike(law, **options)
    assert ratio(result) == pytest.approx(math.exp(-math.pi * zeta / s), rel=1e-6)
    duration = events(result, "open")[0].t - events(result, "close")[0].t
    assert duration == pytest.approx(math.pi / (200.0 * s), rel=1e-7)


@pytest.mark.parametrize("release", ["gap", "force"])
@pytest.mark.parametrize("loss", [0.05, 0.3, 1.0])
def test_viscoelastic_spheres_follow_an_independent_integration(release, loss):
    damping, time = 1000.0 * loss, 5e-3 * loss
    tsuji = Tsuji(stiffness=1e6, damping=damping, release_rule=release)
    expected = scipy_rebound(lambda d, dd: 1e6 * d**1.5 + damping * d**0.25 * dd, release)
    assert ratio(strike(tsuji)) == pytest.approx(expected, rel=1e-6)
    viscous = KuwabaraKono(stiffness=1e6, relaxation_time=time, release_rule=release)
    expected = scipy_rebound(lambda d, dd: 1e6 * (d**1.5 + 1.5 * time * math.sqrt(d) * dd), release)
    assert ratio(strike(viscous)) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("release", ["gap", "force"])
def test_loss_of_kuwabara_kono_grows_with_the_fifth_root_of_the_speed(release):
    """To first order the motion is Hertz's: loss = 3 A K v d^(3/2) int_0^1 sqrt(u (1 - u^(5/2))) du."""
    losses = []
    for speed in (1.0, 32.0):
        depth, _, _ = hertz_contact(1.0, 1e6, 1.5, speed)
        law = KuwabaraKono(stiffness=1e6, relaxation_time=1e-7, release_rule=release)
        losses.append(1.0 - ratio(strike(law, speed=speed, rtol=1e-11)))
        integral = 0.4 * beta(0.6, 1.5)
        assert losses[-1] == pytest.approx(3.0 * 1e-7 * 1e6 * depth**1.5 * integral / speed, rel=2e-3)
    assert losses[1] / losses[0] == pytest.approx(2.0, rel=2e-3)


@pytest.mark.parametrize("exponent, coefficient", [(1.0, math.pi), (1.5, 2.9432751843), (2.0, 2.8043642)])
def test_duration_of_an_undamped_contact_over_depth_and_speed(exponent, coefficient):
    law = Hertz(stiffness=1e5, exponent=exponent)
    result = strike(law, 0.3, 2.0, exponent, rtol=1e-11)
    begin, end = events(result, "close")[0].t, events(result, "open")[0].t
    at_turn = strike(law, 0.3, 2.0, exponent, rtol=1e-11, t_eval=[0.5 * (begin + end)])
    assert (end - begin) * 2.0 / -at_turn["floor.gap"][-1] == pytest.approx(coefficient, rel=5e-7)


def test_steel_sphere_on_steel_half_space_from_its_material():
    steel = Material(youngs_modulus=2.1e11, poisson_ratio=0.3)
    stiffness, mass = sphere_on_plane(0.01, steel, steel), 7800.0 * 4.0 / 3.0 * math.pi * 0.01**3
    assert stiffness == pytest.approx(1.538462e10, rel=5e-7)
    assert mass == pytest.approx(3.267256e-2, rel=5e-7)
    law = Hertz(stiffness=stiffness)
    result = strike(law, mass, rtol=1e-10)
    begin, end = events(result, "close")[0].t, events(result, "open")[0].t
    at_turn = strike(law, mass, rtol=1e-10, t_eval=[0.5 * (begin + end)])
    assert end - begin == pytest.approx(6.893400e-5, rel=5e-7)
    assert -at_turn["floor.gap"] == pytest.approx(2.342085e-5, rel=5e-7)
    assert at_turn["floor.normal_force"] == pytest.approx(1743.776, rel=5e-7)


@pytest.mark.parametrize(
    "fields",
    [{}, {"mass": 1.0}, {"restitution": 0.5}, {"damping": 1.0, "mass": 1.0}, {"damping": 1.0, "restitution": 0.5}],
)
def test_tsuji_is_damped_in_exactly_one_way(fields):
    with pytest.raises(ModelError, match="either damping, or both mass and restitution"):
        Tsuji(stiffness=1.0, **fields)


@pytest.mark.parametrize("law", [Flores, HuGuo, CarvalhoMartins, Gonthier, gonthier_approximate])
def test_laws_that_would_need_infinite_damping_refuse_restitution_0(law):
    with pytest.raises(ModelError, match="restitution"):
        law(stiffness=1.0, restitution=0.0)


@pytest.mark.parametrize("damping", [1e-3, 0.0625])
def test_release_is_found_in_the_step_in_which_the_gap_opens(damping):
    """A weak damper lets go at d = c v/K, so shortly before the gap opens that one step passes both."""
    result = strike(KelvinVoigt(stiffness=1e6, damping=damping), exponent=1.0)
    (opened,) = events(result, "open")
    released = result["floor.gap"][result.t == opened.t][0]
    assert -released == pytest.approx(damping * 1.0 / 1e6, rel=1e-3)
    assert result["floor.normal_force"].min() >= -1e-6 * damping
