"""New partition and new pivots for the structure of the contacts' modes, compiled.

What it does is `tables/partition.prepare`; the elimination is that of `linalg/row_pivoting.py`.
"""

from typing import Any

from ..assembly.condition_probe import set_probe
from ..assembly.evaluate import evaluate_tangent
from ..assembly.partition_building import partition_wanted
from ..assembly.redundant_reactions import analyze_equations
from ..assembly.structure_switch import engage_modes
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..linalg import follow, lu_at
from ..linalg.analyze import call_analyze
from ..linalg.record import WANT_ROOM as NO_MEMORY
from ..linalg.row_pivoting import eliminate
from ..rounding import RANK_TOLERANCE
from ..state.workspace_records import (
    OK,
    convergence_at,
    counters_at,
    structure_at,
)
from .records import OF_ELIMINATION, REPEATED_ROWS, SETTLED, SINGULAR_MATRIX, WANT_MEMORY, WANTS_ROOM, scalars


@internal
def use_modes(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Take the structure of the present modes, with a partition and pivots for the current point."""
    if engage_modes(workspace) != OK:
        return WANT_MEMORY
    evaluate_tangent(workspace, 0.0, 0.0)
    status = _choose_partition(instant, workspace)
    if status != SETTLED:
        return status
    counters, rate = counters_at(workspace.counters), convergence_at(workspace.rate)
    counters.partitions += 1
    counters.analyses += 1
    code = analyze_equations(workspace, workspace.kkt)
    if code == OK and workspace.m_act > 0:
        code = call_analyze(workspace.analyze, lu_at(workspace.lu_d), workspace.values)
    if code == OK and 0 < workspace.m_held < workspace.m_act:
        code = call_analyze(workspace.analyze, lu_at(workspace.lu_p), workspace.values)
    if code != OK:
        return WANT_MEMORY if code == NO_MEMORY else SINGULAR_MATRIX
    if follow(lu_at(workspace.kkt_query), lu_at(workspace.kkt)) != OK:
        return WANT_MEMORY
    set_probe(workspace)
    rate.factor_age, rate.sensitivity, rate.first_sensitivity = -1.0, 0.0, -1.0
    return SETTLED


@internal
def _choose_partition(instant: Any, workspace: Any) -> int:
    rank = rank_of(instant, workspace, RANK_TOLERANCE)
    if rank < 0:
        scalars(instant).short_of = OF_ELIMINATION
        return WANTS_ROOM
    if rank < workspace.m_act:
        return REPEATED_ROWS
    partition_wanted(workspace)
    return SETTLED


@internal
def rank_of(instant: Any, workspace: Any, tolerance: float) -> int:
    """Rank of Phi_q as last evaluated, of whose rows less than `tolerance` is left when they repeat others; the
    coordinates that depend to `wanted_dependent`. -1 where there is too little room."""
    structure, m, n, space = structure_at(workspace.structure), workspace.m_act, workspace.n, instant.rows_space
    size, wholes, reals = n + m + 1, instant.row_wholes, instant.row_reals
    values, slots = vec(workspace.values, workspace.n_values), ivec(structure.jacobian_slot, structure.n_jacobian)
    owner, mark, wanted = ivec(wholes, n), ivec(wholes + 8 * size, n), ivec(workspace.wanted_dependent, m)
    column, pending = ivec(wholes + 16 * size, n), ivec(wholes + 24 * size, n)
    starts, f_starts = ivec(wholes + 32 * size, m + 1), ivec(wholes + 40 * size, m + 1)
    data, x = vec(reals, structure.n_jacobian), vec(reals + 8 * space, n)
    for i in range(n):
        owner[i] = mark[i] = -1
        x[i] = 0.0
    for i in range(m):
        wanted[i] = -1
    starts[0] = f_starts[0] = 0
    if structure.n_jacobian > space:
        return -1
    for e in range(structure.n_jacobian):
        data[e] = values[slots[e]]
    return int(eliminate(
        m, n, ivec(structure.jacobian_start, m + 1), ivec(structure.jacobian_col, structure.n_jacobian), data,
        vec(workspace.scale, n),
        tolerance, wanted, owner, mark, column, pending, x,
        starts, ivec(wholes + 48 * size, space), vec(reals + 8 * (space + size), space),
        f_starts, ivec(wholes + 48 * size + 8 * space, space), vec(reals + 8 * (2 * space + size), space),
    ))  # fmt: skip
