"""Motion of two shapes in space along their common tangent plane.

The velocity of the second shape on the first at the point of contact is u = W(q) v,
    u = s (x_b' - x_a') + w_b x beta_b - w_a x beta_a,
x the markers' points and w the angular velocities in space, 2 E(p) p'. On a half-space, and on shapes of any curvature,
s = 1, beta_b = -R n and beta_a = d - R n: the point of contact is on the sphere. Of two spheres s = (R_a + R_b)/|d|,
beta_b = -R_b n and beta_a = R_a n: u is the rate of the arcs that they roll, and a force along it has no moment on both
together; R_a of a hollow sphere is negative, and so is |d|. Points of contact that move on their bodies are held in
them for W, and their moves are part of the derivatives (`moving_point3d.py`). The acceleration is u' = W a + U v with
U = d(W v)/dq.
"""

import math
from typing import Any

from ..compiled.jit import inlined, internal
from ..elements.measure3d import AXES_A, AXES_B, POINT_A, POINT_B, offset
from ..model.rotation3d import (
    add_bend,
    add_lever,
    along,
    constant,
    cross,
    dot,
    four,
    less,
    onto,
    plus,
    space_axes,
    three,
    times,
    turned,
    turning,
)
from .moving_point3d import CROSSED, HOLLOW, MOVE_A, MOVE_B, MOVED_POINT, SUPPORT, moves_on, on_plane, on_round
from .normal3d import PAIR_SIZE

W, U, NORMAL, OFFSET, ARM_A, ARM_B, GROWTH = 0, 3, 6, 9, 12, 15, 18
"""Rows of the work matrix: W, U, and derivatives of the normal, of d, of beta_a and beta_b, and of s."""
ROWS = 19


@inlined
def column(work: Any, first: int, j: int) -> Any:
    """Column j of the three rows from `first`."""
    return work[first, j], work[first + 1, j], work[first + 2, j]


@inlined
def put(work: Any, first: int, j: int, x: Any) -> None:
    """Column j of the three rows from `first` becomes x."""
    work[first, j], work[first + 1, j], work[first + 2, j] = x[0], x[1], x[2]


@internal
def tangent_motion(
    kind: int, q: Any, v: Any, coord: Any, pair: Any, moves: Any, ra: float, rb: float, work: Any
) -> Any:
    """(n, u, beta_a, beta_b, s) of a pair of shapes whose points are held; matrices go to work (ROWS, 14)."""
    p, s = four(q, coord, 3, pair[0]), four(q, coord, 10, pair[1])
    pd, sd = four(v, coord, 3, 0.0), four(v, coord, 10, 0.0)
    u_a, u_b, m = constant(pair, POINT_A), constant(pair, POINT_B), constant(pair, AXES_A + 6)
    d, of_u, of_w = offset(q, coord, pair, p, s)
    of_n, rate_u, rate_w = turning(p, m), turning(pd, u_a), turning(sd, u_b)
    axes_a, axes_b, spin_a, spin_b = space_axes(p), space_axes(s), space_axes(pd), space_axes(sd)
    w_a, w_b = times(2.0, along(axes_a, pd)), times(2.0, along(axes_b, sd))
    shift = plus(less(three(v, coord, 7), three(v, coord, 0)), less(along(of_w, sd), along(of_u, pd)))
    length = math.sqrt(dot(d, d))
    spheres, move, same = not on_plane(kind), moves_on(kind), on_plane(kind) or on_round(kind)
    # between spheres in spheres with one centre no direction is the normal
    one = 1.0 / length if length > 0.0 else 0.0
    if kind == HOLLOW or kind == CROSSED:
        one = -one
    n = times(one, d) if spheres else turned(of_n, p)
    size = 1.0 if same else (ra + rb) * one
    beta_a = less(d, times(rb, n)) if same else times(ra, n)
    beta_b = times(-rb, n)
    zero = (0.0, 0.0, 0.0)
    run_1 = run_2 = run_3 = zero
    if kind == SUPPORT:
        run_1 = along(turning(s, constant(pair, AXES_B)), sd)
        run_2 = along(turning(s, constant(pair, AXES_B + 3)), sd)
        run_3 = along(turning(s, constant(pair, AXES_B + 6)), sd)
    elif on_round(kind):
        run_1 = times(-1.0, along(turning(p, constant(pair, AXES_A)), pd))
        run_2 = times(-1.0, along(turning(p, constant(pair, AXES_A + 3)), pd))
        run_3 = times(-1.0, along(turning(p, m), pd))
    elif move:
        run_1 = times(-1.0, along(turning(p, m), pd))
        run_2 = along(turning(s, constant(pair, AXES_B + 6)), sd)
    for j in range(PAIR_SIZE):
        unit = (1.0 if j % 7 == 0 else 0.0, 1.0 if j % 7 == 1 else 0.0, 1.0 if j % 7 == 2 else 0.0)
        local = j % 7 - 3
        if j < 7:
            by_d = times(-1.0, of_u[local] if local >= 0 else unit)
        else:
            by_d = of_w[local] if local >= 0 else unit
        goes_a, goes_b = zero, zero
        if move:
            goes_a, goes_b = column(moves, MOVE_A, j), column(moves, MOVE_B, j)
        if spheres:
            apart = plus(by_d, less(goes_b, goes_a))
            by_n = times(one, less(apart, times(dot(n, apart), n)))
        else:
            apart = plus(by_d, goes_b)
            by_n = of_n[local] if 0 <= local and j < 7 else zero
        by_size = 0.0 if same else -size * one * dot(n, apart)
        by_a = less(apart, times(rb, by_n)) if same else times(ra, by_n)
        by_b = times(-rb, by_n)
        of_v, of_q = times(size, by_d), times(by_size, shift)
        of_q = plus(of_q, less(cross(w_b, by_b), cross(w_a, by_a)))
        if local >= 0 and j < 7:
            of_v = less(of_v, times(2.0, cross(axes_a[local], beta_a)))
            of_q = less(of_q, times(size, rate_u[local]))
            # E(p) b = -E(b) p
            of_q = plus(of_q, times(2.0, cross(spin_a[local], beta_a)))
        elif local >= 0:
            of_v = plus(of_v, times(2.0, cross(axes_b[local], beta_b)))
            of_q = plus(of_q, times(size, rate_w[local]))
            of_q = less(of_q, times(2.0, cross(spin_b[local], beta_b)))
        if move:
            held = plus(times(moves[MOVED_POINT, j], run_1), times(moves[MOVED_POINT + 1, j], run_2))
            of_q = plus(of_q, times(size, plus(held, times(moves[MOVED_POINT + 2, j], run_3))))
        put(work, W, j, of_v)
        put(work, U, j, of_q)
        put(work, NORMAL, j, by_n)
        put(work, OFFSET, j, by_d)
        put(work, ARM_A, j, by_a)
        put(work, ARM_B, j, by_b)
        work[GROWTH, j] = by_size
    u = plus(times(size, shift), less(cross(w_b, beta_b), cross(w_a, beta_a)))
    return n, u, beta_a, beta_b, size


