"""The record that `exchange` works with."""

import numpy as np

from ..compiled import types
from ..compiled.jit import caller
from ..state.method_records import METHOD_TYPE
from ..state.workspace_records import WORKSPACE_TYPE

EXCHANGE = np.dtype(
    [
        (name, np.int64)
        for name in (
            "workspace", "method", "loop",                         # addresses of the records
            "drive",                                               # and of that of `drive`
            "query", "accelerations",                              # addresses of functions
            "times",                                               # (TIMES_SIZE,) float64
            "inputs", "before", "n_inputs",                        # wanted; (n_inputs, INPUT_SIZE): what they were
            "rates",                                               # (n_inputs, RATES_SIZE): derivatives that are wanted
            "chunk", "read",
            "sample", "sample_length", "channels", "n_channels",   # one row, and what it gives
            "places", "summed", "n_sums", "number", "column", "signs", "n_terms", "flags", "flag_columns", "n_flags",
            "balance",
            # of derived channels (`model/derived.py`), which follow one another from `first_derived` on
            "derived", "n_derived", "derived_places", "n_derived_places", "derived_numbers", "n_derived_numbers",
            "first_derived",
            "derived_rates", "n_derived_rates",                    # number of each one's rate among them; < 0: none
            "residual_channels",                                   # (3,) int64
            # what is read (`read_channels.py`): the function that finds motion alone; (n_wants,) int64: 1 for kinds of
            # channels that are wanted; the kind of each channel; 1 for kinds that take accelerations
            "query_motion", "wants", "n_wants", "kinds", "forced",
        )
    ]
)  # fmt: skip

# kinds of channels: coordinates, velocities and what follows from them; what takes accelerations and multipliers too;
# energies; then groups of derived ones
MOTION, FORCES, ENERGIES = range(3)
OF_GROUPS = 3

# columns of `times`
NOW = 0
ASKED_TIME = 1
LAST_CHANGE, INTERVAL = 2, 3  # of inputs
INITIAL_ENERGY = 4  # J
STEPS_BEFORE = 5  # steps made, and instants with events, before
TIMES_SIZE = 6
# columns of `rates`
FIRST_RATE, SECOND_RATE = 0, 1
RATES_SINCE = 2  # when they were given: for whoever sets them
RATES_SIZE = 3

QUERY_SIGNATURE = types.int64(WORKSPACE_TYPE, METHOD_TYPE, types.float64)
call_query = caller(QUERY_SIGNATURE)
