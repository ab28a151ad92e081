"""The compiled time loop: steps until the stop time, an event, a full buffer or a failure."""

from typing import Any

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
from ..state.method_records import CHOICE_SIZE, NEXT_K, NEXT_NORM, K, call_step
from ..state.run_records import (
    BREAK_TIME,
    CHUNK,
    CLOCK_SIZE,
    EAGER,
    EVENT,
    FIXED_STEP,
    FULL,
    HELD,
    HOLD,
    LOG_COLUMNS,
    MAX_STEP,
    NEAR_SINGULAR,
    PREVIOUS_NORM,
    REACHED,
    REJECTED_HERE,
    REPARTITION,
    STEP_SIZE,
    STEP_TOO_SMALL,
    STOP_TIME,
    TARGET_TIME,
    TRIAL_STEP,
    VIOLATED,
    call_find_events,
)
from ..state.workspace_records import (
    ATOL,
    CHOICE_CONDITION,
    CONDITION,
    CONTROL_SIZE,
    COUNTERS_SIZE,
    EVALUATIONS,
    FACTOR_AGE,
    FACTORIZATIONS,
    FIRST_SENSITIVITY,
    INNER,
    KRYLOV,
    LEAST_CONDITION,
    LOOKED_CONDITION,
    MOST_CONDITION,
    NOT_FINITE,
    OK,
    OUTER,
    OUTER_DIVERGED,
    OUTER_SLOW,
    RATE_SIZE,
    REANALYZE,
    REJECTED,
    RTOL,
    SENSITIVITY,
    STEPS,
    WORST_CONDITION,
)
from .sample import write_sample
from .step_bound import leap_of
from .step_size import next_step, step_factor

LOG_SIZE = len(LOG_COLUMNS)
AWAY = 8.0  # decrease of the condition after which a singular position is looked for anew
STRAIN = 2.0  # growth of the dependent coordinates' sensitivity that calls for a new partition
LOOK_AGAIN = 5.0  # stages after which a factorisation may be repeated to look at the sensitivity


@internal
def set_weights(ws: Any, ms: Any) -> None:
    """Error weights atol + rtol |y| at the newest row (with fixed steps: of the outer loop's convergence test)."""
    control = vec(ws.control, CONTROL_SIZE)
    row = history_row(ws, ms, 0)
    weight_q, weight_v = vec(ws.weight_q, ws.n_ext), vec(ws.weight_v, ws.n_ext)
    atol_q, atol_v = vec(ws.atol_q, ws.n_ext), vec(ws.atol_v, ws.n_ext)
    scale = vec(ws.scale, ws.n)
    level_q, level_v = 0.0, 0.0
    for i in range(ws.n):
        level_q = max(level_q, abs(row[i]) / scale[i])
        level_v = max(level_v, abs(row[ws.n_ext + i]) / scale[i])
    for i in range(ws.n):
        # a coordinate near zero has the rounding of the large ones that it is tied to by the constraints
        weight_q[i] = max(atol_q[i], COORDINATE_DIFFERENCES * level_q * scale[i]) + control[RTOL] * abs(row[i])
        weight_v[i] = max(atol_v[i], COORDINATE_DIFFERENCES * level_v * scale[i]) + control[RTOL] * abs(
            row[ws.n_ext + i]
        )
    # work accounts: relative to what they hold, or to the model's own energy (impulse)
    work_scale = vec(ws.work_scale, ws.n_ext)
    for i in range(ws.n_ext - ws.n_work, ws.n_ext):
        weight_v[i] = control[ATOL] * work_scale[i] + control[RTOL] * max(work_scale[i], abs(row[ws.n_ext + i]))


@compiled
def set_weights_at(ws: Any, ms: Any) -> None:
    """`set_weights`, for Python."""
    set_weights(ws, ms)


@internal
def all_finite(ws: Any) -> bool:
    """No NaN or infinity in q, v, a, lam, nor what would make one of the energies and the other outputs."""
    for address, count in ((ws.q, ws.n), (ws.v, ws.n_ext), (ws.a, ws.n_ext), (ws.lam, ws.m_ext - 1)):
        x = vec(address, count)
        for i in range(count):
            if not abs(x[i]) < LARGEST:
                return False
    return True


