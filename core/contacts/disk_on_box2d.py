"""Disk against a box: the gap is the distance of the disk's centre from the box's outline, less its radius.

Beside a face the normal is the face's, about a corner it goes round; inside the nearest face counts. A point (radius 0)
on a box is the corner of another.
"""

import math
from collections.abc import Sequence
from typing import ClassVar, Literal

from ..elements.formula2d import Frame2D
from ..model.base import Positive
from ..model.markers import Marker2D
from .contact2d import Disk2D
from .disk_contact2d import DiskContact2D
from .pair_table import pair
from .scalar_contact2d import ScalarContact, scalar_contact
from .shape import Shape2D


class Box2D(Shape2D):
    """A rectangle about the marker, its sides along the marker's axes."""

    type: Literal["Box2D"] = "Box2D"
    marker: Marker2D
    """At its centre; the first axis is along its width."""
    width: Positive
    """Along the marker's first axis, m."""
    height: Positive
    """Along its second axis, m."""

    def corners(self, radius: float = 0.0) -> tuple[Disk2D, ...]:
        """Its corners as points, or as disks of this radius (m) that reach both sides."""
        c, s = math.cos(self.marker.angle), math.sin(self.marker.angle)
        x0, y0 = self.marker.point
        found = []
        for x, y in ((0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)):
            u, w = x * (self.width - 2.0 * radius), y * (self.height - 2.0 * radius)
            point = (x0 + c * u - s * w, y0 + s * u + c * w)
            found.append(Disk2D(marker=Marker2D(body=self.marker.body, point=point), radius=radius))
        return tuple(found)

    def outline(self) -> Sequence[tuple[float, float]]:
        """Its corners along the marker's axes, m, for drawings."""
        x, y = 0.5 * self.width, 0.5 * self.height
        return ((-x, -y), (x, -y), (x, y), (-x, y))

    def shortest_side(self) -> float:
        """m."""
        return min(self.width, self.height)


def box_gap(box: Frame2D, centre: Frame2D, half_width: float, half_height: float, radius: float) -> float:
    dx, dy = centre.x - box.x, centre.y - box.y
    x = abs(dx * box.ex + dy * box.ey) - half_width
    y = abs(dy * box.ex - dx * box.ey) - half_height
    if x > 0.0 and y > 0.0:
        return math.sqrt(x * x + y * y) - radius
    if x > y:
        return x - radius
    return y - radius


def box_slide(box: Frame2D, centre: Frame2D, half_width: float, half_height: float, radius: float) -> float:
    """Arc along the outline at the disk's centre, counter-clockwise from the middle of the right face, less what the
    disk has rolled."""
    dx, dy = centre.x - box.x, centre.y - box.y
    x, y = dx * box.ex + dy * box.ey, dy * box.ex - dx * box.ey
    across, up = abs(x) - half_width, abs(y) - half_height
    rolled = radius * (centre.angle - box.angle)
    quarter = 0.5 * math.pi * radius
    if across > 0.0 and up > 0.0:
        # about a corner the arc of the disk's centre is its radius times the angle
        if x > 0.0 and y > 0.0:
            return half_height + radius * math.atan2(up, across) - rolled
        if y > 0.0:
            return half_height + quarter + 2.0 * half_width + radius * math.atan2(across, up) - rolled
        if x < 0.0:
            return 3.0 * half_height + 2.0 * quarter + 2.0 * half_width + radius * math.atan2(up, across) - rolled
        return 3.0 * half_height + 3.0 * quarter + 4.0 * half_width + radius * math.atan2(across, up) - rolled
    if across > up:
        if x > 0.0:
            return y - rolled
        return 2.0 * half_height + 2.0 * quarter + 2.0 * half_width - y - rolled
    if y > 0.0:
        return half_height + quarter + half_width - x - rolled
    return 3.0 * half_height + 3.0 * quarter + 3.0 * half_width + x - rolled


class DiskOnBox2D(DiskContact2D):
    """A disk, or a point, on a box, round its corners too.

    With radius 0 the contact goes round a corner in one instant; a box that others tip over has a small disk there.
    """

    type: Literal["DiskOnBox2D"] = "DiskOnBox2D"
    surface_sign: ClassVar[float] = -1.0
    formula: ClassVar[ScalarContact] = scalar_contact(box_gap, box_slide, convex=True)

    shape: Box2D
    """The box."""

    @property
    def box(self) -> Marker2D:
        """Centre and axes of the box."""
        return self.shape.marker

    @property
    def half_width(self) -> float:
        """m."""
        return 0.5 * self.shape.width

    @property
    def half_height(self) -> float:
        """m."""
        return 0.5 * self.shape.height

    def lengths(self) -> Sequence[float]:
        return self.disk.radius, self.half_width, self.half_height

    def slide_period(self) -> float:
        return 2.0 * (self.shape.width + self.shape.height) + 2.0 * math.pi * self.disk.radius

    def extent(self) -> float:
        return min(self.shape.width, self.shape.height) + 2.0 * self.disk.radius


pair(DiskOnBox2D, shape=Box2D, disk=Disk2D)
