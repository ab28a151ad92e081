"""The compiled time loop: steps until the stop time, an event, a full buffer or a failure."""

from typing import Any

import numpy as np

from ..assembly.levels import position_level
from ..compiled.jit import compiled, compiled_unlocked, internal
from ..compiled.views import ivec, mat, vec
from ..event_detection.broad_phase import go_on
from ..event_detection.contact_sleeping import doze, look_at_all
from ..event_detection.crossings import remember
from ..methods.frames import select_in_frames, step_in_frames
from ..methods.history import history_row, history_time, leave_bridge, push
from ..methods.multistep import rows_available
from ..rounding import CONTRADICTION, COORDINATE_DIFFERENCES, LARGEST, NO_STEP
from ..stage.inner import STRAINED
from ..stage.matrices import CHOICE_GROWTH
from ..state.method_records import CHOICE_SIZE, NEXT_K, NEXT_NORM, K
from ..state.run_records import (
    CHUNK,
    EVENT,
    EVENTS_FULL,
    LOG_COLUMNS,
    NEAR_SINGULAR,
    REACHED,
    REPARTITION,
    STEP_TOO_SMALL,
    VIOLATED,
    call_find_events,
    clock_at,
)
from ..state.workspace_records import (
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_SLOW,
    REANALYZE,
    control_at,
    convergence_at,
    counters_at,
)
from .sample import write_sample
from .step_bound import leap_of
from .step_size import next_step, step_factor

LOG_SIZE = len(LOG_COLUMNS)
AWAY = 8.0  # decrease of the condition after which a singular position is looked for anew
STRAIN = 2.0  # growth of the dependent coordinates' sensitivity that calls for a new partition
LOOK_AGAIN = 5.0  # stages after which a factorisation may be repeated to look at the sensitivity


@internal
def set_weights(workspace: Any, method: Any) -> None:
    """Error weights atol + rtol |y| at the newest row (with fixed steps: of the outer loop's convergence test)."""
    control = control_at(workspace.control)
    row = history_row(workspace, method, 0)
    weight_q, weight_v = vec(workspace.weight_q, workspace.n_ext), vec(workspace.weight_v, workspace.n_ext)
    atol_q, atol_v = vec(workspace.atol_q, workspace.n_ext), vec(workspace.atol_v, workspace.n_ext)
    scale = vec(workspace.scale, workspace.n)
    level_q, level_v = 0.0, 0.0
    for i in range(workspace.n):
        level_q = max(level_q, abs(row[i]) / scale[i])
        level_v = max(level_v, abs(row[workspace.n_ext + i]) / scale[i])
    for i in range(workspace.n):
        # a coordinate near zero has the rounding of the large ones that it is tied to by the constraints
        weight_q[i] = max(atol_q[i], COORDINATE_DIFFERENCES * level_q * scale[i]) + control.rtol * abs(row[i])
        weight_v[i] = max(atol_v[i], COORDINATE_DIFFERENCES * level_v * scale[i]) + control.rtol * abs(
            row[workspace.n_ext + i]
        )
    # work accounts: relative to what they hold, or to the model's own energy (impulse)
    work_scale = vec(workspace.work_scale, workspace.n_ext)
    for i in range(workspace.n_ext - workspace.n_work, workspace.n_ext):
        weight_v[i] = control.atol * work_scale[i] + control.rtol * max(work_scale[i], abs(row[workspace.n_ext + i]))


@compiled
def set_weights_at(workspace: Any, method: Any) -> None:
    """`set_weights`, for Python."""
    set_weights(workspace, method)


@internal
def all_finite(workspace: Any) -> bool:
    """No NaN or infinity in q, v, a, lam, nor what would make one of the energies and the other outputs."""
    for address, count in (
        (workspace.q, workspace.n),
        (workspace.v, workspace.n_ext),
        (workspace.a, workspace.n_ext),
        (workspace.lam, workspace.m_ext - 1),
    ):
        x = vec(address, count)
        for i in range(count):
            if not abs(x[i]) < LARGEST:
                return False
    return True


