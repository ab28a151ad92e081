"""Smooth convex shapes of the library: ellipsoids, and rings, whose rims are sharp (disks) or round (tori)."""

import math
from typing import Any, ClassVar, Literal

from ..compiled.jit import compiled
from ..model.base import NonNegative, Positive
from .support3d import SmoothShape3D


@compiled
def ellipsoid_support(x: float, y: float, z: float, a: float, b: float, c: float, none: float) -> Any:
    """sqrt(a^2 x^2 + b^2 y^2 + c^2 z^2) with its derivatives."""
    a2, b2, c2 = a * a, b * b, c * c
    h = math.sqrt(a2 * x * x + b2 * y * y + c2 * z * z)
    p, q, r = a2 * x / h, b2 * y / h, c2 * z / h
    return h, p, q, r, (a2 - p * p) / h, -p * q / h, -p * r / h, (b2 - q * q) / h, -q * r / h, (c2 - r * r) / h


@compiled
def ring_support(x: float, y: float, z: float, radius: float, rim: float, none: float, no_more: float) -> Any:
    """radius sqrt(x^2 + y^2) + rim |(x, y, z)| with its derivatives."""
    s, n = math.sqrt(x * x + y * y), math.sqrt(x * x + y * y + z * z)
    u, v = x / s, y / s
    p, q, r = x / n, y / n, z / n
    large, small = radius / s, rim / n
    return (
        radius * s + rim * n, radius * u + rim * p, radius * v + rim * q, rim * r,
        large * v * v + small * (1.0 - p * p), -large * u * v - small * p * q, -small * p * r,
        large * u * u + small * (1.0 - q * q), -small * q * r, small * (1.0 - r * r),
    )  # fmt: skip


class Ellipsoid3D(SmoothShape3D):
    """An ellipsoid about the marker, its half-axes along the marker's axes. It touches half-spaces."""

    type: Literal["Ellipsoid3D"] = "Ellipsoid3D"
    half_axes: tuple[Positive, Positive, Positive]
    """Along the marker's x, y and z axes, m."""
    formula: ClassVar[Any] = ellipsoid_support

    def parameters(self) -> tuple[float, ...]:
        return self.half_axes


class Torus3D(SmoothShape3D):
    """A ring about the marker's z axis: the circle of `radius` in its xy plane, thickened by `rim_radius`; 0 is a disk
    with a sharp rim. It touches half-spaces by its rim. Flat on one it touches along a circle, where it has no one
    point: what lies flat takes the points of a `Cylinder3D`."""

    type: Literal["Torus3D"] = "Torus3D"
    radius: Positive
    """Of the circle about which the rim is rounded, m."""
    rim_radius: NonNegative = 0.0
    """Of the rounding, m."""
    formula: ClassVar[Any] = ring_support

    def parameters(self) -> tuple[float, ...]:
        return (self.radius, self.rim_radius)
