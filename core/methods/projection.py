"""Explicit Runge-Kutta steps of the unstabilised equations, each followed by a projection onto the constraints.

Coordinates, then velocities are moved by the least M-norm (Eich 1993; Hairer and Wanner, Solving ODEs II, VII.2), and
accelerations and multipliers are solved for anew. The error estimate is that of the step before its projection.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..stage.project import project
from ..state.workspace_records import OK
from .explicit import explicit_step


@internal
def projection_step(workspace: Any, method: Any, h: float) -> int:
    """One step; the newest row's accelerations are always those of the first stage."""
    status = explicit_step(workspace, method, h, int(vec(method.parameters, 8)[0]), True)
    if status != OK:
        return status
    status = project(workspace)
    a, aux = vec(workspace.a, workspace.n_ext), vec(workspace.aux, workspace.n_ext)
    for i in range(workspace.n_ext):
        aux[i] = a[i]
    return status
