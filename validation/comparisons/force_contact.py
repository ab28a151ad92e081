"""Contact by force laws, like for like: the same law in exudyn, impact by impact, its step halved until its error bars
are below the tolerance: 1e-4 of every quantity.
"""

from dataclasses import replace

from ..exudyn_run import run_exudyn, settings_for
from .common import Comparison, Task, energy_panel, our_looser_run, our_run, residual_panel, touches
from .force_panels import force_panels
from .force_rows import Levels, Sides, force_rows
from .force_steps import (
    MOST_STEPS,
    aligned,
    end_of,
    entry_bar,
    entry_error,
    first_step,
    jumping_touches,
    jumps,
    most_steps,
    sample_times,
)

MOST_HALVINGS = 3
"""Of exudyn's step, beyond the first three runs."""


def compare_forces(task: Task) -> Comparison:
    """First contact of every contact element, state before the second impact, trajectories until then."""
    scenario = task.scenario
    task.progress("our run")
    first_run = our_run(scenario)
    found = touches(first_run.events)
    notes: list[str] = []
    if not found:
        notes.append("no contact begins and ends before the end of the run: only trajectories are compared")
    ours = our_run(scenario, sample_times(found, scenario.t_end))
    loose = our_looser_run(task, ours.t)
    step = task.step or first_step(scenario.model, found, first_run, scenario.t_end)
    if found and task.step is None:
        # rather a longer step, and an error bar that says so, than an end before the first contact
        step = max(step, 1.2 * found[0].end / MOST_STEPS)
    t_end = end_of(found, step, scenario.t_end)
    if t_end < scenario.t_end:
        notes.append(f"exudyn stops at {t_end:.4g} s, to keep the number of its steps bearable")
    coarsest, regular = 4.0 * step, jumps(scenario.model, found)
    if regular:
        coarsest = aligned(coarsest, found[0], step)
    number = max(1, round(t_end / coarsest))
    if regular:
        t_end = number * coarsest
    runs = []
    for k in range(3 + MOST_HALVINGS):
        h = t_end / number / 2**k
        task.progress(f"exudyn, step {h:.1e} s")
        runs.append(run_exudyn(task.exudyn_model, t_end, h, settings_for(task.exudyn_model)))
        runs = runs[-3:]
        if len(runs) < 3:
            continue
        rows = force_rows(Sides(task, found, ours, loose, Levels(tuple(runs), regular)))
        # the next run has twice the steps
        if task.settled(rows) or 2.0 * t_end / h > most_steps(scenario.model):
            break
    fine = runs[-1]
    jumping = jumping_touches(scenario.model, found[1:] if regular else found)
    if jumping:
        rows = [replace(r, uncertainty=r.uncertainty + entry_bar(r, scenario.model, jumping, ours, fine.step))
                for r in rows]  # fmt: skip
        notes.append(
            "the force jumps at the touch, but exudyn has it for the whole step of the touch or not at all: "
            f"{max(entry_error(scenario.model, x) for x in jumping) * fine.step:.1e} of the speed at most, which is "
            "added to its error bar"
        )
    if regular:
        notes.append(
            "the force jumps at first touch: exudyn's steps are chosen to begin there, so that what a step misses of "
            "the jump is regular, and its values are extrapolated to step zero"
        )
    notes += [
        "exudyn: generalized-alpha (index 3, spectral radius 0.9), steps "
        f"{', '.join(f'{r.step:.1e}' for r in runs)} s; its error bar is Richardson's estimate from them",
        *fine.notes,
    ]
    return Comparison(
        "contact by force, like for like",
        tuple(rows),
        (*force_panels(task, found, ours, fine), energy_panel(first_run), residual_panel(first_run)),
        tuple(notes),
        tuple(r.step for r in runs),
        fine.version,
        first_run.stats["wall_time"],
        sum(r.wall_time for r in runs),
        tuple(first_run.events),
        ours,
    )
