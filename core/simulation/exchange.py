"""Inputs in, time on, channels out, in one crossing into compiled code: what a slave does at every step.

Whoever calls `set_inputs`, `advance` and `values` crosses a dozen times, with Python between that takes as long as the
solver. Here stands the way that almost every step goes (`drive.py`). Where a run leaves it, Python goes on from there;
where it cannot go it, nothing has happened.
"""

import math
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..compiled import types
from ..compiled.jit import address_of, compiled, compiled_unlocked, internal
from ..compiled.records import ArrayRecord
from ..compiled.views import ivec, mat, vec
from ..errors import ModelError
from ..event_detection.dense_output import query, query_motion
from ..events.event_handling import begin_anew
from ..events.inconsistent_modes import find_unsettled
from ..events.moved_surfaces import find_moved
from ..events.records import instant_at
from ..methods.history import history_time, recall
from ..model.signals import INPUT_SIZE
from ..multibody_model import Model
from ..rounding import PUNCTUAL, SAME_INPUT
from ..stage.accelerations import solve_accelerations
from ..state.run_records import (
    ACCELERATIONS_SIGNATURE,
    REACHED,
    call_accelerations,
    counts_at,
    goals_at,
)
from ..state.workspace_records import OK, counters_at
from ..time_loop.drive import drive_at, drive_on, loop_at, method_at, workspace_at
from . import advance
from .exchange_record import (
    ASKED_TIME,
    EXCHANGE,
    FIRST_RATE,
    INITIAL_ENERGY,
    INTERVAL,
    LAST_CHANGE,
    NOW,
    QUERY_SIGNATURE,
    RATES_SIZE,
    SECOND_RATE,
    STEPS_BEFORE,
    TIMES_SIZE,
    call_query,
)
from .read_channels import read_at_goal

if TYPE_CHECKING:
    from .simulation import Simulation

# what `exchange` returns, besides what `run` does
DECLINED = 200
"""Nothing has happened."""
ARRIVED = 201
"""At the goal; the channels have not been asked for, or are not to be had in this way."""
READ = 202


@internal
def _input_changes(exchange: Any, workspace: Any) -> int:
    """How many inputs are to change; -1 if one is no finite number."""
    wanted, count, t = vec(exchange.inputs, exchange.n_inputs), 0, vec(exchange.times, TIMES_SIZE)[NOW]
    for k in range(exchange.n_inputs):
        if not np.isfinite(wanted[k]):
            return -1
        if not _goes_on(exchange, workspace, k, t):
            count += 1
    return count


@internal
def _goes_on(exchange: Any, workspace: Any, k: int, t: float) -> bool:
    """Whether input k does at time t what is wanted, anyway (`inputs.py`)."""
    row, rates = (
        mat(workspace.inputs, exchange.n_inputs, INPUT_SIZE)[k],
        mat(exchange.rates, exchange.n_inputs, RATES_SIZE)[k],
    )
    value, first, second = vec(exchange.inputs, exchange.n_inputs)[k], rates[FIRST_RATE], rates[SECOND_RATE]
    if row[1] == 0.0 and row[2] == 0.0:
        return value == row[0] and first == 0.0 and second == 0.0
    x = t - row[3]
    size = abs(row[0]) + abs(x * row[1]) + abs(0.5 * x * x * row[2]) + abs(row[1] * t) + abs(0.5 * row[2] * t * t)
    if abs(value - (row[0] + x * (row[1] + 0.5 * x * row[2]))) > SAME_INPUT * size:
        return False
    size = abs(row[1]) + abs(x * row[2]) + abs(row[2] * t)
    if abs(first - (row[1] + x * row[2])) > SAME_INPUT * size:
        return False
    return bool(abs(second - row[2]) <= SAME_INPUT * abs(row[2]))


