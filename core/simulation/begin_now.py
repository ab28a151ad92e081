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
    call_sample,
    call_settle,
    clock_at,
    counts_at,
    goals_at,
)
from ..state.workspace_records import OK
from ..time_loop.drive import drive_at, is_due, loop_at, method_at, workspace_at
from .begin import START_UNSOLVED, new_history, start
from .begin_measure import measure, place
from .begin_record import BEGIN_SIZE, DRIVER_ANGLE, DRIVER_SIGN, LESS, MORE, SIGNAL, T0
from .exchange_record import ASKED_TIME, EXCHANGE, INITIAL_ENERGY, INTERVAL, LAST_CHANGE, NOW, TIMES_SIZE

WHOLE_TURN = 2.0 * np.pi

exchange_at = record_view(from_dtype(EXCHANGE))


@compiled
def place_now(begin: Any) -> None:
    """`place`, for Python."""
    place(begin, workspace_at(drive_at(begin.drive).workspace))


@compiled
def measure_now(begin: Any) -> int:
    """`measure`, for Python."""
    drive = drive_at(begin.drive)
    return measure(begin, drive, workspace_at(drive.workspace))


@compiled
def start_now(begin: Any) -> int:
    """`start`, for Python."""
    drive = drive_at(begin.drive)
    workspace, method, loop = workspace_at(drive.workspace), method_at(drive.method), loop_at(drive.loop)
    return start(begin, drive, instant_at(drive.instant), workspace, method, loop)


@compiled
def begin_now(begin: Any) -> int:
    """Begin the run anew with the numbers that its tables have now: SETTLED, or why it cannot."""
    exchange, drive = exchange_at(begin.exchange), drive_at(begin.drive)
    workspace, method, loop = workspace_at(drive.workspace), method_at(drive.method), loop_at(drive.loop)
    t0 = vec(begin.numbers, BEGIN_SIZE)[T0]
    _clear(begin, exchange, drive, workspace, clock_at(loop.clock))
    _turn(begin, workspace, exchange.n_inputs, t0)
    status = measure(begin, drive, workspace)
    if status == SETTLED:
        status = start(begin, drive, instant_at(drive.instant), workspace, method, loop)
    if status != SETTLED:
        return status
    if query(workspace, method, t0) != OK:
        return START_UNSOLVED
    sample = vec(exchange.sample, exchange.sample_length)
    call_sample(drive.write_sample, workspace, sample)
    energy = sample[begin.energies] + sample[begin.energies + 1] + sample[begin.energies + 2]
    vec(exchange.times, TIMES_SIZE)[INITIAL_ENERGY] = energy
    if is_due(drive, workspace):
        status = call_settle(drive.settle, drive)
    else:
        new_history(workspace, method, loop)
    _count_from_here(drive, t0)
    return status


@internal
def _clear(begin: Any, exchange: Any, drive: Any, workspace: Any, clock: Any) -> None:
    """As before a run begins, but for the longest step and the inputs, which are numbers of the model."""
    longest, t0 = clock.max_step, vec(begin.numbers, BEGIN_SIZE)[T0]
    inputs, kept = (
        mat(workspace.inputs, exchange.n_inputs, INPUT_SIZE),
        mat(exchange.before, exchange.n_inputs, INPUT_SIZE),
    )
    for k in range(exchange.n_inputs):
        for i in range(INPUT_SIZE):
            kept[k, i] = inputs[k, i]
    state, blank = ivec(begin.state, begin.n_blank), ivec(begin.blank, begin.n_blank)
    for i in range(begin.n_blank):
        state[i] = blank[i]
    clock.max_step = longest
    for k in range(exchange.n_inputs):
        for i in range(INPUT_SIZE):
            inputs[k, i] = kept[k, i]
    goals_at(drive.goals).handled_at = np.nan
    counts_at(drive.counts).events = 0
    pending = ivec(drive.pending, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        pending[k] = 0
    times = vec(exchange.times, TIMES_SIZE)
    times[NOW], times[ASKED_TIME], times[LAST_CHANGE], times[INTERVAL] = t0, t0, t0, np.inf
    _count_from_here(drive, t0)


@internal
def _turn(begin: Any, workspace: Any, n_inputs: int, t0: float) -> None:
    """Angles at the start with the whole turns that drivers say at this time; as `start_angle3d.py` has it, bit for
    bit."""
    turned, numbers = imat(begin.turned, begin.n_turned, 2), vec(begin.turn_numbers, begin.n_turn_numbers)
    for k in range(begin.n_turned):
        at = turned[k, 1]
        said, _, _ = evaluate_signal(numbers, vec(workspace.inputs, INPUT_SIZE * n_inputs), at + SIGNAL, t0)
        seen = numbers[at + DRIVER_SIGN] * (said + numbers[at + MORE] - numbers[at + LESS])
        angle = numbers[at + DRIVER_ANGLE]
        vec(turned[k, 0], 1)[0] = angle + WHOLE_TURN * np.rint((seen - angle) / WHOLE_TURN)


@internal
def _count_from_here(drive: Any, t0: float) -> None:
    """Counters and the guard against endless events begin."""
    counts, guard = counts_at(drive.counts), vec(drive.guard, GUARD_SIZE)
    counts.budget = counts.handled = counts.here = counts.status = 0
    counts.cause = counts.remedy = counts.attempts = counts.answer = 0
    guard[0], guard[1], guard[2] = t0, t0, 0.0
