"""Corrections of least M-norm that bring positions or velocities onto the constraints."""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, inlined
from ..compiled.views import ivec, vec
from ..linalg import factor, lu_at, solve
from ..rounding import MET, NEARLY_MET
from .evaluate import constraint_norm, evaluate_residuals, evaluate_tangent
from .levels import position_level, rate_level
from .workspace import Workspace


@inlined
def correct_least(ws: Any, residual_address: int, x_address: int) -> None:
    """x += the correction of least M-norm that removes the residual to first order, by the factors of `kkt_query`."""
    rhs = vec(ws.rhs, ws.n + ws.m_act)
    residual = vec(residual_address, ws.m_ext)
    active = ivec(ws.active, ws.m_act)
    for i in range(ws.n):
        rhs[i] = 0.0
    for i in range(ws.m_act):
        rhs[ws.n + i] = -residual[active[i]]
    solve(lu_at(ws.kkt_query), ws.rhs)
    x = vec(x_address, ws.n_ext)
    for i in range(ws.n):
        x[i] += rhs[i]
    evaluate_residuals(ws)


@compiled
def least_correction(ws: Any, residual_address: int, x_address: int) -> int:
    """The correction with matrices of the current point."""
    evaluate_tangent(ws, 0.0, 0.0)
    if factor(lu_at(ws.kkt_query), ws.values) != 0:
        return 1
    correct_least(ws, residual_address, x_address)
    return 0


def bring_to_rest(workspace: Workspace, residual: str, x: str) -> bool:
    """Newton on one level; True when it holds to rounding."""
    ws = workspace.record
    table = workspace._record.table
    previous = np.inf
    for _ in range(25):
        norm = constraint_norm(ws, int(table[residual][0]))
        size = position_level(ws) if x == "q" else rate_level(ws)
        if norm <= MET * size or (norm >= 0.5 * previous and norm <= NEARLY_MET * size):
            return True
        if not np.isfinite(norm) or norm > 1e3 * previous:
            return False
        previous = norm
        if least_correction(ws, int(table[residual][0]), int(table[x][0])) != 0:
            return False
    return False
