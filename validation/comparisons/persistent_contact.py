"""Contacts that stay closed or rub as constraints, against the limit of penalty and regularised friction.

exudyn has neither. But a damper c = m/T with a weak spring k = r c, let go when it would pull, stops a mass m within T
and gives back r T of its speed: it tends to an impact without rebound and to the contact that holds on after it as T
shrinks (it must not pull: a corner that another one lifts off would be held back by an impulse that does not shrink).
Coulomb's friction sticks by a critically damped spring of the frequency 1/T and slides as it is. So every quantity is
a + b T + c T^2 + ..., and a is what the constraint must give. Contacts with restitution get Gonthier's law with a
duration in proportion to T. What differs is asked again with half the last T, and only a limit that has been found
twice can differ.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...core import Result
from ...core.elements import FlexibleBody
from ...core.laws import Gonthier, ImpactLaw, KelvinVoigt
from ...core.laws.friction import CoulombFriction
from ...core.multibody_model import Model
from ..exudyn_run import ExudynResult, run_exudyn, settings_for
from ..metrics import trajectory_difference
from ..translation.formulas import StickingCoulomb
from .common import (
    Comparison,
    Curve,
    Panel,
    Row,
    Task,
    Touch,
    at_times,
    blows,
    course_scale,
    energy_panel,
    is_contact_channel,
    our_error,
    our_run,
    residual_panel,
    touches,
    unit_of,
)
from .events import away_from
from .penalty_limit import latest_limit, unless_sure
from .reversal import first_reversal

TIMES = (1.0, 0.5, 0.25)
"""The times T, in parts of the longest one."""
LONGEST_TIME = 1.0 / 3000.0
"""In parts of the run."""
RETURN_RATE = 20.0
"""The least r, in parts of 1/(length of the run)."""
FLEXIBLE_RETURN_RATE = 400.0
"""The same on flexible bodies: at their contacts is next to no mass, so that little is given back, but the spring that
follows from it has to hold what bends the whole body."""
STEPS_IN_TIME, FLEXIBLE_STEPS_IN_TIME = 7.0, 3.0
"""exudyn's steps in T. A blow begins anywhere in a step: the rates after it have irregular errors that shrink not with
T but with the step in T: 0.5 % with 3 steps, 0.09 % with 5, 0.05 % with 7 (`rocking_block`, against Housner's
block)."""
WEIGHTS = 8.0 / 3.0 + 2.0 + 1.0 / 3.0
"""Sum of the weights with which the three T enter the extrapolation, and the irregular errors of blows with them."""
DURATION = 10.0
"""Of a contact with restitution, in T."""
LOWEST_RESTITUTION = 0.05
STATE = 1e-3
SAMPLES = 1501


@dataclass(frozen=True)
class Scale:
    """What the penalty laws of one contact are made of: effective mass (kg), approach speed (m/s), mean load (N)."""

    mass: float
    approach: float
    load: float = 0.0
    struck: bool = True
    """Whether there is a blow of it in the run; without one its restitution says nothing."""

    def return_rate(self, least: float) -> float:
        """r, 1/s: at least so large that the load sinks no deeper than the blow, N T/(r m) <= v T."""
        return max(least, self.load / (self.mass * self.approach))


@dataclass(frozen=True)
class Limits:
    """exudyn's runs with three or four times T (s), and the last or all of them with twice the step: all in a run
    without blows. What a step changes is then regular, and most of it leaves with T."""

    times: list[float]
    runs: list[ExudynResult]
    coarse: list[ExudynResult]

    def of(self, channel: str, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The limit of a channel at the times `t`, and its uncertainty."""
        values, coarse = (
            np.array([at_times(r.t, r.channels, channel, t) for r in runs]) for runs in (self.runs, self.coarse)
        )
        limit, moved = latest_limit(np.array(self.times), values)
        if len(coarse) == len(values):
            return limit, moved + np.abs(latest_limit(np.array(self.times), coarse)[0] - limit)
        return limit, moved + WEIGHTS * np.abs(coarse[-1] - values[-1])


def persists(model: Model) -> bool:
    """Whether a contact of the model holds on after its impacts, or rubs with Coulomb's friction."""
    return any(
        isinstance(c.law, ImpactLaw)
        and (c.law.restitution < LOWEST_RESTITUTION or isinstance(c.friction, CoulombFriction))
        for c in model.contacts
    )


