"""Bounds of the motion within a part of a step: how far and how fast a gap between two rigid shapes can change there.

The motion is the dense output, a polynomial of fifth degree in each coordinate, angles included. Its control points in
the basis of Bernstein's polynomials bound it and its derivatives. All derivatives are by s = t/tau in [0, 1].

A vector that turns with an angle theta(s), e^(i theta), has derivatives F_j with F_0 = 1 and
F_j = sum_i C(j-1, i) Theta_(i+1) F_(j-1-i), if |theta^(j)| <= Theta_j. The length g of a vector d with
|d^(j)| <= B_j and |d| >= rho > 0 has |g^(j)| <= B_j + sum_(0<i<j) C(j, i) (B_i B_(j-i) + G_i G_(j-i))/(2 rho), from
g^2 = d . d differentiated j times.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..shapes.geometry_kinds import DISKS, PLANE

ORDERS = 7
"""Derivatives of order 0 to 6."""
LENGTH = 16
"""Column of a segment's length in its contact's parameters."""
BINOMIALS = np.array([[math.comb(j, i) for i in range(ORDERS)] for j in range(ORDERS)], dtype=np.float64)
FALLING = np.array([math.perm(5, j) for j in range(6)], dtype=np.float64)
"""5!/(5 - j)!."""


@internal
def control_points(q0: float, v0: float, a0: float, q1: float, v1: float, a1: float, tau: float, c: Any) -> None:
    """Control points (6,) of the polynomial through (q, v, a) at both ends of a time tau."""
    c[0], c[5] = q0, q1
    c[1], c[4] = q0 + tau * v0 / 5.0, q1 - tau * v1 / 5.0
    c[2] = q0 + 0.4 * tau * v0 + tau * tau * a0 / 20.0
    c[3] = q1 - 0.4 * tau * v1 + tau * tau * a1 / 20.0


@internal
def _turning(c: Any, bounds: Any) -> None:
    """Bounds (ORDERS,) of the derivatives of e^(i theta), theta with control points c (overwritten)."""
    rates = np.zeros(ORDERS)
    for j in range(1, 6):
        for k in range(6 - j):
            c[k] = c[k + 1] - c[k]
            rates[j] = max(rates[j], FALLING[j] * abs(c[k]))
    bounds[0] = 1.0
    for j in range(1, ORDERS):
        bounds[j] = 0.0
        for i in range(j):
            bounds[j] += BINOMIALS[j - 1, i] * rates[i + 1] * bounds[j - 1 - i]


@internal
def arm_bounds(kind: int, par: Any, first: Any, last: Any, tau: float, bounds: Any) -> None:
    """Bounds (ORDERS,) of the derivatives of the vector whose length or height is the gap of two rigid shapes: from
    centre to centre, or from a plane's or segment's body to the disk, seen from that body.

    first, last : (x, y, theta) of both bodies with velocities and accelerations at both ends, (18,) each.
    """
    x, y, turn = np.empty(6), np.empty(6), np.empty(6)
    a_turns, b_turns, moves = np.empty(ORDERS), np.empty(ORDERS), np.zeros(ORDERS)
    # of the second body against the first
    for k, c in ((0, x), (1, y)):
        control_points(
            first[9 + k] - first[k], first[12 + k] - first[3 + k], first[15 + k] - first[6 + k],
            last[9 + k] - last[k], last[12 + k] - last[3 + k], last[15 + k] - last[6 + k], tau, c,
        )  # fmt: skip
    for j in range(6):
        for k in range(6 - j):
            if j > 0:
                x[k], y[k] = x[k + 1] - x[k], y[k + 1] - y[k]
            moves[j] = max(moves[j], FALLING[j] * math.hypot(x[k], y[k]))
    for at, bounds_of in ((0, a_turns), (9, b_turns)):
        control_points(first[at + 2], first[at + 5], first[at + 8], last[at + 2], last[at + 5], last[at + 8], tau, turn)
        _turning(turn, bounds_of)
    a_arm, b_arm = math.hypot(par[0], par[1]), math.hypot(par[2], par[3])
    for j in range(ORDERS):
        moves[j] += b_arm * b_turns[j]
    if kind == DISKS:
        for j in range(ORDERS):
            bounds[j] = moves[j] + a_arm * a_turns[j]
        return
    for j in range(ORDERS):
        bounds[j] = 0.0
        for i in range(j + 1):
            bounds[j] += BINOMIALS[j, i] * a_turns[i] * moves[j - i]


@internal
def _bound_of_length(bounds: Any, rho: float) -> float:
    """Bound of the sixth derivative of the length, at least rho, of a vector with these bounds."""
    g = np.empty(ORDERS)
    for j in range(1, ORDERS):
        g[j] = bounds[j]
        for i in range(1, j):
            g[j] += BINOMIALS[j, i] * (bounds[i] * bounds[j - i] + g[i] * g[j - i]) / (2.0 * rho)
    return g[ORDERS - 1]


@internal
def seen_along(par: Any, state: Any) -> Any:
    """Where the disk's centre is: along a segment from its start, and over it, m. `state` as in `arm_bounds`."""
    ca, sa, cb, sb = math.cos(state[2]), math.sin(state[2]), math.cos(state[11]), math.sin(state[11])
    dx = state[9] - state[0] + cb * par[2] - sb * par[3] - ca * par[0] + sa * par[1]
    dy = state[10] - state[1] + sb * par[2] + cb * par[3] - sa * par[0] - ca * par[1]
    nx, ny = math.cos(state[2] + par[4]), math.sin(state[2] + par[4])
    return ny * dx - nx * dy, nx * dx + ny * dy


@internal
def gap_bounds(kind: int, par: Any, first: Any, last: Any, g0: float, g1: float, tau: float) -> Any:
    """(B_1, G_2, G_6): bounds of the first, second and sixth derivative of the gap of two rigid shapes, infinite where
    none is known.

    g0, g1 : the gap at both ends, m.
    """
    bounds = np.empty(ORDERS)
    arm_bounds(kind, par, first, last, tau, bounds)
    if kind == PLANE:
        return bounds[1], bounds[2], bounds[ORDERS - 1]
    # no nearer than this do the centres (or the disk's and the segment) come to one another
    rho = 0.5 * (g0 + g1 + 2.0 * par[5] - bounds[1])
    if rho <= 0.0:
        return bounds[1], np.inf, np.inf
    second = bounds[2] + bounds[1] * bounds[1] / rho
    if kind == DISKS:
        return bounds[1], second, _bound_of_length(bounds, rho)
    x0, y0 = seen_along(par, first)
    x1, y1 = seen_along(par, last)
    length, way = par[LENGTH], bounds[1]
    if x0 + x1 > way and 2.0 * length - x0 - x1 > way and abs(y0 + y1) > way:
        return way, bounds[2], bounds[ORDERS - 1]
    if x0 + x1 < -way or x0 + x1 - 2.0 * length > way:
        return way, second, _bound_of_length(bounds, rho)
    # the nearest point may pass an end: the gap's second derivative jumps there
    return way, second, np.inf