@compiled_unlocked
def trial_step(ws: Any, ms: Any, lc: Any, h: float) -> int:
    """One step of size h from the newest row, not accepted yet; its end is the workspace's current point."""
    # a formula that looks ahead (extended BDF) must not see what lies behind a jump of a force
    blind = lc.rows > 1 and history_time(ms, 0) + 2.000001 * h > vec(lc.clock, CLOCK_SIZE)[BREAK_TIME]
    starting = rows_available(ms) < lc.rows or blind
    choice = vec(ms.choice, CHOICE_SIZE)
    if lc.select != 0 and choice[K] >= lc.rows and rows_available(ms) <= choice[K]:
        # a chosen order that the history cannot serve yet
        choice[K] = max(lc.rows, rows_available(ms)) - 1.0
    set_weights(ws, ms)
    rate = vec(ws.rate, RATE_SIZE)
    rate[WORST_CONDITION] = rate[CONDITION]
    if starting:
        status = call_step(lc.starter, ws, ms, h)
    else:
        status = step_in_frames(ws, ms, lc.step, h)
    if status == OK and not all_finite(ws):
        return NOT_FINITE
    return status


@internal
def _write_log(ws: Any, ms: Any, lc: Any) -> None:
    """A record of the step that has just been accepted; counters are running totals."""
    cursor = ivec(lc.log_cursor, 1)
    row = mat(lc.log, lc.log_capacity, LOG_SIZE)[cursor[0]]
    counters, clock = ivec(ws.counters, COUNTERS_SIZE), vec(lc.clock, CLOCK_SIZE)
    row[0] = history_time(ms, 0)
    row[1] = row[0] - history_time(ms, 1) if rows_available(ms) > 1 else 0.0
    row[2] = vec(ms.error, 2)[0]
    row[3] = vec(ms.choice, CHOICE_SIZE)[K]
    row[4] = clock[REJECTED_HERE]
    row[5], row[6] = counters[OUTER], counters[INNER]
    row[7], row[8], row[9] = counters[FACTORIZATIONS], counters[EVALUATIONS], counters[KRYLOV]
    clock[REJECTED_HERE] = 0.0
    cursor[0] += 1


@compiled
def accept(ws: Any, ms: Any, lc: Any) -> None:
    """The current point becomes the newest row, and a sample and a step record if they are wanted."""
    push(ws, ms)
    remember(ws, lc)
    doze(ws, lc)
    go_on(ws, lc)
    ivec(ws.counters, COUNTERS_SIZE)[STEPS] += 1
    if lc.log_capacity > 0:
        _write_log(ws, ms, lc)
    if lc.capacity > 0 and ivec(ws.counters, COUNTERS_SIZE)[STEPS] % lc.stride == 0:
        cursor = ivec(lc.cursor, 1)
        look_at_all(ws, lc)
        write_sample(ws, mat(lc.samples, lc.capacity, lc.sample_length)[cursor[0]])
        cursor[0] += 1


@internal
def partition_strained(ws: Any) -> bool:
    """True if the dependent coordinates have become much more sensitive to the independent ones than they were when
    the partition was chosen: q_d(q_i) then has steep derivatives, which costs accuracy long before Phi_qd is singular.
    """
    rate = vec(ws.rate, RATE_SIZE)
    if rate[SENSITIVITY] > STRAIN * max(rate[FIRST_SENSITIVITY], 1.0):
        return True
    if ws.n_redundant > 0 and rate[CONDITION] > CHOICE_GROWTH * rate[CHOICE_CONDITION] > 0.0:
        return True
    if ws.m_act == 0 or ws.m_act == ws.n or rate[FACTOR_AGE] < LOOK_AGAIN:
        return False
    # the sensitivity is known from the last factorisation; dependent coordinates that now move faster than the
    # independent ones are a reason to look again: the next stage factors anew
    v, scale = vec(ws.v, ws.n_ext), vec(ws.scale, ws.n)
    dependent = ivec(ws.dependent, ws.m_act)
    everything, of_dependent = 0.0, 0.0
    for i in range(ws.n):
        everything += (v[i] / scale[i]) ** 2
    for k in range(ws.m_act):
        of_dependent += (v[dependent[k]] / scale[dependent[k]]) ** 2
    if of_dependent * (ws.n - ws.m_act) > (everything - of_dependent) * ws.m_act:
        rate[FACTOR_AGE] = -1.0
    return False


@compiled
def violates_redundant(ws: Any, relaxed: float) -> bool:
    """True if the motion breaks a row that was taken for redundant."""
    phi, redundant = vec(ws.phi, ws.m_ext), ivec(ws.redundant, ws.n_redundant)
    row_scale = vec(ws.row_scale, ws.m_ext)
    most = relaxed * CONTRADICTION * position_level(ws)
    for i in range(ws.n_redundant):
        if not abs(phi[redundant[i]]) <= most * row_scale[redundant[i]]:
            return True
    return False


