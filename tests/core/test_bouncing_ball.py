"""The bouncing ball against its closed form, up to and beyond the point where the impacts accumulate."""

import math

import numpy as np
import pytest
from helpers import G, ball_over_floor, events
from tlismni.core import NewtonImpact, simulate
from tlismni.models import load

E = 0.8
FALL = math.sqrt(2.0 / G)
METHODS = ("ebdf", "bdf", "irk", "hht", "newmark")


@pytest.fixture(scope="module")
def bouncing():
    scenario = load("bouncing_ball", height=1.0, restitution=E, gravity=G)
    return simulate(scenario.model, scenario.t_end)


def impact_time(n, e=E):
    return FALL * (1.0 + 2.0 * sum(e**k for k in range(1, n)))


def test_first_ten_impact_times_are_those_of_the_closed_form(bouncing):
    times = [event.t for event in events(bouncing, "impact")]
    assert np.abs(np.array(times[:10]) - [impact_time(n) for n in range(1, 11)]).max() < 1e-10


@pytest.mark.parametrize("method", METHODS)
def test_every_method_finds_the_impact_times(method):
    """Free flight is a parabola, which every formula of order >= 2 follows exactly."""
    result = simulate(ball_over_floor(NewtonImpact(restitution=E)), 4.0, method=method)
    times = [event.t for event in events(result, "impact")]
    assert np.abs(np.array(times[:10]) - [impact_time(n) for n in range(1, 11)]).max() < 1e-10


def test_impact_speeds_and_impulses_and_losses_follow_newtons_law(bouncing):
    for n, event in enumerate(events(bouncing, "impact")[:10]):
        approach = E**n * math.sqrt(2.0 * G)
        assert event.approach_speed == pytest.approx(approach, rel=1e-9)
        assert event.separation_speed == pytest.approx(E * approach, rel=1e-9)
        assert event.impulse == pytest.approx((1.0 + E) * approach, rel=1e-9)
        assert event.energy_loss == pytest.approx(0.5 * (1.0 - E**2) * approach**2, rel=1e-9)
        assert event.velocity_increment_residual < 1e-12


def test_height_of_every_bounce_shrinks_by_the_square_of_the_restitution():
    tops = [impact_time(n) + E**n * FALL for n in range(1, 8)]
    result = simulate(ball_over_floor(NewtonImpact(restitution=E)), 4.0, t_eval=tops)
    assert result["ball.y"] == pytest.approx([E ** (2 * n) for n in range(1, 8)], abs=1e-9)
    assert np.abs(result["ball.vy"]).max() < 1e-8


@pytest.mark.parametrize("rest_ratio", [1e-2, 1e-4, 1e-6])
def test_rest_comes_at_the_accumulation_point_within_the_rest_rule(rest_ratio):
    """At rest the rule drops the bounces with separation speed below v_rest = rest_ratio v_1. Flights with
    v_rest e^k last 2 v_rest e^k / g, together 2 v_rest / (g (1 - e)): by so much at most rest comes too early."""
    result = simulate(ball_over_floor(NewtonImpact(restitution=E, rest_ratio=rest_ratio)), 5.0)
    (rest,) = events(result, "rest")
    exact = FALL * (1.0 + E) / (1.0 - E)
    early = 2.0 * rest_ratio * math.sqrt(2.0 * G) / (G * (1.0 - E))
    assert exact - early - 1e-9 <= rest.t <= exact + 1e-9
    # and it drops no bounce that it need not drop
    assert rest.t >= exact - early and exact - rest.t >= E * early - 1e-9
    bounces = math.floor(math.log(rest_ratio) / math.log(E)) + 1
    assert len(events(result, "impact")) == bounces


def test_without_a_rest_ratio_it_rests_where_bounces_are_lower_than_can_be_told():
    """Instead of bouncing until the guard against runs without progress speaks; and its event is that of accumulating
    bounces."""
    result = simulate(ball_over_floor(NewtonImpact(restitution=E, rest_ratio=0.0)), 5.0)
    (rest,) = events(result, "rest")
    assert rest.t == pytest.approx(FALL * (1.0 + E) / (1.0 - E), rel=1e-5)


def test_ball_stays_at_rest(bouncing):
    (rest,) = events(bouncing, "rest")
    at_rest = bouncing.t > rest.t
    assert at_rest.sum() >= 2
    assert np.abs(bouncing["floor.gap"][at_rest]).max() < 1e-15
    assert np.abs(bouncing["ball.vy"][at_rest]).max() < 1e-15
    assert np.abs(bouncing["ball.ay"][at_rest]).max() < 1e-12
    assert np.abs(bouncing["floor.normal_force"][at_rest] - G).max() < 1e-12
    assert np.all(bouncing["floor.in_contact"][at_rest] == 1.0)
    assert bouncing.events[-1] is rest


def test_event_kinds_of_a_bouncing_ball_are_impacts_then_one_rest(bouncing):
    kinds = [event.kind for event in bouncing.events]
    assert kinds[:-1] == ["impact"] * (len(kinds) - 1) and kinds[-1] == "rest"
    assert np.all(np.diff([event.t for event in bouncing.events]) >= 0.0)


def test_all_energy_is_lost_at_the_impacts(bouncing):
    assert bouncing["energy.impact_loss"][-1] == pytest.approx(G, rel=1e-9)
    assert np.abs(bouncing["energy.balance"]).max() < 1e-8 * G
    assert sum(event.energy_loss for event in bouncing.events) == pytest.approx(G, rel=1e-9)


def test_impulse_of_the_floor_balances_weight(bouncing):
    """Momentum from rest to rest: the floor's impulse is m g t."""
    assert bouncing["floor.impulse"][-1] == pytest.approx(G * bouncing.t[-1], rel=1e-9)


def test_elastic_ball_returns_to_its_height_for_ever():
    period = 2.0 * FALL
    result = simulate(ball_over_floor(NewtonImpact(restitution=1.0)), 20.0 * period, t_eval=period * np.arange(21))
    assert np.abs(result["ball.y"] - 1.0).max() < 1e-8
    assert len(events(result, "impact")) == 20 and not events(result, "rest")


def test_plastic_ball_stays_where_it_falls():
    result = simulate(ball_over_floor(NewtonImpact(restitution=0.0)), 1.0)
    assert [event.kind for event in result.events] == ["impact", "close"]
    assert result.events[0].impulse == pytest.approx(math.sqrt(2.0 * G), rel=1e-10)
    after = result.t > result.events[0].t
    assert np.abs(result["floor.gap"][after]).max() < 1e-15
    assert np.abs(result["floor.normal_force"][after] - G).max() < 1e-12