@compiled_unlocked
def trial_step(workspace: Any, method: Any, loop: Any, h: float) -> int:
    """One step of size h from the newest row, not accepted yet; its end is the workspace's current point."""
    # a formula that looks ahead (extended BDF) must not see what lies behind a jump of a force
    blind = loop.rows > 1 and history_time(method, 0) + 2.000001 * h > clock_at(loop.clock).break_time
    starting = rows_available(method) < loop.rows or blind
    choice = vec(method.choice, CHOICE_SIZE)
    if loop.select != 0 and choice[K] >= loop.rows and rows_available(method) <= choice[K]:
        # a chosen order that the history cannot serve yet
        choice[K] = max(loop.rows, rows_available(method)) - 1.0
    set_weights(workspace, method)
    rate = convergence_at(workspace.rate)
    rate.worst_condition = rate.condition
    status = step_in_frames(workspace, method, loop.starter if starting else loop.step, h)
    if status == OK and not all_finite(workspace):
        return NOT_FINITE
    return status


@internal
def _write_log(workspace: Any, method: Any, loop: Any) -> None:
    """A record of the step that has just been accepted; counters are running totals."""
    cursor = ivec(loop.log_cursor, 1)
    row = mat(loop.log, loop.log_capacity, LOG_SIZE)[cursor[0]]
    counters, clock = counters_at(workspace.counters), clock_at(loop.clock)
    row[0] = history_time(method, 0)
    row[1] = row[0] - history_time(method, 1) if rows_available(method) > 1 else 0.0
    row[2] = vec(method.error, 2)[0]
    row[3] = vec(method.choice, CHOICE_SIZE)[K]
    row[4] = clock.rejected_here
    row[5], row[6] = counters.outer, counters.inner
    row[7], row[8], row[9] = counters.factorizations, counters.evaluations, counters.krylov
    clock.rejected_here = 0.0
    cursor[0] += 1


@compiled
def accept(workspace: Any, method: Any, loop: Any) -> None:
    """The current point becomes the newest row, and a sample and a step record if they are wanted."""
    push(workspace, method)
    remember(workspace, loop)
    doze(workspace, loop)
    go_on(workspace, loop)
    counters_at(workspace.counters).steps += 1
    # a way that begins anew from an earlier time may come to the same row again
    clock_at(loop.clock).repaired_at = -np.inf
    if loop.log_capacity > 0:
        _write_log(workspace, method, loop)
    if loop.capacity > 0 and counters_at(workspace.counters).steps % loop.stride == 0:
        cursor = ivec(loop.cursor, 1)
        look_at_all(workspace, loop)
        write_sample(workspace, mat(loop.samples, loop.capacity, loop.sample_length)[cursor[0]])
        cursor[0] += 1


@internal
def partition_strained(workspace: Any) -> bool:
    """True if the dependent coordinates have become much more sensitive to the independent ones than they were when
    the partition was chosen: q_d(q_i) then has steep derivatives, which costs accuracy long before Phi_qd is singular.
    """
    rate = convergence_at(workspace.rate)
    if rate.sensitivity > STRAIN * max(rate.first_sensitivity, 1.0):
        return True
    if workspace.n_redundant > 0 and rate.condition > CHOICE_GROWTH * rate.choice_condition > 0.0:
        return True
    if workspace.m_act == 0 or workspace.m_act == workspace.n or rate.factor_age < LOOK_AGAIN:
        return False
    # the sensitivity is known from the last factorisation; dependent coordinates that now move faster than the
    # independent ones are a reason to look again: the next stage factors anew
    v, scale = vec(workspace.v, workspace.n_ext), vec(workspace.scale, workspace.n)
    dependent = ivec(workspace.dependent, workspace.m_act)
    everything, of_dependent = 0.0, 0.0
    for i in range(workspace.n):
        everything += (v[i] / scale[i]) ** 2
    for k in range(workspace.m_act):
        of_dependent += (v[dependent[k]] / scale[dependent[k]]) ** 2
    if of_dependent * (workspace.n - workspace.m_act) > (everything - of_dependent) * workspace.m_act:
        rate.factor_age = -1.0
    return False


