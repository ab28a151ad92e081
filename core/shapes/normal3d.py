"""Contact of two spheres, and of a sphere and a half-space, along the normal: the gap is a measure of two markers.

Columns of the parameters: `KIND`, the radii, the laws' from 7 on, and those of the pair of markers from `PAIR` on.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, mat, vec
from ..elements.measure3d import COLUMNS, measure
from .normal2d import act, asleep

SIZE = 14
"""Coordinates of both bodies."""
PACKED = SIZE * (SIZE + 1) // 2
KIND, RADIUS_A, RADIUS_B = 0, 1, 2
"""Kind of the measure that the gap is, DISTANCE or PLACE, and the radii; that of a half-space is 0."""
PAIR = 16


@internal
def pair_of(b: Any, e: int) -> Any:
    """Parameters of the pair of markers of element e of a batch."""
    return vec(b.par + 8 * (e * b.npar + PAIR), COLUMNS)


@internal
def gap_of(b: Any, e: int, gradient: Any, hessian: Any, packed: Any) -> float:
    """Gap of element e of a batch, m; its derivatives go into gradient (14,), hessian (14, 14) and its upper triangle
    row by row (105,)."""
    par = mat(b.par, b.count, b.npar)[e]
    coord = imat(b.coord, b.count, SIZE)[e]
    g = measure(int(par[KIND]), vec(b.q, b.n_extended), coord, pair_of(b, e), 0.0, gradient, hessian)
    k = 0
    for i in range(SIZE):
        for j in range(i, SIZE):
            packed[k] = hessian[i, j]
            k += 1
    return g - par[RADIUS_A] - par[RADIUS_B]


@internal
def sphere3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(SIZE), np.empty((SIZE, SIZE)), np.empty(PACKED)
    for e in range(b.count):
        if asleep(b, e):
            continue
        g = gap_of(b, e, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)
