"""Between the runs of a pair: its cost for an error, its error for a cost. On straight lines in log-log scale."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median
from typing import Any

from ..equal_error import at_error
from .records import MatrixRun, Pair, ReferenceFigures

COSTS = ("cpu_time", "outer_iterations", "factorizations", "evaluations", "steps")
"""Costs that can be compared. Explicit formulas have no iterations and factorise once an evaluation."""
TRUSTED = 3.0
"""Levels of error above this many times the reference's own accuracy are compared."""


@dataclass(frozen=True)
class Cost:
    """What a pair needs for a level of error."""

    values: Mapping[str, float] | None
    """By name of `COSTS`; None: there is no figure."""
    at_most: bool = False
    """True if its loosest run is better than the level: it may need less."""
    reason: str = ""
    """Why there is no figure."""
    kind: str = ""
    """Of the failure, as in `MatrixRun.kind`; "short" if all runs came to their end, but none to the level."""


def cost_at(pair: Pair, level: float) -> Cost:
    """What `pair` needs to come to the error `level`; nothing is extrapolated."""
    good = _good(pair)
    values = {name: at_error(good, level, name) for name in COSTS}
    if None not in values.values():
        return Cost({name: float(value or 0.0) for name, value in values.items()})
    if good and all((run.error or 0.0) <= level for run in good):
        return Cost({name: float(getattr(good[0], name)) for name in COSTS}, at_most=True)
    last = pair.runs[-1]
    if not last.ok:
        return Cost(None, reason=last.failure, kind=last.kind)
    best = min((run.error or math.inf for run in good), default=math.inf)
    return Cost(None, reason=f"no run comes to it: best error {best:.1e}", kind="short")


def error_at(pair: Pair, budget: float, quantity: str = "cpu_time") -> float | None:
    """The error that `pair` has reached when it has spent `budget` of `quantity`.

    None if its cheapest run is dearer. A pair whose dearest run is cheaper has that run's error.
    """
    good = sorted(_good(pair), key=lambda run: float(getattr(run, quantity)))
    affordable = [run for run in good if getattr(run, quantity) <= budget]
    if not affordable:
        return None
    best = min(run.error or 0.0 for run in affordable)
    for a, b in pairwise(good):
        low, high = float(getattr(a, quantity)), float(getattr(b, quantity))
        if low <= budget < high and low > 0.0 and a.error and b.error and b.error < a.error:
            share = math.log(budget / low) / math.log(high / low)
            return min(best, a.error * (b.error / a.error) ** share)
    return best


def levels_of(reference: ReferenceFigures, levels: Sequence[float]) -> tuple[float, ...]:
    """Those that the reference is exact enough for."""
    return tuple(level for level in levels if level > TRUSTED * reference.accuracy)


def budget_of(pairs: Sequence[Pair], level: float, quantity: str = "cpu_time") -> float | None:
    """The cost at which the methods of a scenario are compared: the median of what they need for `level`."""
    found = [cost.values[quantity] for pair in pairs if (cost := cost_at(pair, level)).values is not None]
    return median(found) if found else None


def equal_rows(
    pairs: Sequence[Pair], references: Mapping[str, ReferenceFigures], levels: Sequence[float]
) -> list[dict[str, Any]]:
    """One row a pair: cost at each level, error at the scenario's budget, and the figures of its tightest run."""
    rows = []
    for scenario in dict.fromkeys(pair.scenario for pair in pairs):
        here = [pair for pair in pairs if pair.scenario == scenario]
        trusted = levels_of(references[scenario], levels)
        budget = budget_of(here, levels[0])
        for pair in here:
            row: dict[str, Any] = {"scenario": scenario, "label": pair.setting.label, "budget": budget}
            for level in levels:
                untrusted = Cost(None, reason="the reference is not exact enough", kind="short")
                cost = cost_at(pair, level) if level in trusted else untrusted
                row |= {f"{name} at {level:.0e}": (cost.values or {}).get(name) for name in COSTS}
                row |= {f"at most at {level:.0e}": cost.at_most, f"no figure at {level:.0e}": cost.reason}
            row["error at the budget"] = None if budget is None else error_at(pair, budget)
            rows.append(row | _tightest(pair))
    return rows


def _tightest(pair: Pair) -> dict[str, Any]:
    """The run with the smallest error in full, and the first reason of failure."""
    best = min(_good(pair), key=lambda run: run.error or 0.0, default=None)
    failure = pair.failure
    found: dict[str, Any] = {"failure": failure.failure if failure else ""}
    if best is None:
        return found
    return found | {f"best run: {name}": value for name, value in best.model_dump(exclude={"failure", "kind"}).items()}


def _good(pair: Pair) -> list[MatrixRun]:
    return [run for run in pair.runs if run.ok and run.error is not None]
