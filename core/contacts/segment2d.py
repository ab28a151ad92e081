"""Contact of a disk with a finite segment: a thin plate, or a ledge, with its two ends as corners.

The gap is the distance of the disk's centre from the nearest point of the segment, less R, the radius of the disk and
half the segment's thickness. Its gradient is continuous where that point passes an end, its Hessian is not: the
centre then goes round the end on an arc of curvature 1/R.
"""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from ..compiled.jit import internal
from ..compiled.views import imat, mat, to_fixed_tuple, vec
from ..elements.base import Numbering, Row
from ..elements.geometry2d import arms, bearing, distance, height_over_line
from ..model.base import NonNegative, Positive
from ..model.markers import Marker2D
from .bristle2d import act_bristles
from .contact2d import Contact2D, Disk2D
from .geometry_kinds import SEGMENT, are
from .normal2d import act, is_sleeping
from .pair_table import no_pair, pair
from .polygon2d import ANGULAR
from .shape import Shape2D
from .sliding2d import act_sliding

QUARTER_TURN = 0.5 * np.pi
LENGTH = 16
"""Column of the segment's length in the table of parameters, after those that every contact has."""


@internal
def _seen_from_segment(q: Any, coord: Any, par: Any) -> Any:
    """Where the disk's centre is: along the segment from its start, and over it, m."""
    ax, ay, bx, by = arms(q, coord, par[0], par[1], par[2], par[3])
    dx, dy = q[coord[3]] + bx - q[coord[0]] - ax, q[coord[4]] + by - q[coord[1]] - ay
    angle = q[coord[2]] + par[4]
    nx, ny = math.cos(angle), math.sin(angle)
    return ny * dx - nx * dy, nx * dx + ny * dy


@internal
def _end(par: Any) -> Any:
    """The far end in the frame of the segment's body."""
    return par[0] + par[LENGTH] * math.sin(par[4]), par[1] - par[LENGTH] * math.cos(par[4])


@internal
def gap_to_segment(q: Any, coord: Any, par: Any) -> Any:
    """(g, gradient(6), Hessian(21)) of one row of coordinates and parameters."""
    x, height = _seen_from_segment(q, coord, par)
    if x < 0.0:
        g, gradient, hessian = distance(q, coord, par[0], par[1], par[2], par[3])
    elif x > par[LENGTH]:
        ex, ey = _end(par)
        g, gradient, hessian = distance(q, coord, ex, ey, par[2], par[3])
    else:
        # on the back the normal points the other way
        angle = par[4] if height >= 0.0 else par[4] + np.pi
        g, gradient, hessian = height_over_line(q, coord, par[0], par[1], par[2], par[3], angle)
    return g - par[5], gradient, hessian


@internal
def slide_on_segment(q: Any, coord: Any, par: Any) -> Any:
    """Sliding distance (s, gradient(6), Hessian(21)): along the front from its start on, then round the end.

    s = sigma - R delta + r (theta_b - theta_a): sigma the arc length on the segment, delta the angle by which the
    normal has turned from the front's, R and r the radii with and without half the thickness. On the back sigma
    counts backwards, so that s jumps by the circumference 2 L + 2 pi R only where one has gone all round.
    """
    x, height = _seen_from_segment(q, coord, par)
    length, both, radius = par[LENGTH], par[5], par[6]
    rolled = radius * (q[coord[5]] - q[coord[2]])
    if 0.0 <= x <= length:
        front = height >= 0.0
        angle = par[4] - QUARTER_TURN if front else par[4] + QUARTER_TURN
        sigma, (t0, t1, t2, t3, t4, t5), hessian = height_over_line(q, coord, par[0], par[1], par[2], par[3], angle)
        gradient = (t0, t1, t2 - radius, t3, t4, t5 + radius)
        start = 0.0 if front else 2.0 * length + np.pi * both
        return start + sigma + rolled, gradient, hessian
    if x < 0.0:
        ex, ey, start, middle = par[0], par[1], 0.0, 0.5 * np.pi
    else:
        ex, ey = _end(par)
        start, middle = length, -0.5 * np.pi
    phi, turn, bend = bearing(q, coord, ex, ey, par[2], par[3])
    turned = phi - q[coord[2]] - par[4]
    # between the front's direction and the back's, on this end's side
    turned -= 2.0 * np.pi * np.rint((turned - middle) / (2.0 * np.pi))
    turn *= -both
    bend *= -both
    turn[2] += both - radius
    turn[5] += radius
    return start - both * turned + rolled, to_fixed_tuple(turn, 6), to_fixed_tuple(bend, 21)


