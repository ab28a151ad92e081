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
from ..events.zeno import MANY_TOUCH, only_impulses, pushed_lately
from ..methods.history import history_row, history_time
from ..state.impact_law_codes import AT_MASSLESS, BY_FORCE
from ..state.method_records import CARRIES, CHOICE_SIZE, NEXT_K, NEXT_NORM, RING_SIZE
from ..state.modes import CLOSED, OPEN, STICKS, memories_at
from ..state.modes import STEP_FORCES as BLOCKS
from ..state.run_records import (
    DRIVE_TYPE,
    clock_at,
    counts_at,
    goals_at,
)
from ..state.workspace_records import convergence_at
from ..time_loop.drive import drive_at, loop_at, method_at, workspace_at
from .exchange_record import ASKED_TIME as GOAL_TIME
from .exchange_record import EXCHANGE, NOW, STEPS_BEFORE, TIMES_SIZE

OF_COPY = (DRIVE_TYPE, types.int64)
AT_SHIFT = (types.from_dtype(EXCHANGE), types.int64)


@compiled
def normalise_buffer(drive: Any, address: int) -> None:
    """Of a copy of the state's buffer, which begins with the memories of the contacts, at an address."""
    workspace = workspace_at(drive.workspace)
    _normalise(drive, workspace, method_at(drive.method), loop_at(drive.loop), address - workspace.memory)


@compiled
def normalise(exchange: Any, shift: int) -> bool:
    """Of a copy of all numbers of a run without Python."""
    drive = drive_at(exchange.drive)
    workspace, method = workspace_at(drive.workspace), method_at(drive.method)
    _normalise(drive, workspace, method, loop_at(drive.loop), shift)
    goals, counts, times = (
        goals_at(drive.goals + shift),
        counts_at(drive.counts + shift),
        vec(exchange.times + shift, TIMES_SIZE),
    )
    goals.goal = goals.last_stop = goals.passed = 0.0
    counts.budget = counts.handled = counts.events = counts.status = 0
    counts.cause = counts.remedy = counts.attempts = counts.answer = 0
    if goals.handled_at != history_time(method, 0):
        goals.handled_at, counts.here = np.nan, 0
    times[NOW] = times[GOAL_TIME] = times[STEPS_BEFORE] = 0.0
    wanted, chosen = (
        ivec(workspace.wanted + shift, workspace.n_contacts),
        ivec(workspace.wanted_dependent + shift, workspace.n + workspace.m_ext),
    )
    for k in range(workspace.n_contacts):
        wanted[k] = 0
    for i in range(workspace.n + workspace.m_ext):
        chosen[i] = 0
    return True


@internal
def _normalise(drive: Any, workspace: Any, method: Any, loop: Any, shift: int) -> None:
    _order_history(workspace, method, shift)
    _place_newest(workspace, method, shift)
    _forget_used(workspace, method, shift)
    _forget_in_clock(drive, workspace, method, loop, shift)
    _forget_in_memories(drive, workspace, loop, shift)


@internal
def _order_history(workspace: Any, method: Any, shift: int) -> None:
    """The oldest row first, as after a restart; none beyond the newest."""
    n, length, count = workspace.n_ext, workspace.row_length, ivec(method.ring, RING_SIZE)[1]
    rows, times = mat(method.history + shift, method.capacity, length), vec(method.times + shift, method.capacity)
    carries = vec(method.parameters, 8)[CARRIES] != 0.0
    for back in range(count):
        row, to = history_row(workspace, method, back), rows[count - 1 - back]
        for i in range(length):
            to[i] = row[i]
        if back > 0 or not carries:
            for i in range(3 * n, 4 * n):
                to[i] = 0.0
        times[count - 1 - back] = history_time(method, back)
    for j in range(count, method.capacity):
        times[j], to = 0.0, rows[j]
        for i in range(length):
            to[i] = 0.0
    ivec(method.ring + shift, RING_SIZE)[0] = count - 1


