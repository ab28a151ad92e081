"""Figures of a cross-check. matplotlib is imported only when a figure is drawn, without a display."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..core.errors import TlismniError
from .comparisons.common import Curve, Panel

if TYPE_CHECKING:
    from .crosscheck import CrossCheck

OURS = ("#0b3c5d", "#1d7874", "#7b2d8b", "#3f88c5", "#5a8f29", "#a35d6a")
THEIRS = ("#d1495b", "#e58b3a", "#b8b042")
RESOLUTION = 160
STYLE = {
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.5,
    "legend.frameon": False,
    "legend.fontsize": 8,
}


def save_figures(found: "CrossCheck", folder: Path) -> tuple[Path, ...]:
    """Draw the panels of a cross-check into PNG files in `folder`; returns the files.

    Raises TlismniError if matplotlib cannot be imported.
    """
    figure_class, context = _matplotlib()
    panels = found.comparison.panels
    if not panels:
        return ()
    path = folder / f"{found.name or found.scenario}_crosscheck.png"
    with context(STYLE):
        rows = (len(panels) + 1) // 2
        figure = figure_class(figsize=(10.5, 2.9 * rows), layout="constrained", dpi=RESOLUTION)
        grid = figure.subplots(rows, 2, squeeze=False)
        for axes, panel in zip(grid.flat, panels, strict=False):
            draw(axes, panel)
        for axes in list(grid.flat)[len(panels) :]:
            axes.set_visible(False)
        figure.suptitle(f"{found.scenario}: {found.comparison.kind}", fontsize=11, fontweight="bold")
        figure.savefig(path)
    return (path,)


def draw(axes: Any, panel: Panel) -> None:
    """One panel into matplotlib axes: time in s, or in ms after the first touch where that is zoomed in."""
    start, factor, label = 0.0, 1.0, "time (s)"
    if _is_zoom(panel):
        start, factor = float(panel.origin or 0.0), 1e3
        label = f"time after the first touch at {start:.6f} s (ms)"
    counts = {True: 0, False: 0}
    several = sum(not c.ours for c in panel.curves) > 1
    for curve in sorted(panel.curves, key=lambda c: not c.ours):
        colours = OURS if curve.ours else THEIRS
        colour = colours[counts[curve.ours] % len(colours)]
        counts[curve.ours] += 1
        t, y = _visible(curve, panel)
        if panel.logarithmic:
            y = np.where(y > 0.0, y, np.nan)
        axes.plot((t - start) * factor, y, color=colour, label=curve.label, **_line(curve, panel, several))
    if panel.logarithmic:
        axes.set_yscale("log")
    if panel.window:
        axes.set_xlim(*((np.array(panel.window) - start) * factor))
    if panel.points:
        low, high = axes.get_ylim()
        low = max(low, 1e-18)  # below rounding there is nothing to see
        axes.set_ylim(low, high * (high / low) ** 0.35)  # room for the legend over a cloud of points
    axes.set_title(panel.title)
    axes.set_xlabel(label)
    quantity = panel.title.split(",")[0].split(":")[0].rpartition(".")[2].replace("_", " ")
    axes.set_ylabel(panel.unit if panel.points or "|" in panel.unit else f"{quantity} ({panel.unit})")
    axes.legend(loc="upper right" if panel.points else "best", markerscale=4.0)


def _line(curve: Curve, panel: Panel, several: bool) -> dict[str, Any]:
    """How a curve is drawn. exudyn's lies dashed on ours, so that both show where they agree."""
    if panel.points:
        return {"linestyle": "none", "marker": ".", "markersize": 2.5}
    if curve.ours:
        return {"linewidth": 2.6 if several else 1.6}
    return {"linewidth": 1.1, "linestyle": "-" if several else (0, (4, 3))}


def _is_zoom(panel: Panel) -> bool:
    if panel.window is None:
        return False
    whole = max(float(c.t[-1] - c.t[0]) for c in panel.curves)
    return panel.window[1] - panel.window[0] < 0.1 * whole


def _visible(curve: Curve, panel: Panel) -> tuple[np.ndarray, np.ndarray]:
    """The part of a curve inside the window, with one sample on either side, so that the scale fits it."""
    if panel.window is None:
        return curve.t, curve.y
    first = max(int(np.searchsorted(curve.t, panel.window[0])) - 1, 0)
    last = int(np.searchsorted(curve.t, panel.window[1], side="right")) + 1
    return curve.t[first:last], curve.y[first:last]


def _matplotlib() -> tuple[Any, Any]:
    try:
        from matplotlib import rc_context
        from matplotlib.figure import Figure
    except ImportError as error:
        raise TlismniError(
            f"figures need matplotlib, which cannot be imported ({error}). Install it with: pip install 'tlismni[plot]'"
        ) from error
    return Figure, rc_context
