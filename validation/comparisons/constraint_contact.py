"""Contact as a constraint against the penalty limit: exudyn with growing stiffnesses, extrapolated.

A first comparison takes three stiffnesses and halves exudyn's step. What does not agree then is asked again with
stiffer contacts, until the limits of the last three stiffnesses and of the three before tell the same: only such a
limit can differ. Where contacts of the penalty merge, break into pieces or do not end, that is said, and nothing is
decided.
"""

from dataclasses import replace

import numpy as np

from ...core import Result
from ..exudyn_run import run_exudyn, settings_for
from .common import (
    Comparison,
    Curve,
    Panel,
    Row,
    Task,
    Touch,
    at_times,
    blows,
    contact_units,
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
from .penalty_limit import (
    EXPONENT,
    RUNS,
    PenaltyRun,
    Sides,
    contact_step,
    contacts_of,
    impact_quantities,
    softest_stiffness,
    stiffer,
    sure,
    with_stiffness,
)
from .persistent_contact import compare_persistent
from .toggled import toggled_rows

MOST_HALVINGS = 2
"""Of exudyn's steps, while an error bar is above the tolerance."""
MOST_STIFFER = 3
"""Stiffnesses beyond the first three, each ten times the one before."""
MOST_STEPS = 400_000
"""Of exudyn in the run with the stiffest contact."""
RELATIVE = 1e-3
"""Tolerance of every quantity against the extrapolated limit."""
SAMPLES = 2001


def compare_constraints(task: Task) -> Comparison:
    """First impact, flight after it, state before the second impact; without an impact, where contacts are closed from
    the start on or never touch, as `compare_persistent` has it.

    Raises
    ------
    NotTranslatable : for restitution below LOWEST_RESTITUTION (the contact persists, a penalty rings in it).
    """
    scenario = task.scenario
    task.progress("our run")
    first_run = our_run(scenario)
    found = blows(touches(first_run.events))
    if not found:
        return compare_persistent(task)
    t_end = _end(found, scenario.t_end)
    ours = our_run(scenario, np.linspace(0.0, scenario.t_end, SAMPLES))
    loose = our_looser_run(task, ours.t)
    softest = softest_stiffness(found, t_end)
    step = min(task.step or np.inf, nice_step(contact_step(found[0], softest)))
    for _ in range(1 + MOST_HALVINGS):
        plan = [(stiffer(softest, k), step * stiffer(1.0, k) ** (-1.0 / (EXPONENT + 1.0))) for k in range(RUNS)]
        *runs, doubled = (_penalty_run(task, k, t_end, h) for k, h in (*plan, (softest, 2.0 * step)))
        sides = Sides(task, found, ours, loose, runs, doubled)
        rows = _rows(sides)
        if task.settled(rows):
            break
        step *= 0.5
    sides, rows = _confirmed(sides, rows, t_end)
    runs = sides.runs
    rows += toggled_rows(task, found[0], first_run)
    notes = (
        "the constraint is compared with the limit of Gonthier's law with exact restitution, "
        f"K = {', '.join(f'{r.stiffness:.0e}' for r in runs)} N/m^1.5, the last three extrapolated in K^(-0.4); "
        "exudyn's error bar is the difference of the quadratic and the linear extrapolation, and what twice the step "
        "changes" + (", and how far the limit has moved with the last stiffness" if len(runs) > RUNS else ""),
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
        tuple(r.result.step for r in (*runs, sides.doubled)),
        runs[-1].result.version,
        first_run.stats["wall_time"],
        sum(r.result.wall_time for r in (*runs, sides.doubled)),
        tuple(first_run.events),
        ours,
    )


def _confirmed(sides: Sides, rows: list[Row], t_end: float) -> tuple[Sides, list[Row]]:
    """Stiffer contacts, until all rows agree or a difference is sure; then why what is left is not decided."""
    for _ in range(MOST_STIFFER):
        differing = any(row.verdict == "differ" for row in rows)
        settled = sides.task.settled(rows) and not sides.doubts()
        if all(row.verdict == "agree" for row in rows) or (sides.confirmed and any(sure(row) for row in rows)):
            break
        if not differing and (not sides.task.refine or settled):
            break
        last = sides.runs[-1]
        step = last.result.step * stiffer(1.0, 1) ** (-1.0 / (EXPONENT + 1.0))
        if t_end / step > MOST_STEPS:
            break
        sides = replace(sides, runs=[*sides.runs, _penalty_run(sides.task, stiffer(last.stiffness, 1), t_end, step)])
        rows = _rows(sides)
    doubts = sides.doubts()
    if doubts:
        return sides, [replace(row, doubt="; ".join(doubts)) for row in rows]
    decided = [row.verdict == "agree" or (sides.confirmed and sure(row)) for row in rows]
    return sides, [r if known else replace(r, doubt=_open_limit(sides)) for r, known in zip(rows, decided, strict=True)]


def _open_limit(sides: Sides) -> str:
    depth = sides.runs[-1].contacts[0][1].duration if sides.runs[-1].contacts else None
    lasting = "" if depth is None else f", the last contact takes {depth:.1e} s"
    return (
        f"the limit of stiff contacts is not reached: K goes up to {sides.runs[-1].stiffness:.0e} N/m^1.5{lasting}, "
        "and the limit still moves, or lies too near to ours, to call a difference one of the models"
    )


def _rows(sides: Sides) -> list[Row]:
    runs = [*sides.runs, sides.doubled]
    if all(r.first_of(sides.found[0].contact) for r in runs):
        return _impact_rows(sides) + _flight_rows(sides)
    name = sides.found[0].contact
    missing = [f"{r.stiffness:.0e}" for r in runs if not r.first_of(name)]
    title = f"{name}: runs of exudyn without contact (K = {', '.join(missing)})"
    return [Row(title, "1", 0.0, float(len(missing)), 0.0, "absolute")]


def _end(found: list[Touch], t_end: float) -> float:
    """Shortly before the third impact: what comes after adds nothing but time."""
    return min(t_end, found[1].start + 0.9 * (found[2].start - found[1].start)) if len(found) > 2 else t_end


def _penalty_run(task: Task, stiffness: float, t_end: float, step: float) -> PenaltyRun:
    task.progress(f"exudyn, K = {stiffness:.0e} N/m^1.5, step {step:.1e} s")
    result = run_exudyn(with_stiffness(task.exudyn_model, stiffness), t_end, step, settings_for(task.exudyn_model))
    return PenaltyRun(stiffness, result, contacts_of(task, result))


def _impact_rows(sides: Sides) -> list[Row]:
    first = sides.found[0]
    again = next((x for x in touches(sides.loose.events) if x.contact == first.contact), first)
    *values, doubled = (impact_quantities(run, first.contact) for run in (*sides.runs, sides.doubled))
    limit, bar = sides.limit(values, doubled)
    units = contact_units(sides.ours, first.contact)
    names = (
        ("time of the first impact", "s", first.start, again.start),
        ("approach speed", units.speed, first.approach_speed, again.approach_speed),
        ("impulse", units.impulse, first.impulse, again.impulse),
        ("separation speed", units.speed, first.separation_speed, again.separation_speed),
    )
    return [
        Row(f"{first.contact}: {name}", unit, ours, float(limit[k]), RELATIVE, "relative", float(bar[k]),
            ours_uncertainty=float(own_bar(ours, loose)))
        for k, (name, unit, ours, loose) in enumerate(names)
    ]  # fmt: skip


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
