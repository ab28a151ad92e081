"""Kernels of contacts of a sphere with a part of a mesh: those of spheres, with the nearest triangle or edge held."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import shown, shown_at
from ..elements.measure3d import COLUMNS
from .coulomb3d import grip
from .frame3d import FRAME_ROWS
from .friction3d import regularised
from .geometry_kinds import SPHERE, are
from .mesh_nearest3d import hold_on_mesh
from .moving_point3d import MOVES
from .normal2d import act, idle
from .normal3d import PACKED, PAIR_SIZE, gap_of
from .tangent3d import ROWS


@internal
def mesh3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(PAIR_SIZE), np.empty((PAIR_SIZE, PAIR_SIZE)), np.empty(PACKED)
    held, moves = np.empty(COLUMNS), np.empty((MOVES, PAIR_SIZE))
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        kind = hold_on_mesh(b, e, held, moves)
        g = gap_of(kind, b, e, held, moves, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)


@internal
def rubbing_mesh3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(PAIR_SIZE), np.empty((PAIR_SIZE, PAIR_SIZE)), np.empty(PACKED)
    work, held, moves = np.empty((ROWS, PAIR_SIZE)), np.empty(COLUMNS), np.empty((MOVES, PAIR_SIZE))
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        kind = hold_on_mesh(b, e, held, moves)
        g = gap_of(kind, b, e, held, moves, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)
        regularised(kind, b, job, t, e, g, held, moves, gradient, hessian, work)


@internal
def gripping_mesh3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(PAIR_SIZE), np.empty((PAIR_SIZE, PAIR_SIZE)), np.empty(PACKED)
    work, held, moves = np.empty((FRAME_ROWS, PAIR_SIZE)), np.empty(COLUMNS), np.empty((MOVES, PAIR_SIZE))
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        kind = hold_on_mesh(b, e, held, moves)
        g = gap_of(kind, b, e, held, moves, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)
        grip(kind, b, job, t, e, gradient, held, moves, work)


are(SPHERE, mesh3d_kernel, rubbing_mesh3d_kernel, gripping_mesh3d_kernel)
