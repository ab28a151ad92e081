"""The matrix of the joints and of all contacts that are closed, factorised for Python."""

from typing import Any

from ..assembly.compatibility import factor_equations, solve_equations
from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..compiled.jit import compiled


@compiled
def evaluate_joints(ws: Any) -> None:
    """[M Phi_q^T; Phi_q 0] of the present structure at the current point."""
    evaluate_residuals(ws)
    evaluate_tangent(ws, 0.0, 0.0)


@compiled
def factor_joints(ws: Any) -> int:
    """The same matrix as `evaluate_joints`, and its factors with the pivots that the structure has."""
    evaluate_joints(ws)
    return int(factor_equations(ws, ws.kkt_query))


@compiled
def solve_joints(ws: Any) -> None:
    """rhs -> its solution with the factorised matrix."""
    solve_equations(ws, ws.kkt_query)
