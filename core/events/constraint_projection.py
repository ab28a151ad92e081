"""Positions and velocities are brought onto the constraints of a new structure."""

from typing import Any

from ..assembly.evaluate import evaluate_residuals
from ..assembly.projection import meet
from ..compiled.jit import internal


@internal
def meet_positions(workspace: Any) -> bool:
    """Bring the positions onto the constraints of the present structure, by rounding's worth; False if they cannot be
    met."""
    evaluate_residuals(workspace)
    return bool(meet(workspace, False))


@internal
def meet_rates(workspace: Any) -> bool:
    """The same with the velocities, with all evaluated at the end."""
    evaluate_residuals(workspace)
    met = bool(meet(workspace, True))
    evaluate_residuals(workspace)
    return met


@internal
def meet_constraints(workspace: Any) -> bool:
    """Bring positions and velocities onto the constraints of the present structure, by rounding's worth; False if they
    cannot be met."""
    return meet_positions(workspace) and meet_rates(workspace)
