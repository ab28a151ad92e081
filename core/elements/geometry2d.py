"""Scalar functions of two planar markers, with gradient and Hessian in (x_a, y_a, theta_a, x_b, y_b, theta_b).

Used by the prismatic joint, the distance joint and the gap functions. rho = R(theta) u is a marker's offset,
rho' = J rho with J = [[0, -1], [1, 0]], rho'' = -rho.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.kernels import RESIDUAL, line_of
from ..compiled.packed import curvature
from ..compiled.views import imat, ivec, vec

HESSIAN_PAIRS = np.array([(i, j) for i in range(6) for j in range(i, 6)], dtype=np.int64)
"""Upper triangle in the order of the Hessian tuples returned here."""

FULL_PATTERN: Sequence[tuple[int, int]] = tuple((i, j) for i in range(6) for j in range(6))
ROW_PATTERN: Sequence[tuple[int, int]] = tuple((0, j) for j in range(6))


def place(point: tuple[float, float], body: Sequence[float]) -> tuple[float, float]:
    """Where a marker's `point` is when its body is at (x, y, angle), m."""
    x, y, angle = body
    c, s = math.cos(angle), math.sin(angle)
    return x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]


@inlined
def arms(q: Any, coord: Any, ux: float, uy: float, wx: float, wy: float) -> Any:
    """The offsets u on body a and w on body b in the directions of space: (a_x, a_y, b_x, b_y)."""
    ta, tb = q[coord[2]], q[coord[5]]
    ca, sa = math.cos(ta), math.sin(ta)
    ax, ay = ca * ux - sa * uy, sa * ux + ca * uy
    cb, sb = math.cos(tb), math.sin(tb)
    bx, by = cb * wx - sb * wy, sb * wx + cb * wy
    return ax, ay, bx, by


@internal
def _from_line(q: Any, coord: Any, ux: float, uy: float, wx: float, wy: float) -> Any:
    """For a line through point a (offset u) and a point b (offset w): (r_b + rho_b - r_a, rho_a, rho_b)."""
    ax, ay, bx, by = arms(q, coord, ux, uy, wx, wy)
    return q[coord[3]] + bx - q[coord[0]], q[coord[4]] + by - q[coord[1]], ax, ay, bx, by


@internal
def _height(nx: float, ny: float, ex: float, ey: float, ax: float, ay: float, bx: float, by: float) -> Any:
    """(g, gradient(6), Hessian(21)) of the height along the direction n, which turns with body a."""
    # e = r_b + rho_b - r_a: n . rho_a does not depend on theta_a
    g = nx * (ex - ax) + ny * (ey - ay)
    mx, my = -ny, nx  # n' = J n
    gradient = (-nx, -ny, mx * ex + my * ey, nx, ny, -nx * by + ny * bx)
    z = 0.0
    hessian = (
        z, z, -mx, z, z, z,
        z, -my, z, z, z,
        -(nx * ex + ny * ey), mx, my, -mx * by + my * bx,
        z, z, z,
        z, z,
        -(nx * bx + ny * by),
    )  # fmt: skip
    return g, gradient, hessian


@internal
def height_over_line(q: Any, coord: Any, ux: float, uy: float, wx: float, wy: float, angle: float) -> Any:
    """Height of point b (offset w) over the line through point a (offset u) with normal at `angle` in a's frame.

    Returns (g, gradient(6), Hessian(21)), lengths in m.
    """
    ex, ey, ax, ay, bx, by = _from_line(q, coord, ux, uy, wx, wy)
    turned = q[coord[2]] + angle
    return _height(math.cos(turned), math.sin(turned), ex, ey, ax, ay, bx, by)


@internal
def height_and_way(q: Any, coord: Any, ux: float, uy: float, wx: float, wy: float, angle: float) -> Any:
    """`height_over_line`, and the same along the line, a quarter turn clockwise from the normal: six values."""
    ex, ey, ax, ay, bx, by = _from_line(q, coord, ux, uy, wx, wy)
    turned = q[coord[2]] + angle
    nx, ny = math.cos(turned), math.sin(turned)
    g, gradient, hessian = _height(nx, ny, ex, ey, ax, ay, bx, by)
    s, along_gradient, along_hessian = _height(ny, -nx, ex, ey, ax, ay, bx, by)
    return g, gradient, hessian, s, along_gradient, along_hessian


