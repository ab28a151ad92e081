"""Damped elastic rods that strike: our constraint against the limit of exudyn's penalty, on the same mesh.

Material damping gives the wave's front a width that the mesh resolves, and calms the chatter of a penalty stiffer than
an element: so the stiffness k can grow, and mean force, time in contact, impulse and courses are a + b/k + c/k^2 + ...,
where a is what the constraint must give. (Without damping nothing of this holds: see `rod_impact`.)
"""

from dataclasses import replace

import numpy as np

from ...core import Result
from ...core.elements import AxialRod
from ...models import Scenario
from ..exudyn_run import ExudynResult
from ..metrics import power_limit, trajectory_difference
from .common import (
    LOOSER,
    Comparison,
    Curve,
    Panel,
    Row,
    Task,
    at_times,
    course_scale,
    energy_panel,
    is_contact_channel,
    our_run,
    own_bar,
    residual_panel,
    unit_of,
)
from .rod_impact import BLOW, Blow, blow_of_exudyn, blow_of_ours, run_penalty

SHARES = (4.0, 16.0, 64.0)
"""Stiffness of exudyn's contact in parts of an element's, EA/l."""
COURANT = 0.05
"""Part of an element that a wave passes in a step, on both sides."""
SETTLING = 5.0
"""Around an event of the contact, in passages of an element: a spring needs time where a constraint jumps."""
RELATIVE = 1e-3
SAMPLES = 1501


def damped(scenario: Scenario) -> bool:
    """Whether all rods of the model have damping."""
    rods = [b for b in scenario.model.bodies if isinstance(b, AxialRod)]
    return bool(rods) and all(r.damping_time > 0.0 for r in rods) and len(scenario.model.contacts) == 1


def compare_damped_rods(task: Task) -> Comparison:
    """Mean force, time in contact, impulse, and the courses of the compared channels."""
    scenario = task.scenario
    name = scenario.model.contacts[0].name
    passage = min(b.length / b.elements / b.wave_speed for b in scenario.model.bodies if isinstance(b, AxialRod))
    scenario = replace(scenario, options={**scenario.options, "step": COURANT * passage})
    task.progress("our run")
    ours = our_run(scenario)
    task.progress("our run with twice the step")
    coarse_steps = our_run(scenario, looser=LOOSER)
    events = np.array([e.t for e in ours.events])
    grid = np.linspace(0.0, scenario.t_end, SAMPLES)
    grid = grid[np.abs(grid[:, None] - events[None, :]).min(axis=1, initial=np.inf) > SETTLING * passage]
    runs: list[ExudynResult] = []
    for share, courant in (*((s, COURANT) for s in SHARES), (SHARES[0], 2.0 * COURANT)):
        task.progress(f"exudyn, k = {share:g} EA/l")
        runs.append(run_penalty(task.exudyn_model, scenario.t_end, share, courant))
    *runs, doubled = runs
    mine, other = blow_of_ours(ours, name), blow_of_ours(coarse_steps, name)
    *theirs, again = (blow_of_exudyn(r, name) for r in (*runs, doubled))
    rows = [_blow_row(name, field, mine, other, theirs, again) for field in BLOW]
    rows += [
        _channel_row(channel, ours, grid, _on(grid, channel, ours, coarse_steps), runs, doubled)
        for channel in scenario.compare
        if channel in runs[0].channels and channel in ours.channels and not is_contact_channel(task, channel)
    ]
    notes = (
        f"the same mesh on both sides; exudyn's contact is a spring of k = {', '.join(f'{s:g}' for s in SHARES)} times "
        "an element's stiffness EA/l, extrapolated in 1/k; its error bar is the difference of the quadratic and the "
        "linear extrapolation, and what twice the step changes with the softest spring; ours is what twice the step "
        "changes",
        "the damping of the material gives the front of the wave a width that the mesh resolves; without it a spring "
        "stiffer than EA/l chatters, and there is no such limit",
        *runs[-1].notes,
    )
    force = f"{name}.normal_force"
    panels = []
    for channel in dict.fromkeys((force, *scenario.compare)):
        if channel in runs[0].channels and channel in ours.channels:
            curves = [Curve("tlismni, constraint", ours.t, ours[channel], True)]
            curves += [
                Curve(f"exudyn, k = {share:g} EA/l", r.t, r[channel], False)
                for share, r in zip(SHARES, runs, strict=True)
            ]
            panels.append(Panel(channel, unit_of(ours, channel), tuple(curves)))
    return Comparison(
        "impact of damped elastic rods, against the penalty limit on the same mesh",
        tuple(rows),
        (*panels, energy_panel(ours), residual_panel(ours)),
        notes,
        tuple(r.step for r in (*runs, doubled)),
        runs[-1].version,
        ours.stats["wall_time"],
        sum(r.wall_time for r in (*runs, doubled)),
        events=tuple(ours.events),
        result=ours,
    )


def _on(grid: np.ndarray, channel: str, *runs: Result) -> tuple[np.ndarray, ...]:
    return tuple(np.interp(grid, r.t, r[channel]) for r in runs)


def _limit(values: list[np.ndarray], doubled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    limit, bar = power_limit(1.0 / np.array(SHARES), np.array(values))
    return limit, bar + np.abs(values[0] - doubled)


def _blow_row(name: str, field: str, mine: Blow, other: Blow, theirs: list[Blow], again: Blow) -> Row:
    title, unit = BLOW[field]
    limit, bar = _limit([np.array([getattr(b, field)]) for b in theirs], np.array([getattr(again, field)]))
    value = getattr(mine, field)
    return Row(
        f"{name}: {title}", unit, value, float(limit[0]), RELATIVE, "relative", float(bar[0]),
        ours_uncertainty=float(own_bar(value, getattr(other, field))),
    )  # fmt: skip


def _channel_row(
    channel: str,
    ours: Result,
    grid: np.ndarray,
    mine: tuple[np.ndarray, ...],
    runs: list[ExudynResult],
    doubled: ExudynResult,
) -> Row:
    values = [at_times(r.t, r.channels, channel, np.minimum(grid, r.t[-1])) for r in (*runs, doubled)]
    limit, bar = _limit(values[:-1], values[-1])
    found = trajectory_difference(grid, mine[0], limit)
    k = int(np.argmin(np.abs(grid - found.at)))
    return Row(
        f"{channel}, where it differs most (t = {found.at:.4g} s)", unit_of(ours, channel), float(mine[0][k]),
        float(limit[k]), RELATIVE, "relative", float(bar[k]), course_scale(ours, channel, found.scale),
        ours_uncertainty=float(own_bar(mine[0][k], mine[1][k])), channel=channel, at=float(grid[k]),
    )  # fmt: skip
