"""Contact of two shapes in space without friction."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, shown, shown_at
from ..compiled.views import mat
from ..elements.measure3d import COLUMNS
from .geometry_kinds import SPHERE, are
from .moving_point3d import MOVES, moves_on
from .normal2d import act, idle
from .normal3d import GAP_KIND, PACKED, PAIR_SIZE, gap_of, hold
from .spheres3d import press_spheres


@internal
def sphere3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(PAIR_SIZE), np.empty((PAIR_SIZE, PAIR_SIZE)), np.empty(PACKED)
    held, moves = np.empty(COLUMNS), np.empty((MOVES, PAIR_SIZE))
    par = mat(b.par, b.count, b.npar)
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        if job == RESIDUAL and not moves_on(int(par[e, GAP_KIND])):
            press_spheres(b, e)
            continue
        kind = hold(b, e, held, moves)
        g = gap_of(kind, b, e, held, moves, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)


are(SPHERE, sphere3d_kernel)
