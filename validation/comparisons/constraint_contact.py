"""Contact as a constraint against the penalty limit: exudyn with three growing stiffnesses, extrapolated.

exudyn has no unilateral constraints and no impact law. But a force law whose rebound is exactly e tends to the
impact with restitution e as its stiffness K grows: with F = K d^n (1 + D d'/v0) and D the exact root for e
(Gonthier), duration and depth of the contact fall as x = K^(-1/(n+1)), and with them what gravity and the motion
add during it. So every quantity is a + b x + c x^2 + ..., and a is what the constraint must give.

exudyn's steps are the same part of a contact for every stiffness, so that they change the limit as much as one run:
what twice the step changes with the softest contact goes into the error bar, beside what the extrapolation leaves open.
"""

from dataclasses import dataclass

import numpy as np

from ...core import Gonthier, NewtonImpact, Result
from ...core.description import Model
from ..errors import NotTranslatable
from ..exudyn_run import ExudynResult, run_exudyn, settings_for
from ..metrics import ContactInterval, contact_intervals, impulse, power_limit, speeds
from .common import (
    Comparison,
    Curve,
    Panel,
    Row,
    Task,
    Touch,
    at_times,
    course_scale,
    energy_panel,
    is_contact_channel,
    nice_step,
    our_looser_run,
    our_run,
    own_bar,
    residual_panel,
    touches,
    unit_of,
)
from .toggled import toggled_rows

STIFFNESSES = (1e6, 1e7, 1e8)
EXPONENT = 1.5
STEPS_IN_CONTACT = 100
MOST_HALVINGS = 2
"""Of exudyn's steps, while an error bar is above the tolerance."""
LOWEST_RESTITUTION = 0.05
RELATIVE = 1e-3
"""Tolerance of every quantity against the extrapolated limit."""
SAMPLES = 2001


@dataclass(frozen=True)
class PenaltyRun:
    """A run of exudyn with one stiffness, and its contacts in time."""

    stiffness: float
    result: ExudynResult
    contacts: list[tuple[str, ContactInterval]]

    @property
    def x(self) -> float:
        return float(self.stiffness ** (-1.0 / (EXPONENT + 1.0)))


