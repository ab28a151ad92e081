"""Force laws that only push, and what they do where shapes meet without an approach: the table that drops away, loads
on shapes that rest, contacts that start closed."""

import logging
import math

import numpy as np
import pytest
from helpers import G, events, floor_contact
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from strikes import ratio, strike
from tlismni.core import (
    AppliedForce2D,
    CarvalhoMartins,
    Disk2D,
    DiskOnHalfPlane2D,
    Flores,
    Gonthier,
    HalfPlane2D,
    HuntCrossley,
    KelvinVoigt,
    LeeWang,
    Marker2D,
    Model,
    MovingFrame2D,
    PointMass2D,
    Polynomial,
    Ramp,
    SpringDamper2D,
    Step,
    Tsuji,
    simulate,
)
from tlismni.core.laws import FORCE_LAWS
from tlismni.core.laws.damping_ratio import damping_ratio_without_pull, restitution_without_pull
from tlismni.core.laws.hunt_crossley import HuntCrossleyFamily

quick = settings(deadline=None, max_examples=20, derandomize=True)
K = 1e6
GIVEN = {"stiffness": K, "restitution": 0.3, "damping": 200.0, "relaxation_time": 1e-3}
FAMILY = [law for law in FORCE_LAWS.values() if issubclass(law, HuntCrossleyFamily)]
PULLS = [law for law in FORCE_LAWS.values() if "release_rule" in law.model_fields]


def law_of(kind, **more):
    """A law with much loss, everything else left out."""
    left_out = {Tsuji: "restitution"}.get(kind)
    return kind(**{n: x for n, x in GIVEN.items() if n in kind.model_fields and n != left_out}, **more)


def static_depth(law):
    power = 1.0 if isinstance(law, KelvinVoigt) else getattr(law, "exponent", 1.5)
    return (G / law.stiffness) ** (1.0 / power)


def on_table(law, table, *forces):
    part = PointMass2D(name="part", mass=1.0, position=(0.0, -static_depth(law)))
    frame = MovingFrame2D(name="table", y=table)
    plane = HalfPlane2D(marker=Marker2D(body="table"))
    contact = DiskOnHalfPlane2D(name="c", plane=plane, disk=Disk2D(marker=Marker2D(body="part")), law=law)
    return Model(bodies=[part, frame], forces=list(forces), contacts=[contact], gravity=(0.0, -G))


def test_there_are_thirteen_laws_and_those_with_a_damper_have_the_rule():
    assert len(FORCE_LAWS) == 13
    assert {law.__name__ for law in FORCE_LAWS.values()} - {law.__name__ for law in PULLS} == {"Hertz"}
    assert all(law.model_fields["release_rule"].default == "force" for law in PULLS)


@pytest.mark.parametrize("kind", FORCE_LAWS.values(), ids=lambda kind: kind.__name__)
def test_a_table_that_drops_away_does_not_pull_the_part_along(kind):
    law = law_of(kind)
    model = on_table(law, Ramp(start=0.1, duration=1.0, before=0.0, after=-0.3))
    result = simulate(model, 0.15, rtol=1e-8, atol=1e-11)
    assert result["c.normal_force"].min() >= 0.0
    after = result.t > 0.1
    assert np.all(result["part.vy"][after] >= -G * (result.t[after] - 0.1) - 1e-6)
    assert result["part.vy"][-1] == pytest.approx(-0.3, abs=0.31)  # it is not carried off either
    assert np.abs(result["energy.balance"]).max() < 1e-6


@pytest.mark.parametrize("kind", FORCE_LAWS.values(), ids=lambda kind: kind.__name__)
def test_a_part_that_a_rope_lifts_is_not_held_back(kind):
    law = law_of(kind)
    depth = static_depth(law)
    hook = MovingFrame2D(name="hook", y=Polynomial(coefficients=[0.0, 0.0, 0.0, 0.5 / 0.12]))
    rope = SpringDamper2D(
        name="rope", a=Marker2D(body="hook", point=(0.0, 1.0)), b=Marker2D(body="part"), stiffness=2e4, damping=50.0,
        natural_length=1.0 + depth,
    )  # fmt: skip
    part = PointMass2D(name="part", mass=1.0, position=(0.0, -depth))
    model = Model(bodies=[part, hook], forces=[rope], contacts=[floor_contact(law, body="part")], gravity=(0.0, -G))
    result = simulate(model, 0.12)
    assert result["floor.normal_force"].min() >= 0.0
    assert result["floor.gap"][-1] > 0.0


