"""Positions and velocities are brought onto the constraints of a new structure."""

from typing import Any

from ..assembly.evaluate import evaluate_residuals
from ..assembly.projection import meet
from ..compiled.jit import internal


@internal
def meet_constraints(workspace: Any) -> bool:
    """Bring positions and velocities onto the constraints of the present structure, by rounding's worth; False if they
    cannot be met."""
    for level in range(2):
        evaluate_residuals(workspace)
        if not meet(workspace, level == 1):
            return False
    evaluate_residuals(workspace)
    return True
