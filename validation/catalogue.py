"""The cross-check of the whole catalogue: every case of every scenario, one report each and an overview."""

import logging
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..core.errors import TlismniError
from ..models import load
from .cases import Case, cases
from .comparisons.common import Progress
from .crosscheck import CrossCheck, crosscheck
from .exchange import as_cables, has_floating_beams
from .exudyn_import import import_exudyn
from .workers import Tell, Workers

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Outcome:
    """What became of one case: a cross-check, or the reason why there is none."""

    case: Case
    found: CrossCheck | None
    reason: str
    seconds: float
    """By the clock, reports included."""
    failed: bool = False
    cpu_seconds: float = 0.0
    """Of the processor, user and system: what does not depend on what else the machine does."""

    @property
    def verdict(self) -> str:
        """ "agree", "undecided", "differ", "not comparable" or "failed"."""
        if self.found is None:
            return "failed" if self.failed else "not comparable"
        if not self.found.ok:
            return "differ"
        decisive = {row.verdict for row in self.found.rows if row.required}
        if "undecided" in decisive:
            return "undecided"
        return "agree" if "agree" in decisive else "not comparable"

    @property
    def doubt(self) -> str:
        """Why there is no cross-check, or why it decides nothing: of the quantity farthest from its tolerance."""
        if self.reason or self.found is None or self.verdict not in ("undecided", "not comparable"):
            return self.reason
        undecided = [row for row in self.found.rows if row.required and row.why]
        undecided.sort(key=lambda row: -row.difference / row.allowed if row.allowed > 0.0 else 0.0)
        told = [f"{row.quantity}: {row.why}" for row in undecided]
        more = f" (and {len(told) - 1} more)" if len(told) > 1 else ""
        return f"{told[0]}{more}" if told else ""

    @property
    def remark(self) -> str:
        """The doubt, if there is one, else what the case is for."""
        return self.doubt or self.case.why

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "scenario": self.case.scenario,
            "case": self.case.name,
            "parameters": dict(self.case.parameters),
            "verdict": self.verdict,
            "reason": self.doubt,
            "why": self.case.why,
            "seconds": round(self.seconds, 2),
            "cpu_seconds": round(self.cpu_seconds, 2),
            "crosscheck": None if self.found is None else self.found.to_dict(),
        }


@dataclass(frozen=True)
class CatalogueCheck:
    """The cross-check of several scenarios.

    Attributes
    ----------
    outcomes : of the cases that are done, in the catalogue's order.
    planned : number of cases; more than the outcomes while it runs, or if it was interrupted.
    seconds : by the clock. workers : processes at once. coarse : in the short form.
    """

    outcomes: tuple[Outcome, ...]
    report: Path | None = None
    planned: int = 0
    seconds: float = 0.0
    workers: int = 1
    coarse: bool = False

    @property
    def ok(self) -> bool:
        """True if nothing differs and nothing failed."""
        return not any(outcome.verdict in ("differ", "failed") for outcome in self.outcomes)

    @property
    def cpu_seconds(self) -> float:
        """Of the processor, of all cases."""
        return sum(outcome.cpu_seconds for outcome in self.outcomes)

    def to_dict(self) -> dict[str, Any]:
        """Plain data, without the outcomes."""
        return {
            "coarse": self.coarse,
            "planned": self.planned,
            "done": len(self.outcomes),
            "verdicts": dict(Counter(outcome.verdict for outcome in self.outcomes)),
            "seconds": round(self.seconds, 1),
            "cpu_seconds": round(self.cpu_seconds, 1),
            "workers": self.workers,
        }


def run_case(
    case: Case, report_dir: Path | None = None, progress: Progress | None = None, *, coarse: bool = False
) -> CrossCheck:
    """Cross-check one case; `coarse` in the short form that tests use.

    Raises what `crosscheck` raises.
    """
    changes = dict(case.coarse) if coarse else {}
    step, t_end = changes.pop("step", case.step), changes.pop("t_end", case.t_end)
    tolerance = changes.pop("tolerance", case.tolerance)
    scenario = load(case.scenario, **{**case.parameters, **changes})
    if case.accuracy is not None:
        scenario = replace(scenario, rtol=case.accuracy[0], atol=case.accuracy[1])
    other = as_cables(scenario.model, case.cables) if has_floating_beams(scenario.model) else None
    return crosscheck(
        scenario, report_dir, progress, t_end=t_end, step=step, exudyn_model=other, name=case.name, why=case.why,
        least_tolerance=tolerance, whole=case.whole and not coarse, refine=not coarse,
    )  # fmt: skip


