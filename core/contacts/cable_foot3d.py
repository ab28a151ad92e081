"""The point of an ANCF cable in space that touches: a point mass p = sum w_k r_k over the vectors of its nodes.

What is known of two shapes with fourteen coordinates holds with those of the point in place of the second body's: a
matrix of derivatives D by them becomes D T, T = dp/dq with the weights w. Where the foot x of a perpendicular moves
along the cable, x_q = -F_q/F_x with F = dg/dx, each function of the place changes by that way too.
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.views import imat, mat, vec
from ..elements.measure3d import POINT_A
from ..model.rotation3d import constant, four, plus, three, turned, turning
from .cubic import beyond, find_on_cable
from .moving_point3d import ON_CABLE, PAIR_SIZE
from .normal3d import GAP_KIND, pair_of
from .turning3d import ROLLING, TURNING_NUMBERS

FOOT_VECTORS = 4
CABLE_AT = 7
"""Local coordinate where the twelve of the cable's element begin; those of the first body come before."""
FOOT_WIDTH = CABLE_AT + 3 * FOOT_VECTORS
WIDE_PACKED = FOOT_WIDTH * (FOOT_WIDTH + 1) // 2
WEIGHTS = ROLLING + TURNING_NUMBERS
"""Column of the parameters with the weights of a point that stays where it is on the cable, (4,)."""
FOOT_LENGTH = WEIGHTS + FOOT_VECTORS
"""That of an element's length."""
PIECE, PIECES = 7, 8
"""Columns of `extra`: number of the element, and how many the cable has."""
WAY, AT = 0, 1
"""Rows of the matrix of moves: x_q; and w, w', p', p'' and whether the foot moves."""
SLOPE, FIRST_SLOPE, SECOND_SLOPE, MOVES_ON = 4, 8, 11, 14
FOOT_ROWS = 2

OWN_COORDINATES = np.arange(PAIR_SIZE)
"""Local coordinates of the pair as it stands by itself."""


@internal
def hold_on_cable(b: Any, e: int, held: Any, moves: Any) -> int:
    """The pair of markers of element e, the first of a contact with a cable, to held, and how its point is made of the
    nodes and moves, to moves (FOOT_ROWS, FOOT_WIDTH). Returns the element that the point is on."""
    pair, par = pair_of(b, e), mat(b.par, b.count, b.npar)[e]
    for i in range(len(pair)):
        held[i] = pair[i]
    moves[:, :] = 0.0
    if int(par[GAP_KIND]) != ON_CABLE:
        for k in range(FOOT_VECTORS):
            moves[AT, k] = par[WEIGHTS + k]
        return e
    coord, extra, q = imat(b.coord, b.count, FOOT_WIDTH), imat(b.extra, b.count, b.nextra), vec(b.q, b.n_extended)
    p = four(q, coord[e], 3, held[0])
    centre = plus(three(q, coord[e], 0), turned(turning(p, constant(held, POINT_A)), p))
    c, place, length = np.empty((4, 3)), np.empty(3), par[FOOT_LENGTH]
    place[0], place[1], place[2] = centre
    piece, x = find_on_cable(q, coord, e, extra[e, PIECES], CABLE_AT, length, place, c)
    for k in range(3):
        moves[AT, FIRST_SLOPE + k] = c[1, k] + x * (2.0 * c[2, k] + 3.0 * x * c[3, k])
        moves[AT, SECOND_SLOPE + k] = 2.0 * c[2, k] + 6.0 * x * c[3, k]
    _weigh(x, length, moves)
    on = beyond(c, place, x)
    before = extra[piece, PIECE] == 0 and x <= 0.0 and on < 0.0
    behind = extra[piece, PIECE] == extra[piece, PIECES] - 1 and x >= 1.0 and on > 0.0
    moves[AT, MOVES_ON] = 0.0 if before or behind else 1.0
    return piece


@inlined
def _weigh(x: float, length: float, moves: Any) -> None:
    """Weights of r0, s0, r1, s1 in p and p'."""
    moves[AT, 0], moves[AT, 1] = 1.0 - x * x * (3.0 - 2.0 * x), length * x * (1.0 - x) ** 2
    moves[AT, 2], moves[AT, 3] = x * x * (3.0 - 2.0 * x), length * x * x * (x - 1.0)
    moves[AT, SLOPE], moves[AT, SLOPE + 1] = 6.0 * x * (x - 1.0), length * (1.0 - 4.0 * x + 3.0 * x * x)
    moves[AT, SLOPE + 2], moves[AT, SLOPE + 3] = 6.0 * x * (1.0 - x), length * x * (3.0 * x - 2.0)


@internal
def gather(x: Any, coord: Any, moves: Any, to: Any) -> None:
    """What the vector x is of the pair as it stands by itself: to (14,)."""
    for j in range(CABLE_AT):
        to[j] = x[coord[j]]
    for c in range(3):
        to[CABLE_AT + c] = 0.0
        for k in range(FOOT_VECTORS):
            to[CABLE_AT + c] += moves[AT, k] * x[coord[CABLE_AT + 3 * k + c]]
    for j in range(CABLE_AT + 3, PAIR_SIZE):
        to[j] = 0.0


@inlined
def slope_of(x: Any, coord: Any, moves: Any) -> Any:
    """How p', made of the vectors in x, is at the point."""
    found = (0.0, 0.0, 0.0)
    for k in range(FOOT_VECTORS):
        w, at = moves[AT, SLOPE + k], CABLE_AT + 3 * k
        found = (found[0] + w * x[coord[at]], found[1] + w * x[coord[at + 1]], found[2] + w * x[coord[at + 2]])
    return found


@inlined
def source(j: int) -> int:
    """The coordinate of the pair that local coordinate j moves."""
    return j if j < CABLE_AT else CABLE_AT + (j - CABLE_AT) % 3


@inlined
def share(j: int, moves: Any) -> float:
    """By how much."""
    return 1.0 if j < CABLE_AT else moves[AT, (j - CABLE_AT) // 3]


@internal
def spread_gap(own_gradient: Any, own_hessian: Any, moves: Any, gradient: Any, hessian: Any, packed: Any) -> None:
    """Gradient (FOOT_WIDTH,), Hessian and its upper triangle of a gap, from those of the pair; fills in how the foot
    moves: H = T^T H T - F_q F_q^T/F_x."""
    for j in range(FOOT_WIDTH):
        gradient[j] = share(j, moves) * own_gradient[source(j)]
    bends = 0.0
    if moves[AT, MOVES_ON] > 0.0:
        for c in range(3):
            bends += own_gradient[CABLE_AT + c] * moves[AT, SECOND_SLOPE + c]
            for d in range(3):
                bends += (
                    moves[AT, FIRST_SLOPE + c] * own_hessian[CABLE_AT + c, CABLE_AT + d] * moves[AT, FIRST_SLOPE + d]
                )
        for j in range(FOOT_WIDTH):
            turns = 0.0
            for c in range(3):
                turns += own_hessian[source(j), CABLE_AT + c] * moves[AT, FIRST_SLOPE + c]
            turns *= share(j, moves)
            if j >= CABLE_AT:
                turns += moves[AT, SLOPE + (j - CABLE_AT) // 3] * own_gradient[source(j)]
            moves[WAY, j] = -turns / bends
    k = 0
    for i in range(FOOT_WIDTH):
        for j in range(FOOT_WIDTH):
            hessian[i, j] = share(i, moves) * own_hessian[source(i), source(j)] * share(j, moves)
            hessian[i, j] -= bends * moves[WAY, i] * moves[WAY, j]
            if j >= i:
                packed[k] = hessian[i, j]
                k += 1
