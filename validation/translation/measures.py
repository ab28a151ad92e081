"""Angles, ways, distances and arcs between two markers, as functions of exudyn's coordinates, with their gradients.

Written from the geometry, not from the solver's formulas: a cross-check must not share what it checks.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ...core.model.markers import Marker2D
from .registry import Build
from .user_gaps import Add, Nodes, Numbers, point_of

Scalar = Callable[[Numbers], tuple[float, list[float]]]
"""Coordinates (n,) -> (value, its gradient (n,))."""


@dataclass(frozen=True)
class Place:
    """A marker at some coordinates: place, direction of its first axis (counting turns), arm from the body's origin."""

    x: float
    y: float
    angle: float
    arm: tuple[float, float]
    add: Add

    def push(self, gradient: list[float], fx: float, fy: float, torque: float = 0.0) -> None:
        """Add the gradient of fx x + fy y + torque angle, the factors held: the generalised force of that load."""
        self.add(gradient, fx, fy, fy * self.arm[0] - fx * self.arm[1] + torque)


Measure = Callable[[Place, Place, list[float]], float]
"""(a, b, gradient) -> value; its gradient is added to the given one."""


def angle(a: Place, b: Place, gradient: list[float]) -> float:
    """From the first axis of a to that of b, rad."""
    b.push(gradient, 0.0, 0.0, 1.0)
    a.push(gradient, 0.0, 0.0, -1.0)
    return b.angle - a.angle


def slide(a: Place, b: Place, gradient: list[float]) -> float:
    """How far b is along the first axis of a, m: the axis turns with a's body."""
    ex, ey = math.cos(a.angle), math.sin(a.angle)
    dx, dy = b.x - a.x, b.y - a.y
    b.push(gradient, ex, ey)
    a.push(gradient, -ex, -ey, ex * dy - ey * dx)
    return ex * dx + ey * dy


def distance(a: Place, b: Place, gradient: list[float]) -> float:
    """Of the two points, m."""
    dx, dy = b.x - a.x, b.y - a.y
    length = math.hypot(dx, dy)
    ux, uy = (dx / length, dy / length) if length > 0.0 else (1.0, 0.0)
    b.push(gradient, ux, uy)
    a.push(gradient, -ux, -uy)
    return length


def direction(a: Place, b: Place, gradient: list[float], factor: float) -> float:
    """Angle of the line from a to b within one turn, times `factor`."""
    dx, dy = b.x - a.x, b.y - a.y
    share = factor / (dx * dx + dy * dy)
    b.push(gradient, -dy * share, dx * share)
    a.push(gradient, dy * share, -dx * share)
    return factor * math.atan2(dy, dx)


MEASURES: dict[str, Measure] = {"angle": angle, "slide": slide, "distance": distance}


def arcs(radius_a: float, radius_b: float) -> Measure:
    """Arcs that have gone past the line of the centres on two wheels: r_a (theta_a - phi) + r_b (theta_b - phi), m.

    Whole turns of the line are taken off.
    """
    both = radius_a + radius_b

    def passed(a: Place, b: Place, gradient: list[float]) -> float:
        a.push(gradient, 0.0, 0.0, radius_a)
        b.push(gradient, 0.0, 0.0, radius_b)
        turned = radius_a * a.angle + radius_b * b.angle
        return turned + direction(a, b, gradient, -both) if both else turned

    return passed


def rolling(radius: float) -> Measure:
    """Way of a wheel a along the first axis of a rack b, and the arc that it has turned on it, m."""

    def rolled(a: Place, b: Place, gradient: list[float]) -> float:
        a.push(gradient, 0.0, 0.0, radius)
        b.push(gradient, 0.0, 0.0, -radius)
        return slide(b, a, gradient) + radius * (a.angle - b.angle)

    return rolled


def scalar(build: Build, a: Marker2D, b: Marker2D, measure: Measure, nodes: Nodes) -> Scalar:
    """The measure from marker a to marker b, as a function of the coordinates of `nodes`."""
    first, second = place_of(build, a, nodes), place_of(build, b, nodes)

    def value(x: Sequence[float]) -> tuple[float, list[float]]:
        gradient = [0.0] * len(nodes.reference)
        return measure(first(x), second(x), gradient), gradient

    return value


def place_of(build: Build, marker: Marker2D, nodes: Nodes) -> Callable[[Numbers], Place]:
    """Where a marker is, as a function of the coordinates."""
    point = point_of(build, marker, nodes)

    def place(x: Numbers) -> Place:
        px, py, turn, ox, oy, add = point(x)
        return Place(px, py, turn + marker.angle, (ox, oy), add)

    return place
