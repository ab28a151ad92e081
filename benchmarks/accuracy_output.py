"""Table and picture of `accuracy_per_time.py`."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

from accuracy_contenders import EXUDYN, EXUDYN_TREE, IDA, OURS, SOLVE_DAE, Contender
from accuracy_problems import Problem
from rich.text import Text
from tlismni.cli.screen import print_table, stdout
from work_precision import Point

SIDES = (OURS, EXUDYN, EXUDYN_TREE, SOLVE_DAE, IDA)
GENERALIZED_ALPHA = "generalized_alpha"


class CurveLike(Protocol):
    """What is shown of a contender."""

    contender: Contender
    points: list[Point]
    end: str

    def reach(self, target: float) -> tuple[float, str]: ...

    def extrapolated(self, target: float) -> float: ...


def milliseconds(seconds: float) -> str:
    """Three digits, in ms."""
    return f"{1e3 * seconds:.3g}" if math.isfinite(seconds) else "-"


def _cell(curve: CurveLike, target: float) -> str:
    seconds, _ = curve.reach(target)
    if math.isfinite(seconds):
        return milliseconds(seconds)
    beyond = curve.extrapolated(target)
    return f"({milliseconds(beyond)})" if math.isfinite(beyond) else "-"


def best(curves: Sequence[CurveLike], side: str, target: float, name: str = "") -> tuple[float, str, bool]:
    """(seconds, method, reached) of the fastest of a side; extrapolated if none reaches the target."""
    chosen = [c for c in curves if c.contender.side == side and c.contender.name.startswith(name)]
    for value, reached in ((lambda c: c.reach(target)[0], True), (lambda c: c.extrapolated(target), False)):
        times = [(value(c), c.contender.name) for c in chosen]
        if times and math.isfinite(min(times)[0]):
            return (*min(times), reached)
    return math.inf, "", False


def print_problem(problem: Problem, curves: Sequence[CurveLike], targets: Sequence[float]) -> None:
    """Times of all methods, then the best of each side beside ours."""
    rows = [(c.contender.side, c.contender.name, *(_cell(c, target) for target in targets), _finest(c)) for c in curves]
    columns = ("", "method", *(f"{target:.0e} m" for target in targets), "finest run")
    print_table(f"{problem.title}; ms to reach an error", columns, rows, left=2)
    rows = []
    for target in targets:
        ours, method, reached = best(curves, OURS, target)
        row = [f"{target:.0e} m", f"{method}, {milliseconds(ours)} ms" if reached else "not reached"]
        for side, name in ((EXUDYN, GENERALIZED_ALPHA), (EXUDYN, ""), (EXUDYN_TREE, ""), (SOLVE_DAE, ""), (IDA, "")):
            seconds, _, peer_reached = best(curves, side, target, name)
            if not any(c.contender.side == side for c in curves):
                row.append("left out")
            elif not math.isfinite(seconds) or not reached:
                row.append("not reached" if not math.isfinite(seconds) else milliseconds(seconds))
            else:
                ratio = f"{seconds / ours:.3g}"
                row.append(ratio if peer_reached else f"not reached, about {ratio}")
        rows.append(row)
    columns = ("error", "our best", "exudyn gen. alpha", "exudyn best", "exudyn minimal", "solve_dae", "IDA")
    print_table("times as long as our best", columns, rows, left=2)
    for c in curves:
        if c.end:
            stdout().print(Text(f"{c.contender.side} {c.contender.name}: {c.end}", style="dim"))
    stdout().print(Text("in brackets, 'about': extrapolated with the order that the finest runs show", style="dim"))


def _finest(curve: CurveLike) -> str:
    if not curve.points:
        return "none succeeded"
    point = min(curve.points, key=lambda p: p.error)
    return f"{point.error:.1e} m, {milliseconds(point.seconds)} ms"


COLOURS = {OURS: "Blues", EXUDYN: "Reds", EXUDYN_TREE: "Purples", SOLVE_DAE: "Greens", IDA: "Oranges"}
LIGHTEST, DARKEST = 0.45, 0.95
"""Of the shades that tell the methods of a side apart."""
MARKERS = "osD^vP*X<>"
MOST_SHOWN = 1.0
"""Largest error that is drawn, m."""


def plot(measured: Sequence[tuple[Problem, Sequence[CurveLike]]], targets: Sequence[float], path: Path) -> None:
    """Time against error, one panel a problem; a colour for each side, a marker for each of its methods."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0 * len(measured), 10.0), layout="constrained")
    axes: Any = figure.subplots(1, len(measured), squeeze=False)[0]
    for axis, (problem, curves) in zip(axes, measured, strict=True):
        used = dict.fromkeys(SIDES, 0)
        most = {side: sum(c.contender.side == side for c in curves) for side in SIDES}
        for c in curves:
            side = c.contender.side
            points = [p for p in c.points if p.error <= MOST_SHOWN]
            if not points:
                continue
            shade = DARKEST - (DARKEST - LIGHTEST) * used[side] / max(most[side] - 1, 1)
            axis.loglog(
                [p.error for p in points], [p.seconds for p in points], color=colormaps[COLOURS[side]](shade),
                marker=MARKERS[used[side] % len(MARKERS)], ms=4, lw=1.2 if side == OURS else 0.9,
                ls="-" if side == OURS else "--", alpha=0.9, label=f"{side}: {c.contender.name}",
            )  # fmt: skip
            used[side] += 1
        for target in targets:
            axis.axvline(target, color="0.75", lw=0.8, zorder=0)
        axis.invert_xaxis()
        axis.grid(alpha=0.25)
        axis.set_title(problem.title, fontsize=9)
        axis.set_xlabel("error, m (finer to the right)")
        axis.set_ylabel("time of the integration, s")
        # below the panel: above the curves it would hide them
        axis.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.09))
    figure.savefig(path, dpi=140)