@compiled_unlocked
def run(ws: Any, ms: Any, lc: Any, chunk: int) -> int:
    """Up to `chunk` steps. Returns a code of `records` or the status of a step that cannot be made."""
    clock = vec(lc.clock, CLOCK_SIZE)
    counters = ivec(ws.counters, COUNTERS_SIZE)
    error = vec(ms.error, 2)
    control, rate = vec(ws.control, CONTROL_SIZE), vec(ws.rate, RATE_SIZE)
    leave_bridge(ms)
    for _ in range(chunk):
        t = history_time(ms, 0)
        stop = clock[STOP_TIME]
        remaining = stop - t
        if t >= clock[TARGET_TIME] or remaining <= NO_STEP * abs(t):
            return REACHED
        if lc.capacity > 0 and ivec(lc.cursor, 1)[0] >= lc.capacity:
            return FULL
        if lc.log_capacity > 0 and ivec(lc.log_cursor, 1)[0] >= lc.log_capacity:
            return FULL
        fixed = clock[FIXED_STEP] > 0.0
        wanted = clock[FIXED_STEP] if fixed else min(clock[STEP_SIZE], clock[MAX_STEP])
        h = wanted
        if h * (1.0 + 1e-6) >= remaining:
            h = remaining
        elif not fixed and h > 0.5 * remaining:
            h = 0.5 * remaining
        clock[TRIAL_STEP] = h
        multistep = lc.rows > 1 and rows_available(ms) >= lc.rows
        status = trial_step(ws, ms, lc, h)
        # a step that fails may have met the position with a stage at which no matrix was measured
        growth = control[MOST_CONDITION] if status == OK else min(control[MOST_CONDITION], STRAINED)
        near = max(growth * rate[LEAST_CONDITION], rate[LOOKED_CONDITION])
        if not fixed and rate[WORST_CONDITION] > near:
            return NEAR_SINGULAR
        if status == REANALYZE:
            return status
        if status != OK or (not fixed and not error[0] <= 1.0):
            counters[REJECTED] += 1
            clock[REJECTED_HERE] += 1.0
            clock[PREVIOUS_NORM] = 0.0
            if fixed or (clock[EAGER] > 0.0 and (status == OUTER_DIVERGED or status == OUTER_SLOW)):
                return status
            if status != OK:
                h *= 0.25
            else:
                h *= min(0.9, step_factor(error[0], error[1], 1.0))
            clock[STEP_SIZE], clock[HELD] = h, 0.0
            if t + 0.01 * h == t or h < 1e-300:
                return STEP_TOO_SMALL if status == OK else status
            continue
        if ws.n_contacts > 0 and not fixed:
            leap = leap_of(ws, ms, lc, h)
            if leap > 1.0:
                clock[STEP_SIZE], clock[HELD] = 0.9 * h / leap, 0.0
                counters[REJECTED] += 1
                clock[REJECTED_HERE] += 1.0
                continue
        if ws.n_redundant > 0 and violates_redundant(ws, 1.0):
            return VIOLATED
        if ws.n_contacts > 0 and call_find_events(lc.find_events, ws, ms, lc, h, False):
            return EVENT
        if h == remaining:
            # the stop time itself, not t + h with its rounding
            vec(ws.t, 1)[0] = stop
        accept(ws, ms, lc)
        if AWAY * rate[CONDITION] < rate[LOOKED_CONDITION]:
            # not within a trial: a step that leads astray would be looked at again and again
            rate[LOOKED_CONDITION] = 0.0
        strained = partition_strained(ws)
        if not fixed:
            norm, order, hold = error[0], error[1], clock[HOLD]
            choice = vec(ms.choice, CHOICE_SIZE)
            if multistep and lc.select != 0:
                hold = choice[K] + 1.0
                if clock[HELD] >= hold and select_in_frames(ws, ms, lc.select, h):
                    choice[K], order, norm = choice[NEXT_K], choice[NEXT_K], choice[NEXT_NORM]
                    choice[NEXT_K] = 0.0
            proposed = next_step(lc, h, norm, order, multistep, hold)
            clock[STEP_SIZE] = max(proposed, wanted) if h < wanted and proposed >= h else proposed
        if strained:
            return REPARTITION
    return CHUNK
