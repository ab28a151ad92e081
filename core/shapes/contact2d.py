"""Planar contacts: two shapes, a law along the normal, and friction."""

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from ..elements.base import BodyElement, Element, Form, Numbering, Row
from ..laws import ContactLaw, ForceLaw
from ..laws.friction import CoulombFriction, Friction, LuGreFriction
from ..model.base import NonNegative, Record
from ..model.markers import GROUND, Marker2D
from ..rounding import LEAST_DEFLECTION
from .bristle2d import bristle_disk_on_disk_kernel, bristle_disk_on_half_plane_kernel
from .normal2d import disk_on_disk_kernel, disk_on_half_plane_kernel
from .sliding2d import sliding_disk_on_disk_kernel, sliding_disk_on_half_plane_kernel


class HalfPlane2D(Record):
    """The half-plane behind a line through the marker; its outward normal is the marker's second axis
    (angle + 90 degrees): a half-plane on the ground with angle 0 is a floor."""

    type: Literal["HalfPlane2D"] = "HalfPlane2D"
    marker: Marker2D = Marker2D()


class Disk2D(Record):
    """A disk about the marker; radius 0 is a point."""

    type: Literal["Disk2D"] = "Disk2D"
    marker: Marker2D
    radius: NonNegative = 0.0
    """m."""


Shape2D = Annotated[HalfPlane2D | Disk2D, Field(discriminator="type")]


class Contact2D(Element):
    """Base of the planar contacts.

    Class attributes: `kernel` without friction, `sliding_kernel` with it, `bristle_kernel` with LuGre's; `width`, the
    number of coordinates that gap and sliding distance depend on.
    """

    sliding_kernel: ClassVar[Any]
    bristle_kernel: ClassVar[Any]
    width: ClassVar[int] = 6

    law: ContactLaw
    """What happens when the gap closes."""
    friction: Friction | None = None
    """What resists sliding: Coulomb's for contacts as constraints, a regularised law or LuGre's for forces."""

    @model_validator(mode="after")
    def _friction_fits(self) -> "Contact2D":
        if self.friction is None:
            return self
        coulomb = isinstance(self.friction, CoulombFriction)
        if coulomb and isinstance(self.law, ForceLaw):
            raise ValueError(
                f"contact '{self.name}': Coulomb friction is set-valued and needs a constraint law such as "
                f"NewtonImpact, not {type(self.law).__name__}; give a regularised law such as Tanh or BrownMcPhee"
            )
        if not coulomb and not isinstance(self.law, ForceLaw):
            raise ValueError(
                f"contact '{self.name}': friction '{self.friction.type}' is regularised and belongs to a force law; "
                f"a contact with {type(self.law).__name__} is a constraint: give it Coulomb friction"
            )
        return self

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
        return Form(kernel, rows, full, tuple((k, j) for k in range(rows) for j in range(n)))

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
        """The disks that it brings in touch, for the drawing."""
        return ()

    def reach(self) -> Sequence[tuple[float, ...]]:
        """Of what is fixed to the ground only the nearest: how far a road goes on says nothing of the wheel."""
        points = [marker.point for marker in self.markers() if marker.body != GROUND]
        fixed = [marker.point for marker in self.markers() if marker.body == GROUND]
        return [*points, *sorted(fixed, key=lambda point: max(abs(x) for x in point))[:1]]

    def lengths(self) -> Sequence[float]:
        return tuple(disk.radius for disk in self.disks())

    def extent(self) -> float:
        """Distance over which the shapes could pass through each other, m; infinite for a half-plane."""
        return math.inf

    def units_in(self, bodies: Mapping[str, BodyElement]) -> tuple[str, str]:
        """Units of gap and sliding distance in a model with these bodies."""
        return "m", "m"

    def _row(
        self, numbering: Numbering, a: Marker2D, b: Marker2D, angle: float, radius: float, first: float = 0.0
    ) -> Row:
        law = self._law_columns(numbering)
        return Row(
            (*a.point, *b.point, angle, radius, first, *law.parameters),
            (*numbering.coordinates(a.body), *numbering.coordinates(b.body)),
            law.extra,
        )

    def _law_columns(self, numbering: Numbering) -> Row:
        """What every contact's row has: columns 7 to 15 of the parameters, and the extra indices."""
        if isinstance(self.law, ForceLaw):
            parameters = self.law.formula_parameters()
            address = numbering.law_address(self.law)
        else:
            parameters, address = (0.0, 0.0, 0.0, 0.0), 0
        friction, friction_address = self._friction(numbering)
        return Row(
            (*parameters, *friction),
            (),
            (
                numbering.contact(self.name),
                address,
                numbering.work(f"{self.name}.impulse"),
                numbering.work(f"{self.name}.dissipation"),
                0,
                friction_address,
            ),
        )

    def _friction(self, numbering: Numbering) -> tuple[tuple[float, ...], int]:
        """Its numbers in the table of parameters, and the address of its formula (0: Coulomb's, or none)."""
        if self.friction is None:
            return (0.0,) * 5, 0
        if isinstance(self.friction, CoulombFriction):
            return (self.friction.coefficient, 0.0, 0.0, 0.0, 0.0), 0
        if isinstance(self.friction, LuGreFriction):
            return self.friction.parameters()[:-1], 0
        return self.friction.formula_parameters(), numbering.friction_address(self.friction)


class DiskOnHalfPlane2D(Contact2D):
    """Contact of a disk (or point) with a half-plane: gap = height of the centre over the line - radius."""

    type: Literal["DiskOnHalfPlane2D"] = "DiskOnHalfPlane2D"
    kernel: ClassVar[Any] = disk_on_half_plane_kernel
    sliding_kernel: ClassVar[Any] = sliding_disk_on_half_plane_kernel
    bristle_kernel: ClassVar[Any] = bristle_disk_on_half_plane_kernel

    plane: HalfPlane2D
    disk: Disk2D

    def disks(self) -> Sequence[Disk2D]:
        return (self.disk,)

    def row(self, numbering: Numbering) -> Row:
        angle = self.plane.marker.angle + 0.5 * math.pi
        return self._row(numbering, self.plane.marker, self.disk.marker, angle, self.disk.radius)

    def markers(self) -> Sequence[Marker2D]:
        return (self.plane.marker, self.disk.marker)


class DiskOnDisk2D(Contact2D):
    """Contact of two disks: gap = distance of the centres - sum of the radii."""

    type: Literal["DiskOnDisk2D"] = "DiskOnDisk2D"
    kernel: ClassVar[Any] = disk_on_disk_kernel
    sliding_kernel: ClassVar[Any] = sliding_disk_on_disk_kernel
    bristle_kernel: ClassVar[Any] = bristle_disk_on_disk_kernel

    a: Disk2D
    b: Disk2D

    def disks(self) -> Sequence[Disk2D]:
        return (self.a, self.b)

    def extent(self) -> float:
        return self.a.radius + self.b.radius or math.inf

    def row(self, numbering: Numbering) -> Row:
        return self._row(numbering, self.a.marker, self.b.marker, 0.0, self.a.radius + self.b.radius, self.a.radius)

    def markers(self) -> Sequence[Marker2D]:
        return (self.a.marker, self.b.marker)
