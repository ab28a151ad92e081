"""The iteration study: its figures are those of the runs, its reference is right, its verdicts follow the figures."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import METHODS, ModelError, simulate
from tlismni.core.stage import solve_stage
from tlismni.models import ScenarioError, load, names
from tlismni.validation.study import IterationStudy, Run, Setting, contenders, iteration_study
from tlismni.validation.study.claims import EBDF, HHT, ratio_table, third_claim
from tlismni.validation.study.equal_error import at_error
from tlismni.validation.study.problems import COUNT, PREFERRED, QUICK_SHARE, problems
from tlismni.validation.study.reference import make_reference
from tlismni.validation.study.runs import LOOPS, QUICK_TOLERANCES

CHAIN = "chain (links = 5)"


@pytest.fixture(scope="module")
def study() -> IterationStudy:
    """The smallest study with all claims."""
    return iteration_study(["chain"], ["hht", "ebdf", "adams"], quick=True)


def test_every_setting_runs_with_every_loop_and_tolerance(study: IterationStudy) -> None:
    settings = contenders(["hht", "ebdf", "adams"])
    assert [run.setting for run in study.runs[:: len(LOOPS) * len(QUICK_TOLERANCES)]] == list(settings)
    assert len(study.runs) == len(settings) * len(LOOPS) * len(QUICK_TOLERANCES)
    assert all(run.ok for run in study.runs)
    assert {run.problem for run in study.runs} == {CHAIN}


def test_the_figures_are_those_of_the_run(study: IterationStudy) -> None:
    (problem,) = problems(["chain"])
    model, t_end = load("chain", links=5).model, QUICK_SHARE * problem.t_end
    assert study.problems[0].t_end == t_end
    for loop in LOOPS:
        (run,) = (r for r in study.runs if (r.setting, r.loop, r.tolerance) == (EBDF, loop, 1e-5))
        stats = simulate(model, t_end, "ebdf", 1e-5, 1e-7, k=4, outer=loop).stats
        assert run.outer_iterations == stats["outer_iterations"] > run.steps == stats["steps"]
        assert run.evaluations == stats["residual_evaluations"] and run.factorizations == stats["factorizations"]
        assert run.per_step == stats["outer_iterations"] / stats["steps"] and run.wall_time > 0.0


def test_tighter_tolerances_cost_more_and_achieve_more(study: IterationStudy) -> None:
    for loop in LOOPS:
        for runs in study.select(CHAIN, loop).values():
            assert np.all(np.diff([run.error for run in runs]) < 0.0)
            assert np.all(np.diff([run.outer_iterations for run in runs]) > 0)
            assert runs[-1].error > 10.0 * study.problems[0].reference_accuracy


def test_the_simple_loop_factorises_in_every_iteration(study: IterationStudy) -> None:
    for run in study.runs:
        if run.loop == "simple":
            assert run.factorizations == run.outer_iterations
        else:
            assert run.factorizations < run.outer_iterations


def test_the_reference_is_as_exact_as_it_says() -> None:
    """A rod on a pin against the equation of its angle: theta'' = -3 g/(2 L) cos(theta)."""
    scenario = load("pendulum_stop", stop_angle=-3.0)
    reference = make_reference(scenario, 0.8)
    t = np.linspace(0.0, 0.8, 81)
    found = solve_ivp(
        lambda t, y: [y[1], -1.5 * 9.81 * np.cos(y[0])], (0.0, 0.8), [0.0, 0.0], "DOP853", t, rtol=1e-13, atol=1e-13
    )
    angle = found.y[0]
    exact = np.stack([0.5 * np.cos(angle), 0.5 * np.sin(angle), angle], axis=1)
    assert 0.0 < reference.accuracy < 1e-8
    assert np.max(np.abs(reference.spline(t) - exact) / reference.scale) < reference.accuracy + 1e-11
    # and errors are measured against it: those of a loose run, by hand
    loose = simulate(scenario.model, 0.8, "hht", 1e-3, 1e-5)
    angles = np.interp(loose.t, t, angle)
    by_hand = np.max(np.abs(loose.q[:, 2] - angles)) / reference.scale[2]
    assert reference.error(loose) >= by_hand - 1e-4 and reference.error(loose) > 1e-4


def test_a_problem_with_an_impact_is_refused() -> None:
    with pytest.raises(ModelError, match=r"has an event at t = 0\.45"):
        iteration_study(["bouncing_ball"], ["hht"], quick=True)


def _runs(setting: Setting, errors: list[float], iterations: list[int], loop: str = "newton") -> list[Run]:
    return [
        Run("made up", setting, loop, 10.0 ** -(k + 3), steps=10, outer_iterations=n, error=error)
        for k, (error, n) in enumerate(zip(errors, iterations, strict=True))
    ]


def test_between_two_runs_the_figures_follow_a_power_law() -> None:
    runs = _runs(HHT, [1e-2, 1e-4, 1e-6], [100, 1000, 10000])
    assert at_error(runs, 1e-3) == pytest.approx(100.0 * 10.0**0.5)
    assert at_error(runs, 1e-5) == pytest.approx(1000.0 * 10.0**0.5)
    assert at_error(runs, 1e-4) == pytest.approx(1000.0)
    assert at_error(runs, 1e-6) == pytest.approx(10000.0)
    assert at_error(runs, 1e-5, "steps") == pytest.approx(10.0)


def test_nothing_is_extrapolated() -> None:
    runs = _runs(HHT, [1e-2, 1e-4], [100, 1000])
    assert at_error(runs, 1e-1) is None and at_error(runs, 9e-5) is None
    assert at_error([], 1e-3) is None
    failed = dataclasses.replace(runs[1], failure="stopped")
    assert at_error([runs[0], failed], 1e-3) is None


def test_the_last_run_that_misses_counts() -> None:
    """An error that happens to be small at a loose tolerance is luck."""
    runs = _runs(HHT, [1e-5, 1e-2, 1e-4], [50, 100, 1000])
    assert at_error(runs, 1e-3) == pytest.approx(100.0 * 10.0**0.5)


@pytest.mark.parametrize(
    "of_ebdf, verdict",
    [
        ([50, 500, 5000], "holds"),
        ([200, 2000, 20000], "does not hold"),
        ([200, 900, 4000], "holds in part"),
    ],
)
def test_the_verdict_on_the_iterations_follows_the_runs(of_ebdf: list[int], verdict: str) -> None:
    errors = [1e-2, 1e-4, 1e-6]
    runs = _runs(HHT, errors, [100, 1000, 10000]) + _runs(EBDF, errors, of_ebdf)
    claim = third_claim(runs)
    assert claim.verdict == verdict
    at_tolerance = [row for row in claim.figures["ratios"] if row["basis"] == "tolerance"]
    assert [row["ratio"] for row in at_tolerance] == pytest.approx(
        [a / b for a, b in zip([100, 1000, 10000], of_ebdf, strict=True)]
    )
    assert ("in every case from 1e-04 down" in claim.observed[0]) == (verdict == "holds in part")


def test_the_ratios_are_those_of_the_runs(study: IterationStudy) -> None:
    rows = ratio_table(study.runs)
    iterations = {(r.setting.label, r.loop, r.tolerance): r.outer_iterations for r in study.runs}
    at_tolerance = [row for row in rows if row["basis"] == "tolerance"]
    assert len(at_tolerance) == 2 * len(LOOPS) * len(QUICK_TOLERANCES)
    for row in at_tolerance:
        key = (row["outer"], row["level"])
        assert row["ratio"] == iterations[(HHT.label, *key)] / iterations[(row["label"], *key)]
    table = {(r["label"], r["outer"], r["error"]): r["outer_iterations"] for r in study.equal_error()}
    at_equal = [row for row in rows if row["basis"] == "error"]
    assert at_equal
    for row in at_equal:
        key = (row["outer"], row["level"])
        assert row["ratio"] == pytest.approx(table[(HHT.label, *key)] / table[(row["label"], *key)])


def test_the_claims(study: IterationStudy) -> None:
    first, second, third = study.claims
    assert (first.name, first.verdict) == ("C1", "holds")
    assert first.figures["stages_per_step"] == 1.0 and first.figures["highest"] < 2.2
    assert second.figures["stages_per_step"] == {"hht": 1.0, "ebdf k=4": 3.0, "bdf order=3": 1.0}
    assert "ebdf k=8" in second.figures["above_two"] and "ebdf k=1" not in second.figures["above_two"]
    assert third.name == "C3" and third.observed
    assert study.to_dict()["claims"][2]["verdict"] == third.verdict


@pytest.mark.sampled(1)
@pytest.mark.parametrize("methods, claims", [(["hht"], ["C1"]), (["bdf"], ["C2"]), (["irk"], [])])
def test_claims_on_methods_that_did_not_run_are_not_judged(methods: list[str], claims: list[str]) -> None:
    study = iteration_study(["chain"], methods, tolerances=(1e-3,), quick=True)
    assert [claim.name for claim in study.claims] == claims


def test_every_method_of_the_core_runs() -> None:
    controlled = set(METHODS) - {"moreau"}
    study = iteration_study(["chain"], controlled - {"bdf", "ebdf"}, tolerances=(1e-3,), quick=True)
    assert {run.setting.method for run in study.runs} == controlled - {"bdf", "ebdf"}
    assert all(run.ok and run.error < 0.5 for run in study.runs if run.loop == "newton")


def test_what_a_method_refuses_is_a_finding(monkeypatch: pytest.MonkeyPatch) -> None:
    """A newcomer whose stages know newton only: its other runs say why there are none."""

    def formula(options: Any) -> Any:
        return dataclasses.replace(METHODS["hht"].formula({"alpha": -0.05}), stage=solve_stage)

    newcomer = dataclasses.replace(METHODS["hht"], name="newcomer", options={}, formula=formula)
    monkeypatch.setitem(METHODS, "newcomer", newcomer)
    assert Setting("newcomer") in contenders()
    study = iteration_study(["chain"], ["newcomer"], tolerances=(1e-3,), quick=True)
    (run,) = (run for run in study.runs if run.loop == "simple")
    assert not run.ok and "knows only outer = 'newton'" in run.failure
    assert study.select(CHAIN, "simple") == {}


def test_the_problems_are_in_the_catalogue() -> None:
    chosen = problems()
    assert len(chosen) == COUNT and chosen == tuple(p for p in PREFERRED if p.scenario in names())[:COUNT]
    assert problems(["pendulum_stop"])[0].parameters == {"stop_angle": -3.0}
    assert problems(["bouncing_ball"])[0].t_end is None
    with pytest.raises(ScenarioError, match="unknown scenario 'nope'"):
        problems(["nope"])


@pytest.mark.parametrize("tolerances", [(), (1e-5, 1e-3), (1e-3, 1e-3)])
def test_tolerances_must_fall(tolerances: tuple[float, ...]) -> None:
    with pytest.raises(ModelError, match="must fall from loose to tight"):
        iteration_study(["chain"], ["hht"], tolerances=tolerances)


def test_progress_is_told(study: IterationStudy) -> None:
    told: list[tuple[str, float]] = []
    iteration_study(
        ["chain"], ["irk"], tolerances=(1e-3,), quick=True, tell=lambda what, share: told.append((what, share))
    )
    shares = [share for _, share in told]
    assert shares == sorted(shares) and shares[-1] == 1.0 and told[0][0] == CHAIN and told[-1][0] == "orders"


def test_the_figure_shows_all_settings(study: IterationStudy, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from tlismni.validation.study.plots import plot_iterations

    path = plot_iterations(study, tmp_path / "iterations.svg")
    text = path.read_text()
    assert all(setting.label in text for setting in contenders(["hht", "ebdf", "adams"]))
