"""The stage of an explicit formula: accelerations and multipliers at a known point.

[M, Phi_q^T; Phi_q, 0] (a, lambda) = (Q, gamma - 2 alpha Phi' - beta^2 Phi), factored anew at each stage. The equations
are linear in (a, lambda): one increment from any guess solves them.
"""

from typing import Any

from ..compiled.jit import internal
from ..state.workspace_records import OK, convergence_at
from .absolute import refactor_absolute, solve_rows
from .solver import add_increment, begin_stage


@internal
def solve_explicit_stage(workspace: Any, t: float, c_q: float, c_v: float) -> int:
    """(a, lambda) at t, q*, v*; alpha and beta (1/s) stand in `control`, c_q and c_v are zero."""
    begin_stage(workspace, t, c_q, c_v)
    status = refactor_absolute(workspace, c_q, c_v)
    # no later stage takes these factors
    convergence_at(workspace.rate).factor_age = -1.0
    if status != OK:
        return status
    solve_rows(workspace, c_q, c_v, 1)
    add_increment(workspace, c_q, c_v)
    return OK