@internal
def _change_inputs(exchange: Any, workspace: Any, method: Any, loop: Any, decline: bool) -> bool:
    """Let the inputs take the values that are wanted, and start anew from now, as `restart_here` does; False, with the
    inputs as they were, if that takes more; `decline`: if it makes contacts pending, too."""
    drive = drive_at(exchange.drive)
    instant = instant_at(drive.instant)
    times = vec(exchange.times, TIMES_SIZE)
    wanted, n = vec(exchange.inputs, exchange.n_inputs), exchange.n_inputs
    rows, before = mat(workspace.inputs, n, INPUT_SIZE), mat(exchange.before, n, INPUT_SIZE)
    rates = mat(exchange.rates, n, RATES_SIZE)
    t, newest = times[NOW], history_time(method, 0)
    # the motion up to now is that of the inputs up to now: velocities of surfaces would be met with the new ones
    if t == newest:
        recall(workspace, method, 0)
        status = OK
    else:
        status = call_query(exchange.query, workspace, method, t)
        vec(workspace.t, 1)[0] = t
    for k in range(n):
        for j in range(INPUT_SIZE):
            before[k, j] = rows[k, j]
        if not _goes_on(exchange, workspace, k, t):
            rows[k, 0], rows[k, 1], rows[k, 2] = wanted[k], rates[k, FIRST_RATE], rates[k, SECOND_RATE]
            # since when does not matter to what stays as it is
            rows[k, INPUT_SIZE - 1] = t if rows[k, 1] != 0.0 or rows[k, 2] != 0.0 else 0.0
    if status == OK:
        status = call_accelerations(exchange.accelerations, workspace)
    unsettled, some = ivec(instant.unsettled, workspace.n_contacts), False
    if status == OK:
        some = find_unsettled(instant, workspace, unsettled)
        some = find_moved(workspace, method, unsettled) or some
    if status != OK or (some and decline):
        for k in range(n):
            for j in range(INPUT_SIZE):
                rows[k, j] = before[k, j]
        return False
    begin_anew(workspace, method, loop)
    pending = ivec(drive.pending, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        # what was to happen later than now will not
        pending[k] = max(pending[k] if t == newest else 0, unsettled[k])
    if t > times[LAST_CHANGE]:
        times[LAST_CHANGE], times[INTERVAL] = t, t - times[LAST_CHANGE]
    return True


@internal
def _stop(times: Any) -> float:
    """`next_stop` of the inputs."""
    expected = times[LAST_CHANGE] + times[INTERVAL]
    if not times[NOW] < expected < np.inf:
        return np.inf
    return times[ASKED_TIME] if expected <= times[ASKED_TIME] + PUNCTUAL * times[INTERVAL] else expected


@compiled_unlocked
def exchange(exchange: Any) -> int:
    """Set the inputs, go to the goal, read the channels."""
    workspace, method, loop = workspace_at(exchange.workspace), method_at(exchange.method), loop_at(exchange.loop)
    changes, drive = _input_changes(exchange, workspace), drive_at(exchange.drive)
    if changes < 0 or (changes > 0 and not _change_inputs(exchange, workspace, method, loop, True)):
        return DECLINED
    times = vec(exchange.times, TIMES_SIZE)
    goals, counts = goals_at(drive.goals), counts_at(drive.counts)
    goals.goal, goals.last_stop, counts.budget = times[ASKED_TIME], _stop(times), exchange.chunk
    times[STEPS_BEFORE] = counters_at(workspace.counters).steps + counts.handled
    code = drive_on(drive, workspace, method, loop, False)
    if code != REACHED:
        return code
    return READ if exchange.read != 0 and read_at_goal(exchange, workspace, method) else ARRIVED


@compiled
def tell(exchange: Any) -> bool:
    """Set the inputs, and nothing else; False, with nothing changed, if that takes Python. Contacts whose mode does not
    fit them are pending then."""
    workspace, method, loop = workspace_at(exchange.workspace), method_at(exchange.method), loop_at(exchange.loop)
    changes = _input_changes(exchange, workspace)
    return changes == 0 or (changes > 0 and _change_inputs(exchange, workspace, method, loop, False))


@compiled
def read(exchange: Any) -> bool:
    """Read the channels at the goal, which is no later than the newest row; False if they are not to be had."""
    return read_at_goal(exchange, workspace_at(exchange.workspace), method_at(exchange.method))


class Exchange:
    """What `exchange` of one simulation works with."""

    def __init__(self, sim: "Simulation") -> None:
        assembly, table, loop = sim.assembly, sim.table, sim._loop
        inputs, channels, length = len(assembly.input_names), len(table.channels), int(loop.table["sample_length"][0])
        chunk = min(advance.steps_at_once(assembly.n), sim.settings.max_steps or sys.maxsize)
        self.wanted, self.times = np.zeros(inputs), np.zeros(TIMES_SIZE)
        self.channels, self.sample = np.zeros(channels), np.zeros(length)
        formulas = table.index_arrays()
        self._record = ArrayRecord(
            EXCHANGE,
            {
                "times": self.times, "inputs": self.wanted, "before": np.zeros((inputs, INPUT_SIZE)),
                "rates": np.zeros((inputs, RATES_SIZE)),
                "sample": self.sample, "channels": self.channels, **formulas,
                "wants": np.ones(len(formulas["forced"]), dtype=np.int64),
            },
            {
                "workspace": sim.workspace.address, "method": sim._method.address, "loop": loop.address,
                "drive": sim.drive.address, "query": address_of(query, QUERY_SIGNATURE),
                "query_motion": address_of(query_motion, QUERY_SIGNATURE), "n_wants": len(formulas["forced"]),
                "accelerations": address_of(solve_accelerations, ACCELERATIONS_SIGNATURE),
                "n_inputs": inputs, "chunk": chunk, "read": 0,
                "sample_length": length, "n_channels": channels, "n_sums": len(formulas["summed"]),
                "n_terms": len(formulas["number"]), "n_flags": len(formulas["flags"]), "balance": table.balance,
                "n_derived": len(formulas["derived"]), "n_derived_places": len(formulas["derived_places"]),
                "n_derived_numbers": len(formulas["derived_numbers"]), "first_derived": table.first_derived,
                "n_derived_rates": len(formulas["derived_rates"]),
            },
        )  # fmt: skip
        self.record = self._record.record
        # whose elements are written in half the time of those of the array
        self.clock: Any = self.times.data
        self.reads = False

    @property
    def table(self) -> NDArray[Any]:
        """The record as an array."""
        return self._record.table

    def prepare(self) -> None:
        """Compile `exchange` now, not at the first step."""
        exchange.compile((types.from_dtype(EXCHANGE),))

    def set_reads(self, wanted: bool) -> None:
        """Say whether the channels are to be read."""
        self._record.table["read"] = self.reads = wanted


def possible(sim: "Simulation") -> bool:
    """Whether steps of this run can be made in one crossing at all."""
    recorded = sim._loop.table["capacity"][0] or sim._loop.table["log_capacity"][0]
    return isinstance(sim.system, Model) and sim.compiled_events and not (sim.assembly.motions or recorded)


def exchange_values(sim: "Simulation", inputs: Sequence[float], t: float, read: bool) -> NDArray[np.float64] | None:
    """See `Simulation.exchange`."""
    crossing, now, times = sim.crossing, sim.t, sim.input_times
    if (
        crossing is None
        or sim.pending
        or sim.progress
        or not now <= t < math.inf
        or len(inputs) != len(crossing.wanted)
    ):
        _at_length(sim, inputs, t)
        return None
    clock = crossing.clock
    crossing.wanted[:] = inputs
    clock[NOW], clock[ASKED_TIME], clock[INITIAL_ENERGY] = now, t, sim.table.initial_energy
    clock[LAST_CHANGE], clock[INTERVAL] = times
    if read != crossing.reads:
        crossing.set_reads(read)
    code = exchange(crossing.record)
    if code == DECLINED:
        _at_length(sim, inputs, t)
        return None
    sim.workspace.sync()
    sim.take_events()
    if clock[LAST_CHANGE] != times[0]:
        sim.input_times = clock[LAST_CHANGE], clock[INTERVAL]
    if code < DECLINED:
        sim.go_on(t, int(clock[STEPS_BEFORE]), code)
    sim.t = float(t)
    if code != READ:
        return None
    return crossing.channels.copy()


def _at_length(sim: "Simulation", inputs: Sequence[float], t: float) -> None:
    names = sim.assembly.input_names
    if len(inputs) != len(names):
        raise ModelError(f"{len(inputs)} inputs were given: there are {len(names)}, in the order {names}")
    sim.set_inputs(dict(zip(names, inputs, strict=True)))
    sim.advance(t)
