"""Projection of a point onto the constraints at every level, by corrections of least M-norm: no partition is needed."""

from typing import Any

import numpy as np

from ..assembly.evaluate import constraint_norm, evaluate_power, evaluate_residuals, evaluate_tangent
from ..assembly.levels import position_level, rate_level
from ..assembly.projection import correct_least
from ..assembly.redundant_reactions import factor_equations
from ..compiled.jit import internal
from ..state.workspace_records import (
    INNER_DIVERGED,
    OK,
    REANALYZE,
    control_at,
)
from .accelerations import solve_accelerations


@internal
def _project_level(workspace: Any, residual_address: int, x_address: int, tolerance: float) -> int:
    """Bring one level of the constraints to rounding by corrections of least M-norm, with the factors of `kkt_query`.

    All coordinates take part, so that no partition is needed: one that is strained at this point does no harm.
    """
    previous = np.inf
    for _ in range(12):
        norm = constraint_norm(workspace, residual_address)
        level = position_level(workspace) if x_address == workspace.q else rate_level(workspace)
        if norm <= tolerance * level:
            return OK
        if not norm < 0.5 * previous:
            return INNER_DIVERGED
        previous = norm
        correct_least(workspace, residual_address, x_address)
    return INNER_DIVERGED


@internal
def project_motion(workspace: Any) -> int:
    """Coordinates and velocities of the current point onto the constraints."""
    control = control_at(workspace.control)
    evaluate_residuals(workspace)
    if workspace.m_act > 0:
        evaluate_tangent(workspace, 0.0, 0.0)
        if factor_equations(workspace, workspace.kkt_query) != 0:
            return REANALYZE
        status = _project_level(workspace, workspace.phi, workspace.q, control.position_tolerance)
        if status != OK:
            return status
        return _project_level(workspace, workspace.phid, workspace.v, control.velocity_tolerance)
    return OK


@internal
def project(workspace: Any) -> int:
    """The same, then accelerations and multipliers."""
    status = project_motion(workspace)
    if status != OK:
        return status
    status = solve_accelerations(workspace)
    evaluate_power(workspace)
    return status
