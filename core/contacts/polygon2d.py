"""Disk against a convex polygon: the gap is the distance of the disk's centre from the outline, less its radius.

The side from whose line the centre is farthest says what is nearest: the side itself, or where the centre's foot lies
beyond an end, the corner there. (In the cone of normals of a corner no other line is farther than those of its two
sides.) Inside the same side counts. A point (radius 0) on a polygon is the corner of another.
"""

import math
from collections.abc import Sequence
from functools import partial
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import field_validator

from ..elements.formula2d import Frame2D
from ..model.markers import Marker2D
from .contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from .disk_contact2d import DiskContact2D
from .disk_on_box2d import Box2D, DiskOnBox2D
from .pair_table import Make, pair, touching
from .scalar_contact2d import ScalarContact, scalar_contact
from .shape import Shape2D

ROUND = 1e-3
"""Of the shortest side of both: radius of corners where shapes with corners touch each other. A point that comes along
a side to a corner of the same height would touch neither of the sides that strike."""
MOST_SIDES = 8
"""Of a polygon."""
FEWEST_SIDES = 3
STRAIGHT = 1e-9
"""Sine of the angle at a corner below which it is none."""


class Polygon2D(Shape2D):
    """A convex polygon, its corners given along the marker's axes."""

    type: Literal["Polygon2D"] = "Polygon2D"
    marker: Marker2D
    """Its origin and axes."""
    vertices: tuple[tuple[float, float], ...]
    """Corners one after another, 3 to 8, from the marker's point along its axes, m."""

    @field_validator("vertices")
    @classmethod
    def _convex(cls, vertices: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        if not FEWEST_SIDES <= len(vertices) <= MOST_SIDES:
            raise ValueError(f"a polygon has {FEWEST_SIDES} to {MOST_SIDES} corners, {len(vertices)} were given: make "
                             "a shape with more of two polygons on one body, or of a Line2D")  # fmt: skip
        sides = np.roll(vertices, -1, axis=0) - np.array(vertices)
        size = np.hypot(*sides.T)
        if not np.all(size > 0.0):
            raise ValueError(f"corners {int(np.argmin(size)) + 1} and the next are the same point: leave one out")
        units = sides / size[:, None]
        after = np.roll(units, -1, axis=0)
        turns = units[:, 0] * after[:, 1] - units[:, 1] * after[:, 0]
        whole = float(np.sum(np.arctan2(turns, np.sum(units * after, axis=1)))) / (2.0 * math.pi)
        if not (np.all(turns > STRAIGHT) or np.all(turns < -STRAIGHT)) or abs(abs(whole) - 1.0) > STRAIGHT:
            worst = int(np.argmin(turns * np.sign(whole or 1.0)))
            corner = vertices[(worst + 1) % len(vertices)]
            raise ValueError(f"the polygon is not convex at {corner}: give its corners one after another, none of them "
                             "straight or inwards, or make it of several convex ones")  # fmt: skip
        return vertices if whole > 0.0 else vertices[::-1]

    def corners(self, radius: float = 0.0) -> tuple[Disk2D, ...]:
        """Its corners as points, or as disks of this radius (m) that reach both sides."""
        c, s = math.cos(self.marker.angle), math.sin(self.marker.angle)
        x0, y0 = self.marker.point
        places = [(x0 + c * x - s * y, y0 + s * x + c * y) for x, y in self._within(radius)]
        return tuple(Disk2D(marker=Marker2D(body=self.marker.body, point=p), radius=radius) for p in places)

    def _within(self, radius: float) -> list[tuple[float, float]]:
        """Places as far from both sides at each corner, m."""
        found, sides = [], len(self.vertices)
        for k, (x, y) in enumerate(self.vertices):
            (ux, uy), (wx, wy) = self.vertices[k - 1], self.vertices[(k + 1) % sides]
            before, after = math.hypot(x - ux, y - uy), math.hypot(wx - x, wy - y)
            # inwards from both sides, which go round counter-clockwise
            a, b = ((uy - y) / before, (x - ux) / before), ((y - wy) / after, (wx - x) / after)
            along = radius / (1.0 + a[0] * b[0] + a[1] * b[1])
            found.append((x + along * (a[0] + b[0]), y + along * (a[1] + b[1])))
        return found

    def outline(self) -> Sequence[tuple[float, float]]:
        """Its corners, for drawings."""
        return self.vertices

    def shortest_side(self) -> float:
        """m."""
        return min(math.dist(a, b) for a, b in zip(self.vertices, self.vertices[1:] + self.vertices[:1], strict=True))

    @property
    def perimeter(self) -> float:
        """m."""
        return sum(math.dist(a, b) for a, b in zip(self.vertices, self.vertices[1:] + self.vertices[:1], strict=True))


def polygon_gap(
    polygon: Frame2D, centre: Frame2D, sides: float, radius: float,
    x0: float, y0: float, x1: float, y1: float, x2: float, y2: float, x3: float, y3: float,
    x4: float, y4: float, x5: float, y5: float, x6: float, y6: float, x7: float, y7: float,
) -> float:  # fmt: skip
    px, py = (x0, x1, x2, x3, x4, x5, x6, x7), (y0, y1, y2, y3, y4, y5, y6, y7)
    dx, dy = centre.x - polygon.x, centre.y - polygon.y
    x, y, n = dx * polygon.ex + dy * polygon.ey, dy * polygon.ex - dx * polygon.ey, int(sides)
    k, length = 0, math.hypot(px[1] - px[0], py[1] - py[0])
    height = ((x - px[0]) * (py[1] - py[0]) - (y - py[0]) * (px[1] - px[0])) / length
    for i in range(1, n):
        j = (i + 1) % n
        other = math.hypot(px[j] - px[i], py[j] - py[i])
        above = ((x - px[i]) * (py[j] - py[i]) - (y - py[i]) * (px[j] - px[i])) / other
        if above > height:
            k, height, length = i, above, other
    j = (k + 1) % n
    along = ((x - px[k]) * (px[j] - px[k]) + (y - py[k]) * (py[j] - py[k])) / length
    if height > 0.0 and along < 0.0:
        return math.sqrt((x - px[k]) * (x - px[k]) + (y - py[k]) * (y - py[k])) - radius
    if height > 0.0 and along > length:
        return math.sqrt((x - px[j]) * (x - px[j]) + (y - py[j]) * (y - py[j])) - radius
    return height - radius


def polygon_slide(
    polygon: Frame2D, centre: Frame2D, sides: float, radius: float,
    x0: float, y0: float, x1: float, y1: float, x2: float, y2: float, x3: float, y3: float,
    x4: float, y4: float, x5: float, y5: float, x6: float, y6: float, x7: float, y7: float,
) -> float:  # fmt: skip
    """Arc along the outline at the disk's centre, counter-clockwise from the first corner, less what the disk has
    rolled."""
    px, py = (x0, x1, x2, x3, x4, x5, x6, x7), (y0, y1, y2, y3, y4, y5, y6, y7)
    dx, dy = centre.x - polygon.x, centre.y - polygon.y
    x, y, n = dx * polygon.ex + dy * polygon.ey, dy * polygon.ex - dx * polygon.ey, int(sides)
    k, length, before, arc, turned = 0, math.hypot(px[1] - px[0], py[1] - py[0]), 0.0, 0.0, 0.0
    height = ((x - px[0]) * (py[1] - py[0]) - (y - py[0]) * (px[1] - px[0])) / length
    passed = length
    ux, uy = (px[1] - px[0]) / length, (py[1] - py[0]) / length
    for i in range(1, n):
        j = (i + 1) % n
        other = math.hypot(px[j] - px[i], py[j] - py[i])
        wx, wy = (px[j] - px[i]) / other, (py[j] - py[i]) / other
        turned += math.atan2(ux * wy - uy * wx, ux * wx + uy * wy)
        ux, uy = wx, wy
        above = (x - px[i]) * wy - (y - py[i]) * wx
        if above > height:
            k, height, length, before, arc = i, above, other, passed, radius * turned
        passed += other
    j = (k + 1) % n
    tx, ty = (px[j] - px[k]) / length, (py[j] - py[k]) / length
    along = (x - px[k]) * tx + (y - py[k]) * ty
    rolled = radius * (centre.angle - polygon.angle)
    if height > 0.0 and along < 0.0:
        return before + arc + radius * math.atan2(along, height) - rolled
    if height > 0.0 and along > length:
        return before + length + arc + radius * math.atan2(along - length, height) - rolled
    return before + along + arc - rolled


class DiskOnPolygon2D(DiskContact2D):
    """A disk, or a point, on a convex polygon, round its corners too.

    With radius 0 the contact goes round a corner in one instant; a polygon that others tip over has small disks there.
    """

    type: Literal["DiskOnPolygon2D"] = "DiskOnPolygon2D"
    surface_sign: ClassVar[float] = -1.0
    formula: ClassVar[ScalarContact] = scalar_contact(polygon_gap, polygon_slide, convex=True)

    shape: Polygon2D
    """The polygon."""

    @property
    def polygon(self) -> Marker2D:
        """Origin and axes of the polygon."""
        return self.shape.marker

    @property
    def sides(self) -> float:
        """How many."""
        return float(len(self.shape.vertices))

    def __getattr__(self, name: str) -> Any:
        """x0, y0 ... y7: corners, m; zero beyond the last one."""
        if len(name) == 2 and name[0] in "xy" and name[1] in "01234567":
            k, vertices = int(name[1]), self.shape.vertices
            return vertices[k]["xy".index(name[0])] if k < len(vertices) else 0.0
        return super().__getattr__(name)  # type: ignore[misc]

    def lengths(self) -> Sequence[float]:
        return self.disk.radius, self.shape.perimeter / self.sides

    def slide_period(self) -> float:
        return self.shape.perimeter + 2.0 * math.pi * self.disk.radius

    def extent(self) -> float:
        return min(math.dist(a, b) for a, b in zip(self.shape.vertices, self.shape.vertices[1:], strict=False))


pair(DiskOnPolygon2D, shape=Polygon2D, disk=Disk2D)
ANGULAR = (Box2D, Polygon2D)
"""What has corners in the plane."""


@touching(HalfPlane2D, ANGULAR)
def _corners_on_plane(plane: HalfPlane2D, shape: Box2D | Polygon2D) -> Sequence[Make]:
    return [partial(DiskOnHalfPlane2D, plane=plane, disk=corner) for corner in shape.corners()]


@touching(ANGULAR, ANGULAR)
def _corners_on_sides(a: Box2D | Polygon2D, b: Box2D | Polygon2D) -> Sequence[Make]:
    """The corners of each on the sides of the other."""
    radius = ROUND * min(a.shortest_side(), b.shortest_side())
    return [*_corners_on(a, b.corners(radius)), *_corners_on(b, a.corners(radius))]


def _corners_on(shape: Box2D | Polygon2D, corners: Sequence[Disk2D]) -> Sequence[Make]:
    if isinstance(shape, Box2D):
        return [partial(DiskOnBox2D, shape=shape, disk=corner) for corner in corners]
    return [partial(DiskOnPolygon2D, shape=shape, disk=corner) for corner in corners]