def crosscheck_all(
    report_dir: str | Path | None = None,
    progress: Progress | None = None,
    *,
    scenarios: Sequence[str] | None = None,
    coarse: bool = False,
    workers: int = 1,
) -> CatalogueCheck:
    """Cross-check every case of these scenarios (all, if left out); with `report_dir` a page each and an overview.

    A case that fails does not stop the others: its outcome says why. The overview is written after every case, so
    that an interruption leaves what is done.

    Parameters
    ----------
    workers : processes at once, each for one case. With 1 all run in this process, where a crash of exudyn would end
        it; a script that asks for more must keep its own work below `if __name__ == "__main__"`.

    Returns
    -------
    CatalogueCheck, whose cross-checks hold their rows, but neither trajectories nor figures.

    Raises
    ------
    ExudynUnavailable : if exudyn cannot be used. ScenarioError : for an unknown scenario. ValueError : for less than
    one worker. OSError : if `report_dir` cannot be made.
    """
    if workers < 1:
        raise ValueError(f"workers = {workers}, but at least one process is needed")
    tell = progress or log.info
    import_exudyn()
    for name in scenarios or ():
        load(name)
    folder = None if report_dir is None else Path(report_dir)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    chosen, start = cases(scenarios), time.perf_counter()
    done: dict[str, Outcome] = {}
    found = CatalogueCheck((), None, len(chosen), 0.0, workers, coarse)
    for outcome in _outcomes(chosen, folder, tell, coarse, workers):
        done[outcome.case.name] = outcome
        tell(
            f"[{len(done)}/{len(chosen)}, {time.perf_counter() - start:.0f} s] {outcome.case.name}: "
            f"{outcome.verdict} ({outcome.seconds:.0f} s)"
        )
        ordered = tuple(done[case.name] for case in chosen if case.name in done)
        found = replace(found, outcomes=ordered, seconds=time.perf_counter() - start)
        if folder is not None:
            from .report import write_overview

            found = replace(found, report=write_overview(found, folder))
    return found


@dataclass(frozen=True)
class _Order:
    """What a process is to do."""

    case: Case
    folder: Path | None
    coarse: bool


def _outcomes(chosen: Sequence[Case], folder: Path | None, tell: Tell, coarse: bool, workers: int) -> Iterator[Outcome]:
    """As they come, the long ones first: the last to end should not be one that has just begun."""
    orders = [_Order(case, folder, coarse) for case in sorted(chosen, key=lambda c: -c.seconds)]
    if workers == 1:
        for order in orders:
            yield _outcome(order, lambda text, name=order.case.name: tell(f"{name}: {text}"))  # type: ignore[misc]
        return
    pool: Workers[_Order, Outcome] = Workers(_outcome, workers, _died)
    for _, outcome in pool.run(orders, lambda order, text: tell(f"{order.case.name}: {text}")):
        yield outcome


def _outcome(order: _Order, tell: Tell) -> Outcome:
    case, start, cpu = order.case, time.perf_counter(), time.process_time()
    if case.not_comparable:
        return Outcome(case, None, case.not_comparable, 0.0)
    found, reason = None, ""
    try:
        found = _light(run_case(case, order.folder, tell, coarse=order.coarse))
    except TlismniError as error:
        reason = str(error)
    except Exception as error:  # whatever breaks a case must not stop the others
        log.exception("case %s", case.name)
        reason = f"{type(error).__name__}: {error}"
    seconds, used = time.perf_counter() - start, time.process_time() - cpu
    return Outcome(case, found, reason, seconds, found is None, used)


def _light(found: CrossCheck) -> CrossCheck:
    """Without trajectories (they are in the report, and would fill the memory), fit to be sent between processes."""
    comparison = replace(found.comparison, panels=(), events=(), result=None)
    plain = {"parameters": dict(found.parameters), "settings": dict(found.settings)}
    return replace(found, model=None, comparison=comparison, **plain)  # type: ignore[arg-type]


def _died(order: _Order, code: int | None, seconds: float) -> Outcome:
    what = "took too long and was stopped" if code is None else f"ended with exit code {code}: a crash, most likely"
    reason = f"its process {what}. Run it alone to see more: tlismni crosscheck {order.case.scenario}"
    return Outcome(order.case, None, reason, seconds, failed=True)
