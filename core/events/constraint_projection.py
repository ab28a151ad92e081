"""Positions and velocities are brought onto the constraints of a new structure."""

from typing import Any

from ..assembly.evaluate import evaluate_residuals
from ..assembly.projection import meet
from ..compiled.jit import internal


@internal
def meet_constraints(ws: Any) -> bool:
    """Bring positions and velocities onto the constraints of the present structure, by rounding's worth; False if they
    cannot be met."""
    for level in range(2):
        evaluate_residuals(ws)
        if not meet(ws, level == 1):
            return False
    evaluate_residuals(ws)
    return True
