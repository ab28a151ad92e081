"""The matrix of the joints and of all contacts that are closed, factorised for Python."""

from typing import Any

from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..assembly.redundant_reactions import factor_equations, solve_equations
from ..compiled.jit import compiled


@compiled
def evaluate_joints(workspace: Any) -> None:
    """[M Phi_q^T; Phi_q 0] of the present structure at the current point."""
    evaluate_residuals(workspace)
    evaluate_tangent(workspace, 0.0, 0.0)


@compiled
def factor_joints(workspace: Any) -> int:
    """The same matrix as `evaluate_joints`, and its factors with the pivots that the structure has."""
    evaluate_joints(workspace)
    return int(factor_equations(workspace, workspace.kkt_query))


@compiled
def solve_joints(workspace: Any) -> None:
    """rhs -> its solution with the factorised matrix."""
    solve_equations(workspace, workspace.kkt_query)
