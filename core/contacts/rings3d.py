"""Rings in space: disks, ends of cylinders, tori, and how they come to lie flat.

A circle of radius R about z reaches R s in a direction c, s = sqrt(c_x^2 + c_y^2). Flat on a plane (s = 0) no one point
of it touches: s has no derivatives there, and the point that touches runs round faster and faster as s becomes small.
So near s = 0 another function is in its place, n f(s/n) with n = |c| and f twice differentiable:

- of a ring alone f is s but below EDGE, where it is rounded off with f(0) = 0: flat, the gap is exact too.
- of a ring that points help to carry (`Rim3D`) f is s but below the sine `tilt`. There it draws back behind the
  points, by a part of the tilt where it is flat, so that these alone carry.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, field_validator

from ..compiled.jit import compiled, inlined
from ..model.base import NonNegative, Positive
from ..model.markers import Marker3D
from .contact3d import Sphere3D
from .support3d import SmoothShape3D

EDGE = 1e-6
"""Sine of the tilt below which a ring alone is rounded off: by less than 1e-7 of its radius."""
BACK, INNER = 0.1, 0.2
"""Of the tilt below which points carry: how far the rim draws back where it is flat, and below which part of it s
itself is rounded off, by 3/8 of that part. So a flat rim is 0.025 times tilt times radius behind its points."""
FLAT_TILT = 0.05
"""Sine of the tilt below which the points of a rim carry, 2.9 degrees."""
WITHIN = 1e-3
"""Of the radius: so far within the rim its points are, so that what rolls on the rim does not touch with them."""
FEWEST_RIM_POINTS = 3
RIM_POINTS = 8

RimPoints = Annotated[int, Field(ge=0)]


@inlined
def _alone(x: float) -> Any:
    """(f, f'/x, f'') of a ring alone, x = s/n."""
    if x >= EDGE:
        return x, 1.0 / x, 0.0
    u = (x / EDGE) ** 2
    return (
        EDGE * u * (1.875 + u * (-1.25 + 0.375 * u)), (3.75 + u * (-5.0 + 2.25 * u)) / EDGE,
        (3.75 + u * (-15.0 + 11.25 * u)) / EDGE,
    )  # fmt: skip


@inlined
def _carried(x: float, tilt: float) -> Any:
    """(f, f'/x, f'') of a ring that points help to carry below this tilt."""
    if x >= tilt:
        return x, 1.0 / x, 0.0
    inner = INNER * tilt
    f, slope, bend = x, 0.0, 0.0
    if x < inner:
        u = (x / inner) ** 2
        f, slope, bend = (
            inner * (0.375 + u * (0.75 - 0.125 * u)), (1.5 - 0.5 * u) / inner, (1.5 - 1.5 * u) / inner
        )  # fmt: skip
    else:
        slope = 1.0 / x
    # back by BACK tilt (1 - u)^3
    u = (x / tilt) ** 2
    rest = 1.0 - u
    return (
        f - BACK * tilt * rest**3, slope + 6.0 * BACK / tilt * rest**2,
        bend + 6.0 * BACK / tilt * rest * (1.0 - 5.0 * u),
    )  # fmt: skip


@compiled
def ring_support(x: float, y: float, z: float, radius: float, rim: float, tilt: float, none: float) -> Any:
    """radius n f(s/n) + rim n with its derivatives, s = |(x, y)| and n = |(x, y, z)|; tilt = 0: of a ring alone."""
    s, n = math.sqrt(x * x + y * y), math.sqrt(x * x + y * y + z * z)
    p, q, r = x / n, y / n, z / n
    # flat, f depends on no direction of s
    u, v = (x / s, y / s) if s > 0.0 else (1.0, 0.0)
    at = s / n
    f, slope, bend = _carried(at, tilt) if tilt > 0.0 else _alone(at)
    by_s, by_n = radius * at * slope, radius * (f - at * at * slope) + rim
    round_it, grows, bends = radius * slope / n, by_n / n, radius * bend / n
    a, b, c = u - at * p, v - at * q, -at * r
    return (
        radius * n * f + rim * n, by_s * u + by_n * p, by_s * v + by_n * q, by_n * r,
        round_it * v * v + grows * (1.0 - p * p) + bends * a * a,
        -round_it * u * v - grows * p * q + bends * a * b,
        -grows * p * r + bends * a * c,
        round_it * u * u + grows * (1.0 - q * q) + bends * b * b,
        -grows * q * r + bends * b * c,
        grows * (1.0 - r * r) + bends * c * c,
    )  # fmt: skip


def check_rim_points(count: int) -> int:
    """The number of points of a rim. Raises ValueError for one or two, which hold nothing."""
    if 0 < count < FEWEST_RIM_POINTS:
        raise ValueError(f"{count} points of a rim do not hold what lies on it: give {FEWEST_RIM_POINTS} or more, or 0")
    return count


class Rim3D(SmoothShape3D):
    """A ring that rolls, and draws back where it lies flat, for points to carry: those of `rim_points`.

    Alone it would sink in there by 0.025 `flat_tilt` times its radius: `contacts_between` and groups make it with its
    points, from disks, tori and cylinders.
    """

    type: Literal["Rim3D"] = "Rim3D"
    radius: Positive
    """Of the circle about which the rim is rounded, m."""
    rim_radius: NonNegative = 0.0
    """Of the rounding, m."""
    flat_tilt: Annotated[float, Field(gt=0.0, le=0.5)] = FLAT_TILT
    """Sine of the tilt below which it draws back, dimensionless."""
    formula: ClassVar[Any] = ring_support

    def parameters(self) -> tuple[float, ...]:
        return (self.radius, self.rim_radius, self.flat_tilt)

    def points(self, count: int) -> tuple[Sphere3D, ...]:
        """What carries it where it lies flat: points evenly round, or spheres of the rim's rounding."""
        axes, middle, found = self.marker.axes(), np.array(self.marker.point), []
        for angle in 2.0 * np.pi * np.arange(count) / max(count, 1):
            x, y, z = (middle + (1.0 - WITHIN) * self.radius * (axes @ (np.cos(angle), np.sin(angle), 0.0))).tolist()
            found.append(Sphere3D(marker=Marker3D(body=self.marker.body, point=(x, y, z)), radius=self.rim_radius))
        return tuple(found)


class Torus3D(SmoothShape3D):
    """A ring about the marker's z axis: the circle of `radius` in its xy plane, thickened by `rim_radius`; 0 is a disk
    with a sharp rim. It touches half-spaces by its rim, and spheres: as a ring with a hole, as a disk with its faces.

    In groups it rolls on its rim, and where it lies flatter than 2.9 degrees points of the rim carry it: these strike
    in turns, and so it comes to rest. A single `SmoothOnHalfSpace3D` has the rim alone, at every tilt: the point that
    touches runs round without bound as the ring comes to lie flat.
    """

    type: Literal["Torus3D"] = "Torus3D"
    shared_fields: ClassVar[tuple[str, ...]] = ("marker", "rim_points")
    radius: Positive
    """Of the circle about which the rim is rounded, m."""
    rim_radius: NonNegative = 0.0
    """Of the rounding, m."""
    rim_points: RimPoints = RIM_POINTS
    """Points of the rim that carry in groups where it lies flat, evenly round; 0: the rim alone, at every tilt."""
    formula: ClassVar[Any] = ring_support

    @field_validator("rim_points")
    @classmethod
    def _hold_it(cls, count: int) -> int:
        return check_rim_points(count)

    def parameters(self) -> tuple[float, ...]:
        return (self.radius, self.rim_radius)

    def touching(self) -> Sequence[SmoothShape3D | Sphere3D]:
        """What of it touches a half-space in a group: the rim and its points."""
        if self.rim_points == 0:
            return (self,)
        rim = Rim3D(marker=self.marker, radius=self.radius, rim_radius=self.rim_radius)
        return (rim, *rim.points(self.rim_points))