@internal
def half_square_distance(q: Any, coord: Any, ux: float, uy: float, wx: float, wy: float) -> Any:
    """Half the squared distance of points a (offset u) and b (offset w), with gradient(6) and Hessian(21)."""
    ax, ay, bx, by = arms(q, coord, ux, uy, wx, wy)
    dx = q[coord[3]] + bx - q[coord[0]] - ax
    dy = q[coord[4]] + by - q[coord[1]] - ay
    gradient = (-dx, -dy, dx * ay - dy * ax, dx, dy, -dx * by + dy * bx)
    z = 0.0
    hessian = (
        1.0, z, -ay, -1.0, z, by,
        1.0, ax, z, -1.0, -bx,
        ax * ax + ay * ay + dx * ax + dy * ay, ay, -ax, -(ax * bx + ay * by),
        1.0, z, -by,
        1.0, bx,
        bx * bx + by * by - dx * bx - dy * by,
    )  # fmt: skip
    return 0.5 * (dx * dx + dy * dy), gradient, hessian


@internal
def distance(q: Any, coord: Any, ux: float, uy: float, wx: float, wy: float) -> Any:
    """Distance of points a (offset u) and b (offset w), with gradient(6) and Hessian(21); 1/0 where they meet."""
    half, gradient, hessian = half_square_distance(q, coord, ux, uy, wx, wy)
    d = math.sqrt(2.0 * half)
    s = 1.0 / d
    g0, g1, g2, g3, g4, g5 = (
        s * gradient[0],
        s * gradient[1],
        s * gradient[2],
        s * gradient[3],
        s * gradient[4],
        s * gradient[5],
    )
    h = hessian
    scaled = (
        s * (h[0] - g0 * g0), s * (h[1] - g0 * g1), s * (h[2] - g0 * g2), s * (h[3] - g0 * g3),
        s * (h[4] - g0 * g4), s * (h[5] - g0 * g5),
        s * (h[6] - g1 * g1), s * (h[7] - g1 * g2), s * (h[8] - g1 * g3), s * (h[9] - g1 * g4),
        s * (h[10] - g1 * g5),
        s * (h[11] - g2 * g2), s * (h[12] - g2 * g3), s * (h[13] - g2 * g4), s * (h[14] - g2 * g5),
        s * (h[15] - g3 * g3), s * (h[16] - g3 * g4), s * (h[17] - g3 * g5),
        s * (h[18] - g4 * g4), s * (h[19] - g4 * g5),
        s * (h[20] - g5 * g5),
    )  # fmt: skip
    return d, (g0, g1, g2, g3, g4, g5), scaled


@internal
def along(gradient: Any, x: Any, coord: Any) -> float:
    """gradient . x at the local coordinates."""
    total = 0.0
    for i in range(len(gradient)):
        total += gradient[i] * x[coord[i]]
    return total


@internal
def add_product(
    values: Any, slot: Any, left: Any, gradient: Any, hessian: Any, v: Any, coord: Any, by_value: float, by_rate: float
) -> None:
    """values[slot[p, j]] += left_p (by_value G + by_rate H v)_j: how a force along `left` changes with the value of the
    function with gradient G and with its rate G . v."""
    for j in range(len(gradient)):
        for p in range(len(left)):
            values[slot[p, j]] += left[p] * by_value * gradient[j]
    i, j = 0, 0
    for k in range(len(hessian)):
        x, y = by_rate * hessian[k] * v[coord[i]], by_rate * hessian[k] * v[coord[j]]
        for p in range(len(left)):
            values[slot[p, j]] += left[p] * x
            if i != j:
                values[slot[p, i]] += left[p] * y
        j += 1
        if j == len(gradient):
            i += 1
            j = i


