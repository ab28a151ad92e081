"""The order table: every method has the order that theory gives it, for positions, velocities and multipliers."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import METHODS, ModelError, simulate
from tlismni.validation.study import OrderRow, Setting, Swing, order_cases, order_table
from tlismni.validation.study.cases import OrderCase
from tlismni.validation.study.orders import COUNTS, FLOOR, MARGIN, measure

G = 9.81


def enough(case: OrderCase) -> tuple[int, ...]:
    """Every second of the steps of the table; of an order above 8 all: soon its errors are at rounding."""
    return COUNTS if case.order is not None and case.order > 8 else COUNTS[::2]


@pytest.mark.sampled(27)
@pytest.mark.parametrize(
    "case, counts",
    [
        *(pytest.param(case, enough(case), id=case.setting.label) for case in order_cases()),
        *(
            pytest.param(case, COUNTS, id=f"{case.setting.label}, all steps", marks=pytest.mark.full)
            for case in order_cases()
            if enough(case) != COUNTS
        ),
    ],
)
def test_observed_order(case: OrderCase, counts: tuple[int, ...]) -> None:
    row = measure(case, counts, Swing())
    assert case.order is not None, "state its theory order in validation/study/cases.py"
    assert row.orders == pytest.approx(row.case.theory, abs=MARGIN)
    assert row.verdict == "agree"
    for quantity in range(3):
        window = row.window(quantity)
        assert row.steps[window][0] == pytest.approx(2.0 * row.steps[window][-1], rel=0.05), "an octave of steps"
        errors = [error[quantity] for error in row.errors[window]]
        assert all(coarse > fine for coarse, fine in pairwise(errors))


def test_every_method_has_a_case() -> None:
    assert {case.setting.method for case in order_cases()} == set(METHODS)
    labels = [case.setting.label for case in order_cases()]
    assert len(set(labels)) == len(labels)


@pytest.mark.parametrize("amplitude", [0.1, 0.5, 0.75])
def test_the_exact_solution_solves_the_equation_of_the_angle(amplitude: float) -> None:
    """Against an independent integration, and the multiplier against the radial equation of motion."""
    t = np.linspace(0.0, 6.0, 61)
    found = solve_ivp(
        lambda t, y: [y[1], -G * math.sin(y[0])], (0.0, 6.0), [amplitude, 0.0], "DOP853", t, rtol=1e-13, atol=1e-13,
        max_step=0.02,
    )  # fmt: skip
    angle, rate = found.y
    q, v, tension = Swing(amplitude).exact(t)
    assert np.abs(q - np.stack([np.cos(angle), np.sin(angle)], axis=1)).max() < 2e-11
    assert np.abs(v - rate[:, None] * np.stack([-np.sin(angle), np.cos(angle)], axis=1)).max() < 5e-11
    # r . (g - a) with a of the circular motion: what the rod has to bear
    acceleration = np.stack(
        [G * np.sin(angle) ** 2 - rate**2 * np.cos(angle), -G * np.sin(angle) * np.cos(angle) - rate**2 * np.sin(angle)]
    )
    radial = np.cos(angle) * (G - acceleration[0]) - np.sin(angle) * acceleration[1]
    assert np.abs(tension[:, 0] - radial).max() < 2e-10


def test_the_multiplier_is_the_tension_of_the_model() -> None:
    swing = Swing(t_end=1.0)
    result = simulate(swing.model(), 1.0, "ebdf", 1e-11, 1e-13)
    _, _, tension = swing.exact(result.t)
    assert np.abs(result.multipliers - tension).max() < 1e-7
    assert result["rod.tension"] == pytest.approx(tension[:, 0], abs=1e-7)


def _row(order: int | None, observed: float, noise: float = 0.0) -> OrderRow:
    """A row whose errors are h^observed + noise."""
    steps = tuple(6.0 / count for count in COUNTS)
    errors = tuple((h**observed + noise,) * 3 for h in steps)
    return OrderRow(OrderCase(Setting("hht"), order), 6.0, steps, errors)


@pytest.mark.parametrize(
    "order, observed, verdict", [(4, 4.1, "agree"), (4, 4.3, "higher"), (4, 3.7, "differ"), (None, 4.0, "open")]
)
def test_the_verdict(order: int | None, observed: float, verdict: str) -> None:
    row = _row(order, observed)
    assert row.orders == pytest.approx((observed,) * 3)
    assert row.verdict == verdict
    assert row.ok == (verdict in ("agree", "open"))


def test_errors_at_rounding_are_not_read() -> None:
    clean, noisy = _row(5, 5.0), _row(5, 5.0, noise=0.02 * FLOOR[0] * COUNTS[0])
    assert noisy.order(0) == pytest.approx(5.0, abs=0.05)
    assert noisy.window(0).stop <= clean.window(0).stop < len(COUNTS)
    drowned = _row(5, 5.0, noise=1e-3)
    assert abs(drowned.order(0) - 5.0) > 1.0 and drowned.verdict == "differ"


def test_too_few_runs_say_nothing() -> None:
    row = OrderRow(OrderCase(Setting("hht"), 2), 6.0, (0.1, 0.05), ((1e-2,) * 3, (2.5e-3,) * 3))
    assert all(math.isnan(order) for order in row.orders)
    assert row.verdict == "differ" and not row.ok


def test_a_method_without_a_line_is_measured_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(METHODS, "newcomer", METHODS["trapezoidal"])
    (row,) = order_table(["newcomer"], quick=True)
    assert row.case.setting == Setting("newcomer") and row.verdict == "open"
    assert row.orders == pytest.approx((2.0, 2.0, 2.0), abs=MARGIN)


def test_steps_that_fail_are_reported() -> None:
    """bdf of order 1 does not converge with very large steps of this swing: a finding, not a crash."""
    (case,) = (c for c in order_cases(["bdf"]) if c.setting.options["order"] == 1)
    row = measure(case, (8, *COUNTS[8:12]), Swing())
    assert len(row.failed) + len(row.steps) == 5
    assert row.failed and "do not converge" in row.failed[0]
    assert row.to_dict()["failed"] == list(row.failed)


@pytest.mark.parametrize("call", [order_cases, order_table])
def test_unknown_methods_are_refused(call: Any) -> None:
    with pytest.raises(ModelError, match="unknown method \\['nope'\\]"):
        call(["hht", "nope"])
