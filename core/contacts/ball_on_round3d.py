"""Contacts of spheres with round shapes in space: smooth ones, cylinders and disks, rings."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from ..elements.base import Numbering, Row
from ..model.markers import Marker3D
from .contact3d import Contact3D, Sphere3D
from .cornered3d import Cylinder3D
from .moving_point3d import ON_CYLINDER, ON_RING, ON_SMOOTH
from .pair_table import Make, pair, touching
from .rings3d import Rim3D, Torus3D
from .round3d import Smooth3D
from .support3d import SUPPORT_NUMBERS, SmoothShape3D, support_address


class _BallOnRound3D(Contact3D):
    """Base of the contacts of a sphere with a round shape.

    The gap is the distance of its centre from the nearest point, less its radius.

    By a force law a sphere may sink in by less than its radius: with its centre in the shape nothing says which way is
    out, and what touches is held where it is.
    """

    sphere: Sphere3D
    """The sphere."""

    @model_validator(mode="after")
    def _is_no_point(self) -> "_BallOnRound3D":
        if not self.sphere.radius > 0.0:
            raise ValueError(
                f"contact '{self.name}' is of a point with a round shape, on whose surface it has no normal: give the "
                "sphere a radius"
            )
        return self

    def extent(self) -> float:
        return self.sphere.radius

    def _row(self, numbering: Numbering, marker: Marker3D, reach: float, numbers: Sequence[float], **more: int) -> Row:
        filled = (*numbers, *(0.0,) * (SUPPORT_NUMBERS - len(numbers)))
        return self._row_of(
            numbering, marker, self.sphere.marker, 0.0, self.sphere.radius, extents=(reach, 0.0), numbers=filled, **more
        )


class SphereOnSmooth3D(_BallOnRound3D):
    """Contact of a sphere with a smooth convex shape: an ellipsoid, or one's own."""

    type: Literal["SphereOnSmooth3D"] = "SphereOnSmooth3D"
    kind: ClassVar[int] = ON_SMOOTH

    shape: Smooth3D
    """An ellipsoid, or an own shape."""

    @model_validator(mode="after")
    def _is_smooth(self) -> "SphereOnSmooth3D":
        if isinstance(self.shape, Torus3D | Rim3D):
            kind, disk = type(self.shape).__name__, self.shape.rim_radius == 0.0
            raise ValueError(
                f"contact '{self.name}' is with a {kind}, whose flat side a support function does not show: take "
                f"{'SphereOnCylinder3D' if disk else 'SphereOnRing3D'} with a Torus3D"
            )
        return self

    def lengths(self) -> Sequence[float]:
        return (self.sphere.radius, self.shape.extent())

    def markers(self) -> Sequence[Marker3D]:
        return (self.shape.marker, self.sphere.marker)

    def row(self, numbering: Numbering) -> Row:
        shape = self.shape
        return self._row(
            numbering, shape.marker, shape.extent(), shape.formula_parameters(), address=support_address(shape)
        )


class SphereOnCylinder3D(_BallOnRound3D):
    """Contact of a sphere with a cylinder, on its side, its ends and rims; or with a disk, on its rim and faces."""

    type: Literal["SphereOnCylinder3D"] = "SphereOnCylinder3D"
    kind: ClassVar[int] = ON_CYLINDER

    shape: Annotated[Cylinder3D | Torus3D, Field(discriminator="type")]
    """The cylinder; or a disk, a Torus3D without rim radius."""

    @model_validator(mode="after")
    def _is_a_disk(self) -> "SphereOnCylinder3D":
        if isinstance(self.shape, Torus3D) and self.shape.rim_radius > 0.0:
            raise ValueError(
                f"contact '{self.name}' takes a Torus3D as a disk, but its rim has a radius of "
                f"{self.shape.rim_radius:g} m: take a SphereOnRing3D, or a Cylinder3D as the disk"
            )
        return self

    def _half(self) -> float:
        """Half its length, m; of a disk nothing."""
        return 0.5 * self.shape.length if isinstance(self.shape, Cylinder3D) else 0.0

    def _reach(self) -> float:
        return float((self.shape.radius**2 + self._half() ** 2) ** 0.5)

    def lengths(self) -> Sequence[float]:
        return (self.sphere.radius, self._reach())

    def markers(self) -> Sequence[Marker3D]:
        return (self.shape.marker, self.sphere.marker)

    def row(self, numbering: Numbering) -> Row:
        return self._row(numbering, self.shape.marker, self._reach(), (self.shape.radius, self._half()))


class SphereOnRing3D(_BallOnRound3D):
    """Contact of a sphere with a torus, which has a hole: the sphere may go through it, or roll in it."""

    type: Literal["SphereOnRing3D"] = "SphereOnRing3D"
    kind: ClassVar[int] = ON_RING

    ring: Torus3D
    """The torus, with a rim radius."""

    @model_validator(mode="after")
    def _goes_through(self) -> "SphereOnRing3D":
        ring, hole = self.ring, self.ring.radius - self.ring.rim_radius
        if not ring.rim_radius > 0.0:
            raise ValueError(
                f"contact '{self.name}' is with a Torus3D without rim radius, which is a disk: take a "
                "SphereOnCylinder3D, or give it a rim_radius"
            )
        if 0.0 < hole <= self.sphere.radius:
            raise ValueError(
                f"contact '{self.name}': a sphere of radius {self.sphere.radius:g} m sits in the hole of a torus, of "
                f"radius {hole:g} m, and touches it all round, which one contact cannot say: take a smaller sphere, "
                "a Cylinder3D for a ring without a hole, or a TriangleMesh3D of the torus"
            )
        return self

    def lengths(self) -> Sequence[float]:
        return (self.sphere.radius, self.ring.radius, self.ring.rim_radius)

    def extent(self) -> float:
        return self.sphere.radius + self.ring.rim_radius

    def markers(self) -> Sequence[Marker3D]:
        return (self.ring.marker, self.sphere.marker)

    def row(self, numbering: Numbering) -> Row:
        ring = self.ring
        return self._row_of(
            numbering, ring.marker, self.sphere.marker, ring.rim_radius, self.sphere.radius, extents=(ring.radius, 0.0),
            numbers=(ring.radius, 0.0, 0.0, 0.0),
        )  # fmt: skip


pair(SphereOnCylinder3D, shape=Cylinder3D, sphere=Sphere3D)
pair(SphereOnSmooth3D, shape=SmoothShape3D, sphere=Sphere3D)


@touching(Torus3D, Sphere3D)
def _ring_or_disk(ring: Torus3D, sphere: Sphere3D) -> Sequence[Make]:
    if ring.rim_radius == 0.0:
        return [partial(SphereOnCylinder3D, shape=ring, sphere=sphere)]
    return [partial(SphereOnRing3D, ring=ring, sphere=sphere)]