@internal
def add_hessian(values: Any, slot: Any, gradient: Any, hessian: Any, factor: float) -> None:
    """values[slot[i, j]] += factor H_ij for all pairs of local coordinates."""
    i, j = 0, 0
    for k in range(len(hessian)):
        values[slot[i, j]] += factor * hessian[k]
        if i != j:
            values[slot[j, i]] += factor * hessian[k]
        j += 1
        if j == len(gradient):
            i += 1
            j = i


@internal
def levels(b: Any, e: int, row: int, g: float, gradient: Any, bend: float) -> None:
    """Row `row` of phi, phid and phidd: value, rate and acceleration of `g`; `bend` is v . H v, H its Hessian."""
    coord = imat(b.coord, b.count, b.ncoord)[e]
    vec(b.phi, b.m_extended)[row] = g
    vec(b.phid, b.m_extended)[row] = along(gradient, vec(b.v, b.n_extended), coord)
    vec(b.phidd, b.m_extended)[row] = along(gradient, vec(b.a, b.n_extended), coord) + bend


@internal
def bend_of(b: Any, e: int, hessian: Any) -> float:
    """v . H v at element e of the batch."""
    return curvature(hessian, vec(b.v, b.n_extended), imat(b.coord, b.count, b.ncoord)[e])


@internal
def constrain(b: Any, job: int, e: int, row: int, local_row: int, g: float, gradient: Any, hessian: Any) -> None:
    """Residual or tangent of the scalar constraint `g = 0` of element `e` of the batch."""
    n = b.ncoord
    lam = vec(b.lam, b.m_extended)[row]
    if job == RESIDUAL:
        levels(b, e, row, g, gradient, bend_of(b, e, hessian))
        coord = imat(b.coord, b.count, n)[e]
        r = vec(b.r, b.n_extended)
        for i in range(len(gradient)):
            r[coord[i]] += gradient[i] * lam
    else:
        values = vec(b.values, b.n_values)
        line = line_of(b, e)
        slot = imat(b.slot_s + 8 * line * n * n, n, n)
        add_hessian(values, slot, gradient, hessian, vec(b.coef, 2)[0] * lam)
        slot_j = ivec(b.slot_j + 8 * line * n * b.nrow, n * b.nrow)
        slot_jt = ivec(b.slot_jt + 8 * line * n * b.nrow, n * b.nrow)
        for i in range(len(gradient)):
            values[slot_j[n * local_row + i]] += gradient[i]
            values[slot_jt[n * local_row + i]] += gradient[i]


@internal
def bearing(q: Any, coord: Any, ux: float, uy: float, wx: float, wy: float) -> Any:
    """Direction (rad) of the line from point a (offset u) to point b (offset w), with gradient(6) and Hessian(21).

    With d = r_b - r_a: phi_i = (d x d_i)/D, phi_ij = (d_j x d_i + d x d_ij)/D - phi_i D_j/D, D = d . d.
    """
    ax, ay, bx, by = arms(q, coord, ux, uy, wx, wy)
    dx = q[coord[3]] + bx - q[coord[0]] - ax
    dy = q[coord[4]] + by - q[coord[1]] - ay
    square = dx * dx + dy * dy
    x1, y1 = (-1.0, 0.0, ay, 1.0, 0.0, -by), (0.0, -1.0, -ax, 0.0, 1.0, bx)
    # second derivatives exist only with respect to each angle
    x2, y2 = (0.0, 0.0, ax, 0.0, 0.0, -bx), (0.0, 0.0, ay, 0.0, 0.0, -by)
    gradient = np.empty(6)
    hessian = np.empty(21)
    for i in range(6):
        gradient[i] = (dx * y1[i] - dy * x1[i]) / square
    for k in range(21):
        i, j = HESSIAN_PAIRS[k, 0], HESSIAN_PAIRS[k, 1]
        second = dx * y2[i] - dy * x2[i] if i == j else 0.0
        growth = 2.0 * (dx * x1[j] + dy * y1[j]) / square
        hessian[k] = (x1[j] * y1[i] - y1[j] * x1[i] + second) / square - gradient[i] * growth
    return math.atan2(dy, dx), gradient, hessian
