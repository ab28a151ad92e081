"""The method matrix survives what happens to its runs: solutions that blow up, processes that die, torn records."""

import json
import math
import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from tlismni.validation.study import Setting
from tlismni.validation.study.equal_error import at_error
from tlismni.validation.study.matrix import (
    MatrixRun,
    MethodMatrix,
    Pair,
    ReferenceFigures,
    Sweep,
    jobs,
    method_matrix,
    runner,
)
from tlismni.validation.study.matrix.equal import budget_of, cost_at, error_at
from tlismni.validation.study.matrix.jobs import Done, Job, died, do, wall_limit
from tlismni.validation.study.matrix.summary import reasons, summary_rows
from tlismni.validation.study.runs import Run

SWEEP = Sweep((1e-2, 1e-4, 1e-6), (1e-3,), 5.0)
LEVEL = 1e-3


def _run(error: float | None, n: int = 1, **more: object) -> MatrixRun:
    return MatrixRun(tolerance=1.0 / n, steps=n, outer_iterations=n, evaluations=n, factorizations=n, cpu_time=1e-3 * n,
                     error=error, **more)  # type: ignore[arg-type]  # fmt: skip


def _pair(*errors: float, scenario: str = "chain", method: str = "hht") -> Pair:
    runs = tuple(_run(error, 10**k) for k, error in enumerate(errors))
    return Pair(scenario=scenario, method=method, options={}, runs=runs)


@pytest.mark.parametrize("error", [math.inf, -math.inf, math.nan])
def test_a_run_without_a_finite_error_has_failed(error: float) -> None:
    run = _run(error, 7, energy_drift=math.nan, residuals=(math.nan, 0.0, 0.0))
    assert not run.ok and (run.kind, run.failure, run.error) == ("failed", "blew up", None)
    assert run.steps == 7 and run.energy_drift is None and run.residuals is None
    # the same out of a file, also of one that was written before this rule
    text = run.model_dump_json().replace('"error":null', '"error":Infinity').replace('"blew up"', '""')
    assert MatrixRun.model_validate_json(text.replace('"failed"', '""')) == run
    assert MatrixRun.model_validate_json(run.model_dump_json()) == run


@pytest.mark.parametrize("bad", [math.inf, math.nan])
def test_a_run_that_blew_up_spoils_no_figure(bad: float) -> None:
    blown, good, never = _pair(bad, 1e-6), _pair(1e-2, 1e-4), _pair(bad, bad, method="trapezoidal")
    cost = cost_at(blown, LEVEL)
    # its other run is better than the level: what it needs is at most that run's cost, not a mean with the infinite
    assert cost.at_most and cost.values is not None and cost.values["steps"] == 10.0
    assert cost_at(never, LEVEL).values is None
    assert (cost_at(never, LEVEL).kind, cost_at(never, LEVEL).reason) == ("failed", "blew up")
    # a run that blows up between two others is no point of their line
    line = cost_at(_pair(1e-2, bad, 1e-4), LEVEL).values
    assert line is not None and line["steps"] == pytest.approx(10.0)
    budget = budget_of([blown, good, never], LEVEL)
    assert budget is not None and budget == pytest.approx(0.5 * (1e-2 + 1e-3 * math.sqrt(10.0)))
    assert error_at(never, budget) is None


def test_the_summary_counts_a_run_that_blew_up_as_failed() -> None:
    reference = ReferenceFigures(scenario="chain", accuracy=1e-9)
    matrix = MethodMatrix(SWEEP, (reference,), (_pair(1e-2, 1e-4), _pair(math.inf, math.nan, method="trapezoidal")))
    rows = {row["label"]: row for row in summary_rows(matrix)}
    at = rows["trapezoidal"]["levels"]["1e-03"]
    assert (at["reached"], at["failed"], rows["trapezoidal"]["failed runs"]) == (0, 1, 2)
    assert rows["hht"]["levels"]["1e-03"]["cpu_time"] == 1.0  # the least of the scenario, not NaN
    assert reasons(matrix, LEVEL) == [("chain", "trapezoidal", "blew up")]


def test_between_runs_of_any_study_only_finite_errors_count() -> None:
    runs = [
        Run("x", Setting("hht"), "newton", 1.0 / n, outer_iterations=n, error=error)
        for n, error in ((1, 1e-2), (10, math.inf), (50, math.nan), (100, 1e-4))
    ]
    assert at_error(runs, LEVEL) == pytest.approx(10.0)
    assert at_error(runs[1:], LEVEL) is None


