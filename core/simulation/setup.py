"""The records of one run: what its formula remembers, and what its time loop works with."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.state_fields import Field, row_length
from ..assembly.workspace import Workspace
from ..compiled.jit import address_of
from ..compiled.records import ArrayRecord
from ..event_detection.balls import build_balls
from ..event_detection.contact_evaluation import build_probes
from ..event_detection.crossings import find_events
from ..event_detection.pool_tables import build_pool, pool_sizes
from ..events.progress import GUARD_SIZE
from ..methods.order_selection import LEAST_K, MOST_K, select_stable_k
from ..methods.registry import FINE_STARTER, STARTER, Formula
from ..stage.accelerations import solve_accelerations
from ..state.method_records import (
    CARRIES,
    CHOICE_SIZE,
    ESTIMATE,
    METHOD,
    PREDICTS,
    RING_SIZE,
    WEIGHTS_WIDTH,
    K,
    step_address,
)
from ..state.run_records import (
    ACCELERATIONS_SIGNATURE,
    CLOCK_SIZE,
    FIND_EVENTS_SIGNATURE,
    LOG_COLUMNS,
    LOOP,
    WATCH,
    clock_of,
)
from ..time_loop.controllers import CONTROLLERS
from ..time_loop.sample import empty_buffer, sample_length
from .settings import Settings

HISTORY_ROWS = 12
"""Rows of (q, v, a) that a multistep formula may look back on."""
_LARGEST_BUFFER = 4_000_000
_LOG_ROWS = 4096


def state_fields(assembly: Assembly) -> list[Field]:
    """The fields of the state that belong to formula and time loop: history of accepted rows and its ring, error norm
    and choice of the order (`methods/records.py`), clock and watch over contacts (`records.py`), and the guard against
    endless events (`events/progress.py`)."""
    return [
        ("method_history", np.float64, (HISTORY_ROWS, row_length(assembly))),
        ("method_times", np.float64, (HISTORY_ROWS,)),
        ("method_ring", np.int64, (RING_SIZE,)),
        ("method_parameters", np.float64, (8,)),
        ("method_weights", np.float64, (8, WEIGHTS_WIDTH)),
        ("method_error", np.float64, (2,)),
        ("method_choice", np.float64, (CHOICE_SIZE,)),
        ("clock", np.float64, (CLOCK_SIZE,)),
        ("watch", np.float64, (max(len(assembly.contacts), 1), WATCH)),
        ("guard", np.float64, (GUARD_SIZE,)),
    ]


def build_method(formula: Formula, settings: Settings, assembly: Assembly, state: NDArray[Any]) -> ArrayRecord:
    """The METHOD record of a formula: its coefficients and an empty history, in the state's buffer (1,)."""
    impulses = formula.impulses and bool(assembly.contacts)
    names = ("history", "times", "ring", "parameters", "weights", "error", "choice")
    arrays = {name: state[f"method_{name}"][0] for name in names}
    parameters, weights = arrays["parameters"], arrays["weights"]
    parameters[: len(formula.parameters)] = formula.parameters
    if formula.stage is None:
        parameters[PREDICTS] = float(formula.sums_up > 0.0 or formula.embedded)
    parameters[CARRIES] = float(formula.carries and impulses == formula.impulses)
    parameters[ESTIMATE] = float(settings.step is None and not impulses)
    if formula.select is select_stable_k and not assembly.has_waves:
        parameters[LEAST_K] = parameters[MOST_K]
    for row, values in zip(weights, formula.weights, strict=False):
        row[: len(values)] = values
    arrays["choice"][K] = formula.k
    return ArrayRecord(METHOD, arrays, {"capacity": HISTORY_ROWS, "exact": int(formula.exact)})


def _set_clock(clock: Any, formula: Formula, settings: Settings, longest_step: float) -> None:
    """What the time loop knows about steps before the first one (`records.py`)."""
    clock.fixed_step = settings.step or 0.0
    clock.largest_growth, clock.hold = formula.growth, float(formula.rows)
    controller = CONTROLLERS[settings.controller]
    clock.b1, clock.b2, clock.a2 = controller.b1, controller.b2, controller.a2
    clock.eager = float(settings.fallback)
    clock.max_step = min(settings.max_step or math.inf, longest_step)
    clock.stop_time = clock.break_time = math.inf
    clock.repaired_at = -math.inf


def build_loop(
    workspace: Workspace, formula: Formula, settings: Settings, record: int, step_records: bool
) -> ArrayRecord:
    """The LOOP record of a run; buffers have room for one row only where nothing is to be recorded.

    `record` : every so many steps a sample; 0: none.
    """
    assembly = workspace.assembly
    length = sample_length(assembly.n, assembly.m, len(assembly.contacts), len(assembly.work_names), assembly.n_slots)
    capacity = max(16, min(4096, _LARGEST_BUFFER // length)) if record else 0
    log_capacity = _LOG_ROWS if step_records else 0
    balls = build_balls(assembly)
    clock, watch = workspace.state["clock"][0], workspace.state["watch"][0]
    impulses = formula.impulses and bool(assembly.contacts)
    _set_clock(clock_of(clock), formula, settings, assembly.longest_step)
    starter, fine_starter = STARTER if settings.step is None else FINE_STARTER, FINE_STARTER
    if impulses:
        starter = fine_starter = formula.step
    return ArrayRecord(
        LOOP,
        {
            "clock": clock,
            "watch": watch,
            "leap": assembly.leap,
            **build_probes(workspace),
            **balls,
            **build_pool(workspace, len(balls["pair_found"])),
            "samples": empty_buffer(max(capacity, 1), length),
            "cursor": np.zeros(1, dtype=np.int64),
            "log": empty_buffer(max(log_capacity, 1), len(LOG_COLUMNS)),
            "log_cursor": np.zeros(1, dtype=np.int64),
        },
        {
            "find_events": address_of(find_events, FIND_EVENTS_SIGNATURE),
            "accelerations": address_of(solve_accelerations, ACCELERATIONS_SIGNATURE),
            "select": 0 if formula.select is None else step_address(formula.select),
            "log_capacity": log_capacity,
            "step": step_address(formula.step),
            "starter": step_address(starter),
            "fine_starter": step_address(fine_starter),
            "rows": formula.rows,
            "capacity": capacity,
            "only_impulses": int(impulses),
            "may_sleep": 0,
            "n_balls": len(balls["balls"]),
            **pool_sizes(assembly),
            "stride": max(int(record), 1),
            "sample_length": length,
        },
    )
