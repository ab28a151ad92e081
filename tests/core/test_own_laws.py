"""A user's own contact law: defined, used, written and read like the library's."""

import math
from typing import Literal

import numba
import numpy as np
import pytest
from helpers import ball_over_floor, events
from hypothesis import given, settings
from hypothesis import strategies as st
from strikes import ratio, rebound, scipy_rebound, strike
from tlismni.core import (
    EquationSystem,
    ForceLaw,
    GapContact,
    Hertz,
    HuntCrossley,
    Model,
    ModelError,
    force_formula,
    simulate,
)
from tlismni.core.laws import LAW_SIGNATURE
from tlismni.core.laws.friction import FrictionLaw, TanhFriction
from tlismni.core.laws.hunt_crossley import HuntCrossleyFamily
from tlismni.core.model.base import NonNegative, Positive

quick = settings(deadline=None, max_examples=25, derandomize=True)


def damped_spring(delta, delta_dot, v0, stiffness, exponent, loss):
    """Hunt and Crossley's force, written as a user would."""
    return stiffness * delta**exponent * (1.0 + loss * delta_dot / v0)


class DampedSpring(ForceLaw):
    """From the force alone: no derivatives, no `type`, no `parameters`."""

    formula = force_formula(damped_spring)
    stiffness: Positive
    exponent: Positive = 1.5
    loss: NonNegative = 0.0


@numba.njit(error_model="numpy")
def linear_formula(d, dd, v0, k, c, p2, p3):
    return k * d * (1.0 + c * dd), k * (1.0 + c * dd), k * d * c, k * d, 0.5 * k * d * d


class FullForm(ForceLaw):
    """With derivatives, elastic part and energy."""

    formula = linear_formula
    stiffness: Positive
    loss: NonNegative

    def parameters(self):
        return self.stiffness, self.loss


def two_slopes(delta, delta_dot, v0, k1, k2, limit):
    """Branches, max, abs, functions of math, and a branch without derivative."""
    if delta <= 0.0:
        return 0.0
    force = k1 * delta
    if delta > limit:
        force = k1 * limit + k2 * (delta - limit) + 0.1 * math.sqrt(delta - limit) ** 3
    return force * max(1.0 + 0.2 * math.tanh(delta_dot / v0) - 0.01 * abs(delta_dot) ** 1.5, 0.0)


class TwoSlopes(ForceLaw):
    formula = force_formula(two_slopes)
    k1: Positive
    k2: Positive
    limit: Positive


@pytest.mark.parametrize("loss", [0.0, 0.4, 1.2])
def test_own_law_bounces_as_the_library_s(loss):
    """A bouncing ball under gravity: same formula, same events, to the tolerance of the integration."""
    own = DampedSpring(stiffness=1e5, loss=loss)
    known = HuntCrossley(stiffness=1e5, restitution=1.0 - loss / 1.5)
    runs = [simulate(ball_over_floor(law, height=0.5), 1.2, rtol=1e-9, atol=1e-12) for law in (own, known)]
    times = [[event.t for event in events(run, "close", "open")] for run in runs]
    assert len(times[0]) >= 4
    assert times[0] == pytest.approx(times[1], rel=1e-7)
    assert runs[0]["ball.y"][-1] == pytest.approx(runs[1]["ball.y"][-1], rel=1e-6)
    assert np.abs(runs[0]["energy.balance"]).max() < 1e-6
    assert ratio(strike(own)) == pytest.approx(rebound(loss), rel=1e-7)


@quick
@given(st.floats(1e-6, 1.0), st.floats(-2.0, 2.0), st.floats(0.1, 3.0), st.floats(1.0, 3.0))
def test_derivatives_of_a_force_alone_are_exact(depth, rate, v0, exponent):
    own = DampedSpring(stiffness=7.0, exponent=exponent, loss=0.9)
    known = HuntCrossley(stiffness=7.0, exponent=exponent, restitution=0.4, release_rule="gap")
    expected = known.evaluate(depth, rate, v0)
    assert own.evaluate(depth, rate, v0)[:4] == pytest.approx(expected[:4], rel=1e-12, abs=1e-14)
    # the quadrature is exact for half-integer exponents, and close to it between
    assert own.elastic_energy(depth) == pytest.approx(known.elastic_energy(depth), rel=1e-6)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 2.5, 3.0])
