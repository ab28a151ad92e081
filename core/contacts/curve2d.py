"""Derivatives of what a disk sees of a moving curve p(xi, q): the nearest point, the distance, and the direction.

With e = c - p, c the disk's centre, the foot of the perpendicular is where F(xi, q) = e . p' = 0. Eliminating it,
xi_i = -F_i/F_xi, and e(q) = c - p(xi(q), q) has derivatives E_i, E_ij, from which those of its length (the gap) and of
its angle follow. Every local coordinate i moves one vector (a node or the centre) along `directions[i]`, and twice
differentiated along `bends[i]`; the weight of that vector in p, p' and p'' is `weights[0..2, i]`, where the centre
counts as -1, 0, 0. Hessians are upper triangles, row by row.

Nothing here knows what kind of curve it is, or how many coordinates it has.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..rounding import SAME_PARAMETER


@internal
def foot_derivatives(
    weights: Any,
    directions: Any,
    bends: Any,
    ex: float,
    ey: float,
    slopes: Any,
    moves: bool,
    gradient: Any,
    hessian: Any,
) -> None:
    """gradient (W,) and hessian of xi, zero where the foot is held at an end of the curve (`moves` is False).

    slopes : p', p'', p''' at the foot, (3, 2).
    """
    n = len(gradient)
    if not moves:
        gradient[:] = 0.0
        hessian[:] = 0.0
        return
    x1, y1, x2, y2, x3, y3 = slopes[0, 0], slopes[0, 1], slopes[1, 0], slopes[1, 1], slopes[2, 0], slopes[2, 1]
    f_1 = -(x1 * x1 + y1 * y1) + ex * x2 + ey * y2
    f_11 = -3.0 * (x1 * x2 + y1 * y2) + ex * x3 + ey * y3
    f_1i = np.empty(n)
    for i in range(n):
        dx, dy = directions[i, 0], directions[i, 1]
        on_1, on_2, on_e = dx * x1 + dy * y1, dx * x2 + dy * y2, dx * ex + dy * ey
        gradient[i] = (weights[0, i] * on_1 - weights[1, i] * on_e) / f_1
        f_1i[i] = -2.0 * weights[1, i] * on_1 - weights[0, i] * on_2 + weights[2, i] * on_e
    k = 0
    for i in range(n):
        for j in range(i, n):
            across = directions[i, 0] * directions[j, 0] + directions[i, 1] * directions[j, 1]
            f_ij = -(weights[0, i] * weights[1, j] + weights[0, j] * weights[1, i]) * across
            if i == j:
                f_ij += bends[i, 0] * (weights[1, i] * ex - weights[0, i] * x1)
                f_ij += bends[i, 1] * (weights[1, i] * ey - weights[0, i] * y1)
            f_ij += f_1i[i] * gradient[j] + f_1i[j] * gradient[i] + f_11 * gradient[i] * gradient[j]
            hessian[k] = -f_ij / f_1
            k += 1


@internal
def arm_derivatives(
    weights: Any, directions: Any, bends: Any, slopes: Any, xi: Any, xi_hessian: Any, first: Any, second: Any
) -> None:
    """First (W, 2) and second derivatives (W (W + 1)/2, 2) of e."""
    n, k = len(xi), 0
    for i in range(n):
        for c in range(2):
            first[i, c] = -weights[0, i] * directions[i, c] - slopes[0, c] * xi[i]
        for j in range(i, n):
            for c in range(2):
                value = -weights[1, i] * directions[i, c] * xi[j] - weights[1, j] * directions[j, c] * xi[i]
                value -= slopes[1, c] * xi[i] * xi[j] + slopes[0, c] * xi_hessian[k]
                if i == j:
                    value -= weights[0, i] * bends[i, c]
                second[k, c] = value
            k += 1


@internal
def length_derivatives(x: float, y: float, first: Any, second: Any, gradient: Any, hessian: Any) -> float:
    """Length of the vector (x, y), with gradient and Hessian."""
    d, n, k = math.sqrt(x * x + y * y), len(gradient), 0
    for i in range(n):
        gradient[i] = (x * first[i, 0] + y * first[i, 1]) / d
    for i in range(n):
        for j in range(i, n):
            value = first[i, 0] * first[j, 0] + first[i, 1] * first[j, 1] + x * second[k, 0] + y * second[k, 1]
            hessian[k] = value / d - gradient[i] * gradient[j] / d
            k += 1
    return d


@internal
def add_direction(
    x: float, y: float, first: Any, second: Any, factor: float, gradient: Any, hessian: Any, turn: Any
) -> None:
    """gradient and hessian += factor times those of the angle of the vector (x, y); `turn` (W,) is overwritten.

    phi_i = (d x d_i)/D, phi_ij = (d_j x d_i + d x d_ij)/D - phi_i D_j/D, D = d . d.
    """
    square, n, k = x * x + y * y, len(gradient), 0
    for i in range(n):
        turn[i] = (x * first[i, 1] - y * first[i, 0]) / square
        gradient[i] += factor * turn[i]
    for i in range(n):
        for j in range(i, n):
            growth = 2.0 * (x * first[j, 0] + y * first[j, 1]) / square
            value = first[j, 0] * first[i, 1] - first[j, 1] * first[i, 0] + x * second[k, 1] - y * second[k, 0]
            hessian[k] += factor * (value / square - turn[i] * growth)
            k += 1


MOST_ITERATIONS = 60
PARTS = 4
"""In which a piece is looked through for its nearest point."""


@internal
def nearest_on_parabola(control: Any, cx: float, cy: float) -> Any:
    """(t, squared distance) of the point of a quadratic Bezier curve, control (3, 2), that is nearest to (cx, cy)."""
    ax, ay = 2.0 * (control[1, 0] - control[0, 0]), 2.0 * (control[1, 1] - control[0, 1])
    bx, by = control[0, 0] - 2.0 * control[1, 0] + control[2, 0], control[0, 1] - 2.0 * control[1, 1] + control[2, 1]
    x0, y0 = cx - control[0, 0], cy - control[0, 1]
    best, least = 0, np.inf
    for k in range(PARTS + 1):
        t = k / PARTS
        ex, ey = x0 - t * (ax + t * bx), y0 - t * (ay + t * by)
        square = ex * ex + ey * ey
        if square < least:
            best, least = k, square
    low, high, t = max(best - 1, 0) / PARTS, min(best + 1, PARTS) / PARTS, best / PARTS
    for _ in range(MOST_ITERATIONS):
        ex, ey = x0 - t * (ax + t * bx), y0 - t * (ay + t * by)
        px, py = ax + 2.0 * t * bx, ay + 2.0 * t * by
        f = ex * px + ey * py
        if f >= 0.0:
            low = t
        else:
            high = t
        slope = 2.0 * (ex * bx + ey * by) - (px * px + py * py)
        step = -f / slope if slope < 0.0 else np.inf
        # at an end of the curve the foot may be held
        if (t >= 1.0 and f >= 0.0) or (t <= 0.0 and f <= 0.0) or low == high:
            break
        following = t + step
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - t) <= SAME_PARAMETER:
            break
        t = following
    ex, ey = x0 - t * (ax + t * bx), y0 - t * (ay + t * by)
    return t, ex * ex + ey * ey
