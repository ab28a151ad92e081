"""Points of contact that move on their bodies: of smooth shapes on a half-space, and of segments against each other.

At each position the points of contact are held in their bodies: the parameters of a pair of markers, with other points.
The gap, a minimum or maximum over the points, has the gradient of the held ones, and the Hessian g_qq - sum c_k m_k^T:
c_k says how the condition that chooses coordinate k of the points changes with q, m_k how that coordinate moves then
(the implicit function theorem on that condition).
What follows the points themselves, levers and normals, gets how they move (`MOVE_A`, `MOVE_B`).
"""

import math
from typing import Any

from ..compiled.jit import inlined, internal
from ..elements.measure3d import ANGLE, AXES_A, AXES_B, DISTANCE, PLACE, POINT_A, POINT_B, offset
from ..model.rotation3d import constant, dot, four, onto, plus, times, turned, turning
from .support3d import call_support

PAIR_SIZE = 14
HOLLOW, SUPPORT, SEGMENTS, ON_CABLE, POINT_OF_CABLE, ON_MESH, ON_SMOOTH, ON_CYLINDER, ON_RING, CROSSED = range(
    ANGLE + 1, ANGLE + 11
)
"""Kinds of gaps beside DISTANCE and PLACE of `measure3d`: a sphere within the first one, a smooth shape on a
half-space, segments along the z axes of both markers, a cable against a sphere, a point of one against a half-space,
and a sphere on a mesh (of the nearest triangle PLACE, of the nearest edge SEGMENTS), a smooth shape, a cylinder, a
ring; and SEGMENTS that are edges of bodies within each other: less their distance."""
MOVE_A, MOVE_B, CHOICE, MOVED_POINT = 0, 3, 6, 9
"""Rows of the matrix of moves: derivatives of both points as they move along their bodies, in space; c_k and m_k: the
latter along the axes of the second marker, or along the z axes of the first and of the second one, or along the axes of
the first one."""
MOVES = 12
PARALLEL = 1e-10
"""Of the squared sine of their angle: segments that are parallel touch in the middle of where they lie side by side."""


@inlined
def on_plane(kind: int) -> bool:
    """True where the first shape is a half-space."""
    return kind == PLACE or kind == SUPPORT or kind == POINT_OF_CABLE


@inlined
def on_cable(kind: int) -> bool:
    """True where the second shape is a cable."""
    return kind == ON_CABLE or kind == POINT_OF_CABLE


@inlined
def moves_on(kind: int) -> bool:
    """True where points of contact move on their bodies."""
    return kind == SUPPORT or kind == SEGMENTS or kind == CROSSED or on_round(kind)


@inlined
def on_round(kind: int) -> bool:
    """True where a sphere is on a round shape, which is the first."""
    return kind == ON_SMOOTH or kind == ON_CYLINDER or kind == ON_RING


@inlined
def measured(kind: int) -> int:
    """The measure of the held points that the gap is."""
    return PLACE if on_plane(kind) else DISTANCE


@internal
def _shift(held: Any, point: int, axis: int, way: float) -> None:
    """A held point goes on along an axis of its marker."""
    for i in range(3):
        held[point + i] += way * held[axis + i]


@internal
def _clip(x: float, most: float) -> float:
    return min(max(x, -most), most)


@internal
def hold_support(q: Any, coord: Any, address: int, numbers: Any, held: Any, moves: Any) -> None:
    """The point of a smooth shape that reaches farthest into a half-space."""
    p, s = four(q, coord, 3, held[0]), four(q, coord, 10, held[1])
    of_n = turning(p, constant(held, AXES_A + 6))
    n = turned(of_n, p)
    of_x, of_y, of_z = (
        turning(s, constant(held, AXES_B)), turning(s, constant(held, AXES_B + 3)),
        turning(s, constant(held, AXES_B + 6)),
    )  # fmt: skip
    x, y, z = turned(of_x, s), turned(of_y, s), turned(of_z, s)
    _, a, b, c, xx, xy, xz, yy, yz, zz = call_support(
        address, -dot(n, x), -dot(n, y), -dot(n, z), numbers[0], numbers[1], numbers[2], numbers[3]
    )
    _shift(held, POINT_B, AXES_B, a)
    _shift(held, POINT_B, AXES_B + 3, b)
    _shift(held, POINT_B, AXES_B + 6, c)
    turn_x, turn_y, turn_z = onto(of_x, n), onto(of_y, n), onto(of_z, n)
    by_x, by_y, by_z = onto(of_n, x), onto(of_n, y), onto(of_n, z)
    for j in range(4):
        for first, dx, dy, dz in ((3, by_x[j], by_y[j], by_z[j]), (10, turn_x[j], turn_y[j], turn_z[j])):
            u, v, w = (
                -(xx * dx + xy * dy + xz * dz), -(xy * dx + yy * dy + yz * dz), -(xz * dx + yz * dy + zz * dz)
            )  # fmt: skip
            at = first + j
            moves[CHOICE, at], moves[CHOICE + 1, at], moves[CHOICE + 2, at] = -dx, -dy, -dz
            moves[MOVED_POINT, at], moves[MOVED_POINT + 1, at], moves[MOVED_POINT + 2, at] = u, v, w
            goes = plus(times(u, x), plus(times(v, y), times(w, z)))
            moves[MOVE_B, at], moves[MOVE_B + 1, at], moves[MOVE_B + 2, at] = goes[0], goes[1], goes[2]