def test_energy_of_half_integer_springs_is_exact(exponent):
    own = DampedSpring(stiffness=7.0, exponent=exponent)
    assert own.elastic_energy(0.3) == pytest.approx(7.0 * 0.3 ** (exponent + 1.0) / (exponent + 1.0), rel=1e-13)


@quick
@given(st.floats(0.02, 0.2), st.floats(0.01, 2.0), st.sampled_from([-1.0, 1.0]))
def test_branches_and_functions_are_differentiated(depth, rate, sign):
    if abs(depth - 0.1) < 1e-3:
        depth += 4e-3
    law, rate = TwoSlopes(k1=1e3, k2=5e3, limit=0.1), sign * rate

    def difference(f, h):
        return (45.0 * (f(h) - f(-h)) - 9.0 * (f(2 * h) - f(-2 * h)) + (f(3 * h) - f(-3 * h))) / (60.0 * h)

    force, by_depth, by_rate, elastic, _ = law.evaluate(depth, rate, 0.8)
    assert force == pytest.approx(two_slopes(depth, rate, 0.8, 1e3, 5e3, 0.1), rel=1e-14)
    assert elastic == pytest.approx(two_slopes(depth, 0.0, 0.8, 1e3, 5e3, 0.1), rel=1e-14)
    slope = difference(lambda x: two_slopes(depth + x, rate, 0.8, 1e3, 5e3, 0.1), 1e-4)
    assert by_depth == pytest.approx(slope, rel=1e-7)
    slope = difference(lambda x: two_slopes(depth, rate + x, 0.8, 1e3, 5e3, 0.1), 1e-3)
    assert by_rate == pytest.approx(slope, rel=1e-6)
    assert law.evaluate(0.0, 1.0, 1.0) == (0.0,) * 5


def rooted(delta, delta_dot, v0, stiffness):
    """Its derivatives at no penetration are quotients of nothing by nothing."""
    return stiffness * math.sqrt(delta) ** 3 + 0.0 * math.sqrt(delta)


class Rooted(ForceLaw):
    formula = force_formula(rooted)
    stiffness: Positive


