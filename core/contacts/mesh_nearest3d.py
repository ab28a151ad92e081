"""The point of a part of a mesh that is nearest to a place: on a triangle, an edge or a corner.

Over a triangle the gap is the height over its plane, as over a half-space; beside it the distance from an edge, as of a
capsule without radius, whose ends are the corners. Triangles stand in the pool of numbers, `STRIDE` each: corners,
normal, whether an edge is flat, and a ball around it.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.views import imat, vec
from ..elements.measure3d import AXES_A, PLACE, POINT_A, offset
from ..model.rotation3d import dot, four, less, turned, turning
from .edges_nearest3d import EDGES, hold_on_edges
from .mesh_parts import Faces, Points, flat_edges, normals_of
from .moving_point3d import SEGMENTS, hold_segments
from .normal3d import pair_of

NORMAL_AT, FLAT_AT, MIDDLE_AT, REACH_AT, STRIDE = 9, 12, 15, 18, 19
FIRST_TRIANGLE, TRIANGLES, OPEN_SURFACE = 7, 8, 9
"""Columns of `extra`: where the part's triangles begin in the pool, how many they are, and whether they are not the
whole surface: then what is behind one of them is not within the body. Or the table is of edges (EDGES)."""
ON_FACE = 3
"""Beside the numbers 0, 1, 2 of the edges."""
CORNER, EDGE, FACE = range(3)
"""Where on a triangle a place is."""
ALIKE = 1e-12
"""Of a squared distance: rounding of it, where the shape is 10^4 times as large."""
WITHIN = 1e-18
"""Of the squared size of a triangle: so little beyond a flat edge the foot is still on the triangle."""


def table_of(vertices: Points, faces: Faces, part: Sequence[int]) -> list[float]:
    """The triangles of a part for the pool; vertices in the frame of the body."""
    points, triangles = np.array(vertices), np.array(faces)
    corners = points[triangles]
    normals, flat, middle = normals_of(points, triangles), flat_edges(vertices, faces), corners.mean(axis=1)
    reach = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    rows = np.hstack([corners.reshape(-1, 9), normals, flat, middle, reach[:, None]])
    return [float(x) for x in rows[list(part)].ravel()]


@inlined
def _corner(pool: Any, at: int, k: int) -> Any:
    return pool[at + 3 * k], pool[at + 3 * k + 1], pool[at + 3 * k + 2]


@inlined
def _from_edge(y: Any, a: Any, ab: Any) -> Any:
    """(squared distance of y from the edge a + t ab, whether the nearest point is between its ends)."""
    away = less(y, a)
    t = dot(ab, away) / dot(ab, ab)
    within = 0.0 < t < 1.0
    t = min(max(t, 0.0), 1.0)
    e = (away[0] - t * ab[0], away[1] - t * ab[1], away[2] - t * ab[2])
    return dot(e, e), within


@internal
def _on_triangle(pool: Any, at: int, y: Any) -> Any:
    """(edge or ON_FACE, squared distance, how much of a face the place is) of the point of a triangle nearest to y."""
    n, a = _corner(pool, at + NORMAL_AT, 0), _corner(pool, at, 0)
    height = dot(n, less(y, a))
    edge, least, outside, size = ON_FACE, np.inf, False, CORNER
    for k in range(3):
        p, q = _corner(pool, at, k), _corner(pool, at, (k + 1) % 3)
        side, away = less(q, p), less(y, p)
        # along n x side, which points into the triangle
        inward = (
            (n[1] * side[2] - n[2] * side[1]) * away[0]
            + (n[2] * side[0] - n[0] * side[2]) * away[1]
            + (n[0] * side[1] - n[1] * side[0]) * away[2]
        )
        if inward < 0.0:
            outside = True
            square, within = _from_edge(y, p, side)
            if square < least:
                edge, least, size = k, square, EDGE if within else CORNER
    if not outside:
        return ON_FACE, height * height, FACE
    if pool[at + FLAT_AT + edge] > 0.0 and least - height * height <= WITHIN * pool[at + REACH_AT] ** 2:
        return ON_FACE, height * height, FACE
    return edge, least, size


@internal
def _nearest(pool: Any, first: int, count: int, y: Any) -> Any:
    """(where the nearest triangle stands, its edge or ON_FACE)."""
    best, edge, least, size = first, ON_FACE, np.inf, CORNER
    for i in range(count):
        at = first + STRIDE * i
        away = less(_corner(pool, at, MIDDLE_AT // 3), y)
        if math.sqrt(dot(away, away)) - pool[at + REACH_AT] > (1.0 + ALIKE) * math.sqrt(least):
            continue
        found, square, whole = _on_triangle(pool, at, y)
        # of a triangle and an edge the triangle, of an edge and its end the edge: near where one goes over into the
        # other, rounding does not tell them apart by their distance, but their curvature is not the same
        if square < (1.0 - ALIKE) * least or (square <= (1.0 + ALIKE) * least and whole > size):
            best, edge, least, size = at, found, square, whole
    return best, edge


@internal
def hold_on_mesh(b: Any, e: int, held: Any, moves: Any) -> int:
    """The pair of markers of element e of a batch, a mesh and a sphere, with the nearest triangle or edge in place of
    the mesh, to held, and how the point of an edge moves, to moves; or the nearest edges of two bodies. Returns the
    kind of their gap."""
    pair, extra = pair_of(b, e), imat(b.extra, b.count, b.nextra)[e]
    for i in range(len(pair)):
        held[i] = pair[i]
    moves[:, :] = 0.0
    if extra[OPEN_SURFACE] == EDGES:
        return hold_on_edges(b, e, extra[FIRST_TRIANGLE], held, moves)
    q, coord, pool = vec(b.q, b.n_extended), imat(b.coord, b.count, b.ncoord)[e], vec(b.signals, b.n_signals)
    for i in range(3):
        held[POINT_A + i] = 0.0
    p, s = four(q, coord, 3, held[0]), four(q, coord, 10, held[1])
    d, _, _ = offset(q, coord, held, p, s)
    y = (
        dot(turned(turning(p, (1.0, 0.0, 0.0)), p), d),
        dot(turned(turning(p, (0.0, 1.0, 0.0)), p), d),
        dot(turned(turning(p, (0.0, 0.0, 1.0)), p), d),
    )
    where, edge = _nearest(pool, extra[FIRST_TRIANGLE], extra[TRIANGLES], y)
    if edge == ON_FACE:
        behind = dot(_corner(pool, where + NORMAL_AT, 0), less(y, _corner(pool, where, 0))) < 0.0
        side = -1.0 if behind and extra[OPEN_SURFACE] != 0 else 1.0
        for i in range(3):
            held[POINT_A + i], held[AXES_A + 6 + i] = pool[where + i], side * pool[where + NORMAL_AT + i]
        return PLACE
    a, b_ = _corner(pool, where, edge), _corner(pool, where, (edge + 1) % 3)
    way = less(b_, a)
    length, along = math.sqrt(dot(way, way)), dot(way, less(y, a)) / dot(way, way)
    # a corner is held as such, and not as the end of one of its edges, which rounding would choose
    half = 0.0 if along <= 0.0 or along >= 1.0 else 0.5 * length
    at = 0.5 if half > 0.0 else (0.0 if along <= 0.0 else 1.0)
    for i in range(3):
        held[POINT_A + i], held[AXES_A + 6 + i] = a[i] + at * way[i], way[i] / length
    hold_segments(q, coord, half, 0.0, held, moves)
    return SEGMENTS
