"""What redundant joints carry at the current point."""

from typing import Any

from ..assembly.evaluate import evaluate_tangent
from ..assembly.redundant_reactions import factor_shared, keep_sharing, left_of_sharing
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at, solve
from ..linalg.record import DENSE
from ..state.workspace_records import OK
from .repivoting import put_back_pivots, take_own_pivots


@internal
def share_joint_loads(workspace: Any, lam: Any) -> None:
    """To multipliers `lam` (m,), those of the workspace, add what shares the same forces on the bodies among joints
    that repeat each other. Nothing else changes, since the motion does not depend on it. At a singular position, where
    the equations do not tell how joints share, `lam` stays as it is."""
    lu, own = lu_at(workspace.kkt_query), False
    keep_sharing(workspace, False)
    evaluate_tangent(workspace, 0.0, 0.0)
    status = factor_shared(workspace, workspace.kkt_query)
    if status != OK and lu.kind != DENSE and lu.ready != 0:
        # pivots that were chosen elsewhere do not suit this point
        evaluate_tangent(workspace, 0.0, 0.0)
        status, own = take_own_pivots(workspace), True
        if status == OK:
            evaluate_tangent(workspace, 0.0, 0.0)
            status = factor_shared(workspace, workspace.kkt_query)
    if status == OK:
        n, rows = workspace.n, workspace.m_act + workspace.n_implied
        rhs, active = vec(workspace.rhs, n + rows), ivec(workspace.active, rows)
        for i in range(n + rows):
            rhs[i] = 0.0
        left_of_sharing(workspace, True)
        solve(lu_at(workspace.kkt_query), workspace.rhs)
        for i in range(rows):
            lam[active[i]] += rhs[n + i]
    if own:
        put_back_pivots(workspace)
    keep_sharing(workspace, True)
