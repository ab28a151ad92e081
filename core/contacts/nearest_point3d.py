"""The point of a round shape that is nearest to the centre of a sphere: of smooth shapes, cylinders, disks, rings.

The shape is the first of the pair, so that y, the point in its frame, is held on it, and c is the centre there. The
nearest point goes on by dy = M dc, in the tangent plane, and the gap |c - y| - R bends by that (`moving_point3d.py`).

- Of a smooth shape with the support function h its outward normal n is where n.c - h(n), the height over the tangent
  plane, is largest among all directions (Boyd and Vandenberghe 2004, section 8.1.3). Newton's method on the sphere,
  with shorter steps where needed, finds it: (h_nn + f) dn = c - f n - h_n, f the height. M = I - f (h_nn + f)^-1.
- Of a cylinder, and of a disk, which is one without length, it is on an end, on the side or on a rim.
- Of a ring it is on its circle.
"""

import math
from typing import Any

from ..compiled.jit import inlined, internal
from ..elements.measure3d import AXES_A, POINT_A, offset
from ..model.rotation3d import constant, dot, four, less, onto, plus, times, turned, turning
from .moving_point3d import CHOICE, HOLLOW, MOVE_A, MOVED_POINT, ON_CYLINDER, ON_SMOOTH, PAIR_SIZE
from .support3d import call_support

NONE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
MOST_STEPS, SHORTEST = 60, 2.0**-30
NEARLY = 1e-6
"""Steps of the normal below it are taken whole: what they should raise is lost in rounding."""
DONE = 1e-15
"""A shorter step of the normal changes nothing."""
LEAST_HEIGHT = 0.05
"""Of |c|, in place of the height in Newton's matrix as long as it is smaller and steps are long."""
ON_IT = 1e-12
"""Of |c|: with less height the centre is on the surface, or in the shape."""


@inlined
def _solved(m: Any, x: Any) -> Any:
    """The solution of [m0 m1 m2; m1 m3 m4; m2 m4 m5] y = x, of a matrix with positive eigenvalues."""
    a, b, c, d, e, f = m
    l1, l2 = b / a, c / a
    d1, e1 = d - l1 * b, e - l1 * c
    l3 = e1 / d1
    f1 = f - l2 * c - l3 * e1
    y1 = x[1] - l1 * x[0]
    z = (x[2] - l2 * x[0] - l3 * y1) / f1
    y = (y1 - e1 * z) / d1
    return (x[0] - b * y - c * z) / a, y, z


@inlined
def _times(m: Any, x: Any) -> Any:
    return (
        m[0] * x[0] + m[1] * x[1] + m[2] * x[2], m[1] * x[0] + m[3] * x[1] + m[4] * x[2],
        m[2] * x[0] + m[4] * x[1] + m[5] * x[2],
    )  # fmt: skip


@inlined
def _support(address: int, numbers: Any, p: Any) -> Any:
    """(h, its gradient, h_pp) at p."""
    h, x, y, z, xx, xy, xz, yy, yz, zz = call_support(
        address, p[0], p[1], p[2], numbers[0], numbers[1], numbers[2], numbers[3]
    )
    return h, (x, y, z), (xx, xy, xz, yy, yz, zz)


@inlined
def _more(m: Any, x: float) -> Any:
    """m + x I."""
    return m[0] + x, m[1], m[2], m[3] + x, m[4], m[5] + x


@inlined
def _unit(x: Any) -> Any:
    return times(1.0 / math.sqrt(dot(x, x)), x)


@internal
def _middle(address: int, numbers: Any) -> Any:
    """The middle of the box around a smooth shape, to start from: its marker may be anywhere."""
    x, y, z = (1.0, 1e-6, 1e-6), (1e-6, 1.0, 1e-6), (1e-6, 1e-6, 1.0)
    up = _support(address, numbers, x)[0], _support(address, numbers, y)[0], _support(address, numbers, z)[0]
    x, y, z = times(-1.0, x), times(-1.0, y), times(-1.0, z)
    down = _support(address, numbers, x)[0], _support(address, numbers, y)[0], _support(address, numbers, z)[0]
    return times(0.5, less(up, down))


