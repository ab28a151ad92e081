"""The whole run through all its impacts, up to some Lyapunov times; what comes after is not comparable.

Constraints are compared with the limit of three stiffnesses that suit the first impact; what differs is asked again
with a fourth, and only a limit that has been found twice can differ.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...core import Result
from ...core.laws import ImpactLaw
from ..exudyn_run import ExudynResult, run_exudyn, settings_for
from ..metrics import trajectory_difference
from ..predictability import predictability
from .common import (
    Comparison,
    Row,
    Task,
    Touch,
    at_times,
    blows,
    course_scale,
    is_contact_channel,
    nice_step,
    our_error,
    our_run,
    touches,
    unit_of,
)
from .events import away_from
from .penalty_limit import (
    EXPONENT,
    RUNS,
    SOFTEST,
    contact_step,
    latest_limit,
    softest_stiffness,
    stiffer,
    unless_sure,
    with_stiffness,
)

STATE = 1e-3
SAMPLES = 2001
MARGIN = 3.0
"""Durations of contacts around an event that do not count."""
STEPS = 4000
"""exudyn's steps in the run, at least."""
MOST_STEPS = 1_000_000
"""At most, with the stiffest contact."""


@dataclass(frozen=True)
class _Limit:
    """exudyn's runs and what they tend to."""

    runs: list[ExudynResult]
    stiffnesses: tuple[float, ...]
    """N/m^1.5; none where the finer of two steps counts."""
    margin: float

    def values(self, channel: str, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(limit, uncertainty)."""
        found = np.array([at_times(r.t, r.channels, channel, np.minimum(t, r.t[-1])) for r in self.runs])
        if self.stiffnesses:
            return latest_limit(np.array(self.stiffnesses) ** (-1.0 / (EXPONENT + 1.0)), found)
        return found[-1], np.abs(found[-1] - found[0])


def with_whole_run(task: Task, comparison: Comparison) -> Comparison:
    """The comparison with rows over the whole run: channels and impulses up to the limit, and channels after it."""
    scenario = task.scenario
    task.progress("Lyapunov exponent over the run")
    known = predictability(scenario)
    end = min(known.limit, scenario.t_end)
    task.progress("our run")
    ours = our_run(scenario, np.linspace(0.0, scenario.t_end, SAMPLES))
    limit = _limit(task, ours)
    events = [e for e in ours.events if e.kind != "graze"]
    away = away_from(ours.t, events, limit.runs, limit.margin)
    channels = [c for c in scenario.compare if c in limit.runs[0].channels and not is_contact_channel(task, c)]
    error = our_error(task, ours, channels)
    until = (
        f"up to {end:.4g} s" if end == scenario.t_end else f"up to {end / known.time:.2g} Lyapunov times ({end:.4g} s)"
    )
    before, after = away & (ours.t <= end), away & (ours.t > end)
    compared = channels if before.any() else []
    rows = [_row(channel, until, ours, limit, before, error, "") for channel in compared]
    if limit.stiffnesses and any(row.verdict == "differ" for row in rows):
        last = limit.stiffnesses[-1]
        if _step(task, touches(ours.events), stiffer(last, 1)) * MOST_STEPS >= scenario.t_end:
            limit = _with_run(task, limit, touches(ours.events), stiffer(last, 1))
            before &= away_from(ours.t, events, limit.runs, limit.margin)
            rows = [_row(channel, until, ours, limit, before, error, "") for channel in compared if before.any()]
        rows = unless_sure(rows, len(limit.runs) > RUNS, _open_limit(limit))
    for channel in channels if after.any() else ():
        if end < scenario.t_end:
            reason = f"chaotic: {known.text()}; compared up to {end / known.time:.2g} of them"
            rows.append(_row(channel, "after that", ours, limit, after, error, reason))
    share = float(np.sum(before)) / max(1, int(np.sum(ours.t <= end)))
    notes = [
        f"whole run: {known.text()}; the run is {scenario.t_end / known.time:.2g} of them long",
        f"{share:.0%} of the times up to {end:.4g} s are compared; the others are too near to a contact",
    ]
    return Comparison(
        **{**comparison.__dict__, "rows": (*comparison.rows, *rows), "notes": (*comparison.notes, *notes)}
    )


def _row(
    channel: str, name: str, ours: Result, limit: _Limit, kept: np.ndarray, error: dict[str, np.ndarray], reason: str
) -> Row:
    t, mine = ours.t[kept], ours[channel][kept]
    theirs, moved = limit.values(channel, t)
    found = trajectory_difference(t, mine, theirs)
    k = int(np.argmin(np.abs(t - found.at)))
    own = error[channel][kept][k] if channel in error else 0.0
    return Row(
        f"{channel} {name}, where it differs most (t = {t[k]:.5g} s)", unit_of(ours, channel), float(mine[k]),
        float(theirs[k]), STATE, "relative", float(moved[k]), course_scale(ours, channel, found.scale), not reason,
        float(own), reason=reason, channel=channel, at=float(t[k]),
    )  # fmt: skip


def _limit(task: Task, ours: Result) -> _Limit:
    model, found, t_end = task.exudyn_model, touches(ours.events), task.scenario.t_end
    settings, runs = settings_for(model), []
    if any(isinstance(c.law, ImpactLaw) for c in model.contacts):
        struck = blows(found)
        softest = softest_stiffness(struck, t_end) if struck else SOFTEST
        while softest > SOFTEST and _step(task, found, stiffer(softest, RUNS - 1)) * MOST_STEPS < t_end:
            softest = stiffer(softest, -1)
        limit = _Limit([], (), MARGIN * 200.0 * _contact(task, found, softest))
        for k in range(RUNS):
            limit = _with_run(task, limit, found, stiffer(softest, k))
        return limit
    durations = [touch.end - touch.start for touch in found if touch.end > touch.start]
    fine = task.step or nice_step(min(0.005 * min(durations, default=t_end), t_end / STEPS))
    for step in (2.0 * fine, fine):
        task.progress(f"exudyn, whole run, step {step:.1e} s")
        runs.append(run_exudyn(model, t_end, step, settings))
    return _Limit(runs, (), MARGIN * max(durations, default=0.0))


def _contact(task: Task, found: Sequence[Touch], stiffness: float) -> float:
    """The least step, s, that resolves a contact of the run."""
    steps = (contact_step(touch, stiffness) for touch in blows(found))
    return min(steps, default=task.scenario.t_end)


def _step(task: Task, found: Sequence[Touch], stiffness: float) -> float:
    """exudyn's, s."""
    return min(task.step or np.inf, nice_step(_contact(task, found, stiffness)), nice_step(task.scenario.t_end / STEPS))


def _with_run(task: Task, limit: _Limit, found: Sequence[Touch], stiffness: float) -> _Limit:
    """The limit with one more run."""
    model, step = task.exudyn_model, _step(task, found, stiffness)
    task.progress(f"exudyn, whole run, K = {stiffness:.0e} N/m^1.5, step {step:.1e} s")
    run = run_exudyn(with_stiffness(model, stiffness), task.scenario.t_end, step, settings_for(model))
    return replace(limit, runs=[*limit.runs, run], stiffnesses=(*limit.stiffnesses, stiffness))


def _open_limit(limit: _Limit) -> str:
    return (
        f"the limit of stiff contacts over the whole run is not reached: K goes up to {limit.stiffnesses[-1]:.0e} "
        "N/m^1.5, and the limit still moves, or lies too near to ours, to call a difference one of the models"
    )
