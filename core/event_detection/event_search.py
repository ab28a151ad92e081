"""Locating events inside a step: it is made again with other sizes until it ends at the first of them.

The watch says which contacts have events in the step, and between which places (`crossings.py`, `root_bounds.py`). Each
of these is searched for by itself (`event_step.py`), and the first of all ends the step.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_time, recall
from ..rounding import NO_STEP, SAME_INSTANT
from ..state.modes import CLOSED, OPEN, memories_at
from ..state.run_records import FOUND_SIZE, call_accept, call_find_events, clock_at
from ..state.workspace_records import OK
from .contact_evaluation import BRACKET, HAPPENS
from .event_step import END_OF_STEP, event_step
from .roots import NEAREST, dense_root
from .trial_steps import make_trial

LATER = 1.001
"""Events that the dense output puts this much later than the first one are searched for only if they turn out to lie
before it: each search makes the step several times."""
# columns of `found`
SIZE, STATE, PLACES = range(3)
UNKNOWN, HAPPENED, SAFE, CANDIDATE = 0.0, 1.0, 2.0, 3.0


@internal
def _guess(workspace: Any, method: Any, loop: Any, k: int, h: float, places: Any) -> float:
    """Where in the step of size h that ends at the current point the dense output says that the event is; -1: it does
    not say."""
    mode, end = memories_at(workspace.memory, workspace.n_contacts)[k].mode, places[0]
    if mode == CLOSED or (mode != OPEN and end <= 0.0 and places[2] == h):
        return -1.0
    return dense_root(workspace, method, loop, k, h, 1.0 if mode == OPEN else -1.0, places[1], places[2])


@internal
def locate(drive: Any, workspace: Any, method: Any, loop: Any) -> int:
    """End the step at the first event in it, accept that, and set `pending`; OK, or the status of a step that cannot be
    made: nothing is accepted then.

    The current point must be the end of the step of size TRIAL_STEP, in which events have been found.
    """
    h = clock_at(loop.clock).trial_step
    found, pending = mat(drive.found, workspace.n_contacts, FOUND_SIZE), ivec(drive.pending, workspace.n_contacts)
    brackets = mat(loop.brackets, workspace.n_contacts, BRACKET)
    vec(drive.last_trial, 1)[0] = vec(drive.nearest, NEAREST)[0] = -1.0
    for k in range(workspace.n_contacts):
        found[k, STATE] = UNKNOWN
    step, least = h, NO_STEP * abs(history_time(method, 0))
    while call_find_events(loop.find_events, workspace, method, loop, step, True):
        late, first, soonest = False, step, np.inf
        for k in range(workspace.n_contacts):
            if brackets[k, HAPPENS] == 0.0 or found[k, STATE] != UNKNOWN:
                continue
            late = True
            # the shorter step may end where a gap is negative that the longer one has passed
            places = found[k, PLACES:]
            places[0] = vec(workspace.phi, workspace.m_ext)[ivec(workspace.contact_rows, workspace.n_contacts)[k]]
            for i in range(3):
                places[1 + i] = step * brackets[k, i]
            places[4] = _guess(workspace, method, loop, k, step, places)
            if places[4] >= 0.0:
                soonest = min(soonest, places[4])
            found[k, STATE] = CANDIDATE
        if not late:
            break
        for k in range(workspace.n_contacts):
            if found[k, STATE] == CANDIDATE and found[k, PLACES + 4] > LATER * soonest:
                found[k, STATE] = UNKNOWN
        nearest = np.inf
        for k in range(workspace.n_contacts):
            if found[k, STATE] == CANDIDATE:
                status, size, happens = event_step(drive, workspace, method, loop, k, step, found[k, PLACES:])
                if status != OK:
                    return status
                # where the motion has none up to next to no time, what was seen is rounding
                found[k, SIZE] = size if happens or size > least else step
                found[k, STATE] = HAPPENED if happens else SAFE
            if found[k, STATE] != UNKNOWN:
                first = min(first, found[k, SIZE])
            if found[k, STATE] == HAPPENED:
                nearest = min(nearest, found[k, SIZE])
        # no time lies between: a step to there would be none
        at_once = least if method.exact != 0 else END_OF_STEP * h
        if (nearest if method.exact != 0 else first) <= at_once:
            recall(workspace, method, 0)
            for k in range(workspace.n_contacts):
                pending[k] = 1 if found[k, STATE] == HAPPENED and found[k, SIZE] <= at_once else 0
            return OK
        step = first
        status = make_trial(drive, workspace, method, loop, step, h)
        if status != OK:
            return status
    call_accept(drive.accept, workspace, method, loop)
    for k in range(workspace.n_contacts):
        pending[k] = 1 if found[k, STATE] == HAPPENED and found[k, SIZE] <= step * (1.0 + SAME_INSTANT) else 0
    return OK
