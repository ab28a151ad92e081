"""Disk inside a ring: the gap is what the ring's inner radius has left over the disk's distance from its middle.

gap = R - r - d, d the distance of the centres. Where the centres meet d has no direction; the gap is largest there, and
1e-8 of R beside it gives it one.
"""

import math
from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import model_validator

from ..elements.formula2d import Frame2D
from ..model.base import Positive
from ..model.markers import Marker2D
from .contact2d import Disk2D
from .disk_contact2d import DiskContact2D
from .geometry_kinds import RING, are
from .pair_table import pair
from .scalar_contact2d import ScalarContact, scalar_contact
from .shape import Shape2D


class Ring2D(Shape2D):
    """A round hole about the marker, touched from inside: the bore of a bearing, a drum."""

    type: Literal["Ring2D"] = "Ring2D"
    marker: Marker2D
    """Its centre."""
    radius: Positive
    """Of the hole, m."""


def ring_gap(ring: Frame2D, centre: Frame2D, ring_radius: float, radius: float) -> float:
    dx, dy = centre.x - ring.x, centre.y - ring.y
    return ring_radius - radius - math.sqrt(dx * dx + dy * dy + 1e-16 * ring_radius * ring_radius)


def ring_slide(ring: Frame2D, centre: Frame2D, ring_radius: float, radius: float) -> float:
    """Arc of the place of contact on the ring, counter-clockwise, less the same on the disk: R (phi - alpha) - r (phi -
    beta), alpha and beta the angles of ring and disk, phi the direction of the centres."""
    phi = math.atan2(centre.y - ring.y, centre.x - ring.x)
    return ring_radius * (phi - ring.angle) - radius * (phi - centre.angle)


class DiskInRing2D(DiskContact2D):
    """A disk, or a point, in a round hole: gap = radius of the hole - radius of the disk - distance of the centres."""

    type: Literal["DiskInRing2D"] = "DiskInRing2D"
    formula: ClassVar[ScalarContact] = scalar_contact(ring_gap, ring_slide)

    shape: Ring2D
    """The hole."""

    @model_validator(mode="after")
    def _fits(self) -> "DiskInRing2D":
        if not self.disk.radius < self.shape.radius:
            raise ValueError(
                f"contact '{self.name}': a disk of radius {self.disk.radius:g} m does not go into a hole of radius "
                f"{self.shape.radius:g} m: the hole must be larger"
            )
        return self

    @property
    def ring(self) -> Marker2D:
        """Centre of the hole."""
        return self.shape.marker

    @property
    def ring_radius(self) -> float:
        """Of the hole, m."""
        return self.shape.radius

    def lengths(self) -> Sequence[float]:
        return self.disk.radius, self.shape.radius

    def slide_period(self) -> float:
        return 2.0 * math.pi * (self.shape.radius - self.disk.radius)


are(RING, ring_gap)
pair(DiskInRing2D, shape=Ring2D, disk=Disk2D)
