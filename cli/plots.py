"""Figures of the command line, drawn without a display."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..core import Result
from ..models import Scenario
from .cosimulation import Comparison
from .result_files import replace_whole
from .summary import LEVELS

FLOOR = 1e-18
"""Smallest residual that is drawn: zero has no logarithm."""

RATES = {
    "x": "vx", "y": "vy", "angle": "angular_velocity", "gap": "gap_rate",
    "vx": "ax", "vy": "ay", "angular_velocity": "angular_acceleration",
}  # fmt: skip
POINTS = 12
"""Points drawn in a step: a high-order method's steps are long, straight lines between their ends mislead."""


def units_of(result: Result) -> dict[str, str]:
    """Units of the channels."""
    return {channel.name: channel.unit for channel in result.channel_records}


def plot_result(result: Result, scenario: Scenario, path: Path) -> Path:
    """The channels that the scenario looks at, the energies, and the residuals at three levels."""
    units = units_of(result)
    names = [name for name in scenario.compare if name in units] or list(result.channels[:4])
    figure, axes = panels(len(names) + 2)
    for axis, name in zip(axes, names, strict=False):
        axis.plot(*curve(result, name), lw=1.0)
        axis.set_ylabel(f"{name}\n{units[name]}")
    for name in ("kinetic", "potential", "strain", "impact_loss", "dissipation"):
        axes[-2].plot(result.t, result[f"energy.{name}"], ".-", ms=2.5, lw=0.6, label=name.replace("_", " "))
    axes[-2].set_ylabel("energy\nJ")
    axes[-2].legend(fontsize=7, ncols=5)
    for level, unit in LEVELS:
        axes[-1].semilogy(result.t, np.maximum(result[f"residual.{level}"], FLOOR), lw=0.8, label=f"{level} ({unit})")
    axes[-1].set_ylabel("constraint\nresiduals")
    axes[-1].legend(fontsize=7, ncols=3)
    for axis in axes[:-1]:
        mark_events(axis, [event.t for event in result.events])
    figure.suptitle(f"{scenario.name}, {scenario.method}", fontsize=10)
    return save(figure, path)


def curve(result: Result, name: str) -> tuple[np.ndarray, np.ndarray]:
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
    """A figure with `count` panels over one time axis, and the panels' axes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 1.0 + 1.6 * count), layout="constrained")
    axes = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.yaxis.label.set_fontsize(8)
    axes[-1].set_xlabel("time, s")
    return figure, axes


def mark_events(axis: Any, times: Sequence[float], most: int = 60) -> None:
    """Thin vertical lines where contacts change; none if they would fill the panel."""
    if len(times) <= most:
        for t in times:
            axis.axvline(t, color="0.7", lw=0.5, zorder=0)


def save(figure: Any, path: Path) -> Path:
    """Write a figure."""
    return replace_whole(path, lambda name: figure.savefig(name, dpi=150))


def plot_cosimulation(scenario: Scenario, found: Comparison, path: Path) -> Path:
    """The FMU's outputs over those of the uninterrupted run, and the differences of the two."""
    names = list(found.uninterrupted) or [name for name in found.fmu if name != "solver.events"][:4]
    figure, axes = panels(len(names) + 1)
    for axis, name in zip(axes, names, strict=False):
        if name in found.uninterrupted:
            axis.plot(found.times, found.uninterrupted[name], lw=1.0, color="0.6", label="uninterrupted run")
        axis.plot(found.times, found.slave[name], lw=0.8, label="slave in process")
        axis.plot(found.times, found.fmu[name], ".", ms=2.5, label="FMU under fmpy")
        axis.set_ylabel(name)
    axes[0].legend(fontsize=7, ncols=3)
    for name, values in found.uninterrupted.items():
        axes[-1].semilogy(found.times, np.maximum(np.abs(found.fmu[name] - values), FLOOR), lw=0.8, label=name)
    axes[-1].set_ylabel("difference to the\nuninterrupted run")
    if found.uninterrupted:
        axes[-1].legend(fontsize=7, ncols=2)
    verdict = "identical bit for bit" if found.identical else f"{len(found.different)} outputs differ"
    figure.suptitle(f"{scenario.name}: FMU and slave, {verdict}", fontsize=10)
    return save(figure, path)
