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
from ..rounding import SAME_PARAMETER
from .curve2d import arm_derivatives, foot_derivatives, length_derivatives
from .geometry_kinds import CABLE, are
from .normal2d import act

VECTORS = 4  # r0, s0, r1, s1
WIDTH = 2 * VECTORS + 3
PAIRS = WIDTH * (WIDTH + 1) // 2

# columns of the table of parameters; 7 to 15 are those of the laws
BOTH = 0
POINT, LENGTH = 16, 18  # of the disk in its body, (2,); of an element
# columns of `extra` after those that every contact has
PIECE, PIECES = 6, 7

PARTS = 8
"""In which an element is looked through for its nearest point."""
MOST_ITERATIONS = 60


@internal
def _coefficients(q: Any, coord: Any, length: float, c: Any) -> None:
    """Coefficients (4, 2) of p = c0 + c1 x + c2 x^2 + c3 x^3 over an element."""
    for k in range(2):
        r0, s0 = q[coord[k]], length * q[coord[2 + k]]
        r1, s1 = q[coord[4 + k]], length * q[coord[6 + k]]
        c[0, k], c[1, k] = r0, s0
        c[2, k] = 3.0 * (r1 - r0) - 2.0 * s0 - s1
        c[3, k] = 2.0 * (r0 - r1) + s0 + s1


@internal
def _centre(q: Any, coord: Any, par: Any) -> Any:
    """(x, y, arm_x, arm_y) of the disk's centre."""
    theta = q[coord[2 * VECTORS + 2]]
    c, s = math.cos(theta), math.sin(theta)
    ax, ay = c * par[POINT] - s * par[POINT + 1], s * par[POINT] + c * par[POINT + 1]
    return q[coord[2 * VECTORS]] + ax, q[coord[2 * VECTORS + 1]] + ay, ax, ay


@internal
def _nearest(c: Any, x: float, y: float) -> Any:
    """(t, squared distance) of the point of a cubic with coefficients c (4, 2) that is nearest to (x, y)."""
    best, least = 0, np.inf
    for k in range(PARTS + 1):
        t = k / PARTS
        ex = x - c[0, 0] - t * (c[1, 0] + t * (c[2, 0] + t * c[3, 0]))
        ey = y - c[0, 1] - t * (c[1, 1] + t * (c[2, 1] + t * c[3, 1]))
        square = ex * ex + ey * ey
        if square < least:
            best, least = k, square
    low, high, t = max(best - 1, 0) / PARTS, min(best + 1, PARTS) / PARTS, best / PARTS
    for _ in range(MOST_ITERATIONS):
        ex = x - c[0, 0] - t * (c[1, 0] + t * (c[2, 0] + t * c[3, 0]))
        ey = y - c[0, 1] - t * (c[1, 1] + t * (c[2, 1] + t * c[3, 1]))
        px, py = c[1, 0] + t * (2.0 * c[2, 0] + 3.0 * t * c[3, 0]), c[1, 1] + t * (2.0 * c[2, 1] + 3.0 * t * c[3, 1])
        f = ex * px + ey * py
        if f >= 0.0:
            low = t
        else:
            high = t
        bx, by = 2.0 * c[2, 0] + 6.0 * t * c[3, 0], 2.0 * c[2, 1] + 6.0 * t * c[3, 1]
        slope = ex * bx + ey * by - (px * px + py * py)
        # at an end of the element the foot may be held
        if (t >= 1.0 and f >= 0.0) or (t <= 0.0 and f <= 0.0) or low == high:
            break
        following = t - f / slope if slope < 0.0 else np.inf
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - t) <= SAME_PARAMETER:
            break
        t = following
    ex = x - c[0, 0] - t * (c[1, 0] + t * (c[2, 0] + t * c[3, 0]))
    ey = y - c[0, 1] - t * (c[1, 1] + t * (c[2, 1] + t * c[3, 1]))
    return t, ex * ex + ey * ey


