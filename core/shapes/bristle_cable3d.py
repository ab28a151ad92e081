"""Kernel of contacts of points of a cable with half-spaces, with LuGre's friction."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import mat
from ..elements.measure3d import COLUMNS
from .bristle3d import bend
from .cable_contact3d import gap_of_cable
from .cable_foot3d import FOOT_ROWS, WIDE_PACKED, WIDTH
from .normal2d import act, asleep
from .normal3d import KIND
from .tangent3d import ROWS


@internal
def bristle_cable3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(WIDTH), np.empty((WIDTH, WIDTH)), np.empty(WIDE_PACKED)
    held, moves, work = np.empty(COLUMNS), np.empty((FOOT_ROWS, WIDTH)), np.empty((ROWS, WIDTH))
    for e in range(b.count):
        if asleep(b, e):
            continue
        _, g = gap_of_cable(b, e, held, moves, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)
        bend(int(mat(b.par, b.count, b.npar)[e, KIND]), b, job, e, g, held, moves, gradient, hessian, work)
