"""The channels at a time within the newest step, compiled: what `ChannelTable.values` makes of a sample."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, ivec, vec
from ..loop.sample import write_sample
from ..methods.history import bridge_rows, history_time
from ..methods.multistep import rows_available
from ..model.derived import HEAD_SIZE, derive_row
from ..repair.near_singular import STRAINED
from ..state.modes import ACTIVE, CLOSED
from ..state.workspace_records import LEAST_CONDITION, OK, RATE_SIZE, WORST_CONDITION
from .exchange_record import GOAL, INITIAL_ENERGY, TIMES_SIZE, call_query


@internal
def near_singular(ws: Any, ms: Any, t: float) -> bool:
    """`strained` at time t."""
    rate = vec(ws.rate, RATE_SIZE)
    strained = rate[WORST_CONDITION] > STRAINED * rate[LEAST_CONDITION] > 0.0
    inside = rows_available(ms) > 1 and history_time(ms, 1) < t < history_time(ms, 0)
    return (strained and inside) or bridge_rows(ms) > 0


@internal
def read_at_goal(ex: Any, ws: Any, ms: Any) -> bool:
    """The channels at the goal; False if they are not to be had, or one is not finite."""
    t = vec(ex.times, TIMES_SIZE)[GOAL]
    if near_singular(ws, ms, t) or call_query(ex.query, ws, ms, t) != OK:
        return False
    out = vec(ex.channels, ex.n_channels)
    write_sample(ws, vec(ex.sample, ex.sample_length))
    put_channels(ex, out)
    for k in range(ex.n_channels):
        if not np.isfinite(out[k]):
            return False
    return True


@internal
def put_channels(ex: Any, out: Any) -> None:
    """What the sample gives."""
    sample = vec(ex.sample, ex.sample_length)
    places = ivec(ex.places, ex.n_channels)
    for k in range(ex.n_channels):
        out[k] = sample[places[k]]
    summed = ivec(ex.summed, ex.n_sums)
    for k in range(ex.n_sums):
        out[summed[k]] = 0.0
    number, column, signs = ivec(ex.number, ex.n_terms), ivec(ex.column, ex.n_terms), vec(ex.signs, ex.n_terms)
    for i in range(ex.n_terms):
        out[summed[number[i]]] += signs[i] * sample[column[i]]
    out[ex.balance] -= vec(ex.times, TIMES_SIZE)[INITIAL_ENERGY]
    flags, columns = ivec(ex.flags, ex.n_flags), ivec(ex.flag_columns, ex.n_flags)
    for k in range(ex.n_flags):
        mode = sample[columns[k]]
        out[flags[k]] = 1.0 if mode == CLOSED or mode == ACTIVE else 0.0
    if ex.n_derived > 0:
        heads = imat(ex.derived, ex.n_derived, HEAD_SIZE)
        places, numbers = ivec(ex.derived_places, ex.n_derived_places), vec(ex.derived_numbers, ex.n_derived_numbers)
        derive_row(sample, heads, places, numbers, out[ex.first_derived :])
