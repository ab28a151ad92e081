"""The index-1 stage: Baumgarte's constraint at acceleration level (Baumgarte 1972).

  M a + Phi_q^T lambda = Q,   Phi'' + 2 alpha Phi' + beta^2 Phi = 0,   q = q* + c_q a, v = v* + c_v a.
alpha = beta = 0: the equations with accelerations constrained only, whose positions drift away. The increment sees
(1 + 2 alpha c_v + beta^2 c_q) Phi_q da; the derivatives of Phi_q v are left to the iteration.
"""

from typing import Any

from ..compiled.jit import internal
from .absolute import solve_absolute


@internal
def solve_index1_stage(workspace: Any, t: float, c_q: float, c_v: float) -> int:
    """Solve one stage; alpha and beta (1/s) stand in `control`."""
    return solve_absolute(workspace, t, c_q, c_v, 1)
