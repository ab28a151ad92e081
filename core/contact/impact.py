"""Impact at velocity-increment level, bilateral joints included.

[M Phi_q^T G^T; Phi_q 0 0; G 0 0] (dv, Lambda_b, -P) = (0, 0, -(1 + e) g'^-), v^+ = v^- + dv, P >= 0.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..compiled.jit import compiled
from ..compiled.views import ivec, vec
from ..linalg import factor, lu_at, solve
from ..system.evaluate import evaluate_residuals, evaluate_tangent


@dataclass(frozen=True)
class Impact:
    """What an impact did."""

    impulse: float
    """Normal impulse P, N s."""
    impulses: dict[int, float]
    """-Lambda of every active row of Phi: for contacts, their normal impulses, N s."""
    energy_loss: float
    """J."""
    residual: float
    """Largest violation of the constraints at velocity-increment level, m/s."""


@compiled
def _velocity_increment(ws: Any, row: int, increment: float) -> int:
    """rhs = (dv, Lambda) for the closed structure: G dv = increment in `row`, 0 in all other rows."""
    evaluate_residuals(ws)
    evaluate_tangent(ws, 0.0, 0.0)
    status = factor(lu_at(ws.kkt_query), ws.values)
    if status != 0:
        return status
    rhs = vec(ws.rhs, ws.n + ws.m_act)
    active = ivec(ws.active, ws.m_act)
    for i in range(ws.n):
        rhs[i] = 0.0
    for i in range(ws.m_act):
        rhs[ws.n + i] = increment if active[i] == row else 0.0
    solve(lu_at(ws.kkt_query), ws.rhs)
    return 0


def unit_impulse(workspace: Any, row: int) -> float:
    """Normal impulse that changes the gap's rate in `row` by 1 m/s, in the closed structure, N s."""
    if _velocity_increment(workspace.record, row, 1.0) != 0:
        return 0.0
    position = int(np.flatnonzero(workspace.structure.active == row)[0])
    return -float(workspace.arrays["rhs"][workspace.assembly.n + position])


def apply_impact(workspace: Any, row: int, restitution: float) -> Impact | None:
    """Newton's impact law on the contact in `row`, in the closed structure; changes v.

    Returns None if the matrix is singular (the caller names the contact).
    """
    ws, arrays, n = workspace.record, workspace.arrays, workspace.assembly.n
    evaluate_residuals(ws)
    approach = float(arrays["phid"][row])
    if _velocity_increment(ws, row, -(1.0 + restitution) * approach) != 0:
        return None
    active = workspace.structure.active
    solution = arrays["rhs"][: n + len(active)].copy()
    dv, multipliers = solution[:n], solution[n:]
    position = int(np.flatnonzero(active == row)[0])
    impulse = -float(multipliers[position])
    before = arrays["phid"][active].copy()
    # M dv + Phi_q^T Lambda = 0, hence T^- - T^+ = -dv . M (v^- + dv/2) = Lambda . Phi_q (v^- + dv/2)
    arrays["v"][:n] += dv
    evaluate_residuals(ws)
    after = arrays["phid"][active]
    expected = np.zeros(len(active))
    expected[position] = -(1.0 + restitution) * approach
    residual = float(np.max(np.abs(after - before - expected), initial=0.0))
    impulses = {int(r): -float(x) for r, x in zip(active, multipliers, strict=True)}
    return Impact(impulse, impulses, impulse * 0.5 * (1.0 - restitution) * -approach, residual)
