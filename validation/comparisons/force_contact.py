"""Contact by force laws, like for like: the same law in exudyn, impact by impact.

Tolerances (agreed for this project): contact time within exudyn's step, peak force 0.5 %, impulse 0.1 %, angle and
rate before the second impact 1e-4.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...core import ForceLaw, KelvinVoigt, Result
from ...core.description import Model
from ..exudyn_run import ExudynResult, run_exudyn, settings_for
from ..metrics import contact_intervals, impulse, peak, released, speeds, trajectory_difference
from .common import (
    RATES,
    Comparison,
    Row,
    Task,
    Touch,
    at_times,
    is_contact_channel,
    nice_step,
    our_run,
    residual_panel,
    touches,
    unit_of,
)
from .force_panels import force_panels

STEPS_IN_CONTACT = 200
APPROACH_SPEED = 5e-5
"""Largest relative error of the approach speed that exudyn may make (see `_step`)."""
ENTRY = 2e-4
"""Largest relative error of speed that a force which jumps at first touch may make (see `_entry_error`)."""
MANY_STEPS, MOST_STEPS = 300_000, 1_000_000
SAMPLES, SAMPLES_IN_CONTACT = 2001, 1201
PEAK, IMPULSE, STATE = 5e-3, 1e-3, 1e-4
Channels = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Quantities:
    """The measured quantities of one contact in one run."""

    start: float
    approach_speed: float
    duration: float
    peak_force: float
    impulse: float
    separation_speed: float
    end: float


def compare_forces(task: Task) -> Comparison:
    """First contact of every contact element, state before the second impact, trajectories until then."""
    scenario = task.scenario
    task.progress("our run")
    first_run = our_run(scenario)
    found = touches(first_run.events)
    notes: list[str] = []
    if not found:
        notes.append("no contact begins and ends before the end of the run: only trajectories are compared")
    ours = our_run(scenario, _times(found, scenario.t_end))
    step = task.step or _step(scenario.model, found, first_run, scenario.t_end)
    if found and task.step is None:
        # rather a longer step, and an error bar that says so, than an end before the first contact
        step = max(step, 1.2 * found[0].end / MOST_STEPS)
    t_end = _end(found, step, scenario.t_end)
    if t_end < scenario.t_end:
        notes.append(f"exudyn stops at {t_end:.4g} s, to keep the number of its steps bearable")
    runs = []
    for h in (2.0 * step, step):
        task.progress(f"exudyn, step {h:.1e} s")
        runs.append(run_exudyn(task.exudyn_model, t_end, h, settings_for(task.exudyn_model)))
    coarse, fine = runs
    rows: list[Row] = []
    entry = max((_entry_error(scenario.model, touch) for touch in found[:1]), default=0.0) * fine.step
    for contact in dict.fromkeys(touch.contact for touch in found):
        rows += _contact_rows(
            contact, _pulls(scenario.model, contact), [x for x in found if x.contact == contact], ours, coarse, fine
        )
    rows += _state_rows(task, found, ours, coarse, fine)
    if entry > 0.0:
        rows = [replace(r, uncertainty=r.uncertainty + entry * _moved_by(r, ours, found[0])) for r in rows]
        notes.append(
            "the force jumps at first touch, but exudyn has it for the whole step of the touch or not at all: "
            f"{entry:.1e} of the speed at most, which is added to its uncertainty"
        )
    notes += [
        f"exudyn: generalized-alpha (index 3, spectral radius 0.9), steps {coarse.step:.1e} s and {fine.step:.1e} s; "
        "the uncertainty is how far its values moved when the step was halved",
        *fine.notes,
    ]
    return Comparison(
        "contact by force, like for like",
        tuple(rows),
        (*force_panels(task, found, ours, fine), residual_panel(first_run)),
        tuple(notes),
        (coarse.step, fine.step),
        fine.version,
        first_run.stats["wall_time"],
        coarse.wall_time + fine.wall_time,
        tuple(first_run.events),
        ours,
    )


def _end(found: list[Touch], step: float, t_end: float) -> float:
    """The end of exudyn's run: before the third contact, if it would take too many steps to go on."""
    if len(found) > 2 and t_end / step > MANY_STEPS:
        t_end = found[1].start + 0.9 * (found[2].start - found[1].start)
    return min(t_end, MOST_STEPS * step)


