"""Wheels and balls that roll on a plane, without sliding and without leaving it."""

from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

import numpy as np

from ..model.base import Positive
from ..model.markers import GROUND
from .base import BodyElement
from .joint3d import Joint3D
from .primitive3d import Primitive
from .rolling3d import Rolling
from .spatial_body import start_of_marker

FLAT = 0.02
"""Angle between the plane and the plane of a disk, rad, below which nothing says where the disk touches."""


class RollingSphere3D(Joint3D):
    """A ball rolls on a plane: marker a's xy plane, on the side to which its z axis points; marker b is the centre.

    One row holds the centre at its distance, two hold the point that touches at rest on the plane, at velocity level
    (nonholonomic). The ball may spin about the normal. It neither slides nor leaves the plane: `force_z` below zero
    means that it sticks to it.
    """

    type: Literal["RollingSphere3D"] = "RollingSphere3D"
    symbol: ClassVar[str] = "rolling-sphere"
    radius: Positive
    """m."""

    def primitives(self) -> Sequence[Primitive]:
        return (Rolling(0.0, self.radius),)


class RollingDisk3D(Joint3D):
    """A disk, wheel or coin rolls on a plane: marker a's xy plane, on the side to which its z axis points; marker b is
    the disk's centre, its z axis the axle.

    As `RollingSphere3D`. The rim is sharp, or rounded like that of a torus. A disk that comes to lie flat has no point
    that touches: the run ends there.
    """

    type: Literal["RollingDisk3D"] = "RollingDisk3D"
    symbol: ClassVar[str] = "rolling-disk"
    radius: Positive
    """Of the disk, m; of a rounded one to its outermost circle."""
    rim_radius: float = 0.0
    """Radius of the rounding of the rim, m."""

    def primitives(self) -> Sequence[Primitive]:
        return (Rolling(self.radius - self.rim_radius, self.rim_radius),)

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        super().check_in(bodies)
        if not 0.0 <= self.rim_radius < self.radius:
            raise ValueError(
                f"'{self.name}' has a rim of radius {self.rim_radius:g} m: it must be less than that of the disk, "
                f"{self.radius:g} m, and not negative; a ball is a RollingSphere3D"
            )
        if not all(name == GROUND or name in bodies for name in (self.a.body, self.b.body)):
            return  # the model says which name is unknown
        normal, axle = (start_of_marker(marker, bodies)[1][:, 2] for marker in (self.a, self.b))
        tilt = float(np.linalg.norm(np.cross(normal, axle)))
        if tilt < FLAT:
            raise ValueError(
                f"'{self.name}' starts with its disk {tilt:.3g} rad from flat on the plane, where no single point of "
                "its rim touches: tilt the body, or turn the `attitude` of marker b so that its z axis is the axle"
            )