@internal
def nearest_of_segments(a: Any, b: Any, d: Any, half_a: float, half_b: float) -> Any:
    """(s, t, s is free, t is free): the nearest points d + t b and s a of two segments; a and b are unit vectors where
    the norms of the Euler parameters are met."""
    aa, bb, c, along_a, along_b = dot(a, a), dot(b, b), dot(a, b), dot(a, d), dot(b, d)
    square = aa * bb - c * c
    if half_a == 0.0 or half_b == 0.0 or square > PARALLEL:
        s = _clip((bb * along_a - c * along_b) / square, half_a) if square > PARALLEL and half_b > 0.0 else 0.0
        t = _clip((c * s - along_b) / bb, half_b)
        s = _clip((along_a + c * t) / aa, half_a)
        t = _clip((c * s - along_b) / bb, half_b)
        return s, t, abs(s) < half_a, abs(t) < half_b
    low, high = max(along_a - half_b, -half_a), min(along_a + half_b, half_a)
    s = _clip(0.5 * (low + high), half_a)
    t = _clip(c * s - along_b, half_b)
    return s, t, False, abs(t) < half_b


@internal
def hold_segments(q: Any, coord: Any, half_a: float, half_b: float, held: Any, moves: Any) -> None:
    """The nearest points of two segments, half_a and half_b long to both sides of their markers; 0 is a point."""
    p, s = four(q, coord, 3, held[0]), four(q, coord, 10, held[1])
    of_a, of_b = turning(p, constant(held, AXES_A + 6)), turning(s, constant(held, AXES_B + 6))
    a, b = turned(of_a, p), turned(of_b, s)
    d, _, _ = offset(q, coord, held, p, s)
    at_a, at_b, free_a, free_b = nearest_of_segments(a, b, d, half_a, half_b)
    _shift(held, POINT_A, AXES_A + 6, at_a)
    _shift(held, POINT_B, AXES_B + 6, at_b)
    if not (free_a or free_b):
        return
    d, of_u, of_w = offset(q, coord, held, p, s)
    aa, bb, c, length = dot(a, a), dot(b, b), dot(a, b), math.sqrt(dot(d, d))
    a_turns, b_turns = onto(of_a, d), onto(of_b, d)
    a_at_a, a_at_b, b_at_a, b_at_b = onto(of_u, a), onto(of_w, a), onto(of_u, b), onto(of_w, b)
    for j in range(PAIR_SIZE):
        local = j % 7 - 3
        if local < 0:
            x, y = (-a[j % 7], -b[j % 7]) if j < 7 else (a[j % 7], b[j % 7])
        elif j < 7:
            x, y = a_turns[local] - a_at_a[local], -b_at_a[local]
        else:
            x, y = a_at_b[local], b_turns[local] + b_at_b[local]
        # [aa, -c; -c, bb] (ds, dt) = (x, -y), where both are free
        if free_a and free_b:
            ds, dt = (bb * x - c * y) / (aa * bb - c * c), (c * x - aa * y) / (aa * bb - c * c)
        else:
            ds, dt = (x / aa, 0.0) if free_a else (0.0, -y / bb)
        moves[CHOICE, j], moves[CHOICE + 1, j], moves[CHOICE + 2, j] = x / length, -y / length, 0.0
        moves[MOVED_POINT, j], moves[MOVED_POINT + 1, j], moves[MOVED_POINT + 2, j] = ds, dt, 0.0
        for i in range(3):
            moves[MOVE_A + i, j], moves[MOVE_B + i, j] = ds * a[i], dt * b[i]


@internal
def bend_held(hessian: Any, moves: Any) -> None:
    """Take from the Hessian of the held points what their moves change."""
    for k in range(3):
        for i in range(PAIR_SIZE):
            x = moves[CHOICE + k, i]
            if x != 0.0:
                for j in range(PAIR_SIZE):
                    hessian[i, j] -= x * moves[MOVED_POINT + k, j]
