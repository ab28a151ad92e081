"""Where a fully implicit Runge-Kutta method keeps its tableau and its stages.

The method record's `weights` hold the tableau, as `Tableau.data` writes it, and what the convergence test remembers.
The workspace's `stage_rows` hold the stages.
"""

from typing import Any

from ..compiled.jit import inlined, internal
from ..compiled.views import mat, vec
from ..stage.corotating import leave_frame
from ..state.workspace_records import COUPLED_STAGES
from .multistep import weight_rows

# rows of `weights`; matrices are stored row by row, COUPLED_STAGES wide
A, A_SQUARED, SHIFT, SHIFT2, VECTORS, EMBEDDED, INVERSE, MEMORY = range(8)
# parts of VECTORS: nodes c, b, b^T A, extrapolation of the stages to the end
NODES, B, BA, END = 0, COUPLED_STAGES, 2 * COUPLED_STAGES, 3 * COUPLED_STAGES
# parts of EMBEDDED after the weights of the stages: weight of the start, gamma, weights of the lower difference and of
# the one that sees jumps
START, GAMMA, LOWER, JUMP = COUPLED_STAGES, COUPLED_STAGES + 1, COUPLED_STAGES + 2, 2 * COUPLED_STAGES + 2
# columns of MEMORY: contraction of the sweeps; sweeps, inner iterations for each stage and size of the last step
SWEEP_RATE, LAST_SWEEPS, INNER_EACH, LAST_STEP = range(4)
STAGE_COUNT = 0  # parameter


@inlined
def stage_rows(workspace: Any) -> Any:
    """The stages as rows like those of the history: q, v, a, correction of a (each n_ext), lam (m_ext)."""
    return mat(workspace.stage_rows, COUPLED_STAGES, workspace.row_length)


@internal
def load_stage(workspace: Any, method: Any, i: int, t: float, h: float) -> None:
    """Stage i becomes the current point of the workspace, in space."""
    n, row = workspace.n_ext, stage_rows(workspace)[i]
    q, v, a, lam = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    for l in range(workspace.n):
        q[l] = row[l]
        v[l] = row[n + l]
        a[l] = row[2 * n + l]
    for l in range(workspace.m_ext):
        lam[l] = row[4 * n + l]
    vec(workspace.t, 1)[0] = t + weight_rows(method)[VECTORS, NODES + i] * h
    leave_frame(workspace)


@inlined
def stage_count(method: Any) -> int:
    """Number of stages."""
    return int(vec(method.parameters, 8)[STAGE_COUNT])
