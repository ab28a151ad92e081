"""What is done where steps and instants do not lead on: one policy, compiled, for runs with and without Python.

`drive` calls `recover` with the code at which it has ended. What compiled code can do is done at once, and `drive` goes
on. What it cannot do is asked for by a code: memory (WANTED), other redundant rows (REPARTITION), a step over a
singular position (NEAR_SINGULAR, LAST_RESORT), another outer loop (FALL_BACK). Whoever drives the run answers in
`counts` and calls `drive` again, which goes on with the policy where it was; who cannot do it ends the run.
"""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal
from ..events.records import SETTLED, WANT_MEMORY
from ..methods.history import history_time
from ..rounding import SHORTEST
from ..state.run_records import (
    DIVIDES,
    DONE,
    FALL_BACK,
    GOES_BY_IMPULSES,
    JAM,
    LAST_RESORT,
    NEAR_SINGULAR,
    NOT_DONE,
    OTHER_ROWS,
    REACHED,
    REPARTITION,
    STEP_TOO_SMALL,
    UNANSWERED,
    UNLOCATED,
    UNREPAIRED,
    VIOLATED,
    WANTED,
    call_locate,
    call_settle,
    clock_at,
    counts_at,
)
from ..state.workspace_records import (
    INNER_DIVERGED,
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_SLOW,
    REANALYZE,
    SINGULAR,
    control_at,
    convergence_at,
)
from ..time_loop.drive import loop_at, method_at, workspace_at
from .near_singular import STRAINED_GROWTH
from .step_division import grow_parts, halve_step

MOST_LOCATIONS = 3
"""Of one event, each with the pivots of the newest row; a trial that fails with all of them needs shorter steps."""
BY_PARTITION, BY_SMALLER_STEP, BY_PASSAGE, BY_IMPULSES = range(1, 5)
"""Remedies, in the order in which they are tried: new partition and pivots; a smaller step, or parts of a fixed one; a
step over a singular position; steps of impulses. 0: none."""


@compiled
def recover(drive: Any, code: int) -> int:
    """What follows once `drive` has ended with `code`: OK, it goes on; else what whoever drives the run has to do, or
    may say, or why it ends. `code` does not count while an answer is awaited."""
    workspace, method = workspace_at(drive.workspace), method_at(drive.method)
    counts, clock = counts_at(drive.counts), clock_at(loop_at(drive.loop).clock)
    remedy, answer = counts.remedy, counts.answer
    counts.remedy, counts.answer = 0, UNANSWERED
    if remedy == 0:
        now = history_time(method, 0)
        if code == REACHED:
            return OK if grow_parts(clock, now) else code
        counts.cause, counts.attempts = code, 0
        if _may_fall_back(workspace, clock, code):
            return FALL_BACK
        remedy = _first_remedy(clock, code, now)
        if remedy == 0:
            return code
    cause = counts.cause
    if remedy == BY_PARTITION:
        found = _renew_partition(drive, workspace, counts, answer)
        if found == REPARTITION or found == WANTED:
            counts.remedy = BY_PARTITION
        if found == REPARTITION or found == WANTED or found == OK:
            return found
        # without it the motion does not go on, but where steps fail there is more to try
        more = BY_PASSAGE if found == VIOLATED or cause <= OUTER_SLOW else 0
        remedy, answer = BY_SMALLER_STEP if found == UNLOCATED else more, UNANSWERED
    if remedy == BY_SMALLER_STEP:
        whole = clock.halvings == 0.0
        if _may_shrink(cause) and clock.fixed_step == 0.0 and _shrink(workspace, method, clock):
            if cause == REANALYZE:  # the matrix of the shorter step has other pivots
                clock.repaired_at = -np.inf
            return OK
        if halve_step(drive, workspace, method, clock):
            return DIVIDES if whole else OK
        remedy = 0 if cause == UNLOCATED else BY_PASSAGE
    if remedy == BY_PASSAGE:
        on_the_way = cause == NEAR_SINGULAR or cause == VIOLATED
        if answer == UNANSWERED and (on_the_way or _strained(workspace, clock)):
            counts.remedy = BY_PASSAGE
            return NEAR_SINGULAR if on_the_way else LAST_RESORT
        if answer == DONE or cause == NEAR_SINGULAR:
            # where there is none near, it will be looked for again later
            return OK
        remedy = 0 if cause == VIOLATED else BY_IMPULSES
    if remedy == BY_IMPULSES and drive.go_by_impulses != 0 and call_settle(drive.go_by_impulses, drive) == SETTLED:
        return GOES_BY_IMPULSES
    # whoever tries again all the same begins anew
    clock.repaired_at = -np.inf
    return UNREPAIRED if counts.attempts < 0 else cause


@internal
def _may_fall_back(workspace: Any, clock: Any, code: int) -> bool:
    failed = code == OUTER_DIVERGED or code == OUTER_SLOW
    return failed and clock.eager > 0.0 and control_at(workspace.control).outer_loop != 0.0


@internal
def _first_remedy(clock: Any, code: int, now: float) -> int:
    """0 where the code is none of a failure."""
    if code == REPARTITION or code == VIOLATED or code == UNLOCATED:
        return BY_PARTITION
    if code == NEAR_SINGULAR:
        return BY_PASSAGE
    if code == JAM:
        return BY_IMPULSES
    if code == STEP_TOO_SMALL or code == NOT_FINITE:
        return BY_SMALLER_STEP
    if code > OUTER_SLOW:
        return 0
    if clock.repaired_at == now:
        return BY_SMALLER_STEP
    clock.repaired_at = now
    return BY_PARTITION


@internal
def _renew_partition(drive: Any, workspace: Any, counts: Any, answer: int) -> int:
    """A new partition at the newest row; and of an event that could not be located, another search with it: OK,
    REPARTITION or WANTED (what is asked for), UNREPAIRED, UNLOCATED, or VIOLATED (the same redundant rows)."""
    cause = counts.cause
    while True:
        if answer == UNANSWERED:
            if workspace.n_redundant > 0:
                return REPARTITION
            counts.status = call_settle(drive.repair, drive)
            if counts.status != SETTLED and counts.status <= WANT_MEMORY:
                return WANTED
            answer = DONE if counts.status == SETTLED else NOT_DONE
        if answer == NOT_DONE:
            counts.attempts = -1
            return UNREPAIRED
        if cause == VIOLATED and answer != OTHER_ROWS:
            return VIOLATED
        if cause != UNLOCATED or call_locate(drive.locate, drive, True) == OK:
            return OK
        counts.attempts += 1
        if counts.attempts == MOST_LOCATIONS:
            return UNLOCATED
        answer = UNANSWERED


@internal
def _may_shrink(cause: int) -> bool:
    return cause == INNER_DIVERGED or cause == SINGULAR or cause == REANALYZE or cause == UNLOCATED


@internal
def _shrink(workspace: Any, method: Any, clock: Any) -> bool:
    """A smaller step after a failure of a repaired system; False if it cannot be smaller."""
    h, scale = 0.25 * clock.trial_step, 1.0 / control_at(workspace.control).rate_scale
    clock.step_size = h
    return bool(h > SHORTEST * max(abs(history_time(method, 0)), 1e-6 * scale))


@internal
def _strained(workspace: Any, clock: Any) -> bool:
    """True if the constraints are nearly dependent, and steps under error control have failed on the way there."""
    rate = convergence_at(workspace.rate)
    return clock.fixed_step == 0.0 and rate.worst_condition > STRAINED_GROWTH * rate.least_condition > 0.0
