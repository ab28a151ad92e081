"""What the matrix says about each method: medians over the scenarios, and how many it comes through."""

import math
from collections.abc import Sequence
from statistics import median
from typing import Any

from ..cases import Setting
from ..equal_error import at_error
from .equal import COSTS, Cost, cost_at, levels_of
from .records import Pair
from .runner import MethodMatrix

BASE = Setting("hht").label
"""Iterations are told in units of this method's."""
QUALITIES = ("energy_drift", "joint_force_error", "impulse_error")
"""Figures of a run that are compared at equal error of the coordinates."""
LEVELS_OF_CONSTRAINTS = ("position", "velocity", "acceleration")
UNTRUSTED = Cost(None, reason="the reference is not exact enough", kind="short")


def cost_table(matrix: MethodMatrix, level: float) -> dict[tuple[str, str], Cost]:
    """Cost of each pair at a level of error, by label and scenario."""
    found: dict[tuple[str, str], Cost] = {}
    for reference in matrix.references:
        if not reference.ok:
            continue
        trusted = level in levels_of(reference, [level])
        for label in matrix.labels:
            found[label, reference.scenario] = (
                cost_at(matrix.pair(reference.scenario, label), level) if trusted else UNTRUSTED
            )
    return found


def summary_rows(matrix: MethodMatrix) -> list[dict[str, Any]]:
    """One row a method: over all scenarios, at each level of error.

    `reached`: scenarios with a figure; `failed`, `refused`, `limit`, `short`, `broken`: those without, by kind;
    medians of each cost over the least of the scenario, and of the outer iterations over those of `BASE`,
    with the number of scenarios in which they are fewer, of those that can be compared; medians of
    `QUALITIES` at that error of the coordinates; `residuals`: the largest of all runs at the three levels; `runs` and
    `failed runs`: with any tolerance.
    """
    rows = []
    for label in matrix.labels:
        row: dict[str, Any] = {"label": label, "levels": {}}
        pairs = [matrix.pair(name, label) for name in matrix.scenarios]
        for level in matrix.sweep.levels:
            table = cost_table(matrix, level)
            row["levels"][f"{level:.0e}"] = _at_level(matrix, label, table) | {
                name: _median(_quality(pair, level, name) for pair in pairs) for name in QUALITIES
            }
        everything = [run for pair in pairs for run in pair.runs]
        row["runs"], row["failed runs"] = len(everything), sum(run.kind in ("failed", "broken") for run in everything)
        runs = [run for run in everything if run.residuals is not None]
        row["residuals"] = {
            name: max((run.residuals[k] for run in runs if run.residuals and _finite(run.residuals[k])), default=None)
            for k, name in enumerate(LEVELS_OF_CONSTRAINTS)
        }
        rows.append(row)
    return rows


def _at_level(matrix: MethodMatrix, label: str, table: dict[tuple[str, str], Cost]) -> dict[str, Any]:
    here = {name: table[label, name] for name in matrix.scenarios}
    found: dict[str, Any] = {"reached": sum(cost.values is not None for cost in here.values())}
    for kind in ("failed", "refused", "limit", "short", "broken"):
        found[kind] = sum(cost.kind == kind for cost in here.values())
    for quantity in COSTS:
        ratios = []
        for name, cost in here.items():
            all_costs = [table[other, name].values for other in matrix.labels]
            least = min((values[quantity] for values in all_costs if values), default=math.inf)
            if cost.values is not None and 0.0 < least < math.inf:
                ratios.append(cost.values[quantity] / least)
        found[quantity] = median(ratios) if ratios else None
    shares = [
        cost.values["outer_iterations"] / base.values["outer_iterations"]
        for name, cost in here.items()
        if (base := table.get((BASE, name), UNTRUSTED)).values
        and cost.values
        and not cost.at_most
        and not base.at_most
        and base.values["outer_iterations"] > 0.0
    ]
    found[f"outer iterations over {BASE}"] = _median(shares)
    found[f"fewer than {BASE}"] = (sum(share < 1.0 for share in shares), len(shares))
    return found


def _quality(pair: Pair, level: float, name: str) -> float | None:
    runs = [run for run in pair.runs if run.ok and run.error and _finite(getattr(run, name))]
    return at_error(runs, level, name)


def _finite(value: float | None) -> bool:
    return value is not None and math.isfinite(value)


def _median(values: Any) -> float | None:
    found = [value for value in values if value is not None]
    return median(found) if found else None


def reasons(matrix: MethodMatrix, level: float) -> list[tuple[str, str, str]]:
    """Scenario, method, reason of each pair without a figure at `level`; methods with the same reason together."""
    grouped: dict[tuple[str, str], list[str]] = {}
    for (label, scenario), cost in cost_table(matrix, level).items():
        if cost.values is None:
            grouped.setdefault((scenario, cost.reason), []).append(label)
    missing = [(r.scenario, "all", r.failure) for r in matrix.references if not r.ok]
    return missing + [(scenario, ", ".join(labels), reason) for (scenario, reason), labels in grouped.items()]


def best_labels(matrix: MethodMatrix, level: float, quantity: str = "cpu_time") -> dict[str, str]:
    """The cheapest method of each scenario at a level of error."""
    table = cost_table(matrix, level)
    found: dict[str, str] = {}
    for name in matrix.scenarios:
        costs: Sequence[tuple[float, str]] = [
            (cost.values[quantity], label) for label in matrix.labels if (cost := table[label, name]).values is not None
        ]
        if costs:
            found[name] = min(costs)[1]
    return found