@internal
def _add_moves(
    kind: int, values: Any, slot: Any, q: Any, coord: Any, pair: Any, moves: Any, force: Any, factor: float
) -> None:
    """The same of points that move on their bodies, values += factor dB(p, u)^T force."""
    p, s = four(q, coord, 3, pair[0]), four(q, coord, 10, pair[1])
    for k in range(3):
        on_a, axis = kind != SUPPORT and k == 0, AXES_B + 3 * k
        if on_round(kind):
            on_a, axis = True, AXES_A + 3 * k
        elif kind != SUPPORT:
            axis = AXES_A + 6 if on_a else AXES_B + 6
        pull = onto(turning(p if on_a else s, constant(pair, axis)), force)
        first, sign = (3, -factor) if on_a else (10, factor)
        for j in range(PAIR_SIZE):
            way = sign * moves[MOVED_POINT + k, j]
            if way != 0.0:
                for i in range(4):
                    values[slot[first + i, j]] += way * pull[i]


@internal
def add_directions(
    kind: int, values: Any, slot: Any, q: Any, coord: Any, pair: Any, moves: Any, work: Any, beta_a: Any, beta_b: Any,
    size: float, force: Any, factor: float,
) -> None:  # fmt: skip
    """values += factor d(W^T force)/dq, the force held."""
    if moves_on(kind):
        _add_moves(kind, values, slot, q, coord, pair, moves, force, factor * size)
    p, s = four(q, coord, 3, pair[0]), four(q, coord, 10, pair[1])
    axes_a, axes_b = space_axes(p), space_axes(s)
    for j in range(PAIR_SIZE):
        grows = factor * work[GROWTH, j]
        on_a = onto(axes_a, cross(column(work, ARM_A, j), force))
        on_b = onto(axes_b, cross(column(work, ARM_B, j), force))
        for i in range(PAIR_SIZE):
            if grows != 0.0:
                values[slot[i, j]] += grows * dot(column(work, OFFSET, i), force)
        for i in range(4):
            values[slot[3 + i, j]] -= 2.0 * factor * on_a[i]
            values[slot[10 + i, j]] += 2.0 * factor * on_b[i]
    add_bend(values, slot, 3, -factor * size, force, constant(pair, POINT_A))
    add_bend(values, slot, 10, factor * size, force, constant(pair, POINT_B))
    add_lever(values, slot, 3, -2.0 * factor, cross(beta_a, force))
    add_lever(values, slot, 10, 2.0 * factor, cross(beta_b, force))


@inlined
def product_with(work: Any, first: int, x: Any, coord: Any) -> Any:
    """The three rows from `first` times x at the local coordinates."""
    a = b = c = 0.0
    for j in range(work.shape[1]):
        y = x[coord[j]]
        a += work[first, j] * y
        b += work[first + 1, j] * y
        c += work[first + 2, j] * y
    return a, b, c
