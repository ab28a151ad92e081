"""The method matrix: errors fall with the tolerance, constraints hold where they should, failures say why."""

import math
from pathlib import Path

import numpy as np
import pytest
from tlismni.core import ModelError
from tlismni.models import ScenarioError
from tlismni.validation.study import Setting
from tlismni.validation.study.matrix import MatrixRun, MethodMatrix, Pair, Sweep, method_matrix
from tlismni.validation.study.matrix.course import Course, event_errors, mean_difference
from tlismni.validation.study.matrix.equal import budget_of, cost_at, error_at
from tlismni.validation.study.matrix.measure import Measured
from tlismni.validation.study.matrix.problems import problem_of
from tlismni.validation.study.matrix.references import AGREE, LEAST_SHARE, _compared, make_reference
from tlismni.validation.study.matrix.summary import reasons, summary_rows
from tlismni.validation.study.matrix.tables import write_csv

SMOOTH, WITH_CONTACT = "chain", "pendulum_stop"
SWEEP = Sweep(tolerances=(1e-3, 1e-5, 1e-7), levels=(1e-3, 1e-5), limit=5.0)
ROUNDING = 1e-9
"""The inner loop's tolerance is 1e-12, relative to coordinates up to ten; accelerations have larger figures."""


@pytest.fixture(scope="module")
def matrix(tmp_path_factory: pytest.TempPathFactory) -> MethodMatrix:
    """Two scenarios, three methods."""
    records = tmp_path_factory.mktemp("matrix") / "records.jsonl"
    return method_matrix(
        [SMOOTH, WITH_CONTACT], ["hht", "ebdf", "baumgarte"], sweep=SWEEP, processes=1, records=records
    )


def test_two_families_agree_on_the_reference(matrix: MethodMatrix) -> None:
    for reference in matrix.references:
        assert reference.ok and reference.first.startswith("ebdf") and reference.second.startswith("irk")
        assert reference.accuracy < 1e-2 * min(SWEEP.levels)
        assert reference.t_end == reference.asked  # neither is chaotic
    assert [reference.events for reference in matrix.references] == [0, 3]


def test_errors_fall_with_the_tolerance(matrix: MethodMatrix) -> None:
    for pair in matrix.pairs:
        errors = [run.error for run in pair.runs]
        assert len(errors) >= 2 and all(run.ok for run in pair.runs)
        assert np.all(np.diff(errors) < 0.0) and errors[-1] < 0.02 * errors[0]
        if pair.scenario == WITH_CONTACT:
            times = [run.first_event_error for run in pair.runs]
            impulses = [run.impulse_error for run in pair.runs]
            assert times[-1] < 0.1 * times[0] and impulses[-1] < 0.1 * impulses[0]
            assert all(run.events == 3 for run in pair.runs)
        assert pair.runs[-1].joint_force_error < 0.1 * pair.runs[0].joint_force_error
        assert pair.runs[-1].energy_drift < 0.1 * pair.runs[0].energy_drift


def test_tlismni_meets_the_constraints_at_three_levels_and_baumgarte_does_not(matrix: MethodMatrix) -> None:
    for pair in matrix.pairs:
        for run in pair.runs:
            assert run.residuals is not None
            if pair.method != "baumgarte":
                assert max(run.residuals) < ROUNDING < run.tolerance
            else:
                # the violation is an error of the formula: it falls with the tolerance, and grows from level to level
                assert run.residuals[0] < run.residuals[1] < run.residuals[2]
                assert run.residuals[1] > 0.05 * run.tolerance > ROUNDING
    drift = [max(matrix.pair(SMOOTH, "baumgarte").runs[k].residuals or ()) for k in (0, 1)]
    assert drift[1] < 0.1 * drift[0]


def test_errors_fall_with_the_steps_as_the_order_says(matrix: MethodMatrix) -> None:
    """Steps that error control chooses are not equal, but their number stands for 1/h."""
    for label, order in (("hht", 2.0), ("ebdf k=4", 5.0)):
        a, b = matrix.pair(SMOOTH, label).runs[-2:]
        assert a.error and b.error
        found = math.log(a.error / b.error) / math.log(b.steps / a.steps)
        assert found == pytest.approx(order, rel=0.2)


def test_the_table_has_every_pair(matrix: MethodMatrix, tmp_path: Path) -> None:
    rows = matrix.rows()
    assert len(rows) == len(matrix.scenarios) * len(matrix.labels) == 2 * 4
    summary = {row["label"]: row for row in summary_rows(matrix)}
    assert set(summary) == {"hht", "ebdf k=4", "ebdf k=auto", "baumgarte"}
    assert all(row["levels"]["1e-05"]["cpu_time"] is None or row["levels"]["1e-05"]["cpu_time"] >= 1.0
               for row in summary.values())  # fmt: skip
    assert summary["hht"]["levels"]["1e-03"]["outer iterations over hht"] == 1.0
    lines = write_csv(matrix, tmp_path / "x.csv").read_text().splitlines()
    assert len(lines) == 1 + sum(len(pair.runs) for pair in matrix.pairs)
    assert matrix.to_dict()["rows"] == rows


def test_a_study_that_was_stopped_goes_on(tmp_path: Path) -> None:
    path, seen = tmp_path / "records.jsonl", []

    def stop_after_two(what: str, share: float) -> None:
        seen.append(what)
        if len(seen) == 2:
            raise KeyboardInterrupt

    chosen = {"scenarios": [WITH_CONTACT], "methods": ["hht", "ebdf"], "sweep": SWEEP, "processes": 1}
    with pytest.raises(KeyboardInterrupt):
        method_matrix(**chosen, records=path, tell=stop_after_two)  # type: ignore[arg-type]
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines) + '\npair {"scenario": "pend')  # the line that was being written
    told: list[str] = []
    found = method_matrix(**chosen, records=path, tell=lambda what, share: told.append(what))  # type: ignore[arg-type]
    assert len(found.pairs) == 3 and len(told) == 1
    with pytest.raises(ModelError, match="other tolerances"):
        method_matrix([WITH_CONTACT], ["hht"], sweep=Sweep(limit=1.0), processes=1, records=path)


