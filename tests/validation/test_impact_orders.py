"""Runs cut by impacts keep the order of their method; impact times and impulses are those of minimal coordinates."""

import math
from itertools import pairwise

import numpy as np
import pytest
from tlismni.core import simulate
from tlismni.models import load
from tlismni.validation.study.cases import OrderCase, Setting
from tlismni.validation.study.double_pendulum import NAMES, DoublePendulum
from tlismni.validation.study.impact_orders import LOST, ROUNDING, STARTS, ImpactOrderRow, measure

SCENARIO = load("double_pendulum_wall")
REFERENCE = DoublePendulum.of(SCENARIO)
COURSE = REFERENCE.solve(SCENARIO.t_end)
END, BLOWS = COURSE.end, COURSE.blows


# ---- the reference itself


def test_reference_keeps_its_energy_between_blows_and_loses_at_them_what_it_says() -> None:
    lost = sum(blow.energy_loss for blow in BLOWS)
    assert len(BLOWS) == 6 and lost > 1.0
    assert REFERENCE.energy(END) == pytest.approx(REFERENCE.energy(REFERENCE.start()) - lost, abs=1e-11)


def test_reference_does_not_depend_on_its_tolerance() -> None:
    course = REFERENCE.solve(SCENARIO.t_end, 1e-12)
    assert np.abs(course.end - END).max() < 1e-9
    assert max(abs(a.t - b.t) for a, b in zip(course.blows, BLOWS, strict=True)) < 1e-11


def test_reference_strikes_as_newton_says_with_the_gap_closed() -> None:
    y = np.array([-1.4, -1.7, 0.5, -2.0])
    after, blow = REFERENCE.strike(0.0, y)
    gradient = REFERENCE.gradient(y)
    assert gradient @ after[2:] == pytest.approx(-0.8 * gradient @ y[2:], rel=1e-14)
    assert blow.energy_loss == pytest.approx(REFERENCE.energy(y) - REFERENCE.energy(after), rel=1e-12)
    # impulse on the tip: momenta change by P dg/dq
    momenta = REFERENCE.mass(*y[:2]) @ (after[2:] - y[2:])
    assert momenta == pytest.approx(blow.impulse * gradient, rel=1e-12)


# ---- tight tolerances


@pytest.mark.parametrize(
    "method, options, rtol",
    [
        ("ebdf", {"k": 4}, 1e-12),
        ("ebdf", {"k": "auto"}, 1e-12),
        ("mebdf", {"k": 6}, 1e-12),
        ("irk", {"tableau": "gauss3"}, 1e-11),
        ("irk", {"tableau": "radau3"}, 1e-12),
        ("adams", {"order": 7}, 1e-12),
        ("bdf", {"order": "auto"}, 2e-13),
    ],
)
def test_six_impacts_at_tight_tolerance_agree_to_1e_10(method: str, options: dict, rtol: float) -> None:
    result = simulate(SCENARIO.model, SCENARIO.t_end, method, rtol, 0.01 * rtol, **options)
    assert [event.kind for event in result.events] == ["impact"] * 6
    for event, blow in zip(result.events, BLOWS, strict=True):
        assert event.t == pytest.approx(blow.t, abs=1e-10)
        assert event.impulse == pytest.approx(blow.impulse, abs=1e-9)
        assert event.approach_speed == pytest.approx(blow.approach_speed, abs=1e-9)
        assert event.energy_loss == pytest.approx(blow.energy_loss, abs=1e-9)
    assert np.abs([result[name][-1] for name in NAMES] - END).max() < 1e-8


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method, options", [("ebdf", {"k": 6}), ("irk", {"tableau": "gauss3"})])
def test_plastic_impacts_hold_the_tip_at_the_wall_until_its_force_vanishes(method: str, options: dict) -> None:
    scenario = load("double_pendulum_wall", restitution=0.0, wall=0.2)
    course = DoublePendulum.of(scenario).solve(2.9)
    result = simulate(scenario.model, 2.9, method, 1e-12, 1e-14, **options)
    assert [event.kind for event in result.events] == ["impact", "close", "open"] * 3 + ["impact", "close"]
    impacts = [event for event in result.events if event.kind == "impact"]
    for impact, blow in zip(impacts, course.blows, strict=True):
        assert impact.t == pytest.approx(blow.t, abs=1e-9)
        assert impact.impulse == pytest.approx(blow.impulse, abs=1e-8)
    openings = [event.t for event in result.events if event.kind == "open"]
    assert openings == pytest.approx(course.openings[:3], abs=1e-9) and course.openings[3] == math.inf
    assert np.abs([result[name][-1] for name in NAMES] - course.end).max() < 1e-7


