"""Consistent start: positions, velocities, accelerations and multipliers from given q0, v0."""

import logging
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import compiled
from ..compiled.views import ivec, vec
from ..errors import ConsistencyError
from ..linalg import factor, lu_at, solve
from .assembly import Assembly
from .evaluate import constraint_norm, evaluate_residuals, evaluate_tangent
from .partition import prepare
from .workspace import Workspace

logger = logging.getLogger(__name__)

START_TOLERANCE = 1e-3
"""How far q0 (relative to the size of the mechanism) and v0 (relative to the speeds) may be moved, by default."""


@compiled
def _least_correction(ws: Any, residual_address: int, x_address: int) -> int:
    """x += the correction of least M-norm that removes the residual to first order."""
    evaluate_tangent(ws, 0.0, 0.0)
    if factor(lu_at(ws.kkt_query), ws.values) != 0:
        return 1
    rhs = vec(ws.rhs, ws.n + ws.m_act)
    residual = vec(residual_address, ws.m_ext)
    active = ivec(ws.active, ws.m_act)
    for i in range(ws.n):
        rhs[i] = 0.0
    for i in range(ws.m_act):
        rhs[ws.n + i] = -residual[active[i]]
    solve(lu_at(ws.kkt_query), ws.rhs)
    x = vec(x_address, ws.n_ext)
    for i in range(ws.n):
        x[i] += rhs[i]
    evaluate_residuals(ws)
    return 0


def make_consistent(workspace: Workspace, tolerance: float = START_TOLERANCE) -> None:
    """Move the current q, v onto the constraints by the least change in the M-norm.

    Raises
    ------
    ConsistencyError : if they cannot be met, or only by a change larger than `tolerance`; names the constraints.
    """
    ws, arrays, assembly = workspace.record, workspace.arrays, workspace.assembly
    n = assembly.n
    prepare(workspace)
    evaluate_residuals(ws)
    given = _violations(assembly, workspace.structure.active, arrays["phi"])
    scale_v = np.maximum(assembly.coordinate_scale, np.max(np.abs(arrays["v"][:n]), initial=0.0))
    for level, residual, x, scale in (
        ("positions q0", "phi", "q", assembly.coordinate_scale),
        ("velocities v0", "phid", "v", scale_v),
    ):
        before = arrays[x][:n].copy()
        if level.startswith("v"):
            given = _violations(assembly, workspace.structure.active, arrays["phid"])
        ok = bring_to_rest(workspace, residual, x)
        moved = np.abs(arrays[x][:n] - before) / scale
        worst = int(np.argmax(moved)) if n else 0
        if not ok or (n and not moved[worst] <= tolerance):
            detail = (
                f"the nearest consistent ones differ by {moved[worst] * scale[worst]:.3g} in "
                f"{assembly.coordinate_names[worst]}"
                if ok
                else "no consistent ones were found near by"
            )
            raise ConsistencyError(
                f"the given {level} violate the constraints beyond repair: {given}; {detail}, and "
                f"start_tolerance = {tolerance:g} (relative) is allowed. Give consistent values, or raise "
                "start_tolerance."
            )
        if n and moved[worst] > 1e-12:
            logger.info("%s moved by up to %.3g (relative) to meet the constraints", level, moved[worst])
    if n and workspace.structure.active.size:
        prepare(workspace)


def bring_to_rest(workspace: Workspace, residual: str, x: str) -> bool:
    """Newton on one level; True when it holds to rounding."""
    ws, arrays = workspace.record, workspace.arrays
    table = workspace._record.table
    previous = np.inf
    for _ in range(25):
        norm = constraint_norm(ws, int(table[residual][0]))
        size = max(1.0, float(np.max(np.abs(arrays[x][: workspace.assembly.n]), initial=0.0)))
        if norm <= 1e-15 * size or (norm >= 0.5 * previous and norm <= 1e-11 * size):
            return True
        if not np.isfinite(norm) or norm > 1e3 * previous:
            return False
        previous = norm
        if _least_correction(ws, int(table[residual][0]), int(table[x][0])) != 0:
            return False
    return False


def _violations(assembly: Assembly, active: NDArray[np.int64], residual: NDArray[np.float64]) -> str:
    """The worst violated constraints by name."""
    worst: dict[str, float] = {}
    for row in active:
        name = assembly.row_names[row]
        worst[name] = max(worst.get(name, 0.0), abs(float(residual[row])))
    ordered = sorted(worst.items(), key=lambda item: -item[1])[:5]
    return ", ".join(f"'{name}' by {value:.3g}" for name, value in ordered if value > 0.0) or "none"
