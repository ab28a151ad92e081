"""Figure of the contact study: the first contact of `pendulum_stop`, with the velocity jump and without."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...core import SimulationError
from ..plots import STYLE, _matplotlib
from .cases import Setting
from .contact_failure import PROBLEMS, STEPS, ContactRow, start
from .plots import COLOURS, RESOLUTION

SHOWN = (
    (Setting("ebdf", {"k": 4}), True, "TLISMNI, with the jump"),
    (Setting("baumgarte"), False, "Baumgarte, alpha = beta = 5 1/s"),
    (Setting("baumgarte", {"alpha": 50.0, "beta": 50.0}), False, "Baumgarte, alpha = beta = 50 1/s"),
    (Setting("hht_ggl"), False, "HHT on GGL"),
    (Setting("hht_i3"), False, "HHT on index 3"),
    (Setting("ebdf", {"k": 4}), False, "TLISMNI without the jump"),
)
DASHES = ("-", "--", "-", "-", "-", ":")
AROUND = (-0.05, 0.3)
"""Shown before and after the first contact, s."""


def plot_contact(rows: Sequence[ContactRow], path: Path) -> Path:
    """Gap, its rate and the stored energy over time at the first contact, and all errors of impulse and energy.

    Raises TlismniError if matplotlib cannot be imported.
    """
    figure_class, context = _matplotlib()
    with context(STYLE):
        figure = figure_class(figsize=(11.0, 7.4), layout="constrained", dpi=RESOLUTION)
        (gap, rate), (energy, errors) = figure.subplots(2, 2)
        for (setting, jump, label), dashes in zip(SHOWN, DASHES, strict=True):
            t, values = _trace(setting, jump)
            style = {"color": COLOURS[setting.method], "linestyle": dashes, "label": label, "linewidth": 1.8}
            for axes, column in ((gap, 0), (rate, 1), (energy, 2)):
                axes.plot(t, values[column], **style)
        for axes, text in ((gap, "gap, m"), (rate, "rate of the gap, m/s"), (energy, "stored energy, J")):
            axes.set_ylabel(text)
            axes.set_xlabel("time after the first touch, s")
            axes.set_xlim(*AROUND)
        gap.set_ylim(-0.42, 0.5)
        gap.axhline(0.0, color="#999999", linewidth=0.6)
        figure.legend(*gap.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        _errors(errors, rows)
        figure.suptitle(
            "A pendulum strikes its stop (restitution 0.7): constraint switched on with and without the velocity jump",
            fontsize=11,
            fontweight="bold",
        )
        figure.savefig(path)
    return path


def _trace(setting: Setting, jump: bool) -> tuple[Any, Any]:
    """Time from the first touch, and gap, its rate and the stored energy, (3, N)."""
    problem = PROBLEMS[0]
    run = start(problem, setting, jump, STEPS[0])
    try:
        run.run_to(1.0)
    except SimulationError:
        pass  # what was reached is shown
    run.flush()
    samples = np.concatenate(run.samples)
    gap, rate, kinetic, potential = (
        run.table.column(samples, name) for name in ("stop.gap", "stop.gap_rate", "energy.kinetic", "energy.potential")
    )
    return samples[:, 0] - run.events[0].t, np.array([gap, rate, kinetic + potential])


def _errors(axes: Any, rows: Sequence[ContactRow]) -> None:
    """Impulse of the first contact over the right one, all problems: filled with the jump, open without."""
    labels = list(dict.fromkeys(row.setting.label for row in rows))
    for row in rows:
        if math.isnan(row.impulse_error):
            continue
        axes.plot(
            row.impulse_error + 1.0, labels.index(row.setting.label), marker="o", markersize=5,
            color=COLOURS[row.setting.method], markerfacecolor=None if row.jump else "none",
        )  # fmt: skip
    axes.axvline(1.0, color="#999999", linewidth=0.6)
    axes.set_yticks(range(len(labels)), labels, fontsize=7.5)
    axes.invert_yaxis()
    axes.set_xlabel("impulse of the first contact over the right one\n(filled: with the velocity jump; open: without)")
