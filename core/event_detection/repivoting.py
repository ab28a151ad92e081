"""Questions about a point of which the matrix has pivots of its own where those of the newest step do not suit it.

The ones from before are put back, and how far the entries of L may grow with them: asking leaves no trace.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_power, evaluate_residuals, evaluate_tangent
from ..assembly.redundant_reactions import analyze_equations, factor_equations, keep_sharing
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, vec
from ..linalg import determinant_sign, lu_at
from ..linalg.analyze import call_analyze
from ..linalg.record import ANALYZE_SPARSE, DENSE
from ..linalg.record import WANT_ROOM as NO_MEMORY
from ..stage.accelerations import solve_accelerations
from ..stage.project import project_motion
from ..state.modes import AT_LIMIT, CLOSED, IDLE, memories_at
from ..state.workspace_records import OK, REANALYZE, SINGULAR


@internal
def take_own_pivots(workspace: Any) -> int:
    """Pivots for the matrix as it was last evaluated: OK, SINGULAR if there are none, REANALYZE if there is too little
    memory for them."""
    lu = lu_at(workspace.kkt_query)
    kept, pivots, limits = vec(workspace.query_kept, 2 * lu.n), ivec(lu.perm_r, lu.n), _limits(lu)
    for i in range(lu.n):
        kept[i], kept[lu.n + i] = pivots[i], limits[i]
    code = analyze_equations(workspace, workspace.kkt_query)
    if code == NO_MEMORY:
        return REANALYZE
    return OK if code == OK else SINGULAR


@internal
def put_back_pivots(workspace: Any) -> None:
    lu = lu_at(workspace.kkt_query)
    kept, wanted = vec(workspace.query_kept, 2 * lu.n), ivec(lu.wanted, lu.n)
    for i in range(lu.n):
        wanted[i] = int(kept[i])
    # they were there before, so there is room for them
    call_analyze(ivec(lu.functions, ANALYZE_SPARSE + 1)[ANALYZE_SPARSE], lu, 0)
    limits = _limits(lu)
    for i in range(lu.n):
        limits[i] = kept[lu.n + i]


@internal
def _limits(lu: Any) -> Any:
    """How far the entries of L may grow, by column."""
    return vec(lu.values + 8 * (lu.nl + lu.nu + lu.n), lu.n)


@internal
def project_between(workspace: Any, motion: bool) -> int:
    """The current point onto the constraints at every level, or its `motion` alone, with the same bits; REANALYZE where
    pivots of its own would take more memory than there is."""
    lu, own = lu_at(workspace.kkt_query), False
    chosen = lu.kind != DENSE and lu.ready != 0
    keep_sharing(workspace, False)
    status = project_motion(workspace)
    if status == REANALYZE and chosen:
        status, own = take_own_pivots(workspace), True
        if status == OK:
            status = _unless_unfit(project_motion(workspace))
    if status == OK and not motion:
        status = solve_accelerations(workspace)
        if own:
            status = _unless_unfit(status)
        elif status == REANALYZE and chosen:
            status, own = take_own_pivots(workspace), True
            if status == OK:
                status = _unless_unfit(solve_accelerations(workspace))
        evaluate_power(workspace)
    if own:
        put_back_pivots(workspace)
    keep_sharing(workspace, True)
    return status if chosen else _unless_unfit(status)


@inlined
def _unless_unfit(status: int) -> int:
    """Where the pivots of this very point do not suit it, there are none."""
    return SINGULAR if status == REANALYZE else status


@internal
def _evaluate_sliding(workspace: Any) -> None:
    """values = [M, G; Phi_q, 0] at the current point, G the directions of the forces: friction of what slides is in
    proportion to its normal force, that of contacts which others hold counts as given.

    Their constant shares of the normal forces choose one friction of many. Beside constraints that nearly repeat each
    other they can turn the determinant's sign by themselves, which says nothing about sliding.
    """
    memory, kept = memories_at(workspace.memory, workspace.n_contacts), vec(workspace.query_kept, workspace.n_contacts)
    evaluate_residuals(workspace)
    for k in range(workspace.n_contacts):
        kept[k] = memory[k].friction_ratio
        if memory[k].mode == CLOSED and (memory[k].slide_mode == IDLE or memory[k].slide_mode == AT_LIMIT):
            memory[k].friction_ratio = 0.0
    evaluate_tangent(workspace, 0.0, 0.0)
    for k in range(workspace.n_contacts):
        memory[k].friction_ratio = kept[k]


@internal
def orientation(workspace: Any) -> float:
    """Sign of the determinant of the matrix of `_evaluate_sliding`; 0 where it is singular, NaN where there is too
    little memory for pivots of its own."""
    _evaluate_sliding(workspace)
    lu = lu_at(workspace.kkt_query)
    if lu.kind != DENSE and lu.ready == 0:
        # pivots that nobody has chosen yet need not be put back
        code = analyze_equations(workspace, workspace.kkt_query)
        if code != OK:
            return np.nan if code == NO_MEMORY else 0.0
    status = factor_equations(workspace, workspace.kkt_query)
    if status == OK or lu.kind == DENSE:
        return determinant_sign(lu) if status == OK else 0.0
    # also where a pivot is next to nothing, for they may have been chosen for other values
    status = take_own_pivots(workspace)
    if status == OK:
        status = factor_equations(workspace, workspace.kkt_query)
    sign = determinant_sign(lu) if status == OK else (np.nan if status == REANALYZE else 0.0)
    put_back_pivots(workspace)
    return sign
