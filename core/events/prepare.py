"""New partition and new pivots for the structure of the contacts' modes, compiled.

What it does is `tables/partition.prepare`; the elimination is that of `linalg/row_pivoting.py`.
"""

from typing import Any

from ..assembly.compatibility import analyze_equations
from ..assembly.condition_probe import set_probe
from ..assembly.evaluate import evaluate_tangent
from ..assembly.partition_building import partition_wanted
from ..assembly.structure_switch import engage_modes
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..linalg import follow, lu_at
from ..linalg.analyze import call_analyze
from ..linalg.record import WANT_ROOM as NO_MEMORY
from ..linalg.row_pivoting import eliminate
from ..rounding import RANK_TOLERANCE
from ..state.workspace_records import (
    ANALYSES,
    COUNTERS_SIZE,
    FACTOR_AGE,
    FIRST_SENSITIVITY,
    OK,
    PARTITIONS,
    RATE_SIZE,
    SENSITIVITY,
    structure_at,
)
from .records import REPEATED_ROWS, SETTLED, SINGULAR_MATRIX, WANT_MEMORY, WANT_ROOM


@internal
def use_modes(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Take the structure of the present modes, with a partition and pivots for the current point."""
    if engage_modes(ws) != OK:
        return WANT_MEMORY
    evaluate_tangent(ws, 0.0, 0.0)
    status = _choose_partition(ev, ws)
    if status != SETTLED:
        return status
    counters, rate = ivec(ws.counters, COUNTERS_SIZE), vec(ws.rate, RATE_SIZE)
    counters[PARTITIONS] += 1
    counters[ANALYSES] += 1
    code = analyze_equations(ws, ws.kkt)
    if code == OK and ws.m_act > 0:
        code = call_analyze(ws.analyze, lu_at(ws.lu_d), ws.values)
    if code == OK and 0 < ws.m_held < ws.m_act:
        code = call_analyze(ws.analyze, lu_at(ws.lu_p), ws.values)
    if code != OK:
        return WANT_MEMORY if code == NO_MEMORY else SINGULAR_MATRIX
    if follow(lu_at(ws.kkt_query), lu_at(ws.kkt)) != OK:
        return WANT_MEMORY
    set_probe(ws)
    rate[FACTOR_AGE], rate[SENSITIVITY], rate[FIRST_SENSITIVITY] = -1.0, 0.0, -1.0
    return SETTLED


@internal
def _choose_partition(ev: Any, ws: Any) -> int:
    rank = rank_of(ev, ws, RANK_TOLERANCE)
    if rank < 0:
        return WANT_ROOM
    if rank < ws.m_act:
        return REPEATED_ROWS
    partition_wanted(ws)
    return SETTLED


@internal
def rank_of(ev: Any, ws: Any, tolerance: float) -> int:
    """Rank of Phi_q as last evaluated, of whose rows less than `tolerance` is left when they repeat others; the
    coordinates that depend to `wanted_dependent`. -1 where there is too little room."""
    st, m, n, space = structure_at(ws.structure), ws.m_act, ws.n, ev.rows_space
    size, wholes, reals = n + m + 1, ev.row_wholes, ev.row_reals
    values, slots = vec(ws.values, ws.n_values), ivec(st.jacobian_slot, st.n_jacobian)
    owner, mark, wanted = ivec(wholes, n), ivec(wholes + 8 * size, n), ivec(ws.wanted_dependent, m)
    column, pending = ivec(wholes + 16 * size, n), ivec(wholes + 24 * size, n)
    starts, f_starts = ivec(wholes + 32 * size, m + 1), ivec(wholes + 40 * size, m + 1)
    data, x = vec(reals, st.n_jacobian), vec(reals + 8 * space, n)
    for i in range(n):
        owner[i] = mark[i] = -1
        x[i] = 0.0
    for i in range(m):
        wanted[i] = -1
    starts[0] = f_starts[0] = 0
    if st.n_jacobian > space:
        return -1
    for e in range(st.n_jacobian):
        data[e] = values[slots[e]]
    return int(eliminate(
        m, n, ivec(st.jacobian_start, m + 1), ivec(st.jacobian_col, st.n_jacobian), data, vec(ws.scale, n),
        tolerance, wanted, owner, mark, column, pending, x,
        starts, ivec(wholes + 48 * size, space), vec(reals + 8 * (space + size), space),
        f_starts, ivec(wholes + 48 * size + 8 * space, space), vec(reals + 8 * (2 * space + size), space),
    ))  # fmt: skip