def _times(found: list[Touch], t_end: float) -> np.ndarray:
    """A grid over the run, dense in the first contacts."""
    grids = [np.linspace(0.0, t_end, SAMPLES)]
    for touch in found[:6]:
        margin = 0.25 * (touch.end - touch.start)
        grids.append(np.linspace(touch.start - margin, touch.end + margin, SAMPLES_IN_CONTACT))
        grids.append(np.array([touch.start, touch.end]))
    return np.concatenate(grids)


def _step(model: Model, found: list[Touch], run: Result, t_end: float) -> float:
    """Small enough for the shortest of the first contacts, and for exudyn's idea of the approach speed.

    exudyn takes that speed at the end of the step in which the touch falls, so that it is wrong by up to the
    acceleration times the step: an error of first order, and irregular (checked: halving the step changes it by
    any amount). It goes into the damping of all laws that know the approach speed.
    """
    limits = [t_end / 2000]
    for touch in found[:3]:
        limits.append((touch.end - touch.start) / STEPS_IN_CONTACT)
        k = int(np.searchsorted(run.t, touch.start)) - 1
        rate = run[f"{touch.contact}.gap_rate"]
        # without approach (a contact that starts closed) there is no speed to get wrong
        if k > 0 and run.t[k] > run.t[k - 1] and touch.approach_speed > 0.0:
            acceleration = abs(rate[k] - rate[k - 1]) / (run.t[k] - run.t[k - 1])
            limits.append(APPROACH_SPEED * touch.approach_speed / max(acceleration, 1e-12))
        limits.append(ENTRY / max(_entry_error(model, touch), 1e-12))
    return nice_step(min(limits))


def _moved_by(row: Row, ours: Result, touch: Touch) -> float:
    """How much a row's value changes for each unit of relative error of the speed after the touch: with its own size,
    and a place with the distance flown since then."""
    own = row.scale or abs(row.exudyn)
    body, _, name = row.channel.rpartition(".")
    rate = f"{body}.{RATES.get(name, '')}"
    if row.at is None or row.at <= touch.end or rate not in ours.channels:
        return own
    after = (ours.t >= touch.end) & (ours.t <= row.at)
    return max(own, float(np.abs(ours[rate][after]).max(initial=0.0)) * (row.at - touch.end))


def _entry_error(model: Model, touch: Touch) -> float:
    """Relative error of speed for each second of exudyn's step, from a damper that acts in full at first touch.

    Its force c v0 begins inside a step, but exudyn has it for all of the step or none: c v0 h of impulse at most,
    beside m v0. Halving the step does not show it, because it depends on where in the step the touch falls.
    """
    law = next(c.law for c in model.contacts if c.name == touch.contact)
    if not isinstance(law, KelvinVoigt):
        return 0.0
    return law.damping * (touch.approach_speed + touch.separation_speed) / touch.impulse


def _pulls(model: Model, contact: str) -> bool:
    """Whether the law of `contact` may pull before it lets go at zero penetration."""
    law = next(c.law for c in model.contacts if c.name == contact)
    return isinstance(law, ForceLaw) and law.release == "gap"


def _measure(t: np.ndarray, channels: Channels, contact: str, pulls: bool, number: int = 0) -> Quantities | None:
    """The quantities of contact `number`, or None if it does not begin and end in the samples.

    `pulls`: the contact lasts until the gap opens, though its force may pull before.
    """
    gap, rate, force = (channels[f"{contact}.{x}"] for x in ("gap", "gap_rate", "normal_force"))
    intervals = [i for i in contact_intervals(t, gap, rate) if i.end is not None]
    if len(intervals) <= number:
        return None
    interval = intervals[number] if pulls else released(t, force, intervals[number])
    inside = slice(max(interval.first - 1, 0), interval.last + 2)
    end = float(interval.end or 0.0)
    approach, separation = speeds(t, rate, interval)
    return Quantities(
        interval.start,
        approach,
        end - interval.start,
        peak(t[inside], force[inside])[1],
        impulse(t, force, interval),
        separation,
        end,
    )


