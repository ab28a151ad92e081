"""What redundant joints carry at the current point."""

from typing import Any

from ..assembly.compatibility import factor_shared, keep_sharing, left_of_sharing
from ..assembly.evaluate import evaluate_tangent
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at, solve
from ..linalg.record import DENSE
from ..state.workspace_records import OK
from .repivoting import put_back_pivots, take_own_pivots


@internal
def share_joint_loads(ws: Any, lam: Any) -> None:
    """To multipliers `lam` (m,), those of the workspace, add what shares the same forces on the bodies among joints
    that repeat each other. Nothing else changes, since the motion does not depend on it. At a singular position, where
    the equations do not tell how joints share, `lam` stays as it is."""
    lu, own = lu_at(ws.kkt_query), False
    keep_sharing(ws, False)
    evaluate_tangent(ws, 0.0, 0.0)
    status = factor_shared(ws, ws.kkt_query)
    if status != OK and lu.kind != DENSE and lu.ready != 0:
        # pivots that were chosen elsewhere do not suit this point
        evaluate_tangent(ws, 0.0, 0.0)
        status, own = take_own_pivots(ws), True
        if status == OK:
            evaluate_tangent(ws, 0.0, 0.0)
            status = factor_shared(ws, ws.kkt_query)
    if status == OK:
        n, rows = ws.n, ws.m_act + ws.n_implied
        rhs, active = vec(ws.rhs, n + rows), ivec(ws.active, rows)
        for i in range(n + rows):
            rhs[i] = 0.0
        left_of_sharing(ws, True)
        solve(lu_at(ws.kkt_query), ws.rhs)
        for i in range(rows):
            lam[active[i]] += rhs[n + i]
    if own:
        put_back_pivots(ws)
    keep_sharing(ws, True)
