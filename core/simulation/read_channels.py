"""The channels at a time within the newest step, compiled: what `ChannelTable.values` makes of a sample.

Whoever reads a few channels says which (`want`): motion alone takes no accelerations, which cost most, and the others
what they are made of. Channels of other kinds are anything. Those that are read have the same bits, whatever else is.
"""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal
from ..compiled.views import imat, ivec, vec
from ..methods.history import bridge_rows, history_time
from ..methods.multistep import rows_available
from ..model.derived import HEAD_SIZE, derive_group
from ..recovery.near_singular import STRAINED
from ..state.modes import ACTIVE, CLOSED
from ..state.workspace_records import LEAST_CONDITION, OK, RATE_SIZE, WORST_CONDITION
from ..time_loop.sample import write_row
from .exchange_record import ENERGIES, FORCES, GOAL, INITIAL_ENERGY, OF_GROUPS, TIMES_SIZE, call_query


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
    wants, kinds = ivec(ex.wants, ex.n_wants), ivec(ex.kinds, ex.n_channels)
    address = ex.query if wants[FORCES] != 0 else ex.query_motion
    if near_singular(ws, ms, t) or call_query(address, ws, ms, t) != OK:
        return False
    out = vec(ex.channels, ex.n_channels)
    write_row(ws, vec(ex.sample, ex.sample_length), wants[ENERGIES] != 0)
    put_channels(ex, out, wants[OF_GROUPS:])
    for k in range(ex.n_channels):
        if wants[kinds[k]] != 0 and not np.isfinite(out[k]):
            return False
    return True


ALL, NONE = -1, -2


@compiled
def want(ex: Any, channel: int) -> bool:
    """Let this channel be read from now on too, ALL, or NONE; whether any is read then that was not before."""
    wants, more = ivec(ex.wants, ex.n_wants), False
    if channel < 0 or channel >= ex.n_channels:
        for k in range(ex.n_wants):
            more = more or (channel == ALL and wants[k] == 0)
            wants[k] = 1 if channel == ALL else 0
        return more
    kind = ivec(ex.kinds, ex.n_channels)[channel]
    if wants[kind] == 0:
        wants[kind], more = 1, True
        if ivec(ex.forced, ex.n_wants)[kind] != 0:
            wants[FORCES] = 1
    return more


@internal
def put_channels(ex: Any, out: Any, groups: Any) -> None:
    """What the sample gives; of derived channels the groups with a 1."""
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
        derived = out[ex.first_derived :]
        for k in range(ex.n_derived):
            if groups[k] != 0:
                derive_group(sample, heads, k, places, numbers, derived)
