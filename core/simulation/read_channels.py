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
from ..recovery.near_singular import STRAINED_GROWTH
from ..state.modes import ACTIVE, CLOSED
from ..state.workspace_records import OK, convergence_at
from ..time_loop.sample import write_row
from .exchange_record import ASKED_TIME, ENERGIES, FORCES, INITIAL_ENERGY, OF_GROUPS, TIMES_SIZE, call_query


@internal
def near_singular(workspace: Any, method: Any, t: float) -> bool:
    """`strained` at time t."""
    rate = convergence_at(workspace.rate)
    strained = rate.worst_condition > STRAINED_GROWTH * rate.least_condition > 0.0
    inside = rows_available(method) > 1 and history_time(method, 1) < t < history_time(method, 0)
    return (strained and inside) or bridge_rows(method) > 0


@internal
def read_at_goal(exchange: Any, workspace: Any, method: Any) -> bool:
    """The channels at the goal; False if they are not to be had, or one is not finite."""
    t = vec(exchange.times, TIMES_SIZE)[ASKED_TIME]
    wants, kinds = ivec(exchange.wants, exchange.n_wants), ivec(exchange.kinds, exchange.n_channels)
    address = exchange.query if wants[FORCES] != 0 else exchange.query_motion
    if near_singular(workspace, method, t) or call_query(address, workspace, method, t) != OK:
        return False
    out = vec(exchange.channels, exchange.n_channels)
    write_row(workspace, vec(exchange.sample, exchange.sample_length), wants[ENERGIES] != 0)
    put_channels(exchange, out, wants[OF_GROUPS:])
    for k in range(exchange.n_channels):
        if wants[kinds[k]] != 0 and not np.isfinite(out[k]):
            return False
    return True


ALL, NONE = -1, -2


@compiled
def want(exchange: Any, channel: int) -> bool:
    """Let this channel be read from now on too, ALL, or NONE; whether any is read then that was not before."""
    wants, more = ivec(exchange.wants, exchange.n_wants), False
    if channel < 0 or channel >= exchange.n_channels:
        for k in range(exchange.n_wants):
            more = more or (channel == ALL and wants[k] == 0)
            wants[k] = 1 if channel == ALL else 0
        return more
    kind = ivec(exchange.kinds, exchange.n_channels)[channel]
    if wants[kind] == 0:
        wants[kind], more = 1, True
        if ivec(exchange.forced, exchange.n_wants)[kind] != 0:
            wants[FORCES] = 1
    return more


@internal
def put_channels(exchange: Any, out: Any, groups: Any) -> None:
    """What the sample gives; of derived channels the groups with a 1."""
    sample = vec(exchange.sample, exchange.sample_length)
    places = ivec(exchange.places, exchange.n_channels)
    for k in range(exchange.n_channels):
        out[k] = sample[places[k]]
    summed = ivec(exchange.summed, exchange.n_sums)
    for k in range(exchange.n_sums):
        out[summed[k]] = 0.0
    number, column, signs = (
        ivec(exchange.number, exchange.n_terms),
        ivec(exchange.column, exchange.n_terms),
        vec(exchange.signs, exchange.n_terms),
    )
    for i in range(exchange.n_terms):
        out[summed[number[i]]] += signs[i] * sample[column[i]]
    out[exchange.balance] -= vec(exchange.times, TIMES_SIZE)[INITIAL_ENERGY]
    flags, columns = ivec(exchange.flags, exchange.n_flags), ivec(exchange.flag_columns, exchange.n_flags)
    for k in range(exchange.n_flags):
        mode = sample[columns[k]]
        out[flags[k]] = 1.0 if mode == CLOSED or mode == ACTIVE else 0.0
    if exchange.n_derived > 0:
        heads = imat(exchange.derived, exchange.n_derived, HEAD_SIZE)
        places, numbers = (
            ivec(exchange.derived_places, exchange.n_derived_places),
            vec(exchange.derived_numbers, exchange.n_derived_numbers),
        )
        derived = out[exchange.first_derived :]
        for k in range(exchange.n_derived):
            if groups[k] != 0:
                derive_group(sample, heads, k, places, numbers, derived)