@internal
def _find(b: Any, first: int, c: Any) -> Any:
    """(element, t) of the nearest point of the cable whose elements begin with `first`; leaves its coefficients."""
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    x, y, _, _ = _centre(q, coord[first], par[first])
    best, t_best, least = first, 0.0, np.inf
    for e in range(first, first + imat(b.extra, b.count, b.nextra)[first, PIECES]):
        _coefficients(q, coord[e], par[e, LENGTH], c)
        # all of the element is within this distance of its first node
        reach = 0.0
        for k in range(1, 4):
            reach += math.hypot(c[k, 0], c[k, 1])
        if math.hypot(x - c[0, 0], y - c[0, 1]) - reach > math.sqrt(least):
            continue
        t, square = _nearest(c, x, y)
        if square < least:
            best, t_best, least = e, t, square
    _coefficients(q, coord[best], par[best, LENGTH], c)
    other = _beyond_joint(c, best - first, imat(b.extra, b.count, b.nextra)[first, PIECES], t_best, x, y)
    if other >= 0:
        best = first + other
        _coefficients(q, coord[best], par[best, LENGTH], c)
        t_best, _ = _nearest(c, x, y)
    return best, t_best


@internal
def _beyond_joint(c: Any, k: int, elements: int, t: float, x: float, y: float) -> int:
    """The neighbour of element k on which the foot lies if that ends before it is reached; else -1.

    Within sqrt(rounding) of a joint both elements are as near as the other, and their curvatures are not the same: the
    slope of the distance, which is not zero where an element ends too early, tells them apart down to rounding.
    """
    if 0.0 < t < 1.0:
        return -1
    on = 0.0
    for d in range(2):
        place = c[0, d] + t * (c[1, d] + t * (c[2, d] + t * c[3, d]))
        on += ((x if d == 0 else y) - place) * (c[1, d] + t * (2.0 * c[2, d] + 3.0 * t * c[3, d]))
    if t <= 0.0 and on < 0.0 and k > 0:
        return k - 1
    if t >= 1.0 and on > 0.0 and k < elements - 1:
        return k + 1
    return -1


@internal
def _weigh(t: float, length: float, weights: Any) -> None:
    """Weights (3, WIDTH) of the nodes' vectors in p, p' and p''; the disk's centre counts as -1, 0, 0."""
    for c in range(2):
        for k in range(VECTORS):
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
    for i in range(2 * VECTORS, WIDTH):
        weights[0, i], weights[1, i], weights[2, i] = -1.0, 0.0, 0.0


@internal
def disk_on_cable_kernel(job: int, t: float, b: Any) -> None:
    coefficients, weights, slopes = np.empty((4, 2)), np.empty((3, WIDTH)), np.empty((3, 2))
    directions, bends = np.zeros((WIDTH, 2)), np.zeros((WIDTH, 2))
    first, second = np.empty((WIDTH, 2)), np.empty((PAIRS, 2))
    xi, xi_hessian, gradient, hessian = np.empty(WIDTH), np.empty(PAIRS), np.empty(WIDTH), np.empty(PAIRS)
    for i in range(WIDTH - 1):
        directions[i, i % 2] = 1.0
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    extra = imat(b.extra, b.count, b.nextra)
    e = 0
    while e < b.count:
        piece, x = _find(b, e, coefficients)
        c = coefficients
        cx, cy, ax, ay = _centre(q, coord[piece], par[piece])
        directions[WIDTH - 1, 0], directions[WIDTH - 1, 1] = -ay, ax
        bends[WIDTH - 1, 0], bends[WIDTH - 1, 1] = -ax, -ay
        ex = cx - c[0, 0] - x * (c[1, 0] + x * (c[2, 0] + x * c[3, 0]))
        ey = cy - c[0, 1] - x * (c[1, 1] + x * (c[2, 1] + x * c[3, 1]))
        for k in range(2):
            slopes[0, k] = c[1, k] + x * (2.0 * c[2, k] + 3.0 * x * c[3, k])
            slopes[1, k] = 2.0 * c[2, k] + 6.0 * x * c[3, k]
            slopes[2, k] = 6.0 * c[3, k]
        _weigh(x, par[piece, LENGTH], weights)
        beyond = ex * slopes[0, 0] + ey * slopes[0, 1]
        before = extra[piece, PIECE] == 0 and x <= 0.0 and beyond < 0.0
        behind = extra[piece, PIECE] == extra[piece, PIECES] - 1 and x >= 1.0 and beyond > 0.0
        foot_derivatives(weights, directions, bends, ex, ey, slopes, not (before or behind), xi, xi_hessian)
        arm_derivatives(weights, directions, bends, slopes, xi, xi_hessian, first, second)
        d = length_derivatives(ex, ey, first, second, gradient, hessian)
        act(b, job, piece, d - par[piece, BOTH], gradient, hessian)
        e += extra[e, PIECES]


are(CABLE, disk_on_cable_kernel)