@compiled
def violates_redundant(workspace: Any, relaxed: float) -> bool:
    """True if the motion breaks a row that was taken for redundant."""
    phi, redundant = vec(workspace.phi, workspace.m_ext), ivec(workspace.redundant, workspace.n_redundant)
    row_scale = vec(workspace.row_scale, workspace.m_ext)
    most = relaxed * CONTRADICTION * position_level(workspace)
    for i in range(workspace.n_redundant):
        if not abs(phi[redundant[i]]) <= most * row_scale[redundant[i]]:
            return True
    return False


@compiled_unlocked
def run(workspace: Any, method: Any, loop: Any, chunk: int) -> int:
    """Up to `chunk` steps. Returns a code of `records` or the status of a step that cannot be made."""
    clock = clock_at(loop.clock)
    counters = counters_at(workspace.counters)
    error = vec(method.error, 2)
    control, rate = control_at(workspace.control), convergence_at(workspace.rate)
    leave_bridge(method)
    for _ in range(chunk):
        t = history_time(method, 0)
        stop = clock.stop_time
        remaining = stop - t
        if t >= clock.target_time or remaining <= NO_STEP * abs(t):
            return REACHED
        if loop.capacity > 0 and ivec(loop.cursor, 1)[0] >= loop.capacity:
            return EVENTS_FULL
        if loop.log_capacity > 0 and ivec(loop.log_cursor, 1)[0] >= loop.log_capacity:
            return EVENTS_FULL
        fixed = clock.fixed_step > 0.0
        wanted = clock.fixed_step if fixed else min(clock.step_size, clock.max_step)
        h = wanted
        if h * (1.0 + 1e-6) >= remaining:
            h = remaining
        elif not fixed and h > 0.5 * remaining:
            h = 0.5 * remaining
        clock.trial_step = h
        multistep = loop.rows > 1 and rows_available(method) >= loop.rows
        status = trial_step(workspace, method, loop, h)
        # a step that fails may have met the position with a stage at which no matrix was measured
        growth = control.most_condition if status == OK else min(control.most_condition, STRAINED)
        near = max(growth * rate.least_condition, rate.looked_condition)
        if not fixed and rate.worst_condition > near:
            return NEAR_SINGULAR
        if status == REANALYZE:
            return status
        if status != OK or (not fixed and not error[0] <= 1.0):
            counters.rejected += 1
            clock.rejected_here += 1.0
            clock.previous_norm = 0.0
            if fixed or (clock.eager > 0.0 and (status == OUTER_DIVERGED or status == OUTER_SLOW)):
                return status
            if status != OK:
                h *= 0.25
            else:
                h *= min(0.9, step_factor(error[0], error[1], 1.0))
            clock.step_size, clock.equal_steps = h, 0.0
            if t + 0.01 * h == t or h < 1e-300:
                return STEP_TOO_SMALL if status == OK else status
            continue
        if workspace.n_contacts > 0 and not fixed:
            leap = leap_of(workspace, method, loop, h)
            if leap > 1.0:
                clock.step_size, clock.equal_steps = 0.9 * h / leap, 0.0
                counters.rejected += 1
                clock.rejected_here += 1.0
                continue
        if workspace.n_redundant > 0 and violates_redundant(workspace, 1.0):
            return VIOLATED
        if workspace.n_contacts > 0 and call_find_events(loop.find_events, workspace, method, loop, h, False):
            return EVENT
        if h == remaining:
            # the stop time itself, not t + h with its rounding
            vec(workspace.t, 1)[0] = stop
        accept(workspace, method, loop)
        if AWAY * rate.condition < rate.looked_condition:
            # not within a trial: a step that leads astray would be looked at again and again
            rate.looked_condition = 0.0
        strained = partition_strained(workspace)
        if not fixed:
            norm, order, hold = error[0], error[1], clock.hold
            choice = vec(method.choice, CHOICE_SIZE)
            if multistep and loop.select != 0:
                hold = choice[K] + 1.0
                if clock.equal_steps >= hold and select_in_frames(workspace, method, loop.select, h):
                    choice[K], order, norm = choice[NEXT_K], choice[NEXT_K], choice[NEXT_NORM]
                    choice[NEXT_K] = 0.0
            proposed = next_step(loop, h, norm, order, multistep, hold)
            clock.step_size = max(proposed, wanted) if h < wanted and proposed >= h else proposed
        if strained:
            return REPARTITION
    return CHUNK
