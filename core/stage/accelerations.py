"""Accelerations and multipliers of a point whose coordinates and velocities are known."""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..assembly.levels import acceleration_level
from ..assembly.redundant_reactions import factor_equations
from ..compiled.jit import compiled_unlocked, internal
from ..compiled.views import ivec, vec
from ..rounding import ACCELERATIONS_LOST, ACCELERATIONS_SOLVED, COORDINATE_NOISE
from ..state.workspace_records import OK, OUTER_SLOW, REANALYZE, control_at
from .solver import solve_increment

LOADS_KNOWN = 2
"""From this iteration on. The first one finds the multipliers of the joints, the second one what depends on them
(`contacts/joint_friction_contact.py`); where that is not all, its derivatives are evaluated anew."""


@internal
def _largest(workspace: Any, x: Any) -> float:
    """Largest of the entries, one for each coordinate, in parts of their scales; infinity if one is not a number."""
    largest, scale = 0.0, vec(workspace.scale, workspace.n)
    for i in range(workspace.n):
        if np.isnan(x[i]):
            return np.inf
        largest = max(largest, abs(x[i]) / scale[i])
    return largest


@compiled_unlocked
def solve_accelerations(workspace: Any) -> int:
    """(a, lambda) of the current (q, v) from the augmented system [M, Phi_q^T; Phi_q, 0], with matrices of its own."""
    n, rows = workspace.n, workspace.m_act + workspace.n_implied
    a, lam = vec(workspace.a, workspace.n_ext), vec(workspace.lam, workspace.m_ext)
    active = ivec(workspace.active, rows)
    increment = vec(workspace.rhs, n + rows)
    evaluate_tangent(workspace, 0.0, 0.0)
    if factor_equations(workspace, workspace.kkt_query) != 0:
        return REANALYZE
    previous, norm, size = np.inf, np.inf, 0.0
    for k in range(10):
        if k == LOADS_KNOWN:
            evaluate_tangent(workspace, 0.0, 0.0)
            if factor_equations(workspace, workspace.kkt_query) != 0:
                return REANALYZE
        evaluate_residuals(workspace)
        solve_increment(workspace, workspace.kkt_query)
        for i in range(n):
            a[i] += increment[i]
        for i in range(rows):
            lam[active[i]] += increment[n + i]
        norm, size = _largest(workspace, increment), acceleration_level(workspace)
        # loads that follow multipliers are those of the iteration before
        if (k > 0 and norm <= ACCELERATIONS_SOLVED * size) or (k >= LOADS_KNOWN and norm >= previous):
            break
        previous = norm
    evaluate_residuals(workspace)
    # in stiff bodies, coordinates that are nearly equal make large forces that cancel each other
    noise = (
        COORDINATE_NOISE
        * control_at(workspace.control).stiffness_scale
        * _largest(workspace, vec(workspace.q, workspace.n))
    )
    return OK if norm <= max(ACCELERATIONS_LOST * size, noise) < np.inf else OUTER_SLOW
