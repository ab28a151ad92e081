"""Figures of the command line, drawn without a display."""

from pathlib import Path
from typing import Any

import numpy as np

from ..core import Result
from ..core.results.plots import curve, mark_events, panels
from ..models import Scenario
from .cosimulation import Comparison
from .result_files import replace_whole
from .summary import LEVELS

FLOOR = 1e-18
"""Smallest residual that is drawn: zero has no logarithm."""


def units_of(result: Result) -> dict[str, str]:
    """Units of the channels."""
    return {channel.name: channel.unit for channel in result.channel_records}


def plot_result(result: Result, scenario: Scenario, path: Path, channels: list[str] | None = None) -> Path:
    """The `channels`, or those that the scenario looks at, the energies, and the residuals at three levels."""
    units = units_of(result)
    names = channels or [name for name in scenario.compare if name in units] or list(result.channels[:4])
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
        axis.set_ylabel(f"{name}\n{found.units[name]}" if name in found.units else name)
    axes[0].legend(fontsize=7, ncols=3)
    for name, values in found.uninterrupted.items():
        axes[-1].semilogy(found.times, np.maximum(np.abs(found.fmu[name] - values), FLOOR), lw=0.8, label=name)
    axes[-1].set_ylabel("difference to the\nuninterrupted run")
    if found.uninterrupted:
        axes[-1].legend(fontsize=7, ncols=2)
    verdict = "identical bit for bit" if found.identical else f"{len(found.different)} outputs differ"
    figure.suptitle(f"{scenario.name}: FMU and slave, {verdict}", fontsize=10)
    return save(figure, path)
