"""Bounds of the motion of two rigid bodies within a part of a step.

The motion is the dense output, a polynomial of fifth degree in each coordinate, angles included. Its control points in
the basis of Bernstein's polynomials bound it and its derivatives. All derivatives are by s = t/tau in [0, 1].

A vector u that turns with its body has |(A u)'| <= T_1 |u| and |(A u)''| <= T_2 |u|. In the plane T_1 = |theta'| and
T_2 = |theta''| + theta'^2. In space A u is a quadratic form in the Euler parameters p, so that T_1 = 2 |p||p'| and
T_2 = 2 |p||p''| + 2 |p'|^2.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..contacts.gap_motion_bound3d import TURN_BOUND

CONTROL_POINTS = 6
"""Control points of a polynomial of fifth degree."""
PLANAR_BODY, SPATIAL_BODY = 3, 7
"""Coordinates of a body of the plane and of space; the first are those of its place."""


@internal
def control_points(q0: float, v0: float, a0: float, q1: float, v1: float, a1: float, tau: float, c: Any) -> None:
    """Control points (6,) of the polynomial through (q, v, a) at both ends of a time tau."""
    c[0], c[5] = q0, q1
    c[1], c[4] = q0 + tau * v0 / 5.0, q1 - tau * v1 / 5.0
    c[2] = q0 + 0.4 * tau * v0 + tau * tau * a0 / 20.0
    c[3] = q1 - 0.4 * tau * v1 + tau * tau * a1 / 20.0


@internal
def _of_body(state: Any, width: int, body: int, j: int) -> Any:
    """Coordinate j of the first or second body with its velocity and acceleration."""
    at = 3 * width * body + j
    return state[at], state[at + width], state[at + 2 * width]


@internal
def _lengths(points: Any, count: int) -> Any:
    """(length of the way, largest first and second derivative) of a vector with control points (count, 6)."""
    way, first, second = 0.0, 0.0, 0.0
    for i in range(CONTROL_POINTS - 1):
        once, twice = 0.0, 0.0
        for j in range(count):
            step = points[j, i + 1] - points[j, i]
            once += step * step
            if i > 0:
                bend = step - points[j, i] + points[j, i - 1]
                twice += bend * bend
        once, twice = math.sqrt(once), math.sqrt(twice)
        way, first, second = way + once, max(first, once), max(second, twice)
    return way, 5.0 * first, 20.0 * second


@internal
def moves(first: Any, last: Any, width: int, tau: float, points: Any) -> Any:
    """(length of the way, largest first and second derivative, largest distance) of the second body's place against
    the first's, m; its control points go into points (3, 6).

    first, last : coordinates, velocities and accelerations of both bodies, one after the other, at both ends.
    """
    count, far = 2 if width == PLANAR_BODY else 3, 0.0
    points[2, :] = 0.0
    for j in range(count):
        q0, v0, a0 = _of_body(first, width, 0, j)
        q1, v1, a1 = _of_body(last, width, 0, j)
        r0, w0, b0 = _of_body(first, width, 1, j)
        r1, w1, b1 = _of_body(last, width, 1, j)
        control_points(r0 - q0, w0 - v0, b0 - a0, r1 - q1, w1 - v1, b1 - a1, tau, points[j])
    for i in range(CONTROL_POINTS):
        far = max(far, math.sqrt(points[0, i] ** 2 + points[1, i] ** 2 + points[2, i] ** 2))
    way, once, twice = _lengths(points, count)
    return way, once, twice, far


@internal
def turns(first: Any, last: Any, width: int, tau: float, body: int) -> Any:
    """(way of the end of a unit vector that turns with a body, T_1, T_2)."""
    begin, count = (2, 1) if width == PLANAR_BODY else (3, 4)
    points = np.empty((4, CONTROL_POINTS))
    for j in range(count):
        q0, v0, a0 = _of_body(first, width, body, begin + j)
        q1, v1, a1 = _of_body(last, width, body, begin + j)
        control_points(q0, v0, a0, q1, v1, a1, tau, points[j])
    way, once, twice = _lengths(points, count)
    if width == PLANAR_BODY:
        return way, once, twice + once * once
    return TURN_BOUND * way, TURN_BOUND * once, TURN_BOUND * (twice + once * once)
