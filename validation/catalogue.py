"""The cross-check of the whole catalogue: every case of every scenario, one report each and an overview."""

import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..core.elements import FlexibleBody
from ..core.errors import TlismniError
from ..models import load
from .cases import Case, cases
from .comparisons.common import Progress
from .crosscheck import CrossCheck, crosscheck
from .exchange import as_cables, has_floating_beams
from .exudyn_import import import_exudyn

FLEXIBLE = 2e-3
"""Relative tolerance with flexible bodies, whose waves both sides damp by their steps."""
TWO_MODELS = 3e-2
"""The same where our model and exudyn's are two of one thing."""
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Outcome:
    """What became of one case: a cross-check, or the reason why there is none."""

    case: Case
    found: CrossCheck | None
    reason: str
    seconds: float
    failed: bool = False

    @property
    def verdict(self) -> str:
        """ "agree", "undecided", "differ", "not comparable" or "failed"."""
        if self.found is None:
            return "failed" if self.failed else "not comparable"
        if not self.found.ok:
            return "differ"
        decisive = [row for row in self.found.rows if row.required]
        return "undecided" if any(row.verdict == "undecided" for row in decisive) else "agree"

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "scenario": self.case.scenario,
            "case": self.case.name,
            "parameters": dict(self.case.parameters),
            "verdict": self.verdict,
            "reason": self.reason,
            "why": self.case.why,
            "seconds": self.seconds,
            "crosscheck": None if self.found is None else self.found.to_dict(),
        }


@dataclass(frozen=True)
class CatalogueCheck:
    """The cross-check of several scenarios."""

    outcomes: tuple[Outcome, ...]
    report: Path | None = None

    @property
    def ok(self) -> bool:
        """True if nothing differs and nothing failed."""
        return not any(outcome.verdict in ("differ", "failed") for outcome in self.outcomes)


def run_case(
    case: Case, report_dir: Path | None = None, progress: Progress | None = None, *, coarse: bool = False
) -> CrossCheck:
    """Cross-check one case; `coarse` in the short form that tests use.

    Raises what `crosscheck` raises.
    """
    changes = dict(case.coarse) if coarse else {}
    step, t_end = changes.pop("step", case.step), changes.pop("t_end", case.t_end)
    scenario = load(case.scenario, **{**case.parameters, **changes})
    other = as_cables(scenario.model) if has_floating_beams(scenario.model) else None
    flexible = any(isinstance(b, FlexibleBody) for b in scenario.model.bodies)
    least = TWO_MODELS if other is not None else FLEXIBLE if flexible else 0.0
    return crosscheck(
        scenario, report_dir, progress, t_end=t_end, step=step, exudyn_model=other, name=case.name, why=case.why,
        least_tolerance=least, whole=case.whole and not coarse,
    )  # fmt: skip


def crosscheck_all(
    report_dir: str | Path | None = None,
    progress: Progress | None = None,
    *,
    scenarios: Sequence[str] | None = None,
    coarse: bool = False,
) -> CatalogueCheck:
    """Cross-check every case of these scenarios (all, if left out); with `report_dir` a page each and an overview.

    A case that fails does not stop the others: its outcome says why.

    Raises
    ------
    ExudynUnavailable : if exudyn cannot be used. ScenarioError : for an unknown scenario.
    """
    tell = progress or log.info
    import_exudyn()
    for name in scenarios or ():
        load(name)
    folder = None if report_dir is None else Path(report_dir)
    chosen = cases(scenarios)
    outcomes = []
    for number, case in enumerate(chosen, 1):
        label = f"[{number}/{len(chosen)}] {case.name}"
        tell(label)
        outcomes.append(_outcome(case, folder, _labelled(tell, label), coarse))
        tell(f"{label}: {outcomes[-1].verdict} ({outcomes[-1].seconds:.0f} s)")
    found = CatalogueCheck(tuple(outcomes))
    if folder is None:
        return found
    from .report import write_overview

    return CatalogueCheck(found.outcomes, write_overview(found, folder))


def _labelled(tell: Progress, label: str) -> Progress:
    return lambda text: tell(f"{label}: {text}")


def _outcome(case: Case, folder: Path | None, tell: Progress, coarse: bool) -> Outcome:
    start = time.perf_counter()
    if case.not_comparable:
        return Outcome(case, None, case.not_comparable, 0.0)
    try:
        found = run_case(case, folder, tell, coarse=coarse)
    except TlismniError as error:
        return Outcome(case, None, str(error), time.perf_counter() - start, failed=True)
    return Outcome(case, found, "", time.perf_counter() - start)
