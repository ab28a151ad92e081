"""Figure of the coupling study: error over communication step, error over cost, longest stable steps."""

from pathlib import Path
from typing import Any

import numpy as np

from ..plots import STYLE, _matplotlib
from .coupling import FIXED_POINT_LIMIT, LONGEST, SHORTEST, CouplingStudy
from .coupling_problems import (
    AITKEN,
    BY_STEPS,
    CONTACT_FREQUENCY,
    END,
    GAUSS_SEIDEL,
    GAUSS_SEIDEL_LINEAR,
    ITERATED,
    JACOBI,
    JACOBI_LINEAR,
    LINEAR,
    NEWTON,
    Contender,
)
from .plots import RESOLUTION

STYLES: dict[Contender, dict[str, Any]] = {
    JACOBI: {"color": "#d1495b", "marker": "o"},
    GAUSS_SEIDEL: {"color": "#e58b3a", "marker": "s"},
    END: {"color": "#8a8d91", "marker": "v"},
    JACOBI_LINEAR: {"color": "#d1495b", "marker": "o", "markerfacecolor": "none", "linestyle": (0, (1, 1.5))},
    GAUSS_SEIDEL_LINEAR: {"color": "#e58b3a", "marker": "s", "markerfacecolor": "none", "linestyle": (0, (1, 1.5))},
    LINEAR: {"color": "#7b2d8b", "marker": "*"},
    ITERATED: {"color": "#5a8f29", "marker": "^"},
    AITKEN: {"color": "#1d7874", "marker": "D"},
    BY_STEPS: {"color": "#3f88c5", "marker": "P"},
    NEWTON: {"color": "#0b3c5d", "marker": "x"},
}
SAME_MAP = (ITERATED, AITKEN, BY_STEPS, NEWTON)
"""They find the same solution: one line in the panel over the step."""


def plot_coupling(study: CouplingStudy, path: Path) -> Path:
    """Write the figure. Raises TlismniError if matplotlib cannot be imported."""
    figure_class, context = _matplotlib()
    with context(STYLE):
        figure = figure_class(figsize=(14.0, 8.6), layout="constrained", dpi=RESOLUTION)
        panels = figure.subplot_mosaic([["step", "cost", "control"], ["energy", "limits", "limits"]])
        _over_step(panels["step"], study)
        _over_cost(panels["cost"], study)
        _controlled(panels["control"], study)
        _energy(panels["energy"], study)
        _limits(panels["limits"], study)
        figure.suptitle("hammer and anvil in two halves that touch, against the whole")
        figure.savefig(path)
    return path


def _over_step(axes: Any, study: CouplingStudy) -> None:
    for contender in (JACOBI, GAUSS_SEIDEL, END, JACOBI_LINEAR, GAUSS_SEIDEL_LINEAR, NEWTON, LINEAR):
        rows = study.of(contender)
        label = "mean of both ends" if contender in SAME_MAP else contender.label
        text = f"{label}: order {study.order(contender):.2f}"
        axes.loglog([1e3 * r.step for r in rows], [r.error for r in rows], label=text, **_line(contender))
    for order, anchor in ((1, GAUSS_SEIDEL), (2, NEWTON)):
        rows = study.of(anchor)
        if rows:
            steps = np.array([rows[0].step, rows[-1].step])
            axes.loglog(
                1e3 * steps, 0.5 * rows[-1].error * (steps / steps[-1]) ** order, color="0.75", lw=0.8, zorder=0
            )
            axes.annotate(f"h$^{order}$", (1e3 * steps[-1], 0.5 * rows[-1].error), fontsize=8, color="0.5", va="top")
    axes.set(xlabel="communication step, ms", ylabel="error of the hammer's velocity\nafter the blow, relative")
    _room_below(axes)
    axes.legend(fontsize=7.5, loc="lower right")


