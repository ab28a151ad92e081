"""Channels, energies and phase portraits as figures of matplotlib."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from ..extras import require
from .tables import units
from .text import name_of

if TYPE_CHECKING:
    from .result import Result

RATES = {
    "x": "vx", "y": "vy", "angle": "angular_velocity", "gap": "gap_rate",
    "vx": "ax", "vy": "ay", "angular_velocity": "angular_acceleration",
}  # fmt: skip
POINTS = 12
"""Points drawn in a step: a high-order method's steps are long, straight lines between their ends mislead."""
LEDGER = ("kinetic", "potential", "strain", "dissipation", "impact_loss", "input_work")
MOST_EVENTS = 60

Floats = NDArray[np.float64]


def curve(result: "Result", name: str) -> tuple[Floats, Floats]:
    """Times and values of a channel, cubic between samples where its rate is recorded too."""
    owner, _, quantity = name.rpartition(".")
    t, y = result.t, result[name]
    rate = f"{owner}.{RATES.get(quantity, '')}"
    if rate not in result.channels or len(t) < 2:
        return t, y
    s = np.linspace(0.0, 1.0, POINTS)
    # impacts have two samples at one time: an interval of length zero draws the jump
    h = np.diff(t)[:, None]
    a, b, da, db = y[:-1, None], y[1:, None], h * result[rate][:-1, None], h * result[rate][1:, None]
    values = (2 * s**3 - 3 * s**2 + 1) * a + (s**3 - 2 * s**2 + s) * da + (3 * s**2 - 2 * s**3) * b + (s**3 - s**2) * db
    return (t[:-1, None] + h * s).ravel(), values.ravel()


def panels(count: int) -> tuple[Any, Any]:
    """A figure with `count` panels over one time axis, and the panels' axes.

    Raises
    ------
    MissingExtraError : without matplotlib.
    """
    require("a plot", "plot", matplotlib="")
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 1.0 + 1.6 * count), layout="constrained")
    axes = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.yaxis.label.set_fontsize(8)
    axes[-1].set_xlabel("time, s")
    return figure, axes


def mark_events(axis: Any, times: Sequence[float], most: int = MOST_EVENTS) -> None:
    """Thin vertical lines where contacts change; none if they would fill the panel."""
    if len(times) <= most:
        for t in times:
            axis.axvline(t, color="0.7", lw=0.5, zorder=0)


def written(figure: Any, path: str | Path | None) -> Any:
    """The figure, which is written to `path` (.png, .pdf, .svg ...) if there is one."""
    if path is not None:
        figure.savefig(path, dpi=150)
    return figure


def plot_channels(result: "Result", names: Sequence[str]) -> Any:
    """A figure with a panel a channel, events as thin lines.

    Raises
    ------
    ModelError : without names. KeyError : for an unknown channel. MissingExtraError : without matplotlib.
    """
    if not names:
        raise ModelError("name the channels to plot, as in result.plot('body.x', 'body.vx'); `result.channels` has all")
    curves = [curve(result, name) for name in names]
    figure, axes = panels(len(names))
    known = units(result)
    for axis, name, (t, y) in zip(axes, names, curves, strict=True):
        axis.plot(t, y, lw=1.0)
        axis.set_ylabel(f"{name}\n{known[name]}")
        mark_events(axis, [event.t for event in result.events])
    figure.suptitle(name_of(result), fontsize=10)
    return figure


def plot_phase(result: "Result", x: str, y: str) -> Any:
    """A figure with channel `y` over channel `x`; a dot where it starts.

    Raises
    ------
    KeyError : for an unknown channel. MissingExtraError : without matplotlib.
    """
    # both on the points of both: a channel without a rate has only its samples
    (tx, px), (ty, py) = curve(result, x), curve(result, y)
    if len(tx) != len(ty):
        px, py = result[x], result[y]
    require("a plot", "plot", matplotlib="")
    from matplotlib.figure import Figure

    figure, known = Figure(figsize=(6.0, 5.0), layout="constrained"), units(result)
    axis = figure.subplots()
    axis.plot(px, py, lw=0.9)
    axis.plot(px[:1], py[:1], "o", ms=5)
    axis.set_xlabel(f"{x}, {known[x]}")
    axis.set_ylabel(f"{y}, {known[y]}")
    axis.grid(alpha=0.3)
    axis.set_title(name_of(result), fontsize=10)
    return figure


def plot_energy(result: "Result") -> Any:
    """A figure of where the energy is and goes: stored, put in, taken; below, what does not add up.

    Raises
    ------
    ModelError : for a result without energies. MissingExtraError : without matplotlib.
    """
    if "energy.balance" not in result.channels:
        raise ModelError("this result has no energies")
    figure, axes = panels(2)
    for name in LEDGER:
        values = result[f"energy.{name}"]
        if np.any(values != 0.0):
            axes[0].plot(result.t, values, lw=1.0, label=name.replace("_", " "))
    axes[0].set_ylabel("energy\nJ")
    axes[0].legend(fontsize=7, ncols=3)
    axes[1].plot(result.t, result["energy.balance"], lw=0.9)
    axes[1].set_ylabel("balance\nJ")
    for axis in axes:
        mark_events(axis, [event.t for event in result.events])
    figure.suptitle(name_of(result), fontsize=10)
    return figure
