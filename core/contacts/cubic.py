"""Cubics between nodes with slopes, in the plane or in space, and the point of a chain of them nearest to a place.

p = c_0 + c_1 t + c_2 t^2 + c_3 t^3, t in [0, 1]; c is (4, dimensions). Nodes are r0, s0, r1, s1, s the slope dr/ds.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..rounding import SAME_PARAMETER

PARTS = 8
"""In which a cubic is looked through for its nearest point."""
MOST_ITERATIONS = 60


@internal
def coefficients(q: Any, coord: Any, first: int, length: float, c: Any) -> None:
    """Coefficients of an element of this length, whose nodes begin with local coordinate `first`."""
    n = c.shape[1]
    for k in range(n):
        at = first + k
        r0, s0 = q[coord[at]], length * q[coord[at + n]]
        r1, s1 = q[coord[at + 2 * n]], length * q[coord[at + 3 * n]]
        c[0, k], c[1, k] = r0, s0
        c[2, k] = 3.0 * (r1 - r0) - 2.0 * s0 - s1
        c[3, k] = 2.0 * (r0 - r1) + s0 + s1


@internal
def _square(c: Any, place: Any, t: float) -> float:
    """Squared distance of the point at t from the place."""
    total = 0.0
    for k in range(c.shape[1]):
        e = place[k] - c[0, k] - t * (c[1, k] + t * (c[2, k] + t * c[3, k]))
        total += e * e
    return total


@internal
def beyond(c: Any, place: Any, t: float) -> float:
    """(place - p) . p' at t: zero at the foot of a perpendicular."""
    total = 0.0
    for k in range(c.shape[1]):
        e = place[k] - c[0, k] - t * (c[1, k] + t * (c[2, k] + t * c[3, k]))
        total += e * (c[1, k] + t * (2.0 * c[2, k] + 3.0 * t * c[3, k]))
    return total


@internal
def _slope(c: Any, place: Any, t: float) -> float:
    """The derivative of `beyond`."""
    bends = moves = 0.0
    for k in range(c.shape[1]):
        e = place[k] - c[0, k] - t * (c[1, k] + t * (c[2, k] + t * c[3, k]))
        p = c[1, k] + t * (2.0 * c[2, k] + 3.0 * t * c[3, k])
        bends += e * (2.0 * c[2, k] + 6.0 * t * c[3, k])
        moves += p * p
    return bends - moves


@internal
def nearest_on_cubic(c: Any, place: Any) -> Any:
    """(t, squared distance) of the point of a cubic that is nearest to a place."""
    best, least = 0, np.inf
    for k in range(PARTS + 1):
        square = _square(c, place, k / PARTS)
        if square < least:
            best, least = k, square
    low, high, t = max(best - 1, 0) / PARTS, min(best + 1, PARTS) / PARTS, best / PARTS
    for _ in range(MOST_ITERATIONS):
        f = beyond(c, place, t)
        if f >= 0.0:
            low = t
        else:
            high = t
        slope = _slope(c, place, t)
        # at an end of the element the foot may be held
        if (t >= 1.0 and f >= 0.0) or (t <= 0.0 and f <= 0.0) or low == high:
            break
        following = t - f / slope if slope < 0.0 else np.inf
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - t) <= SAME_PARAMETER:
            break
        t = following
    return t, _square(c, place, t)


@internal
def find_on_cable(q: Any, coord: Any, first: int, pieces: int, own: int, length: float, place: Any, c: Any) -> Any:
    """(element, t) of the point nearest to a place of the cable whose elements begin with row `first` of coord, their
    nodes with local coordinate `own`; leaves the element's coefficients."""
    best, t_best, least = first, 0.0, np.inf
    for e in range(first, first + pieces):
        coefficients(q, coord[e], own, length, c)
        # all of the element is within this distance of its first node
        reach = away = 0.0
        for i in range(1, 4):
            size = 0.0
            for k in range(c.shape[1]):
                size += c[i, k] * c[i, k]
            reach += math.sqrt(size)
        for k in range(c.shape[1]):
            away += (place[k] - c[0, k]) ** 2
        if math.sqrt(away) - reach > math.sqrt(least):
            continue
        t, square = nearest_on_cubic(c, place)
        if square < least:
            best, t_best, least = e, t, square
    coefficients(q, coord[best], own, length, c)
    other = _beyond_joint(c, best - first, pieces, t_best, place)
    if other >= 0:
        best = first + other
        coefficients(q, coord[best], own, length, c)
        t_best, _ = nearest_on_cubic(c, place)
    return best, t_best


@internal
def _beyond_joint(c: Any, k: int, pieces: int, t: float, place: Any) -> int:
    """The neighbour of element k on which the foot lies if that ends before it is reached; else -1.

    Within sqrt(rounding) of a joint both elements are as near as the other, and their curvatures are not the same: the
    slope of the distance, which is not zero where an element ends too early, tells them apart down to rounding.
    """
    if 0.0 < t < 1.0:
        return -1
    on = beyond(c, place, t)
    if t <= 0.0 and on < 0.0 and k > 0:
        return k - 1
    if t >= 1.0 and on > 0.0 and k < pieces - 1:
        return k + 1
    return -1
