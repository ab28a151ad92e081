"""Corrections of least M-norm that bring positions or velocities onto the constraints."""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, inlined, internal
from ..compiled.views import ivec, vec
from ..rounding import MET, NEARLY_MET
from .evaluate import constraint_norm, evaluate_residuals, evaluate_tangent
from .levels import position_level, rate_level
from .redundant_reactions import factor_equations, solve_equations
from .workspace import Workspace

MOST_CORRECTIONS = 25
"""Of Newton's method; it converges within five, or it does not."""


@inlined
def correct_least(workspace: Any, residual_address: int, x_address: int) -> None:
    """x += the correction of least M-norm that removes the residual to first order, by the factors of `kkt_query`."""
    rhs = vec(workspace.rhs, workspace.n + workspace.m_act)
    residual = vec(residual_address, workspace.m_ext)
    active = ivec(workspace.active, workspace.m_act)
    for i in range(workspace.n):
        rhs[i] = 0.0
    for i in range(workspace.m_act):
        rhs[workspace.n + i] = -residual[active[i]]
    solve_equations(workspace, workspace.kkt_query)
    x = vec(x_address, workspace.n_ext)
    for i in range(workspace.n):
        x[i] += rhs[i]
    evaluate_residuals(workspace)


@internal
def _least_correction(workspace: Any, residual_address: int, x_address: int) -> bool:
    """The correction with matrices of the current point."""
    evaluate_tangent(workspace, 0.0, 0.0)
    if factor_equations(workspace, workspace.kkt_query) != 0:
        return False
    correct_least(workspace, residual_address, x_address)
    return True


@compiled
def meet(workspace: Any, rates: bool) -> bool:
    """Newton on one level, positions or `rates`; True when the constraints hold to rounding."""
    residual, x, previous = (workspace.phid, workspace.v, np.inf) if rates else (workspace.phi, workspace.q, np.inf)
    for _ in range(MOST_CORRECTIONS):
        norm = constraint_norm(workspace, residual)
        size = rate_level(workspace) if rates else position_level(workspace)
        if norm <= MET * size or (norm >= 0.5 * previous and norm <= NEARLY_MET * size):
            return True
        if not np.isfinite(norm) or norm > 1e3 * previous:
            return False
        previous = norm
        if not _least_correction(workspace, residual, x):
            return False
    return False


def bring_to_rest(workspace: Workspace, residual: str, x: str) -> bool:
    """`meet` for the residual "phi" of "q", or "phid" of "v"."""
    return bool(meet(workspace.record, (residual, x) == ("phid", "v")))
