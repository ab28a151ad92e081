"""The nearest two of the edges of two bodies, held as segments against each other.

A table in the pool of numbers has four counts, of the edges and of the faces of both bodies; then these, those of the
first body before those of the second. An edge (`STRIDE`) is its middle and direction in the frame of the body, and half
its length; a face (`FACE`) its outward normal and how far along it the face is.

Where edges cross, their distance rises again behind zero. So where the place on one of them is within the other body,
the gap is less their distance, and falls on.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.views import imat, mat, vec
from ..elements.measure3d import AXES_A, AXES_B, POINT_A, POINT_B
from ..model.rotation3d import constant, dot, four, less, plus, three, times, turned, turning
from .moving_point3d import CROSSED, SEGMENTS, hold_segments, nearest_of_segments
from .normal3d import RADIUS_A, RADIUS_B, TILT
from .parallel_axes3d import back_by

EDGES = 2
"""What stands in place of whether a mesh is open: the table is of edges."""
HEAD, STRIDE, FACE = 4, 7, 4
ALONG, HALF = 3, 6
PLACED = 6
"""Of an edge in space: middle and direction."""


@inlined
def _triple(pool: Any, at: int) -> Any:
    return pool[at], pool[at + 1], pool[at + 2]


@internal
def _place(pool: Any, at: int, origin: Any, p: Any, to: Any) -> None:
    """Middle and direction of an edge in space, to (PLACED,)."""
    middle = plus(origin, turned(turning(p, _triple(pool, at)), p))
    along = turned(turning(p, _triple(pool, at + ALONG)), p)
    for i in range(3):
        to[i], to[ALONG + i] = middle[i], along[i]


@internal
def _nearest(pool: Any, first: int, q: Any, coord: Any, rest: Any, tilt: float, radii: float) -> Any:
    """(where the nearest edges of the first and of the second body stand)."""
    count_a, count_b = int(pool[first]), int(pool[first + 1])
    p, s = four(q, coord, 3, rest[0]), four(q, coord, 10, rest[1])
    on_a, on_b = three(q, coord, 0), three(q, coord, 7)
    start_b = first + HEAD + STRIDE * count_a
    second, one = np.empty((count_b, PLACED)), np.empty(PLACED)
    for k in range(count_b):
        _place(pool, start_b + STRIDE * k, on_b, s, second[k])
    best_a, best_b, least = first + HEAD, start_b, np.inf
    for i in range(count_a):
        at_a = first + HEAD + STRIDE * i
        _place(pool, at_a, on_a, p, one)
        half_a, a = pool[at_a + HALF], _triple(one, ALONG)
        for k in range(count_b):
            at_b, other = start_b + STRIDE * k, second[k]
            half_b, d = pool[at_b + HALF], less(_triple(other, 0), _triple(one, 0))
            if math.sqrt(dot(d, d)) - half_a - half_b > least:
                continue
            b = _triple(other, ALONG)
            along_a, along_b, _, _ = nearest_of_segments(a, b, d, half_a, half_b)
            away = plus(d, less(times(along_b, b), times(along_a, a)))
            found = math.sqrt(dot(away, away)) + back_by(dot(a, b), tilt, radii)
            if found < least:
                best_a, best_b, least = at_a, at_b, found
    return best_a, best_b


@internal
def _within(pool: Any, at: int, count: int, origin: Any, p: Any, place: Any) -> bool:
    """True if a place is within the hull with these faces of the body at `origin` with the Euler parameters p."""
    d = less(place, origin)
    y = (
        dot(turned(turning(p, (1.0, 0.0, 0.0)), p), d),
        dot(turned(turning(p, (0.0, 1.0, 0.0)), p), d),
        dot(turned(turning(p, (0.0, 0.0, 1.0)), p), d),
    )
    for k in range(count):
        if dot(_triple(pool, at + FACE * k), y) >= pool[at + FACE * k + 3]:
            return False
    return count > 0


@internal
def hold_on_edges(b: Any, e: int, first: int, held: Any, moves: Any) -> int:
    """The nearest edges of both bodies in place of the markers of element e of a batch, in held, which has these, and
    how their nearest points move, to moves, which are zero. Returns the kind of their gap."""
    par = mat(b.par, b.count, b.npar)[e]
    q, coord, pool = vec(b.q, b.n_extended), imat(b.coord, b.count, b.ncoord)[e], vec(b.signals, b.n_signals)
    at_a, at_b = _nearest(pool, first, q, coord, held, par[TILT], par[RADIUS_A] + par[RADIUS_B])
    for i in range(3):
        held[POINT_A + i], held[AXES_A + 6 + i] = pool[at_a + i], pool[at_a + ALONG + i]
        held[POINT_B + i], held[AXES_B + 6 + i] = pool[at_b + i], pool[at_b + ALONG + i]
    hold_segments(q, coord, pool[at_a + HALF], pool[at_b + HALF], held, moves)
    p, s = four(q, coord, 3, held[0]), four(q, coord, 10, held[1])
    on_a, on_b = three(q, coord, 0), three(q, coord, 7)
    place_a = plus(on_a, turned(turning(p, constant(held, POINT_A)), p))
    place_b = plus(on_b, turned(turning(s, constant(held, POINT_B)), s))
    faces_a = first + HEAD + STRIDE * int(pool[first] + pool[first + 1])
    count_a, count_b = int(pool[first + 2]), int(pool[first + 3])
    if _within(pool, faces_a, count_a, on_a, p, place_b):
        return CROSSED
    return CROSSED if _within(pool, faces_a + FACE * count_a, count_b, on_b, s, place_a) else SEGMENTS
