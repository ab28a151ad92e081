"""A step of impulses: smooth motion with all contact constraints open, without a look for their events.

What overlaps at its end is pending, and pushed apart there (`events/impulse_step.py`). Contacts with force laws are
forces of the motion; where one begins or ends, the step ends.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..event_detection.broad_phase import keep_watch
from ..event_detection.contact_evaluation import set_travel
from ..event_detection.contact_sleeping import sleeps_on
from ..event_detection.trial_steps import make_trial
from ..events.laws import FORCE
from ..events.zeno import any_force_law, end_pushing, near_level
from ..methods.history import history_time, recall
from ..state.modes import ACTIVE, MEMORY_SIZE, MODE, OPEN, UNWATCHED
from ..state.run_records import (
    CLOCK_SIZE,
    FULL,
    PUSH_STEP,
    PUSHED_FROM,
    PUSHES_LEFT,
    REPARTITION,
    STEP_SIZE,
    STOP_TIME,
    TRIAL_STEP,
    VIOLATED,
    call_accept,
    call_find_events,
    call_locate,
)
from ..state.workspace_records import COUNTERS_SIZE, OF_IMPULSES, OK
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
def make_push_step(dr: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Make it and accept it; OK, REPARTITION, or the status of a step that cannot be made."""
    if lc.capacity > 0 and ivec(lc.cursor, 1)[0] >= lc.capacity:
        return FULL
    if lc.log_capacity > 0 and ivec(lc.log_cursor, 1)[0] >= lc.log_capacity:
        return FULL
    clock, t, error = vec(lc.clock, CLOCK_SIZE), history_time(ms, 0), vec(ms.error, 2)
    remaining, forces = clock[STOP_TIME] - t, any_force_law(dr, ws)
    h = min(clock[PUSH_STEP], remaining)
    if forces and _any_acts(ws):
        h = min(h, clock[STEP_SIZE])
    if remaining > h > 0.5 * remaining:
        h = 0.5 * remaining
    least = SHORTEST * min(clock[PUSH_STEP], remaining)
    while True:
        recall(ws, ms, 0)
        vec(dr.last_trial, 1)[0] = -1.0
        status = make_trial(dr, ws, ms, lc, h, np.inf)
        if status == OK and error[0] <= 1.0:
            break
        if h <= least:
            return status
        h *= 0.25
    clock[TRIAL_STEP] = h
    if ws.n_redundant > 0 and violates_redundant(ws, 1.0):
        return VIOLATED
    status = NONE
    if forces:
        clock[STEP_SIZE] = h * step_factor(error[0], error[1], MAX_FACTOR)
        status = _end_at_forces(dr, ws, ms, lc, h)
        if status != OK and status != NONE:
            return status
    if status == NONE:
        if h == remaining:
            vec(ws.t, 1)[0] = clock[STOP_TIME]
        set_travel(ws, ms, lc, h)
        keep_watch(ws, ms, lc)
        touches = _find_touching(dr, ws, ms, lc, h, False)
        # a sample of what overlaps is none: `settle` makes one of what is left of it
        kept, lc.capacity = lc.capacity, 0 if touches else lc.capacity
        call_accept(dr.accept, ws, ms, lc)
        lc.capacity = kept
    else:
        now = history_time(ms, 0)
        if now == t:
            # at once: no step has been made
            return OK
        touches = _find_touching(dr, ws, ms, lc, now - t, True)
    ivec(ws.counters, COUNTERS_SIZE)[OF_IMPULSES] += 1
    clock[PUSHED_FROM] = t
    clock[PUSHES_LEFT] -= 1.0
    if not touches:
        # nothing is left of the crowd
        end_pushing(ws, lc, history_time(ms, 0))
    return REPARTITION if partition_strained(ws) else OK


@internal
def _any_acts(ws: Any) -> bool:
    """True if a force law acts now."""
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)
    for k in range(ws.n_contacts):
        if memory[k, MODE] == ACTIVE:
            return True
    return False


@internal
def _find_touching(dr: Any, ws: Any, ms: Any, lc: Any, h: float, accepted: bool) -> bool:
    """Constraint contacts that touch at the end of the step of h (s) become pending, and those that are so near that
    they may overlap once others are pushed apart; True if any touches. `accepted`: so is the step."""
    level, rows, phi = near_level(ws, h), ivec(ws.contact_rows, ws.n_contacts), vec(ws.phi, ws.m_ext)
    pending, scale, touches, deepest = ivec(dr.pending, ws.n_contacts), vec(ws.row_scale, ws.m_ext), False, 0.0
    law, sleeping = ivec(dr.law, ws.n_contacts), ivec(ws.sleeping, ws.n_contacts)
    for k in range(ws.n_contacts):
        if law[k] == FORCE:
            continue
        pending[k] = 0
        sleeps = sleeping[k] != 0 if accepted else sleeps_on(ws, ms, lc, k)
        if not sleeps and phi[rows[k]] <= level * scale[rows[k]]:
            pending[k], touches, deepest = 1, True, max(deepest, -phi[rows[k]])
    for k in range(ws.n_contacts):
        if law[k] != FORCE and sleeping[k] == 0 and phi[rows[k]] <= NEAR * deepest:
            pending[k] = 1
    return touches


@internal
def _end_at_forces(dr: Any, ws: Any, ms: Any, lc: Any, h: float) -> int:
    """If a force law begins or ends within the step of h (s) to the current point, end it there, accept that, and let
    it be pending, at once where it is so at the step's start; NONE: nothing of that; else why it cannot."""
    memory, law = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(dr.law, ws.n_contacts)
    starter, rows, kept = lc.starter, lc.rows, lc.capacity
    for k in range(ws.n_contacts):
        if law[k] != FORCE:
            memory[k, MODE] = UNWATCHED
    status = NONE
    if call_find_events(lc.find_events, ws, ms, lc, h, False):
        lc.capacity = 0
        if rows > 1:
            lc.starter, lc.rows = lc.fine_starter, ONE_STEP
        status = call_locate(dr.locate, dr, False)
        lc.starter, lc.rows, lc.capacity = starter, rows, kept
    for k in range(ws.n_contacts):
        if law[k] != FORCE:
            memory[k, MODE] = OPEN
    return int(status)
