"""The panels of a cross-check as plotly figures. plotly is imported only when a report is written."""

import json
from typing import Any

import numpy as np

from .comparisons.common import Curve, Panel
from .plots import OURS, THEIRS

MOST_POINTS = 3000
"""Of a curve outside its window; inside all are kept, to be zoomed into."""


def plotly_library() -> str | None:
    """plotly's JavaScript to be put into a page, or None if plotly is not installed."""
    try:
        from plotly.offline import get_plotlyjs
    except ImportError:
        return None
    return str(get_plotlyjs())


def figures(panels: tuple[Panel, ...]) -> list[str]:
    """Each panel as JSON of plotly's data and layout."""
    return [json.dumps(_figure(panel)) for panel in panels]


def _figure(panel: Panel) -> dict[str, Any]:
    counts = {True: 0, False: 0}
    data = []
    for curve in sorted(panel.curves, key=lambda c: not c.ours):
        colours = OURS if curve.ours else THEIRS
        colour = colours[counts[curve.ours] % len(colours)]
        counts[curve.ours] += 1
        t, y = _thinned(curve, panel)
        if panel.logarithmic:
            y = np.where(y > 0.0, y, np.nan)
        line = {"color": colour, "width": 2.4 if curve.ours else 1.4, "dash": "solid" if curve.ours else "dash"}
        data.append(
            {
                "x": [float(f"{v:.9g}") for v in t],
                "y": [float(f"{v:.7g}") if np.isfinite(v) else None for v in y],
                "name": curve.label,
                "mode": "markers" if panel.points else "lines",
                "line": line,
                "marker": {"color": colour, "size": 3},
            }
        )
    axis: dict[str, Any] = {"title": {"text": "time (s)"}, "exponentformat": "power"}
    heights: dict[str, Any] = {"title": {"text": panel.unit}, "type": "linear", "exponentformat": "power"}
    if panel.logarithmic:
        heights |= {"type": "log"}
    if panel.window:
        axis["range"] = list(panel.window)
        if not panel.logarithmic:
            heights["range"] = _heights(panel, panel.window)
    return {
        "data": data,
        "layout": {
            "title": {"text": panel.title, "x": 0.02, "font": {"size": 14}},
            "xaxis": axis,
            "yaxis": heights,
            "legend": {"orientation": "h", "y": -0.25},
            "margin": {"l": 60, "r": 15, "t": 40, "b": 40},
            "height": 360,
            "template": "none",
        },
    }


def _heights(panel: Panel, window: tuple[float, float]) -> list[float]:
    """What the curves cover within the window, with a margin: plotly itself would take all of them."""
    inside = [np.asarray(c.y)[(c.t >= window[0]) & (c.t <= window[1])] for c in panel.curves]
    low, high = min(map(np.nanmin, inside)), max(map(np.nanmax, inside))
    margin = 0.06 * (high - low) or 1.0
    return [float(low - margin), float(high + margin)]


def _thinned(curve: Curve, panel: Panel) -> tuple[np.ndarray, np.ndarray]:
    every = max(1, len(curve.t) // MOST_POINTS)
    keep = np.zeros(len(curve.t), dtype=bool)
    keep[::every] = True
    if panel.window:
        keep |= (curve.t >= panel.window[0]) & (curve.t <= panel.window[1])
    return curve.t[keep], np.asarray(curve.y)[keep]
