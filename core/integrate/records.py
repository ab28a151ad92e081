"""The loop record: clock, sample buffer and what the watch over contacts remembers."""

import numpy as np

LOOP = np.dtype(
    [
        (name, np.int64)
        for name in (
            "step", "starter", "rows",          # addresses of the step functions, rows that `step` needs
            "clock",                            # (CLOCK_SIZE,) float64
            "leap",                             # (n,) float64: how far a step may move each coordinate
            "watch",                            # (n_contacts, 3) float64: gap, rate, acceleration at the newest row
            "samples", "capacity", "sample_length",  # buffer of recorded samples; capacity 0: record nothing
            "cursor",                           # (1,) int64: samples in the buffer
        )
    ]
)  # fmt: skip

# columns of `clock`
STEP_SIZE = 0  # proposed next step
STOP_TIME = 1
MAX_STEP = 2
FIXED_STEP = 3  # 0: error controlled
TRIAL_STEP = 4  # step of the last trial (an event or a failure)
FAILURES = 5  # rejected trials in a row
TARGET_TIME = 6  # `run` returns once it is reached; a step may go beyond it
BREAK_TIME = 7  # next time at which a force or a driver's rate jumps
GROWTH = 8  # largest factor by which a step may grow
HOLD = 9  # equal steps that a multistep formula takes between two growths
HELD = 10  # equal steps taken since the last change
CLOCK_SIZE = 11

# what `run` returns besides the status of a failed step
REACHED = 100
EVENT = 101
FULL = 102
CHUNK = 103
STEP_TOO_SMALL = 104
REPARTITION = 105
NEAR_SINGULAR = 106
VIOLATED = 107