def compare_persistent(task: Task) -> Comparison:
    """Trajectories over the whole run, away from the impacts, and the impulse of every contact at its end."""
    scenario = task.scenario
    task.progress("our run")
    first_run = our_run(scenario)
    ours = our_run(scenario, np.linspace(0.0, scenario.t_end, SAMPLES))
    found = touches(first_run.events)
    flexible = any(isinstance(b, FlexibleBody) for b in task.exudyn_model.bodies)
    loads = {c.name: 0.0 if flexible else _load(ours[f"{c.name}.normal_force"]) for c in scenario.model.contacts}
    scales = {c.name: _scale(scenario.model, c, found, loads[c.name]) for c in scenario.model.contacts}
    steps_in_time = FLEXIBLE_STEPS_IN_TIME if flexible else STEPS_IN_TIME
    longest = (task.step or 0.0) * steps_in_time or LONGEST_TIME * scenario.t_end
    rate = (FLEXIBLE_RETURN_RATE if flexible else RETURN_RATE) / scenario.t_end
    events = [e for e in first_run.events if e.kind != "graze"]
    struck = any(e.impulse > 0.0 for e in events)
    times = [share * longest for share in TIMES]

    def run(time: float, factor: float = 1.0) -> ExudynResult:
        model = with_time(task.exudyn_model, scales, time, rate)
        step = factor * time / steps_in_time
        task.progress(f"exudyn, T = {time:.1e} s, step {step:.1e} s")
        return run_exudyn(model, scenario.t_end, step, settings_for(model))

    limits = Limits(
        times, [run(time) for time in times], [run(time, 2.0) for time in (times[-1:] if struck else times)]
    )
    channels = [c for c in scenario.compare if not is_contact_channel(task, c) and c in limits.runs[0].channels]
    error = our_error(task, ours, [*channels, *(f"{c.name}.impulse" for c in scenario.model.contacts)])
    margin = 3.0 * DURATION * longest if flexible else DURATION * longest

    def compared(limits: Limits) -> list[Row]:
        return _rows(task, first_run, ours, limits, away_from(ours.t, events, limits.runs, margin), channels, error)

    limits, rows = _confirmed(limits, compared, run)
    times, runs = limits.times, limits.runs
    stepped = (
        f"what twice the step changes in the last run, {WEIGHTS:g} times for the three T (a blow begins anywhere in a "
        "step: irregular and of first order)"
        if struck
        else "what twice the step changes in it"
    )
    notes = (
        "the constraint is compared with the limit of a damper with a weak spring that does not pull (restitution "
        f"below {LOWEST_RESTITUTION:g}, or no blow), of Gonthier's law (else) and of sticking by a stiff spring, "
        f"extrapolated in the time T that a contact takes: {', '.join(f'{x:.1e}' for x in times)} s. exudyn's "
        f"uncertainty is the difference of the quadratic and the linear extrapolation, and {stepped}"
        + (", and how far the limit of the last three T has moved with the last of them" if len(times) > 3 else ""),
        *runs[-1].notes,
    )
    panels = _panels(task, ours, runs, times, channels)
    return Comparison(
        "persistent contact as a constraint, against the limit of a stiff contact",
        tuple(rows),
        (*panels, energy_panel(first_run), residual_panel(first_run)),
        notes,
        tuple(r.step for r in runs),
        runs[-1].version,
        first_run.stats["wall_time"],
        sum(r.wall_time for r in runs),
        events=tuple(first_run.events),
        result=ours,
    )


def _rows(
    task: Task,
    first_run: Result,
    ours: Result,
    limits: Limits,
    away: np.ndarray,
    channels: list[str],
    error: dict[str, np.ndarray],
) -> list[Row]:
    """All that is compared; what comes after a reversal of friction cannot be."""
    model, rows = task.scenario.model, []
    turned = first_reversal(model, first_run)
    until = task.scenario.t_end if turned is None else turned.t
    reason = "" if turned is None else turned.text()
    for channel in channels:
        rows += _channel_rows(channel, ours, away & (ours.t < until), limits, error.get(channel), "")
        if reason:
            rows += _channel_rows(channel, ours, away & (ours.t > until), limits, error.get(channel), reason)
    for contact in model.contacts:
        channel = f"{contact.name}.impulse"
        limit, moved = limits.of(channel, ours.t[-1:])
        own = error.get(channel)
        rows.append(
            Row(f"{contact.name}: impulse of the whole run", unit_of(ours, channel), float(ours[channel][-1]),
                float(limit[0]), STATE, "relative", float(moved[0]), required=not reason, reason=reason,
                ours_uncertainty=0.0 if own is None else own[-1])
        )  # fmt: skip
    return rows


