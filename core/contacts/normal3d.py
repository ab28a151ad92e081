"""Contact of two shapes in space along the normal: the gap is a measure of two points, less radii.

The points are those of two markers, or points of contact that move on their bodies (`moving_point3d.py`). Columns of
the parameters: `GAP_KIND`, the radii, the laws' from 7 on, those of the pair of markers from `PAIR_AT` on, the shape's
at the end."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import imat, mat, vec
from ..elements.measure3d import COLUMNS, measure
from .moving_point3d import (
    CROSSED,
    HOLLOW,
    PAIR_SIZE,
    SEGMENTS,
    SUPPORT,
    bend_held,
    hold_segments,
    hold_support,
    measured,
    moves_on,
    on_round,
)
from .nearest_point3d import hold_on_round
from .parallel_axes3d import draw_back

PACKED = PAIR_SIZE * (PAIR_SIZE + 1) // 2
GAP_KIND, RADIUS_A, RADIUS_B = 0, 1, 2
"""Kind of the gap, DISTANCE or PLACE, or one of `moving_point3d.py`, and the radii; that of a half-space is 0, that of
a hollow sphere negative."""
EXTENT_A, EXTENT_B = 4, 5
"""How far points of contact may be from their markers, m; of segments their half lengths."""
TILT = 6
"""Sine of the angle of two segments below which their gap draws back (`parallel_axes3d.py`); 0: never."""
PAIR_AT = 16
NUMBERS = PAIR_AT + COLUMNS
"""The numbers of a smooth or round shape."""
SUPPORT_ADDRESS = 6
"""Column of `extra` with the address of a smooth shape's formula; 0: it has none."""


@internal
def pair_of(b: Any, e: int) -> Any:
    """Parameters of the pair of markers of element e of a batch."""
    return vec(b.par + 8 * (e * b.npar + PAIR_AT), COLUMNS)


@internal
def hold(b: Any, e: int, held: Any, moves: Any) -> int:
    """The pair of markers of element e of a batch with the points of contact in place of their points, to held
    (COLUMNS,), and how these move on their bodies, to moves (MOVES, 14). Returns the kind of their gap."""
    par, pair = mat(b.par, b.count, b.npar)[e], pair_of(b, e)
    for i in range(COLUMNS):
        held[i] = pair[i]
    kind = int(par[GAP_KIND])
    if not moves_on(kind):
        return kind
    moves[:, :] = 0.0
    q, coord = vec(b.q, b.n_extended), imat(b.coord, b.count, b.ncoord)[e]
    if kind == SUPPORT or on_round(kind):
        address = imat(b.extra, b.count, b.nextra)[e, SUPPORT_ADDRESS]
        numbers = vec(b.par + 8 * (e * b.npar + NUMBERS), 4)
        if kind == SUPPORT:
            hold_support(q, coord, address, numbers, held, moves)
        else:
            kind = hold_on_round(kind, q, coord, address, numbers, held, moves)
    else:
        hold_segments(q, coord, par[EXTENT_A], par[EXTENT_B], held, moves)
    return kind


@internal
def gap_of(kind: int, b: Any, e: int, held: Any, moves: Any, gradient: Any, hessian: Any, packed: Any) -> float:
    """Gap of this kind of element e of a batch, m, whose points are held; its derivatives go into gradient (14,),
    hessian (14, 14) and its upper triangle row by row (105,)."""
    par = mat(b.par, b.count, b.npar)[e]
    coord = imat(b.coord, b.count, b.ncoord)[e]
    g = measure(measured(kind), vec(b.q, b.n_extended), coord, held, 0.0, gradient, hessian)
    if moves_on(kind):
        bend_held(hessian, moves)
        if kind == CROSSED:
            g = -g
            for i in range(PAIR_SIZE):
                gradient[i] = -gradient[i]
                for j in range(PAIR_SIZE):
                    hessian[i, j] = -hessian[i, j]
    elif kind == HOLLOW:
        # the centres may be one: then no wall is nearer than another
        out = -1.0 if g > 0.0 else 0.0
        g = -g
        for i in range(PAIR_SIZE):
            gradient[i] = out * gradient[i] if out != 0.0 else 0.0
            for j in range(PAIR_SIZE):
                hessian[i, j] = out * hessian[i, j] if out != 0.0 else 0.0
    if kind == SEGMENTS and par[TILT] > 0.0:
        g += draw_back(vec(b.q, b.n_extended), coord, held, par[TILT], par[RADIUS_A] + par[RADIUS_B], gradient, hessian)
    k = 0
    for i in range(PAIR_SIZE):
        for j in range(i, PAIR_SIZE):
            packed[k] = hessian[i, j]
            k += 1
    return g - par[RADIUS_A] - par[RADIUS_B]