@internal
def nearest_on_smooth(address: int, numbers: Any, c: Any) -> Any:
    """(outside, y, M) of a smooth shape; within it y is a point of the surface on the way out, and M is zero."""
    middle = _middle(address, numbers)
    away = less(c, middle)
    size = math.sqrt(dot(away, away))
    n = times(1.0 / size, away) if size > 0.0 else (0.0, 0.0, 1.0)
    h, y, m = _support(address, numbers, n)
    f, last = dot(n, c) - h, math.inf
    for _ in range(MOST_STEPS):
        slope = less(less(c, y), times(f, n))
        # near the end the true matrix: f may be small beside h_nn, but not beside rounding
        step = _solved(_more(m, max(f, ON_IT * size if last < NEARLY else LEAST_HEIGHT * size)), slope)
        length, part = math.sqrt(dot(step, step)), 1.0
        there = _unit(plus(n, step))
        if length > NEARLY:
            rises = dot(slope, step)
            while part > SHORTEST and not (
                dot(there, c) - _support(address, numbers, there)[0] >= f + 1e-4 * part * rises
            ):
                part *= 0.5
                there = _unit(plus(n, times(part, step)))
        n = there
        h, y, m = _support(address, numbers, n)
        f = dot(n, c) - h
        if length <= DONE or (length < NEARLY and length >= last):
            break
        last = length
    if not f > ON_IT * size:
        return False, y, NONE
    matrix = _more(m, f)
    one, two, three = (
        _solved(matrix, (f, 0.0, 0.0)), _solved(matrix, (0.0, f, 0.0)), _solved(matrix, (0.0, 0.0, f))
    )  # fmt: skip
    return True, y, (1.0 - one[0], -one[1], -one[2], 1.0 - two[1], -two[2], 1.0 - three[2])


@internal
def nearest_on_ring(radius: float, c: Any) -> Any:
    """(outside, y, M) of a circle about z; from its axis, where all its points are as near, one of them."""
    across = math.sqrt(c[0] * c[0] + c[1] * c[1])
    if across == 0.0:
        return True, (radius, 0.0, 0.0), NONE
    u, v, part = c[0] / across, c[1] / across, radius / across
    return True, (radius * u, radius * v, 0.0), (part * v * v, -part * u * v, 0.0, part * u * u, 0.0, 0.0)


@internal
def nearest_on_cylinder(radius: float, half: float, c: Any) -> Any:
    """(outside, y, M) of a cylinder about z, `half` long to both sides; within it y is on the nearest side."""
    across, high = math.sqrt(c[0] * c[0] + c[1] * c[1]), abs(c[2])
    end = half if c[2] >= 0.0 else -half
    beside, over = across > radius, high > half
    if not beside and not over:
        if half - high < radius - across:
            return False, (c[0], c[1], end), NONE
        u, v = (c[0] / across, c[1] / across) if across > 0.0 else (1.0, 0.0)
        return False, (radius * u, radius * v, c[2]), NONE
    if not beside:
        return True, (c[0], c[1], end), (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    _, y, m = nearest_on_ring(radius, c)
    if over:
        return True, (y[0], y[1], end), m
    return True, (y[0], y[1], c[2]), (m[0], m[1], 0.0, m[3], 0.0, 1.0)


@internal
def hold_on_round(kind: int, q: Any, coord: Any, address: int, numbers: Any, held: Any, moves: Any) -> int:
    """The point of a round shape, the first one, that is nearest to the second's. Returns the kind of the gap: this
    one, or with the centre in the shape that of a hollow, whose gap falls on, from points that do not move."""
    p, s = four(q, coord, 3, held[0]), four(q, coord, 10, held[1])
    of_x, of_y, of_z = (
        turning(p, constant(held, AXES_A)), turning(p, constant(held, AXES_A + 3)),
        turning(p, constant(held, AXES_A + 6)),
    )  # fmt: skip
    x, y, z = turned(of_x, p), turned(of_y, p), turned(of_z, p)
    d, _, _ = offset(q, coord, held, p, s)
    # where the norm of the Euler parameters is not 1, axes are longer by the same factor, and the shape is larger
    square = dot(x, x)
    c = (dot(x, d) / square, dot(y, d) / square, dot(z, d) / square)
    if kind == ON_SMOOTH:
        outside, at, m = nearest_on_smooth(address, numbers, c)
    elif kind == ON_CYLINDER:
        outside, at, m = nearest_on_cylinder(numbers[0], numbers[1], c)
    else:
        outside, at, m = nearest_on_ring(numbers[0], c)
    for k in range(3):
        for i in range(3):
            held[POINT_A + i] += at[k] * held[AXES_A + 3 * k + i]
    if not outside:
        return HOLLOW
    d, of_u, of_w = offset(q, coord, held, p, s)
    length = math.sqrt(dot(d, d))
    turns = onto(of_x, d), onto(of_y, d), onto(of_z, d)
    by_u = onto(of_u, x), onto(of_u, y), onto(of_u, z)
    by_w = onto(of_w, x), onto(of_w, y), onto(of_w, z)
    for j in range(PAIR_SIZE):
        local = j % 7 - 3
        if local < 0:
            i, sign = j % 7, -1.0 if j < 7 else 1.0
            goes = (sign * x[i], sign * y[i], sign * z[i])
        elif j < 7:
            goes = (
                turns[0][local] - by_u[0][local], turns[1][local] - by_u[1][local], turns[2][local] - by_u[2][local]
            )  # fmt: skip
        else:
            goes = (by_w[0][local], by_w[1][local], by_w[2][local])
        on = times(1.0 / square, _times(m, goes))
        far = plus(times(on[0], x), plus(times(on[1], y), times(on[2], z)))
        for i in range(3):
            moves[CHOICE + i, j], moves[MOVED_POINT + i, j], moves[MOVE_A + i, j] = goes[i] / length, on[i], far[i]
    return kind
