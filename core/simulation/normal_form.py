"""The normal form of a state: bytes that are equal exactly if the futures are.

Some words of a run's memory decide nothing as it stands: rows of history that nobody looks at any more, the point that
was evaluated last, times that are set before each use. What is stored is a copy in which these are zero, or follow
from the others; the run itself is not touched.

A function here gets how far behind the run's own memory the copy lies: what stands at x is at x + `shift` in the copy.
"""

from typing import Any

import numpy as np

from ..assembly.sticking_force import in_space
from ..compiled import types
from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, mat, vec
from ..events.laws import FORCE, MASSLESS
from ..events.zeno import MANY_TOUCH, pushed_lately
from ..methods.history import history_row, history_time
from ..state.method_records import CARRIES, CHOICE_SIZE, NEXT_K, NEXT_NORM, RING_SIZE
from ..state.modes import (
    APPROACH_SPEED,
    BEGUN_IMPULSE,
    BEGUN_LOSS,
    CLOSED,
    IMPLIED,
    LARGEST_APPROACH,
    MEMORY_SIZE,
    MODE,
    OPEN,
    PUSHED,
    SLIDE,
    SLIDE_START,
    STICKS,
)
from ..state.modes import PUSHES as BLOCKS
from ..state.run_records import (
    A2,
    B2,
    BREAK_TIME,
    BUDGET,
    CALM,
    CLOCK_SIZE,
    COUNTS_SIZE,
    CROWDED,
    DRIVE_TYPE,
    EVENTS,
    FIXED_STEP,
    GOAL,
    GOALS_SIZE,
    HANDLED,
    HANDLED_AT,
    HELD,
    HERE,
    LAST_STOP,
    PASSED,
    PREVIOUS_NORM,
    PREVIOUS_RATIO,
    PUSH_STEP,
    PUSHED_FROM,
    PUSHED_UNTIL,
    PUSHES,
    PUSHES_LEFT,
    REJECTED_HERE,
    STATUS,
    STEP_SIZE,
    STOP_TIME,
    TARGET_TIME,
    TRIAL_STEP,
    WINDOW_COUNT,
    WINDOW_START,
)
from ..state.workspace_records import CORRECTION, FAILED_NORM, RATE_SIZE, WORST_CONDITION
from ..time_loop.drive import drive_at, loop_at, method_at, workspace_at
from .exchange_record import EXCHANGE, FIRST_STEP, NOW, TIMES_SIZE
from .exchange_record import GOAL as GOAL_TIME

OF_COPY = (DRIVE_TYPE, types.int64)
AT_SHIFT = (types.from_dtype(EXCHANGE), types.int64)


@compiled
def normalise_buffer(dr: Any, address: int) -> None:
    """Of a copy of the state's buffer, which begins with the memories of the contacts, at an address."""
    ws = workspace_at(dr.workspace)
    _normalise(dr, ws, method_at(dr.method), loop_at(dr.loop), address - ws.memory)


@compiled
def normalise(ex: Any, shift: int) -> bool:
    """Of a copy of all numbers of a run without Python."""
    dr = drive_at(ex.drive)
    ws, ms = workspace_at(dr.workspace), method_at(dr.method)
    _normalise(dr, ws, ms, loop_at(dr.loop), shift)
    goals, counts, times = (
        vec(dr.goals + shift, GOALS_SIZE), ivec(dr.counts + shift, COUNTS_SIZE), vec(ex.times + shift, TIMES_SIZE)
    )  # fmt: skip
    goals[GOAL] = goals[LAST_STOP] = goals[PASSED] = 0.0
    counts[BUDGET] = counts[HANDLED] = counts[EVENTS] = counts[STATUS] = 0
    if goals[HANDLED_AT] != history_time(ms, 0):
        goals[HANDLED_AT], counts[HERE] = np.nan, 0
    times[NOW] = times[GOAL_TIME] = times[FIRST_STEP] = 0.0
    wanted, chosen = ivec(ws.wanted + shift, ws.n_contacts), ivec(ws.wanted_dependent + shift, ws.n + ws.m_ext)
    for k in range(ws.n_contacts):
        wanted[k] = 0
    for i in range(ws.n + ws.m_ext):
        chosen[i] = 0
    return True


@internal
def _normalise(dr: Any, ws: Any, ms: Any, lc: Any, shift: int) -> None:
    _order_history(ws, ms, shift)
    _place_newest(ws, ms, shift)
    _forget_used(ws, ms, shift)
    _forget_in_clock(dr, ws, ms, lc, shift)
    _forget_in_memories(dr, ws, lc, shift)


@internal
def _order_history(ws: Any, ms: Any, shift: int) -> None:
    """The oldest row first, as after a restart; none beyond the newest."""
    n, length, count = ws.n_ext, ws.row_length, ivec(ms.ring, RING_SIZE)[1]
    rows, times = mat(ms.history + shift, ms.capacity, length), vec(ms.times + shift, ms.capacity)
    carries = vec(ms.parameters, 8)[CARRIES] != 0.0
    for back in range(count):
        row, to = history_row(ws, ms, back), rows[count - 1 - back]
        for i in range(length):
            to[i] = row[i]
        if back > 0 or not carries:
            for i in range(3 * n, 4 * n):
                to[i] = 0.0
        times[count - 1 - back] = history_time(ms, back)
    for j in range(count, ms.capacity):
        times[j], to = 0.0, rows[j]
        for i in range(length):
            to[i] = 0.0
    ivec(ms.ring + shift, RING_SIZE)[0] = count - 1


