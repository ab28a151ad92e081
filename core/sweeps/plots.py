"""Any column of a sweep over any other."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..extras import require

if TYPE_CHECKING:
    from .sweep import Sweep

FEW, LINE = 500, 60
"""Points up to which they are drawn large, and up to which a line joins those of one sweep."""


def plot_sweep(
    sweep: "Sweep", y: str, x: str | None = None, colour: str | None = None, path: str | Path | None = None
) -> Any:
    """Column `y` over `x` (left out: the first name that was swept) as points; with `colour`, that column as colour,
    and as a map without gaps where x and y are the axes of a grid. Written to `path` if one is given.

    Returns
    -------
    The figure of matplotlib.

    Raises
    ------
    MissingExtraError : without matplotlib. KeyError : for unknown columns.
    """
    require("a plot", "plot", matplotlib="")
    from matplotlib.figure import Figure

    x = sweep.names[0] if x is None else x
    across, up = sweep[x], sweep[y]
    figure = Figure(figsize=(7.5, 5.0), layout="constrained")
    axis = figure.subplots()
    size = 9.0 if len(across) <= FEW else 1.0
    if colour is None and len(across) <= LINE and len(sweep.names) == 1:
        order = np.argsort(across)
        axis.plot(across[order], up[order], "o-", ms=4.5, lw=1.0, color="tab:blue")
    elif colour is None:
        axis.plot(across, up, ".", ms=size**0.5 * 1.5, color="0.1", alpha=1.0 if len(across) <= FEW else 0.5, mew=0)
    else:
        shade = sweep[colour].astype(float)
        columns, rows = np.unique(across), np.unique(up)
        if len(columns) * len(rows) == len(across) > 4:
            image = np.full((len(rows), len(columns)), np.nan)
            image[np.searchsorted(rows, up), np.searchsorted(columns, across)] = shade
            drawn: Any = axis.pcolormesh(columns, rows, image, shading="nearest", cmap="viridis", rasterized=True)
        else:
            drawn = axis.scatter(across, up, s=size, c=shade, cmap="viridis", linewidths=0)
        figure.colorbar(drawn, label=_titled(sweep, colour))
    axis.set(xlabel=_titled(sweep, x), ylabel=_titled(sweep, y))
    axis.grid(alpha=0.3)
    if path is not None:
        figure.savefig(path, dpi=150)
    return figure


def _titled(sweep: "Sweep", name: str) -> str:
    """A column's name with its unit."""
    unit = sweep.units.get(name, "1")
    return name if unit in ("", "1") else f"{name} ({unit})"
