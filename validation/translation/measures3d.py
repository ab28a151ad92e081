"""Angles, places along an axis and distances between two markers in space, as functions of exudyn's coordinates, with
what their rates are of the coordinates' rates.

Written from the geometry, not from the solver's formulas: a cross-check must not share what it checks.
"""

import math
from collections.abc import Callable, Sequence

from ...core.model.markers import Marker3D
from .measures import Scalar
from .registry import Build
from .space_contacts import End, cross, dot, plus, vector
from .user_gaps import Nodes, Numbers

Measure3D = Callable[[Build, Marker3D, Marker3D, Nodes], Scalar]


def slide(build: Build, a: Marker3D, b: Marker3D, nodes: Nodes) -> Scalar:
    """Place of b along the z axis of a, m."""
    first, second, axis = End(build, a, nodes), End(build, b, nodes), vector(a.axes()[:, 2])

    def value(x: Numbers) -> tuple[float, list[float]]:
        z, place, row = first.turned(x, axis), second.place(x), [0.0] * len(x)
        # matter of a at the place of b says how the axis turns
        second.add(row, x, z, place, 1.0)
        first.add(row, x, z, place, -1.0)
        return dot(z, plus(place, first.place(x), -1.0)), row

    return value


def distance(build: Build, a: Marker3D, b: Marker3D, nodes: Nodes) -> Scalar:
    """Of the points, m."""
    first, second = End(build, a, nodes), End(build, b, nodes)

    def value(x: Numbers) -> tuple[float, list[float]]:
        of_a, of_b, row = first.place(x), second.place(x), [0.0] * len(x)
        way = plus(of_b, of_a, -1.0)
        length = math.hypot(*way)
        ahead = way[0] / length, way[1] / length, way[2] / length
        second.add(row, x, ahead, of_b, 1.0)
        first.add(row, x, ahead, of_a, -1.0)
        return length, row

    return value


def angle(build: Build, a: Marker3D, b: Marker3D, nodes: Nodes) -> Scalar:
    """Of the x axis of b in the xy plane of a, rad, within half a turn of zero at the first evaluation."""
    return angle_from(build, a, b, nodes, 0.0)


def angle_from(build: Build, a: Marker3D, b: Marker3D, nodes: Nodes, start: float) -> Scalar:
    """The same, within half a turn of `start` at the first evaluation. Turns are counted from one to the next."""
    first, second = End(build, a, nodes), End(build, b, nodes)
    x_a, y_a = vector(a.axes()[:, 0]), vector(a.axes()[:, 1])
    x_b, last = vector(b.axes()[:, 0]), start

    def value(x: Numbers) -> tuple[float, list[float]]:
        nonlocal last
        along, across, way = first.turned(x, x_a), first.turned(x, y_a), second.turned(x, x_b)
        c, s, row = dot(along, way), dot(across, way), [0.0] * len(x)
        last += math.remainder(math.atan2(s, c) - last, 2.0 * math.pi)
        # c' and s' are (w_b - w_a) . (way x along), (way x across)
        square = c * c + s * s
        forward = plus(plus((0.0, 0.0, 0.0), across, c / square), along, -s / square)
        axis = cross(way, forward)
        second.add_turn(row, x, axis, 1.0)
        first.add_turn(row, x, axis, -1.0)
        return last, row

    return value


def twist(build: Build, a: Marker3D, b: Marker3D, nodes: Nodes) -> Scalar:
    """x_a . y_b - y_a . x_b: zero where b is bent from a about an axis across z, without turning about z."""
    first, second = End(build, a, nodes), End(build, b, nodes)
    (x_a, y_a), (x_b, y_b) = ([vector(axis) for axis in marker.axes().T[:2]] for marker in (a, b))

    def value(x: Numbers) -> tuple[float, list[float]]:
        along, across = first.turned(x, x_a), first.turned(x, y_a)
        way, side, row = second.turned(x, x_b), second.turned(x, y_b), [0.0] * len(x)
        axis = plus(cross(side, along), cross(way, across), -1.0)
        second.add_turn(row, x, axis, 1.0)
        first.add_turn(row, x, axis, -1.0)
        return dot(along, side) - dot(across, way), row

    return value


def weighted(terms: Sequence[tuple[float, Scalar]]) -> Scalar:
    """Sum of measures times factors."""

    def value(x: Numbers) -> tuple[float, list[float]]:
        total, row = 0.0, [0.0] * len(x)
        for factor, of in terms:
            found, own = of(x)
            total += factor * found
            row = [r + factor * o for r, o in zip(row, own, strict=True)]
        return total, row

    return value


MEASURES3D: dict[str, Measure3D] = {"angle": angle, "slide": slide, "distance": distance}