def _contact_rows(
    contact: str, pulls: bool, found: list[Touch], ours: Result, coarse: ExudynResult, fine: ExudynResult
) -> list[Row]:
    touch, h = found[0], fine.step
    a, b = (_measure(r.t, r.channels, contact, pulls) for r in (coarse, fine))
    inside = (ours.t >= touch.start) & (ours.t <= touch.end)
    top = peak(ours.t[inside], ours[f"{contact}.normal_force"][inside])[1]
    if a is None or b is None:
        return [Row(f"{contact}: contacts in exudyn", "1", float(len(found)), 0.0, 0.0, "absolute")]

    def row(name: str, unit: str, value: float, tolerance: float, absolute: bool = False) -> Row:
        key = name.replace(" ", "_")
        x, y = getattr(a, key), getattr(b, key)
        kind = "absolute" if absolute else "relative"
        return Row(f"{contact}: {name}", unit, value, y, tolerance, kind, abs(x - y))  # type: ignore[arg-type]

    return [
        row("start", "s", touch.start, h, absolute=True),
        row("approach speed", "m/s", touch.approach_speed, STATE),
        row("duration", "s", touch.end - touch.start, 2.0 * h, absolute=True),
        row("peak force", "N", top, PEAK),
        row("impulse", "N s", touch.impulse, IMPULSE),
        row("separation speed", "m/s", touch.separation_speed, STATE),
    ]


def _state_rows(task: Task, found: list[Touch], ours: Result, coarse: ExudynResult, fine: ExudynResult) -> list[Row]:
    """State just before the second impact (or at the end), and the trajectories until then."""
    until = min(ours.t[-1], fine.t[-1])
    name = "at the end"
    if len(found) > 1:
        second = found[1]
        number = sum(x.contact == second.contact for x in found[:1])
        pulls = _pulls(task.scenario.model, second.contact)
        theirs = [_measure(r.t, r.channels, second.contact, pulls, number) for r in (coarse, fine)]
        # one common instant, before either of them touches
        until = min([second.start, until, *(q.start for q in theirs if q is not None)])
        name = "before the second impact"
    apart = np.ones(len(ours.t), dtype=bool)
    for touch in found[:1]:
        apart = (ours.t < touch.start - 2.0 * coarse.step) | (ours.t > touch.end + 2.0 * coarse.step)
    grid = ours.t[(ours.t <= until) & apart]
    if not grid.size:  # it starts in contact
        grid = ours.t[ours.t <= until]
    now = np.array([until])
    rows = []
    for channel in task.scenario.compare:
        if is_contact_channel(task, channel) or channel not in fine.channels:
            continue
        unit = unit_of(ours, channel)
        mine, *others = (
            float(at_times(t, channels, channel, now)[0])
            for t, channels in ((ours.t, _Lookup(ours)), (coarse.t, coarse.channels), (fine.t, fine.channels))
        )
        trajectory = _trajectory_row(channel, unit, ours, coarse, fine, grid)
        # relative to the value, but not where that passes through zero
        scale = max(abs(others[1]), trajectory.scale or 0.0) or None
        moved = abs(others[0] - others[1])
        title = f"{channel} {name} (t = {until:.5f} s)"
        rows.append(Row(title, unit, mine, others[1], STATE, "relative", moved, scale, channel=channel, at=until))
        rows.append(trajectory)
    return rows


def _trajectory_row(
    channel: str, unit: str, ours: Result, coarse: ExudynResult, fine: ExudynResult, grid: np.ndarray
) -> Row:
    """Where the trajectories differ most, outside the first contact (where an offset in time looks like one in y)."""
    mine = ours[channel][np.searchsorted(ours.t, grid)]
    theirs = at_times(fine.t, fine.channels, channel, grid)
    found = trajectory_difference(grid, mine, theirs)
    k = int(np.argmin(np.abs(grid - found.at)))
    moved = abs(float(at_times(coarse.t, coarse.channels, channel, grid[k : k + 1])[0]) - float(theirs[k]))
    return Row(
        f"{channel}, where it differs most (t = {found.at:.5f} s)",
        unit,
        float(mine[k]),
        float(theirs[k]),
        STATE,
        "relative",
        moved,
        found.scale or None,
        channel=channel,
        at=found.at,
    )


class _Lookup(dict[str, np.ndarray]):
    """Our result as a mapping of channels."""

    def __init__(self, result: Result) -> None:
        super().__init__({name: result[name] for name in result.channels})
