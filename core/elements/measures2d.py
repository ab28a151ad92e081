"""What motors, servos and springs between two markers measure: the angle, the way along an axis, the distance."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Literal

from .formula2d import Frame2D

Measure = Literal["angle", "slide", "distance"]


def turn(a: Frame2D, b: Frame2D) -> float:
    """Angle from the first axis of a to that of b, rad; it counts turns."""
    return b.angle - a.angle


def slide(a: Frame2D, b: Frame2D) -> float:
    """How far b is along the first axis of a, m."""
    return (b.x - a.x) * a.ex + (b.y - a.y) * a.ey


def span(a: Frame2D, b: Frame2D) -> float:
    """Distance of a and b, m."""
    return math.hypot(b.x - a.x, b.y - a.y)


MEASURES: Mapping[str, Callable[..., Any]] = {"angle": turn, "slide": slide, "distance": span}
EFFORTS: Mapping[str, tuple[str, str]] = {
    "angle": ("torque", "N.m"), "slide": ("force", "N"), "distance": ("force", "N"),
}  # fmt: skip
"""Name and unit of what works against the growth of each."""
