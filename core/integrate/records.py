"""The loop record: clock, sample buffer and what the watch over contacts remembers."""

import numba as nb
import numpy as np
from numba import types

from ..compiled.jit import caller
from ..methods.records import METHOD_TYPE
from ..system.records import WORKSPACE_TYPE

LOOP = np.dtype(
    [
        (name, np.int64)
        for name in (
            "step", "starter", "rows",          # addresses of the step functions, rows that `step` needs
            "find_events", "accelerations",     # addresses of the watch over contacts and of `solve_accelerations`
            "select",                           # address of the function that chooses the order; 0: none
            "clock",                            # (CLOCK_SIZE,) float64
            "leap",                             # (n,) float64: how far a step may move each coordinate
            "watch",                            # (n_contacts, WATCH) float64: what `remember` says of the newest row
            "near", "probes",                   # (n_contacts, NEAR_SIZE) int64, and a BATCH for each contact
            *(f"probe_{name}" for name in ("q", "v", "a", "r", "lam", "phi", "phid", "phidd", "monitor")),
            "travel",                           # (2, n_ext) float64: bounds of the coordinates' ways within a step
            "brackets",                         # (n_contacts, BRACKET) float64: where in a step events are
            "samples", "capacity", "sample_length",  # buffer of recorded samples; capacity 0: record nothing
            "stride",                           # steps from one recorded sample to the next
            "cursor",                           # (1,) int64: samples in the buffer
            "log", "log_capacity",              # per-step records; capacity 0: none are wanted
            "log_cursor",                       # (1,) int64
        )
    ]
)  # fmt: skip

LOOP_TYPE = nb.from_dtype(LOOP)
FIND_EVENTS_SIGNATURE = types.boolean(WORKSPACE_TYPE, METHOD_TYPE, LOOP_TYPE, types.float64, types.boolean)
call_find_events = caller(FIND_EVENTS_SIGNATURE)
"""call_find_events(address, ws, ms, lc, h, all of them)."""

ACCELERATIONS_SIGNATURE = types.int64(WORKSPACE_TYPE)
call_accelerations = caller(ACCELERATIONS_SIGNATURE)

WATCH = 5
"""Columns of `watch`: gap, rate and acceleration of a contact; rate and acceleration of its sliding distance."""

# columns of `clock`
STEP_SIZE = 0  # proposed next step
STOP_TIME = 1
MAX_STEP = 2
FIXED_STEP = 3  # 0: error controlled
TRIAL_STEP = 4  # step of the last trial (an event or a failure)
TARGET_TIME = 5  # `run` returns once it is reached; a step may go beyond it
BREAK_TIME = 6  # next time at which a force or a driver's rate jumps
GROWTH = 7  # largest factor by which a step may grow
HOLD = 8  # equal steps that a multistep formula takes between two growths
HELD = 9  # equal steps taken since the last change
EAGER = 10  # 1: `run` returns when an outer loop fails, so that another can take over
PREVIOUS_NORM = 11  # of one-step formulas: error norm of the last accepted step; 0: there is none
PREVIOUS_RATIO = 12  # and by how much the step changed after it
B1, B2, A2 = 13, 14, 15  # coefficients of the step-size controller
REJECTED_HERE = 16  # trials that failed since the last accepted step
CLOCK_SIZE = 17

# columns of a per-step record
LOG_COLUMNS = ("t", "h", "error", "k", "rejected", "outer", "inner", "factorizations", "evaluations", "krylov")

# what `run` returns besides the status of a failed step
REACHED = 100
EVENT = 101
FULL = 102
CHUNK = 103
STEP_TOO_SMALL = 104
REPARTITION = 105
NEAR_SINGULAR = 106
VIOLATED = 107
