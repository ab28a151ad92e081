"""Smooth convex shapes of the library: ellipsoids. Rings are in `rings3d.py`."""

import math
from typing import Any, ClassVar, Literal

from ..compiled.jit import compiled
from ..model.base import Positive
from .support3d import SmoothShape3D


@compiled
def ellipsoid_support(x: float, y: float, z: float, a: float, b: float, c: float, none: float) -> Any:
    """sqrt(a^2 x^2 + b^2 y^2 + c^2 z^2) with its derivatives."""
    a2, b2, c2 = a * a, b * b, c * c
    h = math.sqrt(a2 * x * x + b2 * y * y + c2 * z * z)
    p, q, r = a2 * x / h, b2 * y / h, c2 * z / h
    return h, p, q, r, (a2 - p * p) / h, -p * q / h, -p * r / h, (b2 - q * q) / h, -q * r / h, (c2 - r * r) / h


class Ellipsoid3D(SmoothShape3D):
    """An ellipsoid about the marker, its half-axes along the marker's axes. It touches spheres and
    half-spaces."""

    type: Literal["Ellipsoid3D"] = "Ellipsoid3D"
    half_axes: tuple[Positive, Positive, Positive]
    """Along the marker's x, y and z axes, m."""
    formula: ClassVar[Any] = ellipsoid_support

    def parameters(self) -> tuple[float, ...]:
        return self.half_axes
