"""Planar contacts: two shapes, a law along the normal, and friction."""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..elements.base import Form, Numbering, Row
from ..laws.friction import CoulombFriction, LuGreFriction
from ..model.base import NonNegative
from ..model.markers import Marker2D
from ..rounding import LEAST_DEFLECTION
from .bristle2d import bristle_disk_on_disk_kernel, bristle_disk_on_half_plane_kernel
from .element import ContactElement
from .normal2d import disk_on_disk_kernel, disk_on_half_plane_kernel
from .pair_table import pair
from .shape import Shape2D
from .sliding2d import sliding_disk_on_disk_kernel, sliding_disk_on_half_plane_kernel


class HalfPlane2D(Shape2D):
    """The half-plane behind a line through the marker; its outward normal is the marker's second axis
    (angle + 90 degrees): a half-plane on the ground with angle 0 is a floor."""

    type: Literal["HalfPlane2D"] = "HalfPlane2D"
    marker: Marker2D = Marker2D()
    """On its edge; its second axis is the outward normal."""


class Disk2D(Shape2D):
    """A disk about the marker; radius 0 is a point."""

    type: Literal["Disk2D"] = "Disk2D"
    marker: Marker2D
    """Its centre."""
    radius: NonNegative = 0.0
    """m."""


class Contact2D(ContactElement):
    """Base of the planar contacts.

    Class attributes: `kernel` without friction, `sliding_kernel` with it, `bristle_kernel` with LuGre's; `width`, the
    number of coordinates that gap and sliding distance depend on.
    """

    symbol: ClassVar[str] = "shapes"

    sliding_kernel: ClassVar[Any]
    bristle_kernel: ClassVar[Any]
    width: ClassVar[int] = 6

    def form(self) -> Form:
        """A contact with friction has a second row, the sliding distance's."""
        kind, n = type(self), self.width
        if self.friction is None:
            kernel, rows, size = kind.kernel, 1, n
        elif isinstance(self.friction, LuGreFriction):
            kernel, rows, size = kind.bristle_kernel, 2, n + 1
        else:
            kernel, rows, size = kind.sliding_kernel, 2, n
        full = tuple((i, j) for i in range(size) for j in range(size))
        return Form(kernel, rows, full, tuple((k, j) for k in range(rows) for j in range(n)), self.rate_rows_of_slide())

    def rate_rows_of_slide(self) -> Sequence[int]:
        """The row of the sliding distance, if it holds at velocity level only: on a surface that moves."""
        return (1,) if self.surface_speed is not None and isinstance(self.friction, CoulombFriction) else ()

    def internal_coordinates(self) -> Sequence[str]:
        return ("bristle",) if isinstance(self.friction, LuGreFriction) else ()

    def contact_rows(self, numbering: Numbering) -> Sequence[Row]:
        """Its rows but for what LuGre's friction adds at their ends."""
        return (self.row(numbering),)

    def rows(self, numbering: Numbering) -> Sequence[Row]:
        rows = self.contact_rows(numbering)
        if not isinstance(self.friction, LuGreFriction):
            return rows
        least, own = LEAST_DEFLECTION * numbering.length, numbering.internal(self.name)
        more = (least, self.friction.parameters()[-1])
        return tuple(Row((*row.parameters, *more), (*row.coordinates, *own), row.extra) for row in rows)

    def disks(self) -> Sequence[Disk2D]:
        return tuple(shape for shape in self.shapes() if isinstance(shape, Disk2D))

    def lengths(self) -> Sequence[float]:
        return tuple(disk.radius for disk in self.disks())

    def _row(
        self, numbering: Numbering, a: Marker2D, b: Marker2D, angle: float, radius: float, first: float = 0.0
    ) -> Row:
        law = self._law_columns(numbering)
        return Row(
            (*a.point, *b.point, angle, radius, first, *law.parameters),
            (*numbering.coordinates(a.body), *numbering.coordinates(b.body)),
            law.extra,
        )


class DiskOnHalfPlane2D(Contact2D):
    """Contact of a disk (or point) with a half-plane: gap = height of the centre over the line - radius."""

    type: Literal["DiskOnHalfPlane2D"] = "DiskOnHalfPlane2D"
    touch: ClassVar[str] = "half-plane"
    kernel: ClassVar[Any] = disk_on_half_plane_kernel
    sliding_kernel: ClassVar[Any] = sliding_disk_on_half_plane_kernel
    bristle_kernel: ClassVar[Any] = bristle_disk_on_half_plane_kernel

    plane: HalfPlane2D
    """The half-plane."""
    disk: Disk2D
    """The disk."""

    def row(self, numbering: Numbering) -> Row:
        angle = self.plane.marker.angle + 0.5 * math.pi
        return self._row(numbering, self.plane.marker, self.disk.marker, angle, self.disk.radius)

    def markers(self) -> Sequence[Marker2D]:
        return (self.plane.marker, self.disk.marker)


class DiskOnDisk2D(Contact2D):
    """Contact of two disks: gap = distance of the centres - sum of the radii."""

    type: Literal["DiskOnDisk2D"] = "DiskOnDisk2D"
    touch: ClassVar[str] = "disks"
    kernel: ClassVar[Any] = disk_on_disk_kernel
    sliding_kernel: ClassVar[Any] = sliding_disk_on_disk_kernel
    bristle_kernel: ClassVar[Any] = bristle_disk_on_disk_kernel

    a: Disk2D
    """The first disk."""
    b: Disk2D
    """The second disk."""

    def extent(self) -> float:
        return self.a.radius + self.b.radius or math.inf

    def row(self, numbering: Numbering) -> Row:
        return self._row(numbering, self.a.marker, self.b.marker, 0.0, self.a.radius + self.b.radius, self.a.radius)

    def markers(self) -> Sequence[Marker2D]:
        return (self.a.marker, self.b.marker)


pair(DiskOnHalfPlane2D, plane=HalfPlane2D, disk=Disk2D)
pair(DiskOnDisk2D, a=Disk2D, b=Disk2D)