@internal
def _place_newest(workspace: Any, method: Any, shift: int) -> None:
    """The newest row as the current point: all that goes on begins there."""
    n, newest = workspace.n_ext, ivec(method.ring + shift, RING_SIZE)[0]
    row = mat(method.history + shift, method.capacity, workspace.row_length)[newest]
    q, v, a, aux = (
        vec(workspace.q + shift, n),
        vec(workspace.v + shift, n),
        vec(workspace.a + shift, n),
        vec(workspace.aux + shift, n),
    )
    lam = vec(workspace.lam + shift, workspace.m_ext)
    for i in range(n):
        q[i], v[i], a[i], aux[i] = row[i], row[n + i], row[2 * n + i], row[3 * n + i]
    for i in range(workspace.m_ext):
        lam[i] = row[4 * n + i]
    vec(workspace.t + shift, 1)[0] = history_time(method, 0)


@internal
def _forget_used(workspace: Any, method: Any, shift: int) -> None:
    """What a step, or the search for its order, has said to whoever made it."""
    error, choice, rate = (
        vec(method.error + shift, 2), vec(method.choice + shift, CHOICE_SIZE), convergence_at(workspace.rate + shift)
    )  # fmt: skip
    error[0] = error[1] = choice[NEXT_K] = choice[NEXT_NORM] = 0.0
    rate.failed_norm = rate.correction = rate.worst_condition = 0.0


@internal
def _forget_in_clock(drive: Any, workspace: Any, method: Any, loop: Any, shift: int) -> None:
    """Where the last way went, and what fixed steps, or contacts without friction, have no use for."""
    clock = clock_at(loop.clock + shift)
    clock.stop_time = clock.trial_step = clock.target_time = clock.break_time = clock.rejected_here = 0.0
    if clock.fixed_step > 0.0:
        clock.step_size = clock.fixed_step
        clock.equal_steps = clock.previous_norm = 0.0
    if clock.repaired_at != history_time(method, 0):
        clock.repaired_at = -np.inf
    if clock.halvings == 0.0:
        clock.failures = clock.divided_until = clock.parts_until = 0.0
    if loop.rows == 1:
        clock.equal_steps = 0.0
    if clock.previous_norm == 0.0:
        clock.previous_ratio = 0.0
    elif clock.b2 == 0.0 and clock.a2 == 0.0:
        # the elementary controller asks only whether there is one
        clock.previous_norm = clock.previous_ratio = 1.0
    friction, rubs = vec(drive.friction, workspace.n_contacts), False
    for k in range(workspace.n_contacts):
        rubs = rubs or friction[k] > 0.0
    if not rubs:
        clock.crowded = 0.0
        if workspace.n_contacts < MANY_TOUCH:
            clock.window_start = clock.window_count = 0.0
    if clock.push_step == 0.0:
        clock.pushes_left = clock.calm = clock.pushed_from = 0.0
    lately = pushed_lately(workspace, loop, history_time(method, 0))
    if clock.push_step == 0.0 and not lately and not only_impulses(loop):
        clock.pushes = clock.pushed_until = 0.0


@internal
def _forget_in_memories(drive: Any, workspace: Any, loop: Any, shift: int) -> None:
    """Of contacts: what their law does not ask for in their mode."""
    pushing = clock_at(loop.clock + shift).push_step != 0.0
    memories, law = memories_at(workspace.memory + shift, workspace.n_contacts), ivec(drive.law, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        memory = memories[k]
        for block in range(0 if pushing else BLOCKS):
            memory.step_force[block] = 0.0
        if law[k] == BY_FORCE or memory.mode != CLOSED:
            memory.implied_rows = 0.0
        if law[k] == BY_FORCE:
            memory.largest_approach = 0.0
            if memory.mode == OPEN:
                memory.approach_speed = memory.begun_impulse = memory.begun_loss = memory.laid_mass = 0.0
            continue
        memory.laid_mass = 0.0
        if not in_space(workspace, k):
            memory.tangent_angle = memory.tangent_axis = memory.slow_sliding = memory.sliding_lean = 0.0
        if law[k] != AT_MASSLESS:
            memory.approach_speed = 0.0
            leans = abs(memory.slide_mode) == 1.0 or ivec(workspace.contact_companion, workspace.n_contacts)[k] != 0
            if memory.mode != CLOSED or not leans:
                memory.sliding_lean = 0.0
            if in_space(workspace, k) or memory.mode != CLOSED or memory.slide_mode != STICKS:
                memory.slide_start = 0.0