@internal
def disk_on_segment_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, 6), vec(b.q, b.n_extended)
    for e in range(b.count):
        if is_sleeping(b, e):
            continue
        g, gradient, hessian = gap_to_segment(q, coord[e], par[e])
        act(b, job, e, g, gradient, hessian)


@internal
def sliding_disk_on_segment_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    for e in range(b.count):
        if is_sleeping(b, e):
            continue
        g, g_gradient, g_hessian = gap_to_segment(q, coord[e], par[e])
        s, gradient, hessian = slide_on_segment(q, coord[e], par[e])
        period = 2.0 * par[e, LENGTH] + 2.0 * np.pi * par[e, 5]
        act_sliding(b, job, t, e, g, g_gradient, g_hessian, s, gradient, hessian, period)


@internal
def bristle_disk_on_segment_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    for e in range(b.count):
        g, g_gradient, g_hessian = gap_to_segment(q, coord[e], par[e])
        _, gradient, hessian = slide_on_segment(q, coord[e], par[e])
        act_bristles(b, job, t, e, g, g_gradient, g_hessian, gradient, hessian)


class Segment2D(Shape2D):
    """A segment from the marker along its first axis, with round ends. Both sides can be touched."""

    type: Literal["Segment2D"] = "Segment2D"
    marker: Marker2D = Marker2D()
    """Its start."""
    length: Positive
    """m."""
    radius: NonNegative = 0.0
    """Half its thickness, m."""


class DiskOnSegment2D(Contact2D):
    """Contact of a disk (or point) with a segment: gap = distance from its nearest point - radii.

    Raises
    ------
    ModelError : for a point on a segment without thickness, which has no inside.
    """

    type: Literal["DiskOnSegment2D"] = "DiskOnSegment2D"
    touch: ClassVar[str] = "segment"
    kernel: ClassVar[Any] = disk_on_segment_kernel
    sliding_kernel: ClassVar[Any] = sliding_disk_on_segment_kernel
    bristle_kernel: ClassVar[Any] = bristle_disk_on_segment_kernel

    segment: Segment2D
    """The segment."""
    disk: Disk2D
    """The disk."""

    @model_validator(mode="after")
    def _check_radius(self) -> "DiskOnSegment2D":
        refuse_point_on_line(self.name, "segment", self.disk.radius, self.segment.radius)
        return self

    def extent(self) -> float:
        return self.disk.radius + self.segment.radius

    def row(self, numbering: Numbering) -> Row:
        marker, radius = self.segment.marker, self.disk.radius
        angle = marker.angle + 0.5 * math.pi
        row = self._row(numbering, marker, self.disk.marker, angle, self.extent(), radius)
        return Row((*row.parameters, self.segment.length), row.coordinates, row.extra)

    def markers(self) -> Sequence[Marker2D]:
        return (self.segment.marker, self.disk.marker)


def refuse_point_on_line(name: str, line: str, disk_radius: float, line_radius: float) -> None:
    """Raise ValueError if a contact's disk and line both have no thickness."""
    if disk_radius + line_radius <= 0.0:
        raise ValueError(
            f"contact '{name}': the disk's radius and the {line}'s are both 0, and a point would pass a line without "
            f"thickness unseen: give one of them a radius (the {line}'s is half its thickness)"
        )


are(SEGMENT, bristle_disk_on_segment_kernel, disk_on_segment_kernel, sliding_disk_on_segment_kernel)
pair(DiskOnSegment2D, segment=Segment2D, disk=Disk2D)
no_pair(ANGULAR, Segment2D, "make the segment a thin box, or let them pass through each other (pass_through)")