@quick
@given(
    st.sampled_from(FAMILY), st.floats(1e-6, 1e-2), st.floats(-10.0, 10.0), st.floats(1e-3, 10.0), st.floats(1.0, 3.0)
)
def test_the_formula_is_the_published_one_and_the_rule_says_until_when(kind, depth, rate, v0, exponent):
    pushes, pulls = (law_of(kind, exponent=exponent, release_rule=rule) for rule in ("force", "gap"))
    published = K * depth**exponent * (1.0 + pulls.damping_factor() * rate / v0)
    assert pulls.evaluate(depth, rate, v0)[0] == pytest.approx(published, rel=1e-12)
    assert pushes.evaluate(depth, rate, v0) == pulls.evaluate(depth, rate, v0)
    assert pushes.never_pulls and not pulls.never_pulls


def test_the_published_formula_pulls_the_part_along():
    law = law_of(Flores, release_rule="gap")
    result = simulate(on_table(law, Ramp(start=0.1, duration=1.0, before=0.0, after=-0.3)), 0.15)
    assert result["c.normal_force"].min() < -G


@pytest.mark.parametrize("kind", FAMILY, ids=lambda kind: kind.__name__)
def test_a_free_blow_is_the_same_with_either_rule(kind):
    """It never pulls: to the last bit."""
    runs = [strike(law_of(kind, release_rule=rule)) for rule in ("force", "gap")]
    assert np.array_equal(runs[0]["floor.normal_force"], runs[1]["floor.normal_force"])
    assert np.array_equal(runs[0]["ball.vy"], runs[1]["ball.vy"])


@quick
@given(st.floats(0.01, 1.0), st.floats(3.0, 8.0), st.floats(-2.0, 2.0), st.floats(-1.0, 1.0))
def test_tsuji_gives_what_is_asked_without_pulling(e, stiffness, mass, speed):
    law = Tsuji(stiffness=10.0**stiffness, mass=10.0**mass, restitution=e)
    result = strike(law, 10.0**mass, 10.0**speed)
    assert ratio(result) == pytest.approx(e, rel=1e-6)
    assert result["floor.normal_force"].min() >= 0.0


@given(st.floats(1e-12, 1.0))
@settings(deadline=None, derandomize=True)
def test_damping_ratio_and_restitution_are_inverse(e):
    assert restitution_without_pull(damping_ratio_without_pull(e)) == pytest.approx(e, rel=1e-9)


@pytest.mark.parametrize("e", [0.0, -0.1, 1.1, math.nan])
def test_no_damping_ratio_gives_another_restitution(e):
    with pytest.raises(ValueError, match="0 < restitution <= 1"):
        damping_ratio_without_pull(e)


def laid(law, load, depth, mass=1.0):
    """Acceleration downwards of a mass on the law as it acts without an approach: the damping of the blow that goes as
    deep as the mass has sunk in, and at least that of the settling speed."""
    n, factor = law.exponent, law.damping_factor()
    slowest = math.sqrt(G * depth)

    def rhs(t, y):
        d, rate = y
        if d <= 0.0:
            return rate, load / mass
        v = max(slowest, math.sqrt(2.0 * law.stiffness * d ** (n + 1.0) / ((n + 1.0) * mass)))
        force = max(law.stiffness * d**n * (1.0 + factor * rate / v), 0.0)
        return rate, (load - force) / mass

    return rhs


@pytest.mark.sampled(4)
@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("kind", [HuntCrossley, LeeWang, Gonthier, CarvalhoMartins])
def test_a_load_on_a_part_at_rest_is_damped_as_by_the_blow_that_goes_as_deep(kind, exponent):
    law = kind(stiffness=1e5, exponent=exponent, restitution=0.5)
    depth, t_end = static_depth(law), 0.05
    part = PointMass2D(name="ball", mass=1.0, position=(0.0, -depth))
    push = AppliedForce2D(name="push", marker=Marker2D(body="ball"), force_y=Step(time=0.01, after=-100.0))
    model = Model(bodies=[part], forces=[push], contacts=[floor_contact(law)], gravity=(0.0, -G))
    times = np.linspace(0.011, t_end, 20)
    result = simulate(model, t_end, rtol=1e-9, atol=1e-12, t_eval=times)
    exact = solve_ivp(laid(law, G + 100.0, depth), (0.01, t_end), (depth, 0.0), "DOP853", t_eval=times,
                      rtol=1e-11, atol=1e-14, max_step=1e-4)  # fmt: skip
    assert -result["ball.y"] == pytest.approx(exact.y[0], rel=1e-6)
    assert np.abs(result["energy.balance"]).max() < 1e-8


