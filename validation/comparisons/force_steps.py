"""Steps and end of exudyn's runs in a comparison of contact by force."""

import numpy as np

from ...core import KelvinVoigt, Result
from ...core.multibody_model import Model
from .common import RATES, Row, Touch, nice_step

STEPS_IN_CONTACT = 200
APPROACH_SPEED = 5e-5
"""Largest relative error of the approach speed that exudyn may make (see `first_step`)."""
ENTRY = 2e-4
"""Largest relative error of speed that a force which jumps at first touch may make (see `entry_error`)."""
MANY_STEPS, MOST_STEPS = 300_000, 1_000_000
MOST_IN_PYTHON = 100_000
"""Steps with friction: exudyn then calls a function of ours in every one of them, often."""
SAMPLES, SAMPLES_IN_CONTACT = 2001, 1201
BEFORE_TOUCH = 1e-4
"""Of the finest step: how long before the touch an aligned step begins (see `aligned`)."""


def end_of(found: list[Touch], step: float, t_end: float) -> float:
    """The end of exudyn's run: before the third contact, if it would take too many steps to go on."""
    if len(found) > 2 and t_end / step > MANY_STEPS:
        t_end = found[1].start + 0.9 * (found[2].start - found[1].start)
    return min(t_end, MOST_STEPS * step)


def sample_times(found: list[Touch], t_end: float) -> np.ndarray:
    """A grid over the run, dense in the first contacts."""
    grids = [np.linspace(0.0, t_end, SAMPLES)]
    for touch in found[:6]:
        margin = 0.25 * (touch.end - touch.start)
        grids.append(np.linspace(touch.start - margin, touch.end + margin, SAMPLES_IN_CONTACT))
        grids.append(np.array([touch.start, touch.end]))
    return np.concatenate(grids)


def first_step(model: Model, found: list[Touch], run: Result, t_end: float) -> float:
    """Small enough for the shortest of the first contacts, and for exudyn's idea of the approach speed.

    exudyn takes that speed at the end of the step in which the touch falls, so that it is wrong by up to the
    acceleration times the step: an error of first order, and irregular (checked: halving the step changes it by
    any amount). It goes into the damping of all laws that know the approach speed.
    """
    limits = [t_end / 2000]
    for touch in found[:3]:
        if touch.end > touch.start:
            limits.append((touch.end - touch.start) / STEPS_IN_CONTACT)
        k = int(np.searchsorted(run.t, touch.start)) - 1
        rate = run[f"{touch.contact}.gap_rate"]
        # without approach (a contact that starts closed) there is no speed to get wrong
        if k > 0 and run.t[k] > run.t[k - 1] and touch.approach_speed > 0.0:
            acceleration = abs(rate[k] - rate[k - 1]) / (run.t[k] - run.t[k - 1])
            limits.append(APPROACH_SPEED * touch.approach_speed / max(acceleration, 1e-12))
        if not jumps(model, found):
            limits.append(ENTRY / max(entry_error(model, touch), 1e-12))
    return nice_step(min(limits))


def moved_by(row: Row, ours: Result, touch: Touch) -> float:
    """How much a row's value changes for each unit of relative error of the speed after the touch: with its own size,
    and a place with the distance flown since then."""
    own = row.scale or abs(row.exudyn)
    if row.at is None and row.unit in ("m/s", "rad/s"):
        own = max(own, touch.approach_speed)  # what is missed is a part of the speed that comes
    body, _, name = row.channel.rpartition(".")
    rate = f"{body}.{RATES.get(name, '')}"
    if row.at is None or row.at <= touch.end or rate not in ours.channels:
        return own
    after = (ours.t >= touch.end) & (ours.t <= row.at)
    return max(own, float(np.abs(ours[rate][after]).max(initial=0.0)) * (row.at - touch.end))


def entry_error(model: Model, touch: Touch) -> float:
    """Relative error of speed for each second of exudyn's step, from a damper that acts in full at first touch.

    Its force c v0 begins inside a step, but exudyn has it for all of the step or none: c v0 h of impulse at most,
    beside m v0. Halving the step does not show it, because it depends on where in the step the touch falls.
    """
    law = next(c.law for c in model.contacts if c.name == touch.contact)
    if not isinstance(law, KelvinVoigt) or not touch.impulse > 0.0:
        return 0.0
    return law.damping * (touch.approach_speed + touch.separation_speed) / touch.impulse


def jumping_touches(model: Model, found: list[Touch]) -> list[Touch]:
    """The first touch of every contact, where its force jumps."""
    first = {x.contact: x for x in reversed(found)}.values()
    return [x for x in first if x.approach_speed > 0.0 and entry_error(model, x) > 0.0]


def entry_bar(row: Row, model: Model, jumping: list[Touch], ours: Result, step: float) -> float:
    """What the jumps before a row's time add to its error bar, with exudyn's `step` (s)."""
    before = [x for x in jumping if row.at is None or row.at >= x.start]
    return sum(entry_error(model, x) * step * moved_by(row, ours, x) for x in before)


def most_steps(model: Model) -> int:
    """To which exudyn's step is halved at most."""
    return MOST_IN_PYTHON if any(c.friction is not None for c in model.contacts) else MOST_STEPS


def jumps(model: Model, found: list[Touch]) -> bool:
    """Whether the first contact's force jumps at the touch, and comes to zero by itself at the end."""
    laws = [c.law for c in model.contacts if found and c.name == found[0].contact]
    strikes = bool(found) and found[0].approach_speed > 0.0
    return strikes and any(isinstance(law, KelvinVoigt) and law.release == "force" for law in laws)


def aligned(step: float, touch: Touch, finest: float) -> float:
    """The step (s) near `step` that begins just before the touch, as its half and quarter then do too.

    A force that jumps at the touch is then had for the same part of a step on every grid: a regular error of first
    order, which Richardson's extrapolation removes. Where in a step the touch falls would else make it irregular.
    """
    if touch.start <= step:
        return step
    return (touch.start - BEFORE_TOUCH * finest) / round(touch.start / step)
