"""An impact in which the sliding turns round ends what a penalty can be compared with."""

from dataclasses import replace

import pytest
from tlismni.core import Result
from tlismni.models import Scenario, load
from tlismni.validation import crosscheck
from tlismni.validation.comparisons.common import our_run
from tlismni.validation.comparisons.reversal import first_reversal
from tlismni.validation.exudyn_import import exudyn_available


def ran(name: str, t_end: float) -> tuple[Scenario, Result]:
    scenario = replace(load(name), t_end=t_end)
    return scenario, our_run(scenario)


def test_it_is_the_peck_of_the_woodpecker_and_not_the_impact_of_the_sleeve_before() -> None:
    scenario, run = ran("woodpecker", 0.1)
    found = first_reversal(scenario.model, run)
    assert found is not None and found.contact == "beak"
    (peck,) = [e for e in run.events if e.contact == "beak" and e.kind == "impact"]
    assert found.t == peck.t and any(e.kind == "impact" and e.t < peck.t for e in run.events)
    assert found.before < 0.0 < found.after
    # all friction against the sliding after it
    assert peck.friction_impulse == pytest.approx(-0.3 * peck.impulse, rel=1e-6)


def test_a_corner_that_sticks_does_not_turn_round() -> None:
    scenario, run = ran("rocking_block", 0.5)
    assert first_reversal(scenario.model, run) is None


@pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
def test_what_follows_is_not_comparable_and_says_so() -> None:
    found = crosscheck("woodpecker", t_end=0.085, step=1e-4)
    impulse = next(row for row in found.rows if row.quantity.startswith("beak: impulse"))
    assert impulse.verdict == "not comparable" and "turns round" in impulse.reason
    assert impulse.third == pytest.approx(impulse.ours, rel=1e-7)
