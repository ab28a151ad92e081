"""The index-3 stage: equilibrium and positions, as the equations of motion stand (Orlandea, Chace and Calahan 1977).

  M a + Phi_q^T lambda - Q = offset,   Phi(q) / c_q = 0,   q = q* + c_q a, v = v* + c_v a.
Velocities and accelerations meet their constraints only as well as the formula differentiates the coordinates. The
rounding of Phi comes back in a and lambda divided by c_q, which goes with h^2.
"""

from typing import Any

from ..compiled.jit import internal
from .absolute import solve_absolute


@internal
def solve_index3_stage(workspace: Any, t: float, c_q: float, c_v: float) -> int:
    """Solve one stage."""
    return solve_absolute(workspace, t, c_q, c_v, 3)
