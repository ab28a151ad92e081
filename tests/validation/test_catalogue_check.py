"""The catalogue against exudyn: every scenario in its coarse form, and in full behind a marker."""

import json
import random
from pathlib import Path
from typing import Any

import pytest
from tlismni.core.source_digests import core_digest
from tlismni.models import ScenarioError, load, names
from tlismni.validation import Case, cases, crosscheck, crosscheck_all, run_case
from tlismni.validation.cases import CASES
from tlismni.validation.exudyn_import import exudyn_available

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
COMPARABLE = [case for case in cases() if not case.not_comparable]
HALVES = ("split_striker", "split_wall")
"""Scenarios that are compared as the whole that they are halves of."""
FIRST = [next(case for case in COMPARABLE if case.scenario == name) for name in names() if name not in HALVES]
FLUCTUATING = ("woodpecker",)
"""Compared in full only: exudyn's limit is expensive there."""
LONG = (
    "newtons_cradle",
    "mass_on_rod",
    "rod_rod",
    "arm_stop",
    "bricard",
    "stick_slip",
    "rocking_block",
    "dropped_box",
    "spinning_sphere",
    "spatial_cradle",
    "spatial_slider_crank",
    "spatial_slider_crank_stop",
    "double_pendulum_wall",
    "impact_oscillator",
    "hub_beam_stop",
    "flexible_slider_crank_stop",
)
"""Scenarios whose coarse comparison takes four to fifteen seconds: three of them, others whenever the core changes, are
among those of which some are sampled; the rest with `-m full`. What they are made of is compared in small in the tests
of the translation."""
SOME_LONG = random.Random(core_digest()).sample(LONG, 3)


def marked(case: Case) -> Any:
    """A parameter."""
    left_out = case.scenario in LONG and case.scenario not in SOME_LONG
    return pytest.param(case, id=case.name, marks=[pytest.mark.full] if left_out else [])


WITH_THIRD_OPINION = (
    "bouncing_ball",
    "pendulum",
    "chain",
    "rod_rod",
    "heavy_top",
    "free_body",
    "tippe_top",
    "rolling_disk",
)
OF_FEW_DIGITS = ("rod_rod", "rod_wall", "mass_on_rod", "sphere_beam")
"""Scenarios whose third opinion is a series or a wave where ours and exudyn's have elements."""


def wrong(found: Any) -> list[tuple[str, float, float]]:
    return [(row.quantity, row.ours, row.exudyn) for row in found.rows if row.required and row.verdict == "differ"]


def test_every_scenario_has_a_case_that_can_be_compared_and_every_case_a_scenario() -> None:
    assert set(CASES) <= set(names())
    for case in cases():
        load(case.scenario, **case.parameters)
    assert {case.scenario for case in COMPARABLE} == set(names()) - set(HALVES)
    assert len({case.name for case in cases()}) == len(cases())


@needs_exudyn
@pytest.mark.sampled(4)
@pytest.mark.parametrize("case", [marked(c) for c in FIRST if c.scenario not in FLUCTUATING])
def test_coarse_cross_check(case: Case) -> None:
    found = run_case(case, coarse=True)
    assert found.ok, wrong(found)
    assert any(row.verdict == "agree" for row in found.rows)
    third = [row for row in found.rows if row.third is not None]
    assert third or case.scenario not in WITH_THIRD_OPINION
    for row in third:
        # a course that hardly changes is compared by its size
        scale = max(row.scale or abs(row.exudyn), 1e-3 * abs(row.exudyn))
        within = row.tolerance if case.scenario in OF_FEW_DIGITS else 1e-7
        assert row.third == pytest.approx(row.ours, abs=within * scale), row.quantity


@needs_exudyn
@pytest.mark.full
@pytest.mark.parametrize("case", COMPARABLE, ids=lambda c: c.name)
def test_full_cross_check(case: Case) -> None:
    found = run_case(case)
    assert found.ok, wrong(found)


@needs_exudyn
def test_the_overview_names_all_cases_and_links_their_pages(tmp_path: Path) -> None:
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    found = crosscheck_all(tmp_path, scenarios=["pendulum", "split_wall"], coarse=True)
    assert found.ok and found.report is not None
    assert {o.verdict for o in found.outcomes} == {"agree", "not comparable"}
    text = found.report.read_text(encoding="utf-8")
    for outcome in found.outcomes:
        if outcome.found is not None:
            assert f'href="{outcome.case.name}_crosscheck.html"' in text
            assert (tmp_path / f"{outcome.case.name}_crosscheck.html").exists()
        else:
            assert "of a mechanism, whose inputs come from the other half" in text
    numbers = json.loads((tmp_path / "overview.json").read_text(encoding="utf-8"))
    assert len(numbers["cases"]) == len(found.outcomes)
    assert numbers["machine"]["versions"]["exudyn"].startswith("1.13")


@needs_exudyn
def test_a_case_that_fails_does_not_stop_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    # the floating beam itself has no equal; without the exchange its case fails, with the nearest route
    monkeypatch.setattr("tlismni.validation.catalogue.has_floating_beams", lambda model: False)
    found = crosscheck_all(scenarios=["flexible_slider_crank_stop", "pendulum"], coarse=True)
    assert [o.verdict for o in found.outcomes] == ["failed", "agree"]
    assert "nearest route" in found.outcomes[0].reason and not found.ok
    with pytest.raises(ScenarioError, match="did you mean"):
        crosscheck_all(scenarios=["pendulm"])


@needs_exudyn
def test_rods_of_ones_own_are_said_to_need_a_scenario() -> None:
    from tlismni.validation import NotTranslatable

    with pytest.raises(NotTranslatable, match="register yours"):
        crosscheck(load("rod_wall").model, t_end=1e-4)
