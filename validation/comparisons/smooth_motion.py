"""No contact: trajectories, exudyn's extrapolated by Richardson until its own error does not matter."""

import numpy as np

from ...core import Result
from ...core.elements import FlexibleBody
from ...models.scenario import Scenario
from ..exudyn_run import ExudynResult, run_exudyn, settings_for
from ..metrics import richardson, trajectory_difference
from .common import (
    Comparison,
    Curve,
    Panel,
    Row,
    Task,
    at_times,
    course_scale,
    energy_panel,
    nice_step,
    our_error,
    our_run,
    residual_panel,
    unit_of,
)

TOLERANCE = 1e-5
"""Relative to half the range of the channel."""
FIRST_STEPS = 2000
MOST_STEPS = 64_000
SAMPLES = 401
TIGHT = 1e-10
"""Newton's tolerance in exudyn: its iteration error must not disturb the extrapolation."""


def compare_motion(task: Task) -> Comparison:
    """Largest difference of each compared channel over the whole run."""
    scenario = task.scenario
    grid = np.linspace(0.0, scenario.t_end, SAMPLES)
    task.progress("our run")
    ours = our_run(scenario, grid)
    channels = [c for c in scenario.compare if c in ours.channels and not _rings(scenario, c)]
    own = our_error(task, ours, channels)
    # index 2: its error has even powers of the step only, which is what the extrapolation wants
    settings = settings_for(
        scenario.model, integrator="trapezoidal", relative_tolerance=TIGHT,
        **({} if any(isinstance(b, FlexibleBody) for b in scenario.model.bodies) else {"absolute_tolerance": TIGHT}),
    )  # fmt: skip
    step = task.step or nice_step(scenario.t_end / FIRST_STEPS)
    runs: list[ExudynResult] = []
    rows: list[Row] = []
    while True:
        task.progress(f"exudyn, step {step:.1e} s")
        runs.append(run_exudyn(task.exudyn_model, scenario.t_end, step, settings))
        if len(runs) > 2:
            rows = [_row(c, ours, own.get(c, np.zeros(SAMPLES)), grid, runs) for c in channels]
            decided = all(r.uncertainty <= 0.3 * TOLERANCE * (r.scale or 1.0) for r in rows)
            if decided or any(r.evident for r in rows) or scenario.t_end / step > 0.5 * MOST_STEPS:
                break
        step *= 0.5
    fine = runs[-1]
    panels = []
    for channel in channels:
        theirs = at_times(fine.t, fine.channels, channel, grid)
        curves = (Curve("tlismni", grid, ours[channel], True), Curve("exudyn", grid, theirs, False))
        panels.append(Panel(channel, unit_of(ours, channel), curves))
        limit, _ = _limit(channel, grid, runs)
        apart = np.abs(ours[channel] - limit)
        difference = (Curve("|tlismni - exudyn, extrapolated|", grid, apart, True),)
        panels.append(Panel(f"{channel}: difference", unit_of(ours, channel), difference, None, True))
    panels += [energy_panel(ours), residual_panel(ours)]
    notes = (
        *fine.notes,
        "exudyn: index-2 trapezoidal rule, extrapolated to step 0 by Richardson; "
        "the uncertainty is how far that extrapolation moved with the last halving of the step",
    )
    return Comparison(
        "motion without contact",
        tuple(rows),
        tuple(panels),
        notes,
        tuple(r.step for r in runs),
        fine.version,
        ours.stats["wall_time"],
        sum(r.wall_time for r in runs),
        result=ours,
    )


def _rings(scenario: Scenario, channel: str) -> bool:
    """Whether a channel of a flexible model is a force or an angle, which fast waves of the mesh make ring."""
    flexible = any(isinstance(b, FlexibleBody) for b in scenario.model.bodies)
    return flexible and not channel.endswith((".x", ".y"))


def _limit(channel: str, grid: np.ndarray, runs: list[ExudynResult]) -> tuple[np.ndarray, np.ndarray]:
    """(extrapolated values, uncertainty) from the three finest runs."""
    values = [at_times(r.t, r.channels, channel, grid) for r in runs[-3:]]
    limit, _ = richardson(values[-2], values[-1])
    before, _ = richardson(values[-3], values[-2])
    return limit, np.abs(limit - before)


def _row(channel: str, ours: Result, own: np.ndarray, grid: np.ndarray, runs: list[ExudynResult]) -> Row:
    limit, uncertainty = _limit(channel, grid, runs)
    found = trajectory_difference(grid, ours[channel], limit)
    k = int(np.argmin(np.abs(grid - found.at)))
    return Row(
        f"{channel}, where it differs most (t = {found.at:.4g} s)",
        unit_of(ours, channel),
        float(ours[channel][k]),
        float(limit[k]),
        TOLERANCE,
        "relative",
        float(uncertainty[k]),
        course_scale(ours, channel, found.scale),
        ours_uncertainty=float(own[k]),
        channel=channel,
        at=float(grid[k]),
    )
