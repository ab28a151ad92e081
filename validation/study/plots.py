"""Figures of the method study. matplotlib is imported only when a figure is drawn, without a display."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..plots import STYLE, _matplotlib
from .claims import EBDF, HHT
from .iterations import IterationStudy
from .orders import QUANTITIES, OrderRow
from .runs import LOOPS

RESOLUTION = 110
COLOURS = {
    "hht": "#d1495b", "newmark": "#e79aa3", "trapezoidal": "#b58463", "park": "#8a8d91", "bdf": "#5a8f29",
    "ebdf": "#0b3c5d", "mebdf": "#3f88c5", "adams": "#7b2d8b", "irk": "#e58b3a", "hht_i3": "#b8b042",
    "hht_ggl": "#1d7874", "generalized_alpha": "#a35d6a", "baumgarte": "#444444", "projection": "#777777",
}  # fmt: skip
OTHER = ("#17becf", "#bcbd22", "#8c564b", "#e377c2")
"""For methods without a colour of their own."""
DASHES = ("-", (0, (4, 2)), (0, (1, 1.5)), (0, (6, 2, 1, 2)))
MARKERS = ("o", "s", "^", "D")
"""For the settings of one method, in turn."""
LOOP_TITLES = {"newton": "Newton's outer loop", "simple": "simple iteration"}


def plot_iterations(study: IterationStudy, path: Path) -> Path:
    """Outer iterations against achieved error: one panel a problem and outer loop.

    Raises TlismniError if matplotlib cannot be imported.
    """
    figure_class, context = _matplotlib()
    with context(STYLE):
        columns = len(study.problems)
        figure = figure_class(figsize=(4.3 * columns + 0.6, 8.6), layout="constrained", dpi=RESOLUTION)
        grid = figure.subplots(len(LOOPS), columns, squeeze=False, sharex="col", sharey="col")
        settings = list(dict.fromkeys(run.setting.label for run in study.runs))
        styles = _styles([run.setting for run in study.runs])
        lines: dict[str, Any] = {}
        for row, loop in enumerate(LOOPS):
            for axes, problem in zip(grid[row], study.problems, strict=True):
                for setting, runs in study.select(problem.label, loop).items():
                    (line,) = axes.loglog(
                        [run.error for run in runs],
                        [run.outer_iterations for run in runs],
                        **styles[setting.label],
                        zorder=3 if setting in (HHT, EBDF) else 2,
                    )
                    lines.setdefault(setting.label, line)
                axes.set_title(f"{problem.label}, {LOOP_TITLES[loop]}")
                if row == len(LOOPS) - 1:
                    axes.set_xlabel("achieved error, relative to half the range (smaller to the right)")
        for axes in grid[:, 0]:
            axes.set_ylabel("outer iterations of the whole run")
        for axes in grid[0]:
            axes.invert_xaxis()  # once for the column: its panels share the axis
        labels = [label for label in settings if label in lines]
        figure.legend([lines[label] for label in labels], labels, loc="outside lower center", ncols=min(7, len(labels)))
        figure.suptitle(
            "Outer iterations against achieved error; each point is a tolerance", fontsize=11, fontweight="bold"
        )
        figure.savefig(path)
    return path


def plot_orders(rows: Sequence[OrderRow], path: Path) -> Path:
    """Errors of positions (filled) and multipliers (open) against the step: one panel a method.

    Raises TlismniError if matplotlib cannot be imported.
    """
    figure_class, context = _matplotlib()
    methods = list(dict.fromkeys(row.case.setting.method for row in rows))
    columns = min(3, len(methods))
    lines = math.ceil(len(methods) / columns)
    with context(STYLE):
        from matplotlib import colormaps

        figure = figure_class(figsize=(4.2 * columns, 3.3 * lines + 0.4), layout="constrained", dpi=RESOLUTION)
        grid = figure.subplots(lines, columns, squeeze=False, sharex=True, sharey=True)
        for axes, method in zip(grid.flat, methods, strict=False):
            cases = [row for row in rows if row.case.setting.method == method]
            for k, row in enumerate(cases):
                colour = colormaps["viridis"](0.9 * k / max(len(cases) - 1, 1))
                for quantity, style in ((0, {"marker": "."}), (2, {"marker": "o", "mfc": "none", "ms": 2.5})):
                    stop = row.window(quantity).stop
                    axes.loglog(
                        row.steps[:stop],
                        [error[quantity] for error in row.errors[:stop]],
                        linewidth=0.8,
                        color=colour,
                        label=_order_label(row) if quantity == 0 else None,
                        **style,
                    )
            axes.set_title(method)
            axes.legend(fontsize=6.5, loc="lower right", handlelength=1.0, labelspacing=0.25)
        for axes in list(grid.flat)[len(methods) :]:
            axes.set_visible(False)
        for axes in grid[:, 0]:
            axes.set_ylabel("error (m; open: N)")
        for k, axes in enumerate(list(grid.flat)[: len(methods)]):
            if k + columns >= len(methods):
                axes.set_xlabel("step (s)")
                axes.tick_params(labelbottom=True)
        figure.suptitle(
            f"Errors of {QUANTITIES[0]} and {QUANTITIES[2]} down to rounding; observed order in brackets",
            fontsize=11,
            fontweight="bold",
        )
        figure.savefig(path)
    return path


def _order_label(row: OrderRow) -> str:
    options = row.case.setting.label.removeprefix(row.case.setting.method).strip()
    return f"{options or 'defaults'} ({row.order(0):.1f})"


def _styles(settings: Sequence[Any]) -> dict[str, dict[str, Any]]:
    """Colour by method, dashes and marker by setting; the pair that the claim compares stands out."""
    found: dict[str, dict[str, Any]] = {}
    seen: dict[str, int] = {}
    for setting in settings:
        if setting.label in found:
            continue
        turn = seen.get(setting.method, 0)
        seen[setting.method] = turn + 1
        colour = COLOURS.get(setting.method) or OTHER[list(seen).index(setting.method) % len(OTHER)]
        found[setting.label] = {
            "color": colour,
            "linestyle": DASHES[turn % len(DASHES)],
            "marker": MARKERS[turn % len(MARKERS)],
            "markersize": 4.5 if setting in (HHT, EBDF) else 3.0,
            "linewidth": 2.6 if setting in (HHT, EBDF) else 1.1,
            "label": setting.label,
        }
    return found
