"""A step of impulses: smooth motion with all contact constraints open, without a look for their events.

What overlaps at its end is pending, and pushed apart there (`events/impulse_step.py`).
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..events.crowding import end_pushing, near_level
from ..location.asleep import sleeps_on
from ..location.broad_phase import keep_watch
from ..location.probe import set_travel
from ..location.trials import make_trial
from ..methods.history import history_time, recall
from ..state.run_records import (
    CLOCK_SIZE,
    FULL,
    PUSH_STEP,
    PUSHED_FROM,
    PUSHES_LEFT,
    REPARTITION,
    STOP_TIME,
    call_accept,
)
from ..state.workspace_records import COUNTERS_SIZE, OF_IMPULSES, OK
from .loop import partition_strained

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
    remaining = clock[STOP_TIME] - t
    h = min(clock[PUSH_STEP], remaining)
    if remaining > h > 0.5 * remaining:
        h = 0.5 * remaining
    least = SHORTEST * h
    while True:
        recall(ws, ms, 0)
        vec(dr.last_trial, 1)[0] = -1.0
        status = make_trial(dr, ws, ms, lc, h, np.inf)
        if status == OK and error[0] <= 1.0:
            break
        if h <= least:
            return status
        h *= 0.25
    if h == remaining:
        vec(ws.t, 1)[0] = clock[STOP_TIME]
    set_travel(ws, ms, lc, h)
    keep_watch(ws, ms, lc)
    level, rows, phi = near_level(ws, h), ivec(ws.contact_rows, ws.n_contacts), vec(ws.phi, ws.m_ext)
    pending, scale, touches, deepest = ivec(dr.pending, ws.n_contacts), vec(ws.row_scale, ws.m_ext), False, 0.0
    for k in range(ws.n_contacts):
        pending[k] = 0
        if not sleeps_on(ws, ms, lc, k) and phi[rows[k]] <= level * scale[rows[k]]:
            pending[k], touches, deepest = 1, True, max(deepest, -phi[rows[k]])
    # what is so near may overlap once those are pushed apart
    for k in range(ws.n_contacts):
        if ivec(ws.asleep, ws.n_contacts)[k] == 0 and phi[rows[k]] <= NEAR * deepest:
            pending[k] = 1
    # a sample of what overlaps is none: `settle` makes one of what is left of it
    kept, lc.capacity = lc.capacity, 0 if touches else lc.capacity
    call_accept(dr.accept, ws, ms, lc)
    lc.capacity = kept
    ivec(ws.counters, COUNTERS_SIZE)[OF_IMPULSES] += 1
    clock[PUSHED_FROM] = t
    clock[PUSHES_LEFT] -= 1.0
    if not touches:
        # nothing is left of the crowd
        end_pushing(ws, lc, history_time(ms, 0))
    return REPARTITION if partition_strained(ws) else OK
