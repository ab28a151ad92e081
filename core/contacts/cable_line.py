"""Contact of a disk with an ANCF cable: its axis is a chain of cubics with a common tangent where two of them meet.

Every element of the cable is an element here, with the coordinates of its two nodes and of the disk; the one with the
nearest point acts. Where that passes from element to element gap, normal and velocity go on; the curvature may jump,
and with it the gap's acceleration, by a bounded amount.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, mat, vec
from .cubic import beyond, find_on_cable
from .curve2d import arm_derivatives, foot_derivatives, length_derivatives
from .geometry_kinds import CABLE, are
from .normal2d import act

LINE_VECTORS = 4  # r0, s0, r1, s1
LINE_WIDTH = 2 * LINE_VECTORS + 3
PAIRS = LINE_WIDTH * (LINE_WIDTH + 1) // 2

# columns of the table of parameters; 7 to 15 are those of the laws
LINE_RADII = 0
LINE_POINT, LINE_LENGTH = 16, 18  # of the disk in its body, (2,); of an element
# columns of `extra` after those that every contact has
PIECE, PIECES = 6, 7


@internal
def _centre(q: Any, coord: Any, par: Any) -> Any:
    """(x, y, arm_x, arm_y) of the disk's centre."""
    theta = q[coord[2 * LINE_VECTORS + 2]]
    c, s = math.cos(theta), math.sin(theta)
    ax, ay = c * par[LINE_POINT] - s * par[LINE_POINT + 1], s * par[LINE_POINT] + c * par[LINE_POINT + 1]
    return q[coord[2 * LINE_VECTORS]] + ax, q[coord[2 * LINE_VECTORS + 1]] + ay, ax, ay


@internal
def _weigh(t: float, length: float, weights: Any) -> None:
    """Weights (3, LINE_WIDTH) of the nodes' vectors in p, p' and p''; the disk's centre counts as -1, 0, 0."""
    for c in range(2):
        for k in range(LINE_VECTORS):
            scale = length if k % 2 == 1 else 1.0
            if k == 0:
                w = (1.0 - 3.0 * t * t + 2.0 * t**3, 6.0 * t * t - 6.0 * t, 12.0 * t - 6.0)
            elif k == 1:
                w = (t - 2.0 * t * t + t**3, 1.0 - 4.0 * t + 3.0 * t * t, 6.0 * t - 4.0)
            elif k == 2:
                w = (3.0 * t * t - 2.0 * t**3, 6.0 * t - 6.0 * t * t, 6.0 - 12.0 * t)
            else:
                w = (t**3 - t * t, 3.0 * t * t - 2.0 * t, 6.0 * t - 2.0)
            for d in range(3):
                weights[d, 2 * k + c] = scale * w[d]
    for i in range(2 * LINE_VECTORS, LINE_WIDTH):
        weights[0, i], weights[1, i], weights[2, i] = -1.0, 0.0, 0.0


@internal
def disk_on_cable_kernel(job: int, t: float, b: Any) -> None:
    c, place, weights, slopes = np.empty((4, 2)), np.empty(2), np.empty((3, LINE_WIDTH)), np.empty((3, 2))
    directions, bends = np.zeros((LINE_WIDTH, 2)), np.zeros((LINE_WIDTH, 2))
    first, second = np.empty((LINE_WIDTH, 2)), np.empty((PAIRS, 2))
    xi, xi_hessian, gradient, hessian = np.empty(LINE_WIDTH), np.empty(PAIRS), np.empty(LINE_WIDTH), np.empty(PAIRS)
    for i in range(LINE_WIDTH - 1):
        directions[i, i % 2] = 1.0
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    extra = imat(b.extra, b.count, b.nextra)
    e = 0
    while e < b.count:
        cx, cy, ax, ay = _centre(q, coord[e], par[e])
        place[0], place[1] = cx, cy
        piece, x = find_on_cable(q, coord, e, extra[e, PIECES], 0, par[e, LINE_LENGTH], place, c)
        directions[LINE_WIDTH - 1, 0], directions[LINE_WIDTH - 1, 1] = -ay, ax
        bends[LINE_WIDTH - 1, 0], bends[LINE_WIDTH - 1, 1] = -ax, -ay
        ex = cx - c[0, 0] - x * (c[1, 0] + x * (c[2, 0] + x * c[3, 0]))
        ey = cy - c[0, 1] - x * (c[1, 1] + x * (c[2, 1] + x * c[3, 1]))
        for k in range(2):
            slopes[0, k] = c[1, k] + x * (2.0 * c[2, k] + 3.0 * x * c[3, k])
            slopes[1, k] = 2.0 * c[2, k] + 6.0 * x * c[3, k]
            slopes[2, k] = 6.0 * c[3, k]
        _weigh(x, par[piece, LINE_LENGTH], weights)
        on = beyond(c, place, x)
        before = extra[piece, PIECE] == 0 and x <= 0.0 and on < 0.0
        behind = extra[piece, PIECE] == extra[piece, PIECES] - 1 and x >= 1.0 and on > 0.0
        foot_derivatives(weights, directions, bends, ex, ey, slopes, not (before or behind), xi, xi_hessian)
        arm_derivatives(weights, directions, bends, slopes, xi, xi_hessian, first, second)
        d = length_derivatives(ex, ey, first, second, gradient, hessian)
        act(b, job, piece, d - par[piece, LINE_RADII], gradient, hessian)
        e += extra[e, PIECES]


are(CABLE, disk_on_cable_kernel)