def fake(job: Job, tell: Callable[[str], None]) -> Done:
    """What the processes of these tests do: two jobs end their process as a crash and the want of memory would."""
    if job.setting is None:
        if job.scenario == "cable_ground":
            os._exit(3)
        return ReferenceFigures(scenario=job.scenario, accuracy=1e-9)
    if (job.scenario, job.setting.method) == ("chain", "newmark"):
        os.kill(os.getpid(), signal.SIGKILL)
    return _pair(1e-2, 1e-4, scenario=job.scenario, method=job.setting.method)


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_a_process_that_dies_takes_its_own_pair_only_and_is_not_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "do", fake)
    records, shares = tmp_path / "records.jsonl", []
    chosen = (["chain", "cable_ground", "pendulum_stop"], ["hht", "newmark"])
    found = method_matrix(
        *chosen, sweep=SWEEP, processes=2, records=records, tell=lambda what, share: shares.append(share)
    )
    assert found.scenarios == ("chain", "pendulum_stop") and len(found.pairs) == 4
    assert found.references[1].failure == "broken: its process ended with exit code 3"
    (dead,) = found.pair("chain", "newmark").runs
    assert dead.kind == "broken" and "ended by SIGKILL, maybe for want of memory" in dead.failure
    assert all(run.ok for pair in found.pairs if pair != found.pair("chain", "newmark") for run in pair.runs)
    assert shares == sorted(shares) and shares[-1] == 1.0
    why = reasons(found, LEVEL)
    assert ("chain", "newmark", dead.failure) in why and ("cable_ground", "all", found.references[1].failure) in why

    def nothing(job: Job, tell: object = None) -> Done:
        raise AssertionError(job)

    before = records.read_text()
    monkeypatch.setattr(runner, "do", nothing)
    for processes in (1, 2):
        again = method_matrix(*chosen, sweep=SWEEP, processes=processes, records=records)
        assert (again.references, again.pairs) == (found.references, found.pairs)
    assert records.read_text() == before


def test_how_a_process_ended_is_told() -> None:
    job = Job("chain", SWEEP, "", Setting("hht", {"alpha": -0.1}))
    reasons = [found.runs[0].failure for code in (-11, 1, None) if isinstance(found := died(job, code, 9.0), Pair)]
    assert [text.removeprefix("broken: its process ") for text in reasons] == [
        "was ended by SIGSEGV", "ended with exit code 1", "was ended after 9 s"
    ]  # fmt: skip
    pair = died(job, 1, 9.0)
    assert isinstance(pair, Pair) and pair.setting == job.setting and pair.runs[0].kind == "broken"
    assert wall_limit(SWEEP) > SWEEP.limit * (len(SWEEP.tolerances) + 1)


def test_whatever_a_reference_raises_is_the_reason_of_its_scenario(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise MemoryError("no room. Buy some")

    monkeypatch.setattr(jobs, "make_reference", fail)
    found = method_matrix(["chain"], ["hht"], sweep=SWEEP, processes=1)
    assert found.scenarios == () and found.pairs == ()
    assert found.references[0].failure == "broken: MemoryError: no room"
    # a pair whose reference is not where it was left
    pair = do(Job("chain", SWEEP, str(tmp_path / "gone"), Setting("hht")))
    assert isinstance(pair, Pair) and pair.runs[0].failure.startswith("broken: FileNotFoundError")


def test_records_go_on_after_a_torn_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "do", lambda job: fake(job, str))
    path = tmp_path / "records.jsonl"
    method_matrix(["pendulum_stop"], ["hht"], sweep=SWEEP, processes=1, records=path)
    # stopped in the middle of a line, and of a character
    path.write_bytes(path.read_bytes() + b'pair {"scenario":"pendulum_stop","method":"\xc3')
    more = method_matrix(["pendulum_stop"], ["hht", "newmark"], sweep=SWEEP, processes=1, records=path)
    lines = path.read_bytes().split(b"\n")
    assert len(lines) == 6 and lines[-1] == b"" and lines[3].endswith(b"\xc3")
    assert json.loads(lines[4].removeprefix(b"pair "))["method"] == "newmark"

    def nothing(job: Job) -> Done:
        raise AssertionError(job)

    monkeypatch.setattr(runner, "do", nothing)
    again = method_matrix(["pendulum_stop"], ["hht", "newmark"], sweep=SWEEP, processes=1, records=path)
    assert again.pairs == more.pairs and len(again.pairs) == 2
