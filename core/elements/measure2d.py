"""Scalar measures of two planar markers: the angle between them, the way along an axis of a, their distance.

Parameters of a pair of markers: point and angle of a, point and angle of b. Coordinates: the six of both bodies; of an
angle, which depends on no other, also the two angles alone.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from ..compiled.jit import inlined, internal
from ..model.markers import Marker2D
from .base import Numbering, PairElement2D
from .geometry2d import distance, height_over_line, place
from .measure3d import ANGLE, Measure, Pair

PLANAR_ANGLE, PLANAR_SLIDE, PLANAR_DISTANCE = range(ANGLE + 1, ANGLE + 4)
"""Kinds of measures, behind those of space."""
KINDS: Mapping[Measure, int] = {"angle": PLANAR_ANGLE, "slide": PLANAR_SLIDE, "distance": PLANAR_DISTANCE}


@inlined
def two_points(kind: int, q: Any, coord: Any, par: Any) -> Any:
    """(value, gradient (6), upper triangle of the Hessian (21)) of PLANAR_SLIDE or PLANAR_DISTANCE, in m."""
    if kind == PLANAR_SLIDE:
        return height_over_line(q, coord, par[0], par[1], par[3], par[4], par[2])
    return distance(q, coord, par[0], par[1], par[3], par[4])


@internal
def measure2d(kind: int, q: Any, coord: Any, par: Any, gradient: Any, hessian: Any, bent: bool) -> float:
    """The measure of this kind, rad or m; its derivatives go into gradient (n,) and, if `bent`, hessian (n, n)."""
    if kind == PLANAR_ANGLE:
        b = len(gradient) - 1
        a = b // 2
        gradient[:] = 0.0
        gradient[a], gradient[b] = -1.0, 1.0
        if bent:
            hessian[:, :] = 0.0
        return q[coord[b]] + par[5] - (q[coord[a]] + par[2])
    x, first, second = two_points(kind, q, coord, par)
    for i in range(6):
        gradient[i] = first[i]
    if bent:
        k = 0
        for i in range(6):
            for j in range(i, 6):
                hessian[i, j] = hessian[j, i] = second[k]
                k += 1
    return x


def width2d(measure: Measure) -> int:
    """Number of coordinates that a measure depends on."""
    return 2 if measure == "angle" else 6


def pair2d(measure: Measure, a: Marker2D, b: Marker2D, numbering: Numbering, width: int | None = None) -> Pair:
    """A measure of two planar markers in the tables, with as many coordinates as it depends on, or all six."""
    of_a, of_b = numbering.frame(a), numbering.frame(b)
    alone = (width or width2d(measure)) == 2
    coordinates = (of_a[2], of_b[2]) if alone else (*of_a, *of_b)
    return Pair(KINDS[measure], (*a.point, a.angle, *b.point, b.angle), coordinates)


def ends2d(a: Marker2D, b: Marker2D, numbering: Numbering) -> Sequence[tuple[float, ...]]:
    """Where the points of both are at the start, m."""
    return [place(marker.point, numbering.initial(marker.body)) for marker in (a, b)]


class MeasuredElement2D(PairElement2D):
    """Base of elements between markers `a` and `b` that act on a `measure` of them."""

    measure: Measure = "angle"
    """What it moves: the angle of a joint, the slide along a's first axis, or the distance of the markers."""
