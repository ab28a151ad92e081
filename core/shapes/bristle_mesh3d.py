"""Kernel of contacts of a sphere with a part of a mesh, with LuGre's friction: the bristles stand on the mesh."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..elements.measure3d import COLUMNS
from .bristle3d import bend
from .geometry_kinds import SPHERE, are
from .held3d import MOVES
from .mesh_nearest3d import hold_on_mesh
from .normal2d import act, asleep
from .normal3d import PACKED, SIZE, gap_of
from .tangent3d import ROWS


@internal
def bristle_mesh3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(SIZE), np.empty((SIZE, SIZE)), np.empty(PACKED)
    work, held, moves = np.empty((ROWS, SIZE)), np.empty(COLUMNS), np.empty((MOVES, SIZE))
    for e in range(b.count):
        if asleep(b, e):
            continue
        kind = hold_on_mesh(b, e, held, moves)
        g = gap_of(kind, b, e, held, moves, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)
        bend(kind, b, job, e, g, held, moves, gradient, hessian, work)


are(SPHERE, bristle_mesh3d_kernel)
