"""Contact as a constraint against the penalty limit: exudyn with three growing stiffnesses, extrapolated.

exudyn has no unilateral constraints and no impact law. But a force law whose rebound is exactly e tends to the
impact with restitution e as its stiffness K grows: with F = K d^n (1 + D d'/v0) and D the exact root for e
(Gonthier), duration and depth of the contact fall as x = K^(-1/(n+1)), and with them what gravity and the motion
add during it. So every quantity is a + b x + c x^2 + ..., and a is what the constraint must give.
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
    energy_panel,
    is_contact_channel,
    nice_step,
    our_run,
    residual_panel,
    touches,
    unit_of,
)
from .toggled import toggled_rows

STIFFNESSES = (1e6, 1e7, 1e8)
EXPONENT = 1.5
STEPS_IN_CONTACT = 100
LOWEST_RESTITUTION = 0.05
IMPULSE, SPEED, STATE = 1e-3, 1e-3, 1e-3
SAMPLES = 2001


@dataclass(frozen=True)
class PenaltyRun:
    """A run of exudyn with one stiffness, and its contacts in time."""

    stiffness: float
    result: ExudynResult
    contacts: list[tuple[str, ContactInterval]]

    @property
    def x(self) -> float:
        return self.stiffness ** (-1.0 / (EXPONENT + 1.0))


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
    runs = []
    for stiffness in STIFFNESSES:
        step = min(task.step or np.inf, nice_step(contact_step(found[0], stiffness)))
        task.progress(f"exudyn, K = {stiffness:.0e} N/m^1.5, step {step:.1e} s")
        result = run_exudyn(with_stiffness(task.exudyn_model, stiffness), t_end, step, settings_for(task.exudyn_model))
        runs.append(PenaltyRun(stiffness, result, _contacts(task, result)))
    rows = _impact_rows(found, runs) if all(r.contacts for r in runs) else []
    if not rows:
        missing = [f"{r.stiffness:.0e}" for r in runs if not r.contacts]
        rows.append(
            Row(f"runs of exudyn without contact (K = {missing})", "1", 0.0, float(len(missing)), 0.0, "absolute")
        )
    else:
        rows += _flight_rows(task, found, ours, runs)
        rows += toggled_rows(task, found[0], first_run)
    notes = (
        f"the constraint is compared with the limit of Gonthier's law with exact restitution, K = {STIFFNESSES} "
        "N/m^1.5, extrapolated in K^(-0.4); the uncertainty is the difference of the quadratic and the linear "
        "extrapolation. Force histories of a rigid impact are not compared",
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
        tuple(r.result.step for r in runs),
        runs[-1].result.version,
        first_run.stats["wall_time"],
        sum(r.result.wall_time for r in runs),
        tuple(first_run.events),
        ours,
    )


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


def contact_step(touch: Touch, stiffness: float) -> float:
    """A step (s) that resolves a contact, from Hertz' duration with the effective mass of our impact."""
    mass = touch.impulse / (touch.approach_speed + touch.separation_speed)
    depth = ((EXPONENT + 1.0) * mass * touch.approach_speed**2 / (2.0 * stiffness)) ** (1.0 / (EXPONENT + 1.0))
    return 2.94 * depth / touch.approach_speed / STEPS_IN_CONTACT


def _contacts(task: Task, result: ExudynResult) -> list[tuple[str, ContactInterval]]:
    found = []
    for contact in task.exudyn_model.contacts:
        intervals = contact_intervals(result.t, result[f"{contact.name}.gap"], result[f"{contact.name}.gap_rate"])
        found += [(contact.name, i) for i in intervals]
    return sorted(found, key=lambda pair: pair[1].start)


def _limit(runs: list[PenaltyRun], values: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    return power_limit(np.array([r.x for r in runs]), np.array(values))


def _impact_rows(found: list[Touch], runs: list[PenaltyRun]) -> list[Row]:
    first = found[0]
    values = []
    for run in runs:
        name, interval = run.contacts[0]
        r = run.result
        approach, separation = speeds(r.t, r[f"{name}.gap_rate"], interval)
        pushed = impulse(r.t, r[f"{name}.normal_force"], interval)
        values.append(np.array([interval.start, approach, pushed, separation]))
    limit, uncertainty = _limit(runs, values)
    largest_step = max(r.result.step for r in runs)
    names = (
        ("time of the first impact", "s", first.start, largest_step, "absolute"),
        ("approach speed", "m/s", first.approach_speed, SPEED, "relative"),
        ("impulse", "N s", first.impulse, IMPULSE, "relative"),
        ("separation speed", "m/s", first.separation_speed, SPEED, "relative"),
    )
    return [
        Row(f"{first.contact}: {name}", unit, ours, float(limit[k]), tolerance, kind, float(uncertainty[k]))  # type: ignore[arg-type]
        for k, (name, unit, ours, tolerance, kind) in enumerate(names)
    ]


def _flight_rows(task: Task, found: list[Touch], ours: Result, runs: list[PenaltyRun]) -> list[Row]:
    """Trajectories in free flight after the first impact, and the state where it ends; pointwise in the limit."""
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
        start, moved = _limit(runs, [np.array([r.contacts[1][1].start]) for r in runs])
        rows.append(
            Row(
                f"{found[1].contact}: time of the second impact", "s", found[1].start, float(start[0]), STATE,
                "relative", float(moved[0]),
            )
        )  # fmt: skip
    for channel in task.scenario.compare:
        if channel not in runs[0].result.channels or is_contact_channel(task, channel):
            continue
        unit = unit_of(ours, channel)
        limit, moved = _limit(runs, [at_times(r.result.t, r.result.channels, channel, flight) for r in runs])
        mine = ours[channel][inside]
        # in a short flight little moves: then a part of the motion of the whole run counts
        scale = max(0.5 * float(np.ptp(limit)), 0.05 * float(np.ptp(ours[channel]))) or None
        worst = int(np.argmax(np.abs(mine - limit)))
        for k, name in ((len(flight) - 1, ending), (worst, "where it differs most in flight")):
            title = f"{channel} {name} (t = {flight[k]:.5f} s)"
            rows.append(
                Row(title, unit, float(mine[k]), float(limit[k]), STATE, "relative", float(moved[k]), scale,
                    channel=channel, at=float(flight[k]))
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