def _over_cost(axes: Any, study: CouplingStudy) -> None:
    for contender in (JACOBI, GAUSS_SEIDEL, JACOBI_LINEAR, GAUSS_SEIDEL_LINEAR, ITERATED, AITKEN, NEWTON):
        rows = study.of(contender)
        axes.loglog(
            [r.instance_steps for r in rows], [r.error for r in rows], label=contender.label, **_line(contender)
        )
    axes.set(xlabel="steps of both instances, repeated ones too", ylabel="error of the hammer's velocity, relative")
    axes.legend(fontsize=7.5, loc="lower left")


def _controlled(axes: Any, study: CouplingStudy) -> None:
    groups = dict.fromkeys((row.contender, row.estimate) for row in study.controlled)
    for contender, estimate in groups:
        chosen = [r for r in study.controlled if (r.contender, r.estimate) == (contender, estimate) and not r.failure]
        style = {**_line(contender), "linestyle": {"": "-", "doubling": (0, (4, 2))}.get(estimate, (0, (1, 1.5)))}
        style["markerfacecolor"] = style["color"] if not estimate else "none"
        label = f"{contender.label}: {'equal steps' if not estimate else f'controlled by {estimate}'}"
        axes.loglog([r.instance_steps for r in chosen], [r.error for r in chosen], label=label, **style)
    axes.set(xlabel="steps of both instances", ylabel="error of the hammer's velocity, relative")
    axes.set_title("a longer run, mostly free flight", fontsize=9)
    axes.xaxis.set_minor_formatter("")
    _room_below(axes)
    axes.legend(fontsize=7.5, loc="lower left")


def _energy(axes: Any, study: CouplingStudy) -> None:
    for contender in (JACOBI, GAUSS_SEIDEL, END, JACOBI_LINEAR, GAUSS_SEIDEL_LINEAR, NEWTON, LINEAR):
        rows = study.of(contender)
        axes.plot([1e3 * r.step for r in rows], [r.energy for r in rows], label=contender.label, **_line(contender))
    axes.axhline(0.0, color="0.6", lw=0.6)
    axes.set_xscale("log")
    axes.set_yscale("symlog", linthresh=1e-4)
    axes.set(xlabel="communication step, ms", ylabel="energy that the coupling adds,\nparts of that at the start")
    axes.set_title("colours as above", fontsize=8)


def _limits(axes: Any, study: CouplingStudy) -> None:
    labels = [row.contender.label for row in study.stability]
    for place, row in enumerate(study.stability):
        bounds = {"none up to": LONGEST, "below": SHORTEST}
        limit = row.limit if row.limit is not None else bounds[row.beyond]
        axes.barh(place, 1e3 * limit, color=STYLES[row.contender]["color"], height=0.6)
        note = {"": row.fails, "none up to": "no limit found", "below": "never stable"}[row.beyond]
        axes.text(1.08e3 * limit, place, f"{note}", va="center", fontsize=7.5)
    axes.axvline(1e3 * FIXED_POINT_LIMIT, color="0.5", lw=0.8, ls="--")
    axes.text(1e3 * FIXED_POINT_LIMIT, -0.75, "fixed point, theory", fontsize=7.5, ha="center", color="0.4")
    axes.set_xscale("log")
    axes.set_xlim(3e2 * min((r.limit for r in study.stability if r.limit), default=SHORTEST), 6e3 * LONGEST)
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.4, -1.0)
    period = 2e3 * np.pi / CONTACT_FREQUENCY
    axes.set_axisbelow(True)
    axes.axvline(period, color="0.5", lw=0.8, ls=":")
    axes.text(period, -0.75, "period", fontsize=7.5, ha="center", color="0.4")
    axes.set_xlabel("longest stable step on a contact that stays, ms")


def _room_below(axes: Any) -> None:
    """Half a panel for the legend."""
    low, high = axes.get_ylim()
    axes.set_ylim(low / (high / low) ** 0.6, high)


def _line(contender: Contender) -> dict[str, Any]:
    return {"linewidth": 1.2, "markersize": 5, **STYLES[contender]}
