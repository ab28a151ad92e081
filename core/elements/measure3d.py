"""Scalar measures of two markers in space with gradient and Hessian in the fourteen coordinates of their bodies.

Lengths, places along axes, angles and turns, which springs and gears act on. Parameters of a pair of markers: `rest` of
both bodies, point of a, axes of a (three directions), point of b, axes of b; `columns_of` makes them.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np

from ..compiled.jit import inlined, internal
from ..model.markers import Marker3D
from ..model.rotation3d import bend, constant, dot, four, less, onto, plus, three, times, turned, turning
from .base import ForceElement, Numbering

Measure = Literal["angle", "slide", "distance"]
"""What a force or a motor may act along."""
COLUMNS = 26
"""Parameters of a pair of markers."""
POINT_A, AXES_A, POINT_B, AXES_B = 2, 5, 14, 17
DISTANCE, PLACE, ANGLE = range(3)
"""Kinds of measures: distance of the points, place of b along the z axis of a, angle of b about the z axis of a."""
KINDS: Mapping[Measure, int] = {"angle": ANGLE, "slide": PLACE, "distance": DISTANCE}
WHOLE_TURN = 2.0 * math.pi


class Pair(NamedTuple):
    """A measure of two markers in the tables: its kind, the parameters of the markers and the coordinates."""

    kind: int
    columns: Sequence[float]
    coordinates: Sequence[int]


def columns_of(a: Marker3D, b: Marker3D, numbering: Numbering) -> tuple[float, ...]:
    """The parameters of a pair of markers."""
    rest = (numbering.at_rest(a)[3], numbering.at_rest(b)[3])
    return (*rest, *a.point, *a.axes().T.ravel().tolist(), *b.point, *b.axes().T.ravel().tolist())


def coordinates_of(a: Marker3D, b: Marker3D, numbering: Numbering) -> Sequence[int]:
    """Indices of the fourteen coordinates."""
    return (*numbering.frame(a), *numbering.frame(b))


def pair3d(measure: Measure, a: Marker3D, b: Marker3D, numbering: Numbering) -> Pair:
    """A measure of two markers in space in the tables."""
    return Pair(KINDS[measure], columns_of(a, b, numbering), coordinates_of(a, b, numbering))


class Pair3D(ForceElement):
    """Base of what acts between two markers in space."""

    a: Marker3D
    """The first marker."""
    b: Marker3D
    """The second marker."""

    def markers(self) -> Sequence[Marker3D]:
        return (self.a, self.b)


@inlined
def add_bent(hessian: Any, first: int, factor: float, f: Any, u: Any) -> None:
    """hessian += factor (second derivative of f . (A u)) in the Euler parameters from `first`."""
    bent, k = bend(f, u), 0
    for i in range(4):
        for j in range(i, 4):
            hessian[first + i, first + j] += factor * bent[k]
            if i != j:
                hessian[first + j, first + i] += factor * bent[k]
            k += 1


@inlined
def offset(q: Any, coord: Any, par: Any, p: Any, s: Any) -> Any:
    """d = x_b - x_a, and the columns of A_a u and A_b w by the Euler parameters p and s."""
    of_u, of_w = turning(p, constant(par, POINT_A)), turning(s, constant(par, POINT_B))
    d = less(three(q, coord, 7), three(q, coord, 0))
    return plus(d, less(turned(of_w, s), turned(of_u, p))), of_u, of_w


@internal
def pack(square: Any, packed: Any) -> None:
    """The upper triangle of a symmetric matrix (n, n), row by row, to packed."""
    k = 0
    for i in range(len(square)):
        for j in range(i, len(square)):
            packed[k] = square[i, j]
            k += 1


@internal
def distance_of(q: Any, coord: Any, par: Any, gradient: Any, hessian: Any) -> float:
    """Distance of the points, m; its derivatives go into gradient (14,) and hessian (14, 14)."""
    p, s = four(q, coord, 3, par[0]), four(q, coord, 10, par[1])
    d, of_u, of_w = offset(q, coord, par, p, s)
    length = math.sqrt(dot(d, d))
    n = times(1.0 / length, d)
    zero = (0.0, 0.0, 0.0)
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    columns = (
        less(zero, x), less(zero, y), less(zero, z),
        less(zero, of_u[0]), less(zero, of_u[1]), less(zero, of_u[2]), less(zero, of_u[3]),
        x, y, z, of_w[0], of_w[1], of_w[2], of_w[3],
    )  # fmt: skip
    for i in range(14):
        gradient[i] = dot(columns[i], n)
    for i in range(14):
        for j in range(14):
            hessian[i, j] = (dot(columns[i], columns[j]) - gradient[i] * gradient[j]) / length
    add_bent(hessian, 3, -1.0, n, constant(par, POINT_A))
    add_bent(hessian, 10, 1.0, n, constant(par, POINT_B))
    return length


@internal
def place_of(q: Any, coord: Any, par: Any, axis: int, gradient: Any, hessian: Any) -> float:
    """Place of the point of b along an axis of a, from the point of a, m."""
    p, s = four(q, coord, 3, par[0]), four(q, coord, 10, par[1])
    d, of_u, of_w = offset(q, coord, par, p, s)
    n = constant(par, AXES_A + 3 * axis)
    of_n = turning(p, n)
    a = turned(of_n, p)
    by_n, by_u, by_w = onto(of_n, d), onto(of_u, a), onto(of_w, a)
    hessian[:, :] = 0.0
    for i in range(3):
        gradient[i], gradient[7 + i] = -a[i], a[i]
    for j in range(4):
        gradient[3 + j], gradient[10 + j] = by_n[j] - by_u[j], by_w[j]
        for i in range(3):
            hessian[i, 3 + j] = hessian[3 + j, i] = -of_n[j][i]
            hessian[7 + i, 3 + j] = hessian[3 + j, 7 + i] = of_n[j][i]
        for i in range(4):
            hessian[3 + i, 3 + j] = -dot(of_n[i], of_u[j]) - dot(of_n[j], of_u[i])
            hessian[3 + i, 10 + j] = hessian[10 + j, 3 + i] = dot(of_n[i], of_w[j])
    add_bent(hessian, 3, 1.0, d, n)
    add_bent(hessian, 3, -1.0, a, constant(par, POINT_A))
    add_bent(hessian, 10, 1.0, a, constant(par, POINT_B))
    return dot(a, d)


@internal
def angle_of(q: Any, coord: Any, par: Any, about: float, gradient: Any, hessian: Any) -> float:
    """Angle of the x axis of b about the z axis of a, rad, from the x axis of a: of those that differ by whole turns
    the one nearest to `about`."""
    p, s = four(q, coord, 3, par[0]), four(q, coord, 10, par[1])
    u, v, w = constant(par, AXES_A), constant(par, AXES_A + 3), constant(par, AXES_B)
    of_u, of_v, of_w = turning(p, u), turning(p, v), turning(s, w)
    ax, ay, bx = turned(of_u, p), turned(of_v, p), turned(of_w, s)
    x, y = dot(ax, bx), dot(ay, bx)
    square = x * x + y * y
    along_x, along_y = x / square, y / square
    hessian[:, :] = 0.0
    gradient[0] = gradient[1] = gradient[2] = gradient[7] = gradient[8] = gradient[9] = 0.0
    x_a, y_a, x_b, y_b = onto(of_u, bx), onto(of_v, bx), onto(of_w, ax), onto(of_w, ay)
    of_x = (0.0, 0.0, 0.0, *x_a, 0.0, 0.0, 0.0, *x_b)
    of_y = (0.0, 0.0, 0.0, *y_a, 0.0, 0.0, 0.0, *y_b)
    # with angle = atan2(y, x): angle_i = (x y_i - y x_i)/(x^2 + y^2), and the radius' growth is (x x_i + y y_i)/(...)
    for i in range(14):
        gradient[i] = along_x * of_y[i] - along_y * of_x[i]
    for i in range(14):
        growth = along_x * of_x[i] + along_y * of_y[i]
        for j in range(14):
            hessian[i, j] -= growth * gradient[j]
            hessian[j, i] -= growth * gradient[j]
    for i in range(4):
        for j in range(4):
            mixed = along_x * dot(of_v[i], of_w[j]) - along_y * dot(of_u[i], of_w[j])
            hessian[3 + i, 10 + j] += mixed
            hessian[10 + j, 3 + i] += mixed
    add_bent(hessian, 3, along_x, bx, v)
    add_bent(hessian, 3, -along_y, bx, u)
    add_bent(hessian, 10, along_x, ay, w)
    add_bent(hessian, 10, -along_y, ax, w)
    angle = math.atan2(y, x)
    return angle + WHOLE_TURN * np.round((about - angle) / WHOLE_TURN)


@internal
def measure(kind: int, q: Any, coord: Any, par: Any, about: float, gradient: Any, hessian: Any) -> float:
    """The measure of this kind, with its derivatives."""
    if kind == DISTANCE:
        return distance_of(q, coord, par, gradient, hessian)
    if kind == PLACE:
        return place_of(q, coord, par, 2, gradient, hessian)
    return angle_of(q, coord, par, about, gradient, hessian)