def test_pairs_without_figures_say_why() -> None:
    reference = make_reference(problem_of(WITH_CONTACT), 20.0)
    assert reference.course is not None
    measured = Measured(problem_of(WITH_CONTACT).load(), reference.course, reference.figures.t_end)
    refused = measured.run(Setting("hht", {"alpha": 3.0}), 1e-3, 5.0)
    assert refused.kind == "refused" and refused.failure.startswith("refused: option alpha of method 'hht' must be")
    dear = measured.run(Setting("hht"), 1e-3, 1e-6)
    assert dear.kind == "limit" and "of 2.5 s" in dear.failure
    pair = measured.sweep(Setting("hht", {"alpha": 3.0}), SWEEP)
    assert len(pair.runs) == 1 and cost_at(pair, 1e-3).reason == refused.failure
    # the stop that Baumgarte's alpha = 1/h under error control never comes over
    failed = measured.run(Setting("baumgarte", {"rule": "step"}), 1e-6, 5.0)
    assert failed.kind in ("failed", "limit") and failed.failure.startswith(("failed ", "limit: "))
    figures = reference.figures.model_copy(update={"scenario": WITH_CONTACT})
    table = MethodMatrix(SWEEP, (figures,), (measured.sweep(Setting("hht", {}), Sweep((1e-1,), limit=5.0)),))
    ((scenario, label, why),) = reasons(table, 1e-3)
    assert (scenario, label) == (WITH_CONTACT, "hht") and why.startswith("no run comes to it: best error ")


def test_a_course_that_two_references_do_not_share_is_compared_up_to_where_they_part() -> None:
    t = np.linspace(0.0, 1.0, 101)
    first, late, early = (_course(t, np.where(t > at, t - at, 0.0) * 1e-3) for at in (2.0, 0.5, 0.01))
    scenario = problem_of(WITH_CONTACT).load()
    found = _compared(scenario, first, late, ["a", "b"], 1.0, 0.0)
    assert found.figures.ok and 0.45 < found.figures.t_end < 0.5 and found.figures.accuracy < AGREE
    assert found.course is not None and found.course.t[-1] <= found.figures.t_end
    none = _compared(scenario, first, early, ["a", "b"], 1.0, 0.0)
    assert not none.figures.ok and "part at t = 0.02 s" in none.figures.failure and LEAST_SHARE > 0.02


def test_forces_are_compared_stretch_by_stretch() -> None:
    """A jump of 5 N at 0.5 s and one at 0.51 s, the forces beside them 1 and 6 N: only that interval counts."""
    t = np.linspace(0.0, 1.0, 101)
    exact, shifted = (_course(np.insert(t, k, t[k]), np.zeros(102), k) for k in (50, 51))
    assert mean_difference(shifted, exact, "joints") == 0.0
    assert event_errors(shifted, exact) == pytest.approx((0.01, 0.01))
    without = _course(t, np.zeros(101))
    assert mean_difference(without, exact, "joints") is None  # another number of stretches
    assert event_errors(without, exact) == (None, None)


def test_between_runs_costs_and_errors_lie_on_lines_in_logarithmic_scale() -> None:
    # error = 1e-2 n^-2 at n steps
    runs = tuple(
        MatrixRun(tolerance=1.0 / n, steps=n, outer_iterations=2 * n, evaluations=3 * n, factorizations=n,
                  cpu_time=1e-3 * n, error=1e-2 / n**2)
        for n in (1, 10, 100)
    )  # fmt: skip
    pair = Pair(scenario="x", method="hht", options={}, runs=runs)
    values = cost_at(pair, 1e-3).values
    assert values is not None and values["steps"] == pytest.approx(math.sqrt(10.0))
    assert cost_at(pair, 1e-1).at_most and cost_at(pair, 1e-9).kind == "short"
    assert error_at(pair, 0.05) == pytest.approx(1e-2 / 50**2)
    assert error_at(pair, 1e-4) is None and error_at(pair, 9.0) == runs[-1].error
    assert budget_of([pair], 1e-3) == pytest.approx(1e-3 * math.sqrt(10.0))


def test_unknown_names_are_refused() -> None:
    with pytest.raises(ScenarioError, match="unknown scenario 'pendel'"):
        method_matrix(["pendel"])
    with pytest.raises(ModelError, match="unknown method"):
        method_matrix([SMOOTH], ["rk5"])


def _course(t: np.ndarray, q: np.ndarray, jump: int | None = None) -> Course:
    """A course of one coordinate at rest or on ramps, with a force that jumps at sample `jump`."""
    columns = [x[:, None] for x in (1.0 + 0.0 * q + q, 0.0 * q, 0.0 * q)]
    columns[0][0] += 1e-6  # it moves at all
    force = np.ones(len(t)) if jump is None else np.where(np.arange(len(t)) > jump, 6.0, 1.0)
    times = np.zeros(0) if jump is None else t[[jump]]
    names = () if jump is None else ("stop",)
    return Course(
        t, *columns, force[:, None], np.zeros((len(t), 0)), np.array([False]), times, names, (0.0, 0.0, 0.0), 0.0, 1.0,
        False,
    )  # fmt: skip
