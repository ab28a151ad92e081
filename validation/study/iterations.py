"""`iteration_study`: what methods need in iterations, evaluations, factorisations, and what they achieve for it."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

from ...core import ModelError
from .cases import Setting, contenders
from .claims import ORDERED, Claim, judge
from .equal_error import LEVELS, at_error
from .orders import OrderRow, order_table
from .problems import QUICK_SHARE, problems
from .reference import make_reference
from .runs import COUNTS, LOOPS, QUICK_TOLERANCES, TOLERANCES, Run, run_all

TRUSTED = 3.0
"""Errors above this many times the reference's own accuracy are compared."""


@dataclass(frozen=True)
class ProblemFigures:
    """A problem as it was run."""

    label: str
    t_end: float
    """s."""
    reference_accuracy: float
    """Difference of the two references: errors near it are not to be trusted."""

    @property
    def levels(self) -> tuple[float, ...]:
        """Errors at which methods can be compared."""
        return tuple(level for level in LEVELS if level > TRUSTED * self.reference_accuracy)


@dataclass(frozen=True)
class IterationStudy:
    """All figures of a study."""

    problems: tuple[ProblemFigures, ...]
    runs: tuple[Run, ...]
    orders: tuple[OrderRow, ...]
    claims: tuple[Claim, ...]

    def select(self, problem: str, loop: str) -> dict[Setting, list[Run]]:
        """The runs of a problem with an outer loop, by contender, from loose to tight; without those that failed."""
        found: dict[Setting, list[Run]] = {}
        for run in self.runs:
            if (run.problem, run.loop) == (problem, loop) and run.ok:
                found.setdefault(run.setting, []).append(run)
        return found

    def equal_error(self) -> list[dict[str, Any]]:
        """What each method needs to come to the errors LEVELS; left out where its runs do not enclose the level."""
        table = []
        for problem in self.problems:
            for loop in LOOPS:
                for setting, runs in self.select(problem.label, loop).items():
                    for level in problem.levels:
                        needs = {name: at_error(runs, level, name) for name in ("steps", *list(COUNTS)[2:])}
                        if None not in needs.values():
                            table.append(
                                {"problem": problem.label, "outer": loop, "label": setting.label, "error": level}
                                | needs
                            )
        return table

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "problems": [vars(problem) for problem in self.problems],
            "runs": [run.to_dict() for run in self.runs],
            "equal_error": self.equal_error(),
            "orders": [row.to_dict() for row in self.orders],
            "claims": [claim.to_dict() for claim in self.claims],
        }


def iteration_study(
    scenarios: Iterable[str] | None = None,
    methods: Iterable[str] | None = None,
    *,
    tolerances: Sequence[float] | None = None,
    quick: bool = False,
    tell: Callable[[str, float], None] | None = None,
) -> IterationStudy:
    """Run every contender on every problem with every outer loop and tolerance.

    Parameters
    ----------
    scenarios : names of scenarios; None: the three of the study.
    methods : names of methods; None: all of the core. Claims on others are left out; C3 needs hht and ebdf.
    tolerances : rtol of the runs, from loose to tight; atol is a hundredth of it.
    quick : few tolerances, short times, coarse orders.
    tell : called with what is being done, and the share that is done (0 ... 1).

    Raises
    ------
    ModelError : for an unknown method, tolerances that do not fall, or a problem with events.
    ScenarioError : for an unknown scenario.
    """
    chosen, settings = problems(scenarios), contenders(methods)
    levels = tuple(tolerances) if tolerances is not None else QUICK_TOLERANCES if quick else TOLERANCES
    if not levels or any(b >= a for a, b in pairwise(levels)):
        raise ModelError(f"tolerances must fall from loose to tight, not {list(levels)}")
    total, done = len(chosen) * (len(settings) * len(LOOPS) * len(levels) + 1) + 1, 0

    def advance(what: str) -> None:
        nonlocal done
        done += 1
        if tell is not None:
            tell(what, done / total)

    figures, runs = [], []
    for problem in chosen:
        scenario = problem.load()
        t_end = (problem.t_end or scenario.t_end) * (QUICK_SHARE if quick else 1.0)
        reference = make_reference(scenario, t_end)
        label = problem.label
        advance(label)
        figures.append(ProblemFigures(label, t_end, reference.accuracy))
        runs += run_all(scenario, label, t_end, reference, settings, levels, partial(advance, label))
    measured = {setting.method for setting in settings}
    orders = order_table([name for name in ORDERED if name in measured], quick=quick)
    advance("orders")
    return IterationStudy(tuple(figures), tuple(runs), orders, judge(runs, orders))
