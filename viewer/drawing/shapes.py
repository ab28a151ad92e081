"""What a drawing is made of: paths, circles and labels in the model's own coordinates (m, y upwards)."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

Point = tuple[float, float]

INK, STEEL, FLEX, GROUND, TOUCH, SPRING, PORT = (
    "#1f3a5f", "#c5d6e8", "#1f7a5c", "#6b7280", "#b3402a", "#6d4aa3", "#c96a00",
)  # fmt: skip
"""Colours: outlines and filling of rigid bodies, flexible bodies, the ground, contacts, springs, inputs and loads."""


@dataclass(frozen=True)
class Path:
    """A line through `points`; widths are in hundredths of the drawing's size."""

    points: Sequence[Point]
    stroke: str | None = INK
    fill: str | None = None
    width: float = 0.5
    closed: bool = False
    dashed: bool = False


@dataclass(frozen=True)
class Circle:
    """A circle, `radius` in m."""

    centre: Point
    radius: float
    stroke: str | None = INK
    fill: str | None = None
    width: float = 0.5


@dataclass(frozen=True)
class Label:
    """A text beside the point `at`: `side` is "right", "left", "above" or "below". Icons have none."""

    at: Point
    text: str
    colour: str = INK
    side: str = "right"


@dataclass
class Drawing:
    """Shapes, and the `size` (m) that symbols are drawn for."""

    size: float
    shapes: list[Path | Circle | Label] = field(default_factory=list)
    behind: list[Path | Circle] = field(default_factory=list)
    """What is under all others."""

    def box(self) -> tuple[Point, Point]:
        """Lower left and upper right corner of everything but labels, with a margin, m."""
        points: list[Point] = []
        for shape in (*self.behind, *self.shapes):
            if isinstance(shape, Path):
                points += shape.points
            elif isinstance(shape, Circle):
                (x, y), r = shape.centre, shape.radius
                points += [(x - r, y - r), (x + r, y + r)]
        (x0, y0), (x1, y1) = bounds(points)
        margin = 0.05 * self.size
        # a drawing along one line gets some height, or width
        wide, high = max(0.5 * self.size - (x1 - x0), 0.0) / 2, max(0.3 * self.size - (y1 - y0), 0.0) / 2
        return (x0 - margin - wide, y0 - margin - high), (x1 + margin + wide, y1 + margin + high)


def bounds(points: Iterable[Point]) -> tuple[Point, Point]:
    """Lower left and upper right corner of some points; (0, 0) twice if there are none."""
    found = list(points) or [(0.0, 0.0)]
    xs, ys = [x for x, _ in found], [y for _, y in found]
    return (min(xs), min(ys)), (max(xs), max(ys))


def turned(vector: Point, angle: float) -> Point:
    """`vector` turned by `angle`, rad."""
    c, s = math.cos(angle), math.sin(angle)
    return c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]


def moved(point: Point, direction: Point, distance: float) -> Point:
    """`point` moved along the unit vector `direction`."""
    return point[0] + distance * direction[0], point[1] + distance * direction[1]


def between(a: Point, b: Point) -> tuple[Point, float]:
    """Unit vector from `a` to `b` (along x if they coincide), and their distance."""
    length = math.dist(a, b)
    return (((b[0] - a[0]) / length, (b[1] - a[1]) / length) if length else (1.0, 0.0)), length


def hull(points: Iterable[Point]) -> list[Point]:
    """Corners of the convex hull, counter-clockwise (Andrew's monotone chain); two points for a line."""
    ordered = sorted(set(points))
    if len(ordered) < 3:
        return ordered

    def half(run: Iterable[Point]) -> list[Point]:
        chain: list[Point] = []
        for p in run:
            while len(chain) > 1 and _cross(chain[-2], chain[-1], p) <= 0.0:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return half(ordered) + half(reversed(ordered))


def _cross(o: Point, a: Point, b: Point) -> float:
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
