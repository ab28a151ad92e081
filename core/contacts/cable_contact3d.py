"""Kernels of contacts with an ANCF cable in space: of a sphere anywhere along it, of a point of it with a half-space.

Every element of the cable is an element here, with the coordinates of the other body and of its two nodes; the one
with the nearest point acts, as in the plane (`cable_line.py`). A point that stays where it is has one element.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, mat, vec
from ..elements.measure3d import COLUMNS, measure
from .cable_foot3d import FOOT_ROWS, FOOT_WIDTH, OWN_COORDINATES, PIECES, WIDE_PACKED, gather, hold_on_cable, spread_gap
from .coulomb3d import grip
from .frame3d import FRAME_ROWS
from .friction3d import regularised
from .geometry_kinds import CABLE_IN_SPACE, are
from .moving_point3d import PAIR_SIZE, measured
from .normal2d import act, is_sleeping
from .normal3d import GAP_KIND, RADIUS_A, RADIUS_B
from .tangent3d import ROWS


@internal
def gap_of_cable(b: Any, e: int, held: Any, moves: Any, gradient: Any, hessian: Any, packed: Any) -> Any:
    """(element that acts, gap in m) of the contact whose elements begin with e; derivatives and moves are filled in."""
    par, own_gradient, own_hessian = (
        mat(b.par, b.count, b.npar)[e],
        np.empty(PAIR_SIZE),
        np.empty((PAIR_SIZE, PAIR_SIZE)),
    )
    q = np.empty(PAIR_SIZE)
    piece = hold_on_cable(b, e, held, moves)
    gather(vec(b.q, b.n_extended), imat(b.coord, b.count, b.ncoord)[piece], moves, q)
    g = measure(measured(int(par[GAP_KIND])), q, OWN_COORDINATES, held, 0.0, own_gradient, own_hessian)
    spread_gap(own_gradient, own_hessian, moves, gradient, hessian, packed)
    return piece, g - par[RADIUS_A] - par[RADIUS_B]


@internal
def cable3d_contact_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(FOOT_WIDTH), np.empty((FOOT_WIDTH, FOOT_WIDTH)), np.empty(WIDE_PACKED)
    held, moves, extra = np.empty(COLUMNS), np.empty((FOOT_ROWS, FOOT_WIDTH)), imat(b.extra, b.count, b.nextra)
    e = 0
    while e < b.count:
        if not is_sleeping(b, e):
            piece, g = gap_of_cable(b, e, held, moves, gradient, hessian, packed)
            act(b, job, piece, g, gradient, packed)
        e += extra[e, PIECES]


@internal
def rubbing_cable3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(FOOT_WIDTH), np.empty((FOOT_WIDTH, FOOT_WIDTH)), np.empty(WIDE_PACKED)
    held, moves, extra = np.empty(COLUMNS), np.empty((FOOT_ROWS, FOOT_WIDTH)), imat(b.extra, b.count, b.nextra)
    work, par = np.empty((ROWS, FOOT_WIDTH)), mat(b.par, b.count, b.npar)
    e = 0
    while e < b.count:
        if not is_sleeping(b, e):
            piece, g = gap_of_cable(b, e, held, moves, gradient, hessian, packed)
            act(b, job, piece, g, gradient, packed)
            regularised(int(par[e, GAP_KIND]), b, job, t, piece, g, held, moves, gradient, hessian, work)
        e += extra[e, PIECES]


@internal
def gripping_cable3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(FOOT_WIDTH), np.empty((FOOT_WIDTH, FOOT_WIDTH)), np.empty(WIDE_PACKED)
    held, moves, extra = np.empty(COLUMNS), np.empty((FOOT_ROWS, FOOT_WIDTH)), imat(b.extra, b.count, b.nextra)
    work, par = np.empty((FRAME_ROWS, FOOT_WIDTH)), mat(b.par, b.count, b.npar)
    e = 0
    while e < b.count:
        if not is_sleeping(b, e):
            piece, g = gap_of_cable(b, e, held, moves, gradient, hessian, packed)
            act(b, job, piece, g, gradient, packed)
            grip(int(par[e, GAP_KIND]), b, job, t, piece, gradient, held, moves, work)
        e += extra[e, PIECES]


are(CABLE_IN_SPACE, cable3d_contact_kernel, gripping_cable3d_kernel, rubbing_cable3d_kernel)
