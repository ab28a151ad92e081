"""A step of impulses: smooth motion with all contact constraints open, without a look for their events.

What overlaps at its end is pending, and pushed apart there (`events/moreau_jean_step.py`). Contacts with force laws are
forces of the motion; where one begins or ends, the step ends.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..event_detection.broad_phase import keep_watch
from ..event_detection.contact_evaluation import set_travel
from ..event_detection.contact_sleeping import show_elements, show_pending, sleeps_on
from ..event_detection.trial_steps import make_trial
from ..events.zeno import any_force_law, begin_impulses, end_pushing, near_level, only_impulses
from ..methods.history import history_time, recall
from ..state.impact_law_codes import BY_FORCE
from ..state.modes import ACTIVE, OPEN, STEP_FORCES, UNWATCHED, memories_at
from ..state.run_records import (
    EVENTS_FULL,
    REPARTITION,
    STEP_TOO_SMALL,
    VIOLATED,
    call_accept,
    call_find_events,
    call_locate,
    clock_at,
)
from ..state.workspace_records import OK, counters_at
from .step_size import MAX_FACTOR, step_factor
from .time_loop import partition_strained, violates_redundant

NONE = -1
ONE_STEP = 1_000_000_000
"""Rows that no history has: formulas of several steps do not begin."""
NEAR = 2.0
"""Of the deepest overlap: a gap so small may close where that one is opened."""
SHORTEST = 1e-3
"""Of a step of impulses: if no smooth step of that size can be made, none can."""


@internal
def make_push_step(drive: Any, workspace: Any, method: Any, loop: Any) -> int:
    """Make it and accept it; OK, REPARTITION, or the status of a step that cannot be made."""
    if loop.capacity > 0 and ivec(loop.cursor, 1)[0] >= loop.capacity:
        return EVENTS_FULL
    if loop.log_capacity > 0 and ivec(loop.log_cursor, 1)[0] >= loop.log_capacity:
        return EVENTS_FULL
    clock, t, error = clock_at(loop.clock), history_time(method, 0), vec(method.error, 2)
    if clock.push_step == 0.0:
        begin_impulses(drive, workspace, method, loop)
        return OK
    remaining, forces = clock.stop_time - t, any_force_law(drive, workspace)
    h = min(clock.push_step, remaining)
    if forces and _any_acts(workspace):
        h = min(h, clock.step_size)
    if remaining > h > 0.5 * remaining:
        h = 0.5 * remaining
    least, rows = SHORTEST * min(clock.push_step, remaining), loop.rows
    # a formula that begins with the accelerations of the newest row would begin with those of the contacts' mean forces
    loop.rows = ONE_STEP
    show_pending(workspace, drive.pending, drive.law)
    while True:
        recall(workspace, method, 0)
        vec(drive.last_trial, 1)[0] = -1.0
        status = make_trial(drive, workspace, method, loop, h, np.inf)
        if (status == OK and error[0] <= 1.0) or h <= least:
            break
        h *= 0.25
    loop.rows = rows
    show_elements(workspace)
    if status != OK or not error[0] <= 1.0:
        return STEP_TOO_SMALL if status == OK else status
    evaluate_residuals(workspace)
    a, aux = vec(workspace.a, workspace.n_ext), vec(workspace.aux, workspace.n_ext)
    for i in range(workspace.n_ext):
        aux[i] = a[i]
    clock.trial_step = h
    if workspace.n_redundant > 0 and violates_redundant(workspace, 1.0):
        return VIOLATED
    status = NONE
    if forces:
        clock.step_size = h * step_factor(error[0], error[1], MAX_FACTOR)
        status = _end_at_forces(drive, workspace, method, loop, h)
        if status != OK and status != NONE:
            return status
    if status == NONE:
        if h == remaining:
            vec(workspace.t, 1)[0] = clock.stop_time
        set_travel(workspace, method, loop, h)
        keep_watch(workspace, method, loop)
        touches = _find_touching(drive, workspace, method, loop, h, False)
        # a sample of what overlaps is none: `settle` makes one of what is left of it
        kept, loop.capacity = loop.capacity, 0 if touches else loop.capacity
        call_accept(drive.accept, workspace, method, loop)
        loop.capacity = kept
    else:
        now = history_time(method, 0)
        if now == t:
            # at once: no step has been made
            return OK
        touches = _find_touching(drive, workspace, method, loop, now - t, True)
    counters_at(workspace.counters).of_impulses += 1
    clock.pushed_from = t
    clock.pushes_left -= 1.0
    if not touches and not only_impulses(loop):
        # nothing is left of the crowd
        end_pushing(workspace, loop, history_time(method, 0))
    return REPARTITION if partition_strained(workspace) else OK


@internal
def _any_acts(workspace: Any) -> bool:
    """True if a force law acts now."""
    memory = memories_at(workspace.memory, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        if memory[k].mode == ACTIVE:
            return True
    return False


@internal
def _find_touching(drive: Any, workspace: Any, method: Any, loop: Any, h: float, accepted: bool) -> bool:
    """Constraint contacts that touch at the end of the step of h (s) become pending, and those that are so near that
    they may overlap once others are pushed apart; True if any touches. `accepted`: so is the step."""
    level, rows, phi = (
        near_level(workspace, h),
        ivec(workspace.contact_rows, workspace.n_contacts),
        vec(workspace.phi, workspace.m_ext),
    )
    pending, scale, touches, deepest = (
        ivec(drive.pending, workspace.n_contacts),
        vec(workspace.row_scale, workspace.m_ext),
        False,
        0.0,
    )
    law, sleeping = ivec(drive.law, workspace.n_contacts), ivec(workspace.sleeping, workspace.n_contacts)
    memory = memories_at(workspace.memory, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        if law[k] == BY_FORCE:
            continue
        pending[k] = 0
        sleeps = sleeping[k] != 0 if accepted else sleeps_on(workspace, method, loop, k)
        if not sleeps and phi[rows[k]] <= level * scale[rows[k]]:
            pending[k], touches, deepest = 1, True, max(deepest, -phi[rows[k]])
    for k in range(workspace.n_contacts):
        if law[k] != BY_FORCE and sleeping[k] == 0 and phi[rows[k]] <= NEAR * deepest:
            pending[k] = 1
        if law[k] != BY_FORCE and pending[k] == 0:
            # it has come apart: when it meets again that is another impact
            for block in range(STEP_FORCES):
                memory[k].step_force[block] = 0.0
    return touches


@internal
def _end_at_forces(drive: Any, workspace: Any, method: Any, loop: Any, h: float) -> int:
    """If a force law begins or ends within the step of h (s) to the current point, end it there, accept that, and let
    it be pending, at once where it is so at the step's start; NONE: nothing of that; else why it cannot."""
    memory, law = memories_at(workspace.memory, workspace.n_contacts), ivec(drive.law, workspace.n_contacts)
    starter, rows, kept = loop.starter, loop.rows, loop.capacity
    for k in range(workspace.n_contacts):
        if law[k] != BY_FORCE:
            memory[k].mode = UNWATCHED
    status = NONE
    if call_find_events(loop.find_events, workspace, method, loop, h, False):
        loop.capacity = 0
        loop.starter, loop.rows = loop.fine_starter, ONE_STEP
        status = call_locate(drive.locate, drive, False)
        loop.starter, loop.rows, loop.capacity = starter, rows, kept
    for k in range(workspace.n_contacts):
        if law[k] != BY_FORCE:
            memory[k].mode = OPEN
    return int(status)