@pytest.mark.parametrize("method, options", [("ebdf", {"k": 4}), ("irk", {"tableau": "gauss3"}), ("hht", {})])
def test_error_falls_with_the_tolerance_through_all_impacts(method: str, options: dict) -> None:
    """A hundredth of the tolerance takes off at least a decade: p/(p + 1) of the two for order p."""
    tolerances = (1e-4, 1e-6, 1e-8)
    errors = []
    for rtol in tolerances:
        result = simulate(SCENARIO.model, SCENARIO.t_end, method, rtol, 0.01 * rtol, **options)
        assert len(result.events) == 6
        errors.append(max(abs(a.t - b.t) for a, b in zip(result.events, BLOWS, strict=True)))
    for coarse, fine in pairwise(errors):
        assert fine < 0.1 * coarse
    assert errors[-1] < 1e-5


# ---- fixed steps


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "method, options, order, counts",
    [
        ("newmark", {}, 2, (453, 640, 905)),
        ("hht", {"alpha": -0.1}, 2, (453, 640, 905)),
        ("bdf", {"order": 2}, 2, (1810, 2560, 3620)),
        ("bdf", {"order": 3}, 3, (1810, 2560, 3620)),
        ("bdf", {"order": 5}, 5, (3620, 5120, 7241)),
        ("ebdf", {"k": 2}, 3, (1810, 2560, 3620)),
        ("ebdf", {"k": 4}, 5, (2560, 3620, 5120)),
        ("adams", {"order": 4}, 4, (3620, 5120, 7241)),
        ("irk", {"tableau": "sdirk4"}, 4, (640, 905, 1280)),
        ("irk", {"tableau": "radau3"}, 5, (320, 453, 640)),
        ("irk", {"tableau": "gauss3"}, 6, (226, 320, 453)),
        ("hht_ggl", {}, 2, (453, 640, 905)),
        ("baumgarte", {"scheme": "rk23"}, 3, (640, 905, 1280)),
    ],
)
def test_order_is_kept_through_six_impacts(method: str, options: dict, order: int, counts: tuple[int, ...]) -> None:
    row = measure(OrderCase(Setting(method, options), order), counts, STARTS[:4])
    assert not row.failed
    assert row.verdict == "kept"
    assert all(order - 0.5 < found < order + 0.8 for found in row.orders), row.orders


def test_lost_order_would_show() -> None:
    """Errors of order 2 in a method of order 4 are called lost; errors at rounding are not read."""
    steps = tuple(0.01 * 2.0**-k for k in range(9))
    case = OrderCase(Setting("irk"), 4)
    row = ImpactOrderRow(case, steps, tuple((h**2, 10.0 * h**2) for h in steps))
    assert row.orders == pytest.approx((2.0, 2.0)) and row.verdict == "lost" and row.floor(0) == 0.0
    noise = 2.0 * steps[5] ** 4
    row = ImpactOrderRow(case, steps, tuple((max(h**4, noise), 1e10 * h**4) for h in steps))
    assert row.floor(0) == ROUNDING * noise and row.floor(1) == 0.0
    assert row.orders == pytest.approx((4.0, 4.0)) and row.verdict == "kept"
    row = ImpactOrderRow(case, steps, tuple((noise, 1e-3 * h**4) for h in steps))
    assert math.isnan(row.order(0)) and row.verdict == "open"
    assert 0.0 < LOST < 0.3