@internal
def _place_newest(ws: Any, ms: Any, shift: int) -> None:
    """The newest row as the current point: all that goes on begins there."""
    n, newest = ws.n_ext, ivec(ms.ring + shift, RING_SIZE)[0]
    row = mat(ms.history + shift, ms.capacity, ws.row_length)[newest]
    q, v, a, aux = vec(ws.q + shift, n), vec(ws.v + shift, n), vec(ws.a + shift, n), vec(ws.aux + shift, n)
    lam = vec(ws.lam + shift, ws.m_ext)
    for i in range(n):
        q[i], v[i], a[i], aux[i] = row[i], row[n + i], row[2 * n + i], row[3 * n + i]
    for i in range(ws.m_ext):
        lam[i] = row[4 * n + i]
    vec(ws.t + shift, 1)[0] = history_time(ms, 0)


@internal
def _forget_used(ws: Any, ms: Any, shift: int) -> None:
    """What a step, or the search for its order, has said to whoever made it."""
    error, choice, rate = (
        vec(ms.error + shift, 2), vec(ms.choice + shift, CHOICE_SIZE), vec(ws.rate + shift, RATE_SIZE)
    )  # fmt: skip
    error[0] = error[1] = choice[NEXT_K] = choice[NEXT_NORM] = 0.0
    rate[FAILED_NORM] = rate[CORRECTION] = rate[WORST_CONDITION] = 0.0


@internal
def _forget_in_clock(dr: Any, ws: Any, ms: Any, lc: Any, shift: int) -> None:
    """Where the last way went, and what fixed steps, or contacts without friction, have no use for."""
    clock = vec(lc.clock + shift, CLOCK_SIZE)
    clock[STOP_TIME] = clock[TRIAL_STEP] = clock[TARGET_TIME] = clock[BREAK_TIME] = clock[REJECTED_HERE] = 0.0
    if clock[FIXED_STEP] > 0.0:
        clock[STEP_SIZE] = clock[FIXED_STEP]
        clock[HELD] = clock[PREVIOUS_NORM] = 0.0
    if lc.rows == 1:
        clock[HELD] = 0.0
    if clock[PREVIOUS_NORM] == 0.0:
        clock[PREVIOUS_RATIO] = 0.0
    elif clock[B2] == 0.0 and clock[A2] == 0.0:
        # the elementary controller asks only whether there is one
        clock[PREVIOUS_NORM] = clock[PREVIOUS_RATIO] = 1.0
    friction, rubs = vec(dr.friction, ws.n_contacts), False
    for k in range(ws.n_contacts):
        rubs = rubs or friction[k] > 0.0
    if not rubs:
        clock[CROWDED] = 0.0
        if ws.n_contacts < MANY_TOUCH:
            clock[WINDOW_START] = clock[WINDOW_COUNT] = 0.0
    if clock[PUSH_STEP] == 0.0:
        clock[PUSHES_LEFT] = clock[CALM] = clock[PUSHED_FROM] = 0.0
    if clock[PUSH_STEP] == 0.0 and not pushed_lately(ws, lc, history_time(ms, 0)):
        clock[PUSHES] = clock[PUSHED_UNTIL] = 0.0


@internal
def _forget_in_memories(dr: Any, ws: Any, lc: Any, shift: int) -> None:
    """Of contacts: what their law does not ask for in their mode."""
    pushing = vec(lc.clock + shift, CLOCK_SIZE)[PUSH_STEP] != 0.0
    memories, law = mat(ws.memory + shift, ws.n_contacts, MEMORY_SIZE), ivec(dr.law, ws.n_contacts)
    for k in range(ws.n_contacts):
        memory = memories[k]
        for block in range(0 if pushing else BLOCKS):
            memory[PUSHED + block] = 0.0
        if law[k] == FORCE or memory[MODE] != CLOSED:
            memory[IMPLIED] = 0.0
        if law[k] == FORCE:
            memory[LARGEST_APPROACH] = 0.0
            if memory[MODE] == OPEN:
                memory[APPROACH_SPEED] = memory[BEGUN_IMPULSE] = memory[BEGUN_LOSS] = 0.0
        elif law[k] != MASSLESS:
            leans = abs(memory[SLIDE]) == 1.0 or ivec(ws.contact_companion, ws.n_contacts)[k] != 0
            if not in_space(ws, k) or not (memory[MODE] == CLOSED and leans):
                memory[APPROACH_SPEED] = 0.0  # (of what slides in space it is LEAN)
            if not in_space(ws, k) and not (memory[MODE] == CLOSED and memory[SLIDE] == STICKS):
                memory[SLIDE_START] = 0.0