@dataclass(frozen=True)
class Sides:
    """What is compared: our run on a grid, the same with looser tolerances, exudyn's of growing stiffness, and one of
    the softest with twice the step."""

    task: Task
    found: list[Touch]
    ours: Result
    loose: Result
    runs: list[PenaltyRun]
    doubled: PenaltyRun

    def limit(self, values: list[np.ndarray], doubled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(the limit, its error bar) of values, one for each run."""
        found, open_ = power_limit(np.array([r.x for r in self.runs]), np.array(values))
        return found, open_ + np.abs(values[0] - doubled)


def compare_constraints(task: Task) -> Comparison:
    """First impact, flight after it, state before the second impact.

    Raises
    ------
    NotTranslatable : for restitution below LOWEST_RESTITUTION (the contact persists, a penalty rings in it).
    """
    scenario = task.scenario
    task.progress("our run")
    first_run = our_run(scenario)
    found = touches(first_run.events)
    if not found:
        raise NotTranslatable(f"scenario '{scenario.name}' has no impact before {scenario.t_end:g} s: none to compare")
    t_end = _end(found, scenario.t_end)
    ours = our_run(scenario, np.linspace(0.0, scenario.t_end, SAMPLES))
    loose = our_looser_run(task, ours.t)
    step = min(task.step or np.inf, nice_step(contact_step(found[0], STIFFNESSES[0])))
    for _ in range(1 + MOST_HALVINGS):
        *runs, doubled = (_penalty_run(task, k, t_end, h) for k, h in _plan(step))
        rows = _rows(Sides(task, found, ours, loose, runs, doubled))
        if task.settled(rows):
            break
        step *= 0.5
    rows += toggled_rows(task, found[0], first_run)
    notes = (
        "the constraint is compared with the limit of Gonthier's law with exact restitution, "
        f"K = {', '.join(f'{k:.0e}' for k in STIFFNESSES)} N/m^1.5, extrapolated in K^(-0.4); exudyn's error bar is "
        "the difference of the quadratic and the linear extrapolation, and what twice the step changes",
        "force histories of a rigid impact are not compared: a constraint has none, a penalty's is its stiffness",
        *runs[-1].result.notes,
    )
    return Comparison(
        "contact as a constraint, against the penalty limit",
        tuple(rows),
        (
            *_panels(task, found, first_run, ours, runs),
            energy_panel(first_run),
            residual_panel(first_run),
        ),
        notes,
        tuple(r.result.step for r in (*runs, doubled)),
        runs[-1].result.version,
        first_run.stats["wall_time"],
        sum(r.result.wall_time for r in (*runs, doubled)),
        tuple(first_run.events),
        ours,
    )


def _rows(sides: Sides) -> list[Row]:
    runs = [*sides.runs, sides.doubled]
    if all(r.contacts for r in runs):
        return _impact_rows(sides) + _flight_rows(sides)
    missing = [f"{r.stiffness:.0e}" for r in runs if not r.contacts]
    return [Row(f"runs of exudyn without contact (K = {missing})", "1", 0.0, float(len(missing)), 0.0, "absolute")]


def with_stiffness(model: Model, stiffness: float) -> Model:
    """`model` with every constraint contact replaced by the force law with the same restitution.

    Raises NotTranslatable for a restitution that the force law cannot have.
    """
    contacts = []
    for contact in model.contacts:
        law = contact.law
        if isinstance(law, NewtonImpact):
            if law.restitution < LOWEST_RESTITUTION:
                raise NotTranslatable(
                    f"contact '{contact.name}' has restitution {law.restitution:g}; below {LOWEST_RESTITUTION:g} the "
                    "contact persists and a penalty force rings in it, so there is no limit to compare with"
                )
            law = Gonthier(stiffness=stiffness, restitution=law.restitution, exponent=EXPONENT)
        contacts.append(contact.model_copy(update={"law": law}))
    # a restitution is no parameter of every law; the copy is for exudyn only
    return model.model_copy(update={"contacts": tuple(contacts), "parameters": ()})


def _end(found: list[Touch], t_end: float) -> float:
    """Shortly before the third impact: what comes after adds nothing but time."""
    return min(t_end, found[1].start + 0.9 * (found[2].start - found[1].start)) if len(found) > 2 else t_end


def contact_step(first: Touch, stiffness: float) -> float:
    """A step (s) that resolves a contact, from Hertz' duration with the effective mass of our impact."""
    mass = first.impulse / (first.approach_speed + first.separation_speed)
    depth = ((EXPONENT + 1.0) * mass * first.approach_speed**2 / (2.0 * stiffness)) ** (1.0 / (EXPONENT + 1.0))
    return 2.94 * depth / first.approach_speed / STEPS_IN_CONTACT


def _plan(step: float) -> list[tuple[float, float]]:
    """Stiffness and step of each run: in proportion to the contact's duration, and the first with twice the step."""
    softest = STIFFNESSES[0]
    runs = [(k, step * (k / softest) ** (-1.0 / (EXPONENT + 1.0))) for k in STIFFNESSES]
    return [*runs, (softest, 2.0 * step)]


def _penalty_run(task: Task, stiffness: float, t_end: float, step: float) -> PenaltyRun:
    task.progress(f"exudyn, K = {stiffness:.0e} N/m^1.5, step {step:.1e} s")
    result = run_exudyn(with_stiffness(task.exudyn_model, stiffness), t_end, step, settings_for(task.exudyn_model))
    return PenaltyRun(stiffness, result, _contacts(task, result))


def _contacts(task: Task, result: ExudynResult) -> list[tuple[str, ContactInterval]]:
    found = []
    for contact in task.exudyn_model.contacts:
        intervals = contact_intervals(result.t, result[f"{contact.name}.gap"], result[f"{contact.name}.gap_rate"])
        found += [(contact.name, i) for i in intervals]
    return sorted(found, key=lambda pair: pair[1].start)


def _impact_rows(sides: Sides) -> list[Row]:
    first = sides.found[0]
    again = next((x for x in touches(sides.loose.events) if x.contact == first.contact), first)
    *values, doubled = (_impact(run) for run in (*sides.runs, sides.doubled))
    limit, bar = sides.limit(values, doubled)
    names = (
        ("time of the first impact", "s", first.start, again.start),
        ("approach speed", "m/s", first.approach_speed, again.approach_speed),
        ("impulse", "N s", first.impulse, again.impulse),
        ("separation speed", "m/s", first.separation_speed, again.separation_speed),
    )
    return [
        Row(f"{first.contact}: {name}", unit, ours, float(limit[k]), RELATIVE, "relative", float(bar[k]),
            ours_uncertainty=float(own_bar(ours, loose)))
        for k, (name, unit, ours, loose) in enumerate(names)
    ]  # fmt: skip


def _impact(run: PenaltyRun) -> np.ndarray:
    """(start, approach speed, impulse, separation speed) of the first contact."""
    (name, interval), r = run.contacts[0], run.result
    approach, separation = speeds(r.t, r[f"{name}.gap_rate"], interval)
    pushed = impulse(r.t, r[f"{name}.normal_force"], interval)
    return np.array([interval.start, approach, pushed, separation])


def _flight_rows(sides: Sides) -> list[Row]:
    """Trajectories in free flight after the first impact, and the state where it ends; pointwise in the limit."""
    task, found, ours, loose = sides.task, sides.found, sides.ours, sides.loose
    runs = [*sides.runs, sides.doubled]
    released = max(float(r.contacts[0][1].end or r.result.t[-1]) for r in runs)
    ends = [r.contacts[1][1].start if len(r.contacts) > 1 else r.result.t[-1] for r in runs]
    until = min([*ends, found[1].start if len(found) > 1 else np.inf])
    if until <= released:
        return []
    inside = (ours.t > released) & (ours.t < until)
    flight = ours.t[inside]
    ending = "before the second impact" if len(found) > 1 else "at the end"
    rows = []
    if len(found) > 1 and all(len(r.contacts) > 1 for r in runs):
        *values, doubled = (np.array([r.contacts[1][1].start]) for r in runs)
        start, bar = sides.limit(values, doubled)
        again = [x.start for x in touches(loose.events)[1:2]] or [found[1].start]
        rows.append(
            Row(f"{found[1].contact}: time of the second impact", "s", found[1].start, float(start[0]), RELATIVE,
                "relative", float(bar[0]), ours_uncertainty=float(own_bar(found[1].start, again[0])))
        )  # fmt: skip
    for channel in task.scenario.compare:
        if channel not in runs[0].result.channels or is_contact_channel(task, channel):
            continue
        unit = unit_of(ours, channel)
        *values, doubled = (at_times(r.result.t, r.result.channels, channel, flight) for r in runs)
        limit, bar = sides.limit(values, doubled)
        mine = ours[channel][inside]
        own = own_bar(mine, loose[channel][inside]) if len(loose.t) == len(ours.t) else np.zeros(len(mine))
        # in a short flight little moves: then a part of the motion of the whole run counts
        own_scale = max(0.5 * float(np.ptp(limit)), 0.05 * float(np.ptp(ours[channel])))
        scale = course_scale(ours, channel, own_scale)
        worst = int(np.argmax(np.abs(mine - limit)))
        for k, name in ((len(flight) - 1, ending), (worst, "where it differs most in flight")):
            title = f"{channel} {name} (t = {flight[k]:.5f} s)"
            rows.append(
                Row(title, unit, float(mine[k]), float(limit[k]), RELATIVE, "relative", float(bar[k]), scale,
                    ours_uncertainty=float(own[k]), channel=channel, at=float(flight[k]))
            )  # fmt: skip
    return rows


def _panels(task: Task, found: list[Touch], first_run: Result, ours: Result, runs: list[PenaltyRun]) -> list[Panel]:
    """Motion over the compared time; impulse and gap around the first impact, for all stiffnesses."""
    first, end = found[0], runs[0].result.t[-1]
    longest = max(float(r.contacts[0][1].end or first.start) - first.start for r in runs if r.contacts)
    window = (first.start - 0.3 * longest, first.start + 1.3 * longest)
    panels = []
    wanted = [(c, None) for c in task.scenario.compare if not is_contact_channel(task, c)]
    wanted += [(f"{first.contact}.impulse", window), (f"{first.contact}.gap", window)]  # type: ignore[list-item]
    for channel, near in wanted:
        if channel not in runs[0].result.channels:
            continue
        mine = first_run if near else ours
        curves = [Curve("tlismni, constraint", mine.t, mine[channel], True)]
        for run in runs:
            r = run.result
            keep = slice(None) if near else slice(None, None, max(1, len(r.t) // 10_000))
            curves.append(Curve(f"exudyn, K = {run.stiffness:.0e}", r.t[keep], r[channel][keep], False))
        title = f"{channel}, first impact" if near else channel
        panels.append(
            Panel(title, unit_of(mine, channel), tuple(curves), near or (0.0, float(end)), origin=first.start)
        )
    return panels
