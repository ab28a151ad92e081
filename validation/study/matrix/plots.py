"""Heat maps of the matrix: methods by scenarios. matplotlib is imported only when a figure is drawn."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from ....core import METHODS
from ...plots import STYLE, _matplotlib
from .equal import Cost
from .runner import MethodMatrix
from .summary import cost_table

RESOLUTION = 120
MOST = 300.0
"""Ratio at which the colours end."""
SYMBOLS = {"refused": "R", "failed": "×", "limit": "L", "broken": "B", "short": "–"}
"""What stands in a cell without a figure: a sign, not only a colour."""
LEGEND = (
    "number: CPU time over the least of the column (≤: even its loosest run has that error)\n"
    "above the line TLISMNI, below it what it is compared with\n"
    "×: the run fails    R: refused    L: above the CPU limit of a run\n"
    "–: its tightest run misses the error    B: broken"
)
NO_FIGURE = "#e4e4e4"
FAILED = "#f6d5d0"


def plot_matrix(matrix: MethodMatrix, path: Path, quantity: str = "cpu_time") -> Path:
    """Cost at equal error, relative to the cheapest method of each scenario: a panel for each level of error.

    Raises TlismniError if matplotlib cannot be imported.
    """
    figure_class, context = _matplotlib()
    levels, labels, scenarios = matrix.sweep.levels, matrix.labels, matrix.scenarios
    what = "CPU time" if quantity == "cpu_time" else quantity.replace("_", " ")
    with context({**STYLE, "axes.grid": False}):
        width = max(8.5, 0.47 * len(scenarios) + 3.2)
        height = (0.28 * len(labels) + 0.9) * len(levels) + 2.3
        figure = figure_class(figsize=(width, height), layout="constrained", dpi=RESOLUTION)
        grid = figure.subplots(len(levels), 1, squeeze=False)
        image = None
        for axes, level in zip(grid[:, 0], levels, strict=True):
            image = _panel(axes, matrix, level, quantity)
        for axes in grid[:-1, 0]:
            axes.set_xticklabels([])
        bar = figure.colorbar(image, ax=list(grid[:, 0]), shrink=0.6, aspect=40, pad=0.01)
        bar.set_ticks([0.0, math.log10(3.0), 1.0, math.log10(30.0), 2.0, math.log10(MOST)], labels=_ticks())
        figure.suptitle(f"{what} for the same error, over that of the cheapest method", fontsize=11, fontweight="bold")
        figure.supxlabel(LEGEND.replace("CPU time over", f"{what} over"), fontsize=8)
        figure.savefig(path)
    return path


def _ticks() -> list[str]:
    return ["1", "3", "10", "30", "100", f"{MOST:.0f}+"]


def _panel(axes: Any, matrix: MethodMatrix, level: float, quantity: str) -> Any:
    labels, scenarios = matrix.labels, matrix.scenarios
    costs = cost_table(matrix, level)
    ratio = np.full((len(labels), len(scenarios)), np.nan)
    for j, name in enumerate(scenarios):
        column = [costs[label, name] for label in labels]
        least = min((_least(cost, quantity) for cost in column), default=math.inf)
        for i, cost in enumerate(column):
            if cost.values is not None:
                ratio[i, j] = cost.values[quantity] / least
    image = axes.imshow(np.log10(np.clip(ratio, 1.0, MOST)), cmap="viridis_r", vmin=0.0, vmax=math.log10(MOST),
                        aspect="auto")  # fmt: skip
    for i, label in enumerate(labels):
        for j, name in enumerate(scenarios):
            _write(axes, i, j, costs[label, name], ratio[i, j])
    axes.set_title(f"error {level:.0e} of the scenario's motion".replace("e-0", "e-"))
    axes.set_yticks(range(len(labels)), labels)
    axes.set_xticks(range(len(scenarios)), [name.replace("_", " ") for name in scenarios], rotation=55, ha="right",
                    rotation_mode="anchor")  # fmt: skip
    axes.set_xticks(np.arange(-0.5, len(scenarios)), minor=True)
    axes.set_yticks(np.arange(-0.5, len(labels)), minor=True)
    axes.grid(which="minor", color="white", linewidth=1.0)
    axes.tick_params(which="both", length=0)
    comparison = [METHODS[label.split()[0]].family != "TLISMNI" for label in labels]
    if any(comparison) and not all(comparison):
        # above: TLISMNI; below: what it is compared with
        axes.axhline(comparison.index(True) - 0.5, color="black", linewidth=1.6)
    for spine in axes.spines.values():
        spine.set_visible(False)
    return image


def _write(axes: Any, i: int, j: int, cost: Cost, ratio: float) -> None:
    if cost.values is None:
        colour = NO_FIGURE if cost.kind == "short" else FAILED
        axes.add_patch(_square(i, j, colour))
        axes.text(j, i, SYMBOLS.get(cost.kind, "?"), ha="center", va="center", fontsize=8, color="#222222")
        return
    text = f"{ratio:.1f}" if ratio < 9.95 else f"{ratio:.0f}"
    dark = ratio > 8.0
    axes.text(j, i, ("≤" if cost.at_most else "") + text, ha="center", va="center", fontsize=6.5,
              color="white" if dark else "#111111")  # fmt: skip


def _square(i: int, j: int, colour: str) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((j - 0.5, i - 0.5), 1.0, 1.0, facecolor=colour, edgecolor="none")


def _least(cost: Cost, quantity: str) -> float:
    return math.inf if cost.values is None else max(cost.values[quantity], 1e-12)
