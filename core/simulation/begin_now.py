"""The start of a run as functions that are called from outside.

Python calls its parts (`start.py`). Where there is no Python a run begins as a whole, with other numbers in the tables
than before, or at another time.
"""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal, record_view
from ..compiled.types import from_dtype
from ..compiled.views import imat, ivec, mat, vec
from ..event_detection.dense_output import query
from ..events.progress import GUARD_SIZE
from ..events.records import SETTLED, instant_at
from ..model.signals import INPUT_SIZE, evaluate_signal
from ..state.run_records import (
    CLOCK_SIZE,
    COUNTS_SIZE,
    EVENTS,
    GOALS_SIZE,
    HANDLED_AT,
    MAX_STEP,
    call_sample,
    call_settle,
)
from ..state.workspace_records import OK
from ..time_loop.drive import drive_at, is_due, loop_at, method_at, workspace_at
from .begin import NO_START, new_history, start
from .begin_measure import measure, place
from .begin_record import ANGLE, BEGIN_SIZE, LESS, MORE, SIGN, SIGNAL, T0
from .exchange_record import EXCHANGE, GOAL, INITIAL_ENERGY, INTERVAL, LAST_CHANGE, NOW, TIMES_SIZE

WHOLE_TURN = 2.0 * np.pi

exchange_at = record_view(from_dtype(EXCHANGE))


@compiled
def place_now(bg: Any) -> None:
    """`place`, for Python."""
    place(bg, workspace_at(drive_at(bg.drive).workspace))


@compiled
def measure_now(bg: Any) -> int:
    """`measure`, for Python."""
    dr = drive_at(bg.drive)
    return measure(bg, dr, workspace_at(dr.workspace))


@compiled
def start_now(bg: Any) -> int:
    """`start`, for Python."""
    dr = drive_at(bg.drive)
    ws, ms, lc = workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop)
    return start(bg, dr, instant_at(dr.instant), ws, ms, lc)


@compiled
def begin_now(bg: Any) -> int:
    """Begin the run anew with the numbers that its tables have now: SETTLED, or why it cannot."""
    ex, dr = exchange_at(bg.exchange), drive_at(bg.drive)
    ws, ms, lc = workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop)
    t0 = vec(bg.numbers, BEGIN_SIZE)[T0]
    _clear(bg, ex, dr, ws, vec(lc.clock, CLOCK_SIZE))
    _turn(bg, ws, ex.n_inputs, t0)
    status = measure(bg, dr, ws)
    if status == SETTLED:
        status = start(bg, dr, instant_at(dr.instant), ws, ms, lc)
    if status != SETTLED:
        return status
    if query(ws, ms, t0) != OK:
        return NO_START
    sample = vec(ex.sample, ex.sample_length)
    call_sample(dr.write_sample, ws, sample)
    energy = sample[bg.energies] + sample[bg.energies + 1] + sample[bg.energies + 2]
    vec(ex.times, TIMES_SIZE)[INITIAL_ENERGY] = energy
    if is_due(dr, ws):
        status = call_settle(dr.settle, dr)
    else:
        new_history(ws, ms, lc)
    _count_from_here(dr, t0)
    return status


@internal
def _clear(bg: Any, ex: Any, dr: Any, ws: Any, clock: Any) -> None:
    """As before a run begins, but for the longest step and the inputs, which are numbers of the model."""
    longest, t0 = clock[MAX_STEP], vec(bg.numbers, BEGIN_SIZE)[T0]
    inputs, kept = mat(ws.inputs, ex.n_inputs, INPUT_SIZE), mat(ex.before, ex.n_inputs, INPUT_SIZE)
    for k in range(ex.n_inputs):
        for i in range(INPUT_SIZE):
            kept[k, i] = inputs[k, i]
    state, blank = ivec(bg.state, bg.n_blank), ivec(bg.blank, bg.n_blank)
    for i in range(bg.n_blank):
        state[i] = blank[i]
    clock[MAX_STEP] = longest
    for k in range(ex.n_inputs):
        for i in range(INPUT_SIZE):
            inputs[k, i] = kept[k, i]
    vec(dr.goals, GOALS_SIZE)[HANDLED_AT] = np.nan
    ivec(dr.counts, COUNTS_SIZE)[EVENTS] = 0
    pending = ivec(dr.pending, ws.n_contacts)
    for k in range(ws.n_contacts):
        pending[k] = 0
    times = vec(ex.times, TIMES_SIZE)
    times[NOW], times[GOAL], times[LAST_CHANGE], times[INTERVAL] = t0, t0, t0, np.inf
    _count_from_here(dr, t0)


@internal
def _turn(bg: Any, ws: Any, n_inputs: int, t0: float) -> None:
    """Angles at the start with the whole turns that drivers say at this time; as `start_angle3d.py` has it, bit for
    bit."""
    turned, numbers = imat(bg.turned, bg.n_turned, 2), vec(bg.turn_numbers, bg.n_turn_numbers)
    for k in range(bg.n_turned):
        at = turned[k, 1]
        said, _, _ = evaluate_signal(numbers, vec(ws.inputs, INPUT_SIZE * n_inputs), at + SIGNAL, t0)
        seen = numbers[at + SIGN] * (said + numbers[at + MORE] - numbers[at + LESS])
        angle = numbers[at + ANGLE]
        vec(turned[k, 0], 1)[0] = angle + WHOLE_TURN * np.rint((seen - angle) / WHOLE_TURN)


@internal
def _count_from_here(dr: Any, t0: float) -> None:
    """Counters and the guard against endless events begin."""
    counts, guard = ivec(dr.counts, COUNTS_SIZE), vec(dr.guard, GUARD_SIZE)
    for i in range(COUNTS_SIZE):
        if i != EVENTS:
            counts[i] = 0
    guard[0], guard[1], guard[2] = t0, t0, 0.0