@pytest.mark.parametrize("rtol", [1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
@pytest.mark.parametrize("height", [0.5, 1.0, 1.3])
def test_a_root_has_no_derivative_where_shapes_just_touch(rtol, height):
    """Where the event of the first touch lies, above or below by rounding or just there, is no matter."""
    law = Rooted(stiffness=1e5)
    assert Rooted.formula(0.0, 0.3, 1.0, 1e5, 0.0, 0.0, 0.0)[:3] == (0.0, 0.0, 0.0)
    result = simulate(ball_over_floor(law, height=height), 1.0, rtol=rtol)
    assert [event.kind for event in result.events[:2]] == ["close", "open"]


def test_law_with_branches_rebounds_as_an_independent_integration():
    law = TwoSlopes(k1=1e3, k2=5e3, limit=0.01)
    model = ball_over_floor(law, height=0.01, speed=-1.0, gravity=0.0)
    result = simulate(model, 0.5, rtol=1e-9, atol=1e-12)
    expected = scipy_rebound(lambda d, dd: two_slopes(d, dd, 1.0, 1e3, 5e3, 0.01), "gap")
    assert ratio(result) == pytest.approx(expected, rel=1e-6)


def test_full_form_is_used_as_it_is():
    law = FullForm(stiffness=1e4, loss=0.3)
    assert law.formula_parameters() == (1e4, 0.3, 0.0, 0.0)
    # a linear spring with D = 0.3 at v0 = 1 m/s
    assert ratio(strike(law, exponent=1.0)) == pytest.approx(rebound(0.3), rel=1e-7)


@pytest.mark.parametrize(
    "law", [DampedSpring(stiffness=3.0, loss=0.5), FullForm(stiffness=2.0, loss=0.1), TwoSlopes(k1=1, k2=2, limit=3)]
)
def test_model_with_an_own_law_is_data(law):
    model = ball_over_floor(law)
    again = Model.from_json(model.to_json())
    assert again == model
    assert type(again.contacts[0].law) is type(law)
    assert law.model_dump()["type"] == type(law).__name__
    assert Model.model_validate(model.model_dump()) == model


def test_own_law_may_be_a_member_of_the_family():
    class ThirdPower(HuntCrossleyFamily):
        def damping_factor(self):
            return 0.5 * (1.0 - self.restitution**3)

    law = ThirdPower(stiffness=1e5, restitution=0.5)
    assert ratio(strike(law)) == pytest.approx(rebound(0.5 * (1.0 - 0.125)), rel=1e-7)
    assert Model.from_json(ball_over_floor(law).to_json()).contacts[0].law == law


def test_own_law_in_own_equations():
    law = DampedSpring(stiffness=1e4, loss=0.5)
    system = EquationSystem(
        mass=np.eye(1), force=np.zeros(1), q0=[0.01], v0=[-1.0],
        contacts=[GapContact(name="floor", gap=lambda t, q: q[0], law=law)],
    )  # fmt: skip
    result = simulate(system, 0.5, rtol=1e-8, atol=1e-11)
    (opened,) = events(result, "open")
    assert opened.separation_speed == pytest.approx(rebound(0.5), rel=1e-6)


def test_own_friction_law_needs_no_registration_either():
    class Halved(FrictionLaw):
        formula = TanhFriction.formula
        coefficient: NonNegative
        transition_speed: Positive

        def parameters(self):
            return 0.5 * self.coefficient, self.transition_speed

    assert Halved(coefficient=0.4, transition_speed=0.1).evaluate(1e3, 2.0)[0] == pytest.approx(-0.4)
    assert Halved.model_fields["type"].default == "Halved"


def test_unknown_laws_are_refused_with_a_way_out():
    text = ball_over_floor(DampedSpring(stiffness=3.0)).to_json().replace("DampedSpring", "NoSuchLaw")
    with pytest.raises(ModelError, match=r"type 'NoSuchLaw' is none of 'NewtonImpact'.*import the module"):
        Model.from_json(text)
    with pytest.raises(ModelError, match=r"DampedSpring: stiffnes: there is no such field; did you mean .stiffness.\?"):
        ball_over_floor({"type": "DampedSpring", "stiffnes": 3.0})

    class Impostor(ForceLaw):
        type: Literal["Hertz"] = "Hertz"
        formula = linear_formula

    with pytest.raises(ModelError, match="type 'Hertz' is taken"):
        ball_over_floor(Impostor())


def test_formulas_that_cannot_be_used_are_named():
    class Plain(ForceLaw):
        formula = staticmethod(lambda *x: x)

    class Scalar(ForceLaw):
        formula = numba.njit(lambda d, dd, v0, p0, p1, p2, p3: d)

    class Nonsense(ForceLaw):
        formula = force_formula(lambda d, dd, v0: d + "x")

    for law, text in (
        (Plain(), "numba function"),
        (Scalar(), "No conversion from float64"),
        (Nonsense(), "Nonsense is not usable"),
    ):
        with pytest.raises(ModelError, match=text):
            simulate(ball_over_floor(law), 0.1)
    with pytest.raises(ModelError, match="takes 8 arguments"):
        force_formula(lambda d, dd, v0, a, b, c, e, f: d)

    class Worded(ForceLaw):
        formula = linear_formula
        kind: str = "soft"

    class Many(ForceLaw):
        formula = linear_formula
        a: float = 1.0
        b: float = 1.0
        c: float = 1.0
        d: float = 1.0
        e: float = 1.0

    with pytest.raises(ModelError, match=r"Worded.kind = 'soft' is no number"):
        simulate(ball_over_floor(Worded()), 0.1)
    with pytest.raises(ModelError, match="Many has 5 parameters, a formula takes 4"):
        simulate(ball_over_floor(Many()), 0.1)


def test_a_law_that_only_damps_does_not_hang_when_a_body_is_laid_on_it():
    class Damper(ForceLaw):
        formula = force_formula(lambda d, dd, v0, c: c * dd)
        damping: Positive

    result = simulate(ball_over_floor(Damper(damping=10.0), height=0.0), 1.0)
    # m y'' = -m g - c y': the speed goes to m g/c
    assert result["ball.vy"][-1] == pytest.approx(-0.981 * (1.0 - math.exp(-10.0)), rel=1e-4)


def test_the_signature_is_that_of_the_documentation():
    assert len(LAW_SIGNATURE.args) == 7
    assert LAW_SIGNATURE.return_type.count == 5
    assert len(Hertz(stiffness=1.0).formula_parameters()) == 4
