"""The stabilised index-2 stage of Gear, Gupta and Leimkuhler (1985): positions and velocities are constrained.

  q = q* + c_q a - h M^-1 Phi_q^T mu,  v = v* + c_v a,  M a + Phi_q^T lambda - Q = offset,  Phi = 0,  Phi_q v = -Phi_t.
The term with mu is what M q' = M v - Phi_q^T mu gives: weighted by M, it moves coordinates of different units in a way
that does not depend on the units, which q' = v - Phi_q^T mu does. mu vanishes in the exact solution.
M and Phi_q in it are those of the point that the stage predicts, one further factorisation a stage.
"""

from typing import Any

from ..compiled.jit import internal
from .absolute import solve_absolute


@internal
def solve_index2_stage(workspace: Any, t: float, c_q: float, c_v: float) -> int:
    """Solve one stage; `rate[CORRECTION]` tells how large the term with mu became."""
    return solve_absolute(workspace, t, c_q, c_v, 2)
