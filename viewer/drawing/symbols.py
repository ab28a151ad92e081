"""Symbols of mechanics, made of shapes: hatched walls, springs, arrows, bearings. `unit` is a length in m."""

import math

from .shapes import GROUND, INK, PORT, SPRING, Circle, Drawing, Path, Point, between, moved, turned


def wall(drawing: Drawing, start: Point, end: Point, colour: str = GROUND, unit: float | None = None) -> None:
    """A line from `start` to `end`, hatched on its right-hand side."""
    direction, length = between(start, end)
    unit = unit or 0.035 * drawing.size
    slant = turned(direction, -0.75 * math.pi)
    for k in range(1, max(2, round(length / unit)) + 1):
        foot = moved(start, direction, min(length, k * length / max(2, round(length / unit))))
        drawing.behind.append(Path((foot, moved(foot, slant, unit)), colour, width=0.25))
    drawing.shapes.append(Path((start, end), colour, width=0.6))


def bearing(drawing: Drawing, at: Point) -> None:
    """A triangle on hatched ground under a joint."""
    u = 0.04 * drawing.size
    (x, y), foot = at, 1.6 * u
    drawing.shapes.append(Path(((x, y), (x - u, y - foot), (x + u, y - foot)), GROUND, "white", 0.4, closed=True))
    wall(drawing, (x - 1.5 * u, y - foot), (x + 1.5 * u, y - foot), unit=0.5 * u)


def pin(drawing: Drawing, at: Point) -> None:
    """A revolute joint."""
    drawing.shapes.append(Circle(at, 0.014 * drawing.size, INK, "white", 0.45))


def spring(drawing: Drawing, a: Point, b: Point, damped: bool, stiff: bool = True) -> None:
    """A zigzag from `a` to `b`, a dashpot, or both side by side."""
    direction, length = between(a, b)
    normal, u = turned(direction, 0.5 * math.pi), min(0.02 * drawing.size, 0.2 * length)
    lanes = [(0.0, stiff)] if stiff != damped else [(1.3 * u, True), (-1.3 * u, False)]
    for offset, zigzag in lanes:
        start, end = moved(a, normal, offset), moved(b, normal, offset)
        if offset:
            drawing.shapes += [Path((a, start), SPRING, width=0.4), Path((b, end), SPRING, width=0.4)]
        first, last = moved(start, direction, 0.2 * length), moved(start, direction, 0.8 * length)
        if zigzag:
            turns = max(4, min(12, round(0.6 * length / u)))
            teeth = [
                moved(moved(first, direction, 0.6 * length * (k + 0.5) / turns), normal, u * (1 if k % 2 else -1))
                for k in range(turns)
            ]
            drawing.shapes.append(Path((start, first, *teeth, last, end), SPRING, width=0.4))
        else:
            middle = moved(start, direction, 0.5 * length)
            back, front = moved(middle, direction, -u), moved(middle, direction, u)
            cup = (moved(front, normal, u), moved(back, normal, u), moved(back, normal, -u), moved(front, normal, -u))
            drawing.shapes += [
                Path((start, back), SPRING, width=0.4),
                Path(cup, SPRING, width=0.4),
                Path((moved(middle, normal, 0.7 * u), moved(middle, normal, -0.7 * u)), SPRING, width=0.4),
                Path((middle, end), SPRING, width=0.4),
            ]


def arrow(drawing: Drawing, tip: Point, direction: Point, colour: str = PORT, length: float | None = None) -> Point:
    """An arrow that ends at `tip`; gives where it begins."""
    length = length or 0.14 * drawing.size
    head = 0.3 * length
    start, neck = moved(tip, direction, -length), moved(tip, direction, -head)
    drawing.shapes.append(Path((start, neck), colour, width=0.7))
    _head(drawing, neck, direction, head, colour)
    return start


def round_arrow(drawing: Drawing, centre: Point, colour: str = PORT) -> Point:
    """A counter-clockwise arrow about `centre`; gives a place for its name."""
    r = 0.075 * drawing.size
    angles = [math.radians(-50.0 + 10.0 * k) for k in range(23)]
    arc = [(centre[0] + r * math.cos(w), centre[1] + r * math.sin(w)) for w in angles]
    drawing.shapes.append(Path(arc, colour, width=0.7))
    _head(drawing, arc[-1], turned((0.0, 1.0), angles[-1] + 0.25), 0.042 * drawing.size, colour)
    return centre[0] + 0.8 * r, centre[1] + 0.8 * r


def _head(drawing: Drawing, neck: Point, direction: Point, length: float, colour: str) -> None:
    """The head of an arrow, from `neck` on."""
    side = turned(direction, 0.5 * math.pi)
    corners = (moved(neck, direction, length), moved(neck, side, 0.4 * length), moved(neck, side, -0.4 * length))
    drawing.shapes.append(Path(corners, colour, colour, 0.2, closed=True))


def centre_of_mass(drawing: Drawing, at: Point) -> None:
    """A circle with two quarters filled."""
    r = 0.013 * drawing.size
    drawing.shapes.append(Circle(at, r, INK, "white", 0.3))
    for first in (0.0, math.pi):
        arc = [moved(at, turned((1.0, 0.0), first + 0.1 * math.pi * k / 2.0), r) for k in range(11)]
        drawing.shapes.append(Path((at, *arc), None, INK, closed=True))
