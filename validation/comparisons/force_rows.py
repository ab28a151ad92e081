"""What is measured of contacts by force, on both sides and on exudyn's three finest grids, and the rows of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from ...core import ForceLaw, Result
from ...core.multibody_model import Model
from ..exudyn_run import ExudynResult
from ..metrics import contact_intervals, impulse, peak, released, speeds, trajectory_difference
from .common import (
    Row,
    Task,
    Touch,
    at_times,
    contact_units,
    course_scale,
    is_contact_channel,
    own_bar,
    touches,
    unit_of,
)
from .contact_count import contact_count

RELATIVE = 1e-4
Channels = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Levels:
    """exudyn's runs, each with half the step of the one before.

    extrapolated : if their error is regular and of first order, so that Richardson's extrapolation holds.
    """

    runs: tuple[ExudynResult, ...]
    extrapolated: bool = False

    @property
    def fine(self) -> ExudynResult:
        return self.runs[-1]

    def value(self, values: Sequence[np.ndarray]) -> np.ndarray:
        """Of the finest run, or extrapolated to step zero."""
        a, b = values[-2:]
        return 2.0 * b - a if self.extrapolated else b

    def bar(self, values: Sequence[np.ndarray]) -> np.ndarray:
        """Richardson's estimate of the error, for first order: entry and exit of a contact leave no more.

        Not extrapolated: the last change of the value, or half of the one before, whichever is larger, because what
        depends on where in a step the touch falls may stand still once by chance. Extrapolated: what that moved.
        """
        a, b, c = values[-3:]
        if self.extrapolated:
            return np.abs((2.0 * c - b) - (2.0 * b - a))
        return np.maximum(np.abs(c - b), 0.5 * np.abs(b - a))


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


@dataclass(frozen=True)
class Sides:
    """What is compared: our run, the same with looser tolerances (for our error bar), and exudyn's."""

    task: Task
    found: list[Touch]
    ours: Result
    loose: Result
    levels: Levels


def force_rows(sides: Sides) -> list[Row]:
    """First contact of every contact element, state before the second impact, trajectories until then."""
    rows: list[Row] = []
    for contact in dict.fromkeys(touch.contact for touch in sides.found):
        rows += contact_count(sides, contact) or _contact_rows(sides, contact)
    return rows + _state_rows(sides)


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


def _pulls(model: Model, contact: str) -> bool:
    """Whether the law of `contact` may pull before it lets go at zero penetration."""
    law = next(c.law for c in model.contacts if c.name == contact)
    return isinstance(law, ForceLaw) and not law.never_pulls


def _contact_rows(sides: Sides, contact: str) -> list[Row]:
    pulls = _pulls(sides.task.scenario.model, contact)
    mine = _own(sides.ours, sides.found, contact)
    other = _own(sides.loose, touches(sides.loose.events), contact) or mine
    theirs = [_measure(r.t, r.channels, contact, pulls) for r in sides.levels.runs]
    if mine is None or other is None:
        return []
    if any(q is None for q in theirs):
        return []
    own = contact_units(sides.ours, contact)
    units = {"start": "s", "approach_speed": own.speed, "duration": "s", "peak_force": own.force,
             "impulse": own.impulse, "separation_speed": own.speed}  # fmt: skip
    rows = []
    for field in fields(Quantities)[:-1]:
        values = [np.asarray(getattr(q, field.name)) for q in theirs]
        a, b = getattr(mine, field.name), getattr(other, field.name)
        # a contact that is there at the start has no time of its own to be relative to
        scale = max(mine.start, mine.duration) if field.name == "start" else None
        rows.append(
            Row(f"{contact}: {field.name.replace('_', ' ')}", units[field.name], a, float(sides.levels.value(values)),
                RELATIVE, "relative", float(sides.levels.bar(values)), scale, ours_uncertainty=float(own_bar(a, b)))
        )  # fmt: skip
    return rows


def _own(run: Result, found: list[Touch], contact: str) -> Quantities | None:
    """Our quantities of a contact: from its events, which are located, not sampled."""
    touch = next((x for x in found if x.contact == contact), None)
    if touch is None:
        return None
    inside = (run.t >= touch.start) & (run.t <= touch.end)
    top = peak(run.t[inside], run[f"{contact}.normal_force"][inside])[1]
    return Quantities(
        touch.start, touch.approach_speed, touch.end - touch.start, top, touch.impulse, touch.separation_speed,
        touch.end,
    )  # fmt: skip


def _state_rows(sides: Sides) -> list[Row]:
    """State just before the second impact (or at the end), and the trajectories until then."""
    task, found, ours, runs = sides.task, sides.found, sides.ours, sides.levels.runs
    fine = sides.levels.fine
    until = min(ours.t[-1], *(r.t[-1] for r in runs))
    name = "at the end"
    if len(found) > 1:
        second = found[1]
        number = sum(x.contact == second.contact for x in found[:1])
        pulls = _pulls(task.scenario.model, second.contact)
        theirs = [_measure(r.t, r.channels, second.contact, pulls, number) for r in runs]
        # one common instant, before either of them touches: the step of the touch bends
        until = min([second.start, until, *(q.start for q in theirs if q is not None)]) - runs[0].step
        name = "before the second impact"
    apart = np.ones(len(ours.t), dtype=bool)
    for touch in found[:1]:
        apart = (ours.t < touch.start - 2.0 * runs[-2].step) | (ours.t > touch.end + 2.0 * runs[-2].step)
    grid = ours.t[(ours.t <= until) & apart]
    if not grid.size:  # it starts in contact
        grid = ours.t[ours.t <= until]
    rows = []
    for channel in task.scenario.compare:
        if is_contact_channel(task, channel) or channel not in fine.channels:
            continue
        unit, (mine, other, theirs_at) = unit_of(ours, channel), _values(sides, channel, grid)
        value, bar = sides.levels.value(theirs_at), sides.levels.bar(theirs_at)
        worst = trajectory_difference(grid, mine, value)
        now, late, at_end = _values(sides, channel, np.array([until]))
        end = float(sides.levels.value(at_end)[0])
        # relative to the value, but not where that passes through zero
        scale = course_scale(sides.ours, channel, max(abs(end), worst.scale))
        title = f"{channel} {name} (t = {until:.5f} s)"
        rows.append(
            Row(title, unit, float(now[0]), end, RELATIVE, "relative", float(sides.levels.bar(at_end)[0]), scale,
                ours_uncertainty=float(own_bar(now, late)[0]), channel=channel, at=float(until))
        )  # fmt: skip
        # outside the first contact, where an offset in time looks like one in the value
        k = int(np.argmin(np.abs(grid - worst.at)))
        title = f"{channel}, where it differs most (t = {worst.at:.5f} s)"
        rows.append(
            Row(title, unit, float(mine[k]), float(value[k]), RELATIVE, "relative", float(bar[k]),
                course_scale(sides.ours, channel, worst.scale), ours_uncertainty=float(own_bar(mine[k], other[k])),
                channel=channel, at=worst.at)
        )  # fmt: skip
    return rows


def _values(sides: Sides, channel: str, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """A channel at `times`: ours, ours with looser tolerances, exudyn's."""
    ours, loose = (at_times(r.t, _Lookup(r), channel, times) for r in (sides.ours, sides.loose))
    return ours, loose, [at_times(r.t, r.channels, channel, times) for r in sides.levels.runs]


class _Lookup(dict[str, np.ndarray]):
    """Our result as a mapping of channels."""

    def __init__(self, result: Result) -> None:
        super().__init__({name: result[name] for name in result.channels})
