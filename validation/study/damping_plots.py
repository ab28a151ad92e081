"""Figure of the damping study: spectra of the contact's multiplier, and its rms over alpha."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..plots import STYLE, _matplotlib
from .damping import DampingRow
from .plots import COLOURS, RESOLUTION

FLOOR = 1e-6
"""Smallest amplitude that is drawn."""
NAMES = {"hht": "inside TLISMNI", "hht_ggl": "on GGL"}


def plot_damping(rows: Sequence[DampingRow], path: Path) -> Path:
    """One line of panels a problem: spectra inside TLISMNI, spectra on GGL, rms over alpha.

    Raises TlismniError if matplotlib cannot be imported.
    """
    labels = list(dict.fromkeys(row.problem.label for row in rows))
    figure_class, context = _matplotlib()
    with context(STYLE):
        figure = figure_class(figsize=(11.0, 2.9 * len(labels)), layout="constrained", dpi=RESOLUTION)
        axes = figure.subplots(len(labels), 3, squeeze=False)
        for line, label in zip(axes, labels, strict=True):
            here = [row for row in rows if row.problem.label == label and not row.failure]
            for panel, method in zip(line, NAMES, strict=False):
                for row in (r for r in here if r.method == method):
                    shade = 0.15 + 0.75 * (1.0 + row.alpha / 0.3) if row.alpha else 0.9
                    panel.semilogy(
                        1e-3 * row.frequencies, np.maximum(row.spectrum, FLOOR), color=str(0.95 - shade), linewidth=1.0,
                        label=f"alpha = {row.alpha:g}",
                    )  # fmt: skip
                if not any(r.method == method for r in here):
                    panel.text(0.5, 0.5, "no run comes to its end", ha="center", va="center", transform=panel.transAxes)
                panel.set_title(f"{label}: HHT {NAMES[method]}", fontsize=9)
                panel.set_xlabel("frequency, kHz")
                panel.set_ylabel("amplitude / mean force")
            for method, marker in zip(NAMES, ("o-", "x--"), strict=True):
                found = [r for r in here if r.method == method]
                line[2].plot(
                    [-r.alpha for r in found], [r.rms for r in found], marker, color=COLOURS[method],
                    label=f"HHT {NAMES[method]}",
                )  # fmt: skip
            line[2].set_xlabel("-alpha")
            line[2].set_ylabel("rms / mean force")
            line[2].set_ylim(0.0, 1.1 * max((r.rms for r in here), default=1.0))
            line[2].legend(fontsize=8)
        axes[0][0].legend(fontsize=7)
        figure.savefig(path)
    return path