def _confirmed(
    limits: Limits, compared: Callable[[Limits], list[Row]], run: Callable[..., ExudynResult]
) -> tuple[Limits, list[Row]]:
    """The rows; where one differs with a fourth T, and with the reason where that leaves it open."""
    rows = compared(limits)
    if not any(row.verdict == "differ" for row in rows):
        return limits, rows
    time = 0.5 * limits.times[-1]
    coarse = [*(limits.coarse if len(limits.coarse) > 1 else []), run(time, 2.0)]
    limits = replace(limits, times=[*limits.times, time], runs=[*limits.runs, run(time)], coarse=coarse)
    doubt = (
        f"the limit of short contacts is not reached: T goes down to {time:.1e} s, and the limit still moves, or lies "
        "too near to ours, to call a difference one of the models"
    )
    return limits, unless_sure(compared(limits), True, doubt)


def with_time(model: Model, scales: dict[str, Scale], time: float, rate: float) -> Model:
    """`model` with every constraint contact as a force that takes `time` (s) to stop its mass; `rate` is r, 1/s."""
    contacts = []
    for contact in model.contacts:
        update: dict[str, Any] = {}
        if isinstance(contact.law, ImpactLaw):
            scale = scales[contact.name]
            update["law"], update["compliance"] = _law(contact.law.restitution, scale, time, rate), 1.0
            if isinstance(contact.friction, CoulombFriction):
                mu, static = contact.friction.coefficient, contact.friction.sticking_coefficient
                spring, damper = scale.mass / time**2, 2.0 * scale.mass / time
                update["friction"] = StickingCoulomb(mu, static, spring, damper)
        contacts.append(contact.model_copy(update=update))
    return model.model_copy(update={"contacts": tuple(contacts), "parameters": ()})


def _law(restitution: float, scale: Scale, time: float, rate: float) -> KelvinVoigt | Gonthier:
    if restitution < LOWEST_RESTITUTION or not scale.struck:
        return KelvinVoigt(stiffness=scale.return_rate(rate) * scale.mass / time, damping=scale.mass / time)
    # Hertz' duration 2.943 d/v of an impact with m v^2/2 = K d^2.5/2.5
    depth = DURATION * time * scale.approach / 2.943
    return Gonthier(stiffness=1.25 * scale.mass * scale.approach**2 / depth**2.5, restitution=restitution)


def _load(force: np.ndarray) -> float:
    """Mean of a contact's normal force while it presses, N."""
    pressing = force[force > 0.0]
    return float(np.mean(pressing)) if pressing.size else 0.0


def _scale(model: Model, contact: Any, found: list[Touch], load: float) -> Scale:
    struck = blows(found)
    # a contact that is never struck is scaled by the others
    own = [x for x in struck if x.contact == contact.name] or struck
    masses = [x.impulse / (x.approach_speed + x.separation_speed) for x in own]
    bodies = {marker.body for marker in contact.markers()}
    carried = [getattr(b, "mass", None) for b in model.bodies if b.name in bodies]
    lightest = min((m for m in carried if isinstance(m, float) and m > 0.0), default=1.0)
    fastest, alone = max((x.approach_speed for x in own), default=1.0), all(x.contact != contact.name for x in struck)
    return Scale(max(masses, default=lightest), fastest, load, not alone)


def _channel_rows(
    channel: str,
    ours: Result,
    away: np.ndarray,
    limits: Limits,
    error: np.ndarray | None,
    reason: str,
) -> list[Row]:
    t = ours.t[away]
    if not t.size:
        return []
    limit, moved = limits.of(channel, t)
    mine, own = ours[channel][away], np.zeros(len(t)) if error is None else error[away]
    found = trajectory_difference(t, mine, limit)
    worst = int(np.argmin(np.abs(t - found.at)))
    unit, scale, rows = unit_of(ours, channel), course_scale(ours, channel, found.scale), []
    last = "at the end" if t[-1] > 0.99 * ours.t[-1] else "before its last impact that can be compared"
    for k, name in ((len(t) - 1, last), (worst, "where it differs most")):
        title = f"{channel} {name} (t = {t[k]:.5g} s)"
        rows.append(
            Row(title, unit, float(mine[k]), float(limit[k]), STATE, "relative", float(moved[k]),
                scale, ours_uncertainty=float(own[k]), channel=channel, at=float(t[k]), reason=reason,
                required=not reason)
        )  # fmt: skip
    return rows


def _panels(task: Task, ours: Result, runs: list[ExudynResult], times: list[float], channels: list[str]) -> list[Panel]:
    panels = []
    wanted = [*channels, *(f"{c.name}.impulse" for c in task.scenario.model.contacts[:3])]
    for channel in wanted:
        curves = [Curve("tlismni, constraint", ours.t, ours[channel], True)]
        for run, time in zip(runs, times, strict=True):
            keep = slice(None, None, max(1, len(run.t) // 4000))
            curves.append(Curve(f"exudyn, T = {time:.0e} s", run.t[keep], run[channel][keep], False))
        panels.append(Panel(channel, unit_of(ours, channel), tuple(curves)))
    return panels