def test_a_linear_spring_without_an_approach_has_half_the_factor_as_damping_ratio():
    """F = K d + D sqrt(m K) d': zeta = D/2; the load of 100 N overshoots by exp(-pi zeta/sqrt(1 - zeta^2))."""
    law = HuntCrossley(stiffness=1e5, exponent=1.0, restitution=0.5)
    zeta, w = 0.5 * law.damping_factor(), math.sqrt(1e5)
    s = math.sqrt(1.0 - zeta**2)
    part = PointMass2D(name="ball", mass=1.0, position=(0.0, -G / 1e5))
    push = AppliedForce2D(name="push", marker=Marker2D(body="ball"), force_y=Step(time=0.01, after=-100.0))
    model = Model(bodies=[part], forces=[push], contacts=[floor_contact(law)], gravity=(0.0, -G))
    result = simulate(model, 0.01 + math.pi / (w * s), rtol=1e-10, atol=1e-13)
    deepest = 1e-5 * (G + 100.0 * (1.0 + math.exp(-math.pi * zeta / s)))
    assert -result["ball.y"][-1] == pytest.approx(deepest, rel=1e-6)


@pytest.mark.parametrize("kind", FAMILY, ids=lambda kind: kind.__name__)
def test_a_contact_that_starts_pressed_lets_go(kind):
    """Without weight, at rest, pressed in by d0: the spring throws the mass out within a period or a few; it was held
    as by glue."""
    law = kind(stiffness=1e5, exponent=1.0, restitution=0.5)
    depth, w = 1e-3, math.sqrt(1e5)
    model = Model(
        bodies=[PointMass2D(name="ball", mass=1.0, position=(0.0, -depth))], contacts=[floor_contact(law)],
        gravity=(0.0, 0.0),
    )  # fmt: skip
    result = simulate(model, 20.0 / w, rtol=1e-9, atol=1e-12)
    zeta = 0.5 * law.damping_factor()
    # the damper is linear, so that depth and speed are; a force that would pull is none
    exact = solve_ivp(lambda t, y: (y[1], -max(w * w * y[0] + 2.0 * zeta * w * y[1], 0.0) if y[0] > 0.0 else 0.0),
                      (0.0, 20.0 / w), (depth, 0.0), rtol=1e-10, atol=1e-14, max_step=1e-2 / w)  # fmt: skip
    assert result["floor.gap"][-1] > 0.0
    assert result["ball.vy"][-1] == pytest.approx(-exact.y[1, -1], rel=1e-4)
    assert np.abs(result["energy.balance"]).max() < 1e-8


def warned(caplog, model):
    with caplog.at_level(logging.WARNING, logger="tlismni"):
        simulate(model, 1e-3)
    return [record.getMessage() for record in caplog.records if "without an approach" in record.getMessage()]


@pytest.mark.parametrize("kind", FORCE_LAWS.values(), ids=lambda kind: kind.__name__)
def test_the_start_names_the_contact_whose_law_asks_for_an_approach(kind, caplog):
    law = law_of(kind)
    part = PointMass2D(name="ball", mass=1.0, position=(0.0, -static_depth(law)))
    found = warned(caplog, Model(bodies=[part], contacts=[floor_contact(law)], gravity=(0.0, -G)))
    if issubclass(kind, HuntCrossleyFamily):
        assert len(found) == 1
        assert "'floor'" in found[0]
        assert kind.__name__ in found[0]
        assert "minimum_approach_speed" in found[0]
    else:
        assert not found


def test_a_blow_at_the_start_is_no_contact_without_an_approach(caplog):
    ball = PointMass2D(name="ball", mass=1.0, velocity=(0.0, -1.0))
    assert not warned(
        caplog, Model(bodies=[ball], contacts=[floor_contact(HuntCrossley(stiffness=K, restitution=0.5))])
    )


@pytest.mark.parametrize("kind", PULLS)
def test_overlapping_shapes_that_part_fast_are_released_at_the_start(kind):
    """Their damper would pull from the first: there is no force, and what the spring holds is not given back."""
    law = law_of(kind)
    part = PointMass2D(name="ball", mass=1.0, position=(0.0, -1e-5), velocity=(0.0, 1.0))
    result = simulate(Model(bodies=[part], contacts=[floor_contact(law)], gravity=(0.0, 0.0)), 0.01)
    assert np.all(result["floor.normal_force"] == 0.0)
    assert result["ball.vy"] == pytest.approx(1.0, rel=1e-12)
    assert not events(result, "close", "open")
    assert np.abs(result["energy.balance"]).max() < 1e-12
