"""What is done where steps and instants do not lead on: one policy, compiled, for runs with and without Python.

`drive` calls `recover` with the code at which it has ended. What compiled code can do is done at once, and `drive` goes
on. What it cannot do is asked for by a code: memory (WANTED), other redundant rows (REPARTITION), a step over a
singular position (NEAR_SINGULAR, LAST_RESORT), another outer loop (FALL_BACK). Whoever drives the run answers in
`counts` and calls `drive` again, which goes on with the policy where it was; who cannot do it ends the run.
"""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, vec
from ..events.records import SETTLED, WANT_MEMORY
from ..methods.history import history_time
from ..rounding import SHORTEST
from ..state.run_records import (
    ANSWER,
    ATTEMPTS,
    CAUSE,
    CLOCK_SIZE,
    COUNTS_SIZE,
    DIVIDES,
    DONE,
    EAGER,
    FALL_BACK,
    FIXED_STEP,
    GOES_BY_IMPULSES,
    HALVINGS,
    JAM,
    LAST_RESORT,
    NEAR_SINGULAR,
    NOT_DONE,
    OTHER_ROWS,
    REACHED,
    REMEDY,
    REPAIRED_AT,
    REPARTITION,
    STATUS,
    STEP_SIZE,
    STEP_TOO_SMALL,
    TRIAL_STEP,
    UNANSWERED,
    UNLOCATED,
    UNREPAIRED,
    VIOLATED,
    WANTED,
    call_locate,
    call_settle,
)
from ..state.workspace_records import (
    CONTROL_SIZE,
    INNER_DIVERGED,
    LEAST_CONDITION,
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_LOOP,
    OUTER_SLOW,
    RATE_SCALE,
    RATE_SIZE,
    REANALYZE,
    SINGULAR,
    WORST_CONDITION,
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
    counts, clock = ivec(drive.counts, COUNTS_SIZE), vec(loop_at(drive.loop).clock, CLOCK_SIZE)
    remedy, answer = counts[REMEDY], counts[ANSWER]
    counts[REMEDY], counts[ANSWER] = 0, UNANSWERED
    if remedy == 0:
        now = history_time(method, 0)
        if code == REACHED:
            return OK if grow_parts(clock, now) else code
        counts[CAUSE], counts[ATTEMPTS] = code, 0
        if _may_fall_back(workspace, clock, code):
            return FALL_BACK
        remedy = _first_remedy(clock, code, now)
        if remedy == 0:
            return code
    cause = counts[CAUSE]
    if remedy == BY_PARTITION:
        found = _renew_partition(drive, workspace, counts, answer)
        if found == REPARTITION or found == WANTED:
            counts[REMEDY] = BY_PARTITION
        if found == REPARTITION or found == WANTED or found == OK:
            return found
        # without it the motion does not go on, but where steps fail there is more to try
        more = BY_PASSAGE if found == VIOLATED or cause <= OUTER_SLOW else 0
        remedy, answer = BY_SMALLER_STEP if found == UNLOCATED else more, UNANSWERED
    if remedy == BY_SMALLER_STEP:
        whole = clock[HALVINGS] == 0.0
        if _may_shrink(cause) and clock[FIXED_STEP] == 0.0 and _shrink(workspace, method, clock):
            if cause == REANALYZE:  # the matrix of the shorter step has other pivots
                clock[REPAIRED_AT] = -np.inf
            return OK
        if halve_step(drive, workspace, method, clock):
            return DIVIDES if whole else OK
        remedy = 0 if cause == UNLOCATED else BY_PASSAGE
    if remedy == BY_PASSAGE:
        on_the_way = cause == NEAR_SINGULAR or cause == VIOLATED
        if answer == UNANSWERED and (on_the_way or _strained(workspace, clock)):
            counts[REMEDY] = BY_PASSAGE
            return NEAR_SINGULAR if on_the_way else LAST_RESORT
        if answer == DONE or cause == NEAR_SINGULAR:
            # where there is none near, it will be looked for again later
            return OK
        remedy = 0 if cause == VIOLATED else BY_IMPULSES
    if remedy == BY_IMPULSES and drive.go_by_impulses != 0 and call_settle(drive.go_by_impulses, drive) == SETTLED:
        return GOES_BY_IMPULSES
    # whoever tries again all the same begins anew
    clock[REPAIRED_AT] = -np.inf
    return UNREPAIRED if counts[ATTEMPTS] < 0 else cause


@internal
def _may_fall_back(workspace: Any, clock: Any, code: int) -> bool:
    failed = code == OUTER_DIVERGED or code == OUTER_SLOW
    return failed and clock[EAGER] > 0.0 and vec(workspace.control, CONTROL_SIZE)[OUTER_LOOP] != 0.0


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
    if clock[REPAIRED_AT] == now:
        return BY_SMALLER_STEP
    clock[REPAIRED_AT] = now
    return BY_PARTITION


@internal
def _renew_partition(drive: Any, workspace: Any, counts: Any, answer: int) -> int:
    """A new partition at the newest row; and of an event that could not be located, another search with it: OK,
    REPARTITION or WANTED (what is asked for), UNREPAIRED, UNLOCATED, or VIOLATED (the same redundant rows)."""
    cause = counts[CAUSE]
    while True:
        if answer == UNANSWERED:
            if workspace.n_redundant > 0:
                return REPARTITION
            counts[STATUS] = call_settle(drive.repair, drive)
            if counts[STATUS] != SETTLED and counts[STATUS] <= WANT_MEMORY:
                return WANTED
            answer = DONE if counts[STATUS] == SETTLED else NOT_DONE
        if answer == NOT_DONE:
            counts[ATTEMPTS] = -1
            return UNREPAIRED
        if cause == VIOLATED and answer != OTHER_ROWS:
            return VIOLATED
        if cause != UNLOCATED or call_locate(drive.locate, drive, True) == OK:
            return OK
        counts[ATTEMPTS] += 1
        if counts[ATTEMPTS] == MOST_LOCATIONS:
            return UNLOCATED
        answer = UNANSWERED


@internal
def _may_shrink(cause: int) -> bool:
    return cause == INNER_DIVERGED or cause == SINGULAR or cause == REANALYZE or cause == UNLOCATED


@internal
def _shrink(workspace: Any, method: Any, clock: Any) -> bool:
    """A smaller step after a failure of a repaired system; False if it cannot be smaller."""
    h, scale = 0.25 * clock[TRIAL_STEP], 1.0 / vec(workspace.control, CONTROL_SIZE)[RATE_SCALE]
    clock[STEP_SIZE] = h
    return bool(h > SHORTEST * max(abs(history_time(method, 0)), 1e-6 * scale))


@internal
def _strained(workspace: Any, clock: Any) -> bool:
    """True if the constraints are nearly dependent, and steps under error control have failed on the way there."""
    rate = vec(workspace.rate, RATE_SIZE)
    return clock[FIXED_STEP] == 0.0 and rate[WORST_CONDITION] > STRAINED_GROWTH * rate[LEAST_CONDITION] > 0.0
