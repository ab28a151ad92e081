"""Contacts of round shapes in space: smooth shapes on half-spaces, spheres in hollow spheres, capsules."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from ..elements.base import Numbering, Row
from ..model.markers import Marker3D
from ..model.open_union import OpenUnion
from .contact3d import Contact3D, HalfSpace3D, Sphere3D, SphereOnHalfSpace3D
from .cornered3d import Capsule3D, Cornered3D, Cylinder3D
from .moving_point3d import HOLLOW, SEGMENTS, SUPPORT
from .pair_table import Make, pair, touching
from .rings3d import Rim3D, Torus3D
from .rounds3d import Ellipsoid3D
from .support3d import SmoothShape3D, support_address

Smooth3D = Annotated[
    SmoothShape3D, OpenUnion({"Ellipsoid3D": Ellipsoid3D, "Rim3D": Rim3D, "Torus3D": Torus3D}, SmoothShape3D)
]
"""Smooth shapes, a user's own too."""


class SmoothOnHalfSpace3D(Contact3D):
    """Contact of a smooth convex shape with a half-space, at the point that reaches farthest, which rolls on both."""

    type: Literal["SmoothOnHalfSpace3D"] = "SmoothOnHalfSpace3D"
    touch: ClassVar[str] = "support"
    kind: ClassVar[int] = SUPPORT

    plane: HalfSpace3D
    """The half-space."""
    shape: Smooth3D
    """An ellipsoid, a torus (a disk without rim radius), or an own shape."""

    def lengths(self) -> Sequence[float]:
        return (self.shape.extent(),)

    def row(self, numbering: Numbering) -> Row:
        shape = self.shape
        return self._row_of(
            numbering, self.plane.marker, shape.marker, 0.0, 0.0, extents=(0.0, shape.extent()),
            numbers=shape.formula_parameters(), address=support_address(shape),
        )  # fmt: skip

    def markers(self) -> Sequence[Marker3D]:
        return (self.plane.marker, self.shape.marker)


SHORTER = 1e-3
"""Of its length: so much a capsule is shorter for all but the ends of the first one: no two contacts say the same."""
TILT = 0.1
"""Of the sum of the radii over the longer length: sine of the angle below which ends carry. At this angle the axes of
two that lie on one another by their ends are nearer by TILT^2/8 of the sum of the radii, less than they draw back."""


class SphereInSphere3D(Contact3D):
    """Contact of a sphere with the inside of a hollow one: gap = difference of the radii - distance of the centres."""

    type: Literal["SphereInSphere3D"] = "SphereInSphere3D"
    touch: ClassVar[str] = "hollow"
    kind: ClassVar[int] = HOLLOW

    hollow: Sphere3D
    """The hollow sphere: its inside."""
    sphere: Sphere3D
    """The sphere in it."""

    @model_validator(mode="after")
    def _fits_in(self) -> "SphereInSphere3D":
        if not self.hollow.radius > self.sphere.radius:
            raise ValueError(
                f"contact '{self.name}': a sphere of radius {self.sphere.radius:g} m does not fit into one of "
                f"{self.hollow.radius:g} m: make the hollow one larger"
            )
        return self

    def spheres(self) -> Sequence[Sphere3D]:
        """The one inside; the hollow one is no ball."""
        return (self.sphere,)

    def lengths(self) -> Sequence[float]:
        return (self.hollow.radius, self.sphere.radius)

    def extent(self) -> float:
        return 2.0 * self.hollow.radius

    def row(self, numbering: Numbering) -> Row:
        return self._row_of(numbering, self.hollow.marker, self.sphere.marker, -self.hollow.radius, self.sphere.radius)

    def markers(self) -> Sequence[Marker3D]:
        return (self.hollow.marker, self.sphere.marker)


class CapsuleOnCapsule3D(Contact3D):
    """Contact of two capsules, or of a capsule and a sphere, at their nearest points.

    Capsules that are parallel touch in the middle of where they lie side by side, at one place, which is no way to lie
    on one another: `contacts_between` and groups make five contacts, of the axes and of the ends (`_two_capsules`).
    """

    type: Literal["CapsuleOnCapsule3D"] = "CapsuleOnCapsule3D"
    kind: ClassVar[int] = SEGMENTS

    a: Capsule3D
    """The first capsule."""
    b: Annotated[Capsule3D | Sphere3D, Field(discriminator="type")]
    """The second one, or a sphere."""
    parallel_tilt: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0
    """Sine of the angle of two capsules below which their gap draws back, by up to 0.002 of the sum of the radii, where
    contacts of their ends carry, dimensionless; 0: nowhere."""

    def spheres(self) -> Sequence[Sphere3D]:
        return (*self.a.corners(), *(self.b.corners() if isinstance(self.b, Capsule3D) else (self.b,)))

    def lengths(self) -> Sequence[float]:
        return (self.a.radius, self.b.radius, self.a.length)

    def extent(self) -> float:
        return self.a.radius + self.b.radius

    def row(self, numbering: Numbering) -> Row:
        halves = 0.5 * self.a.length, 0.5 * self.b.length if isinstance(self.b, Capsule3D) else 0.0
        return self._row_of(
            numbering,
            self.a.marker,
            self.b.marker,
            self.a.radius,
            self.b.radius,
            extents=halves,
            tilt=self.parallel_tilt,
        )

    def markers(self) -> Sequence[Marker3D]:
        return (self.a.marker, self.b.marker)


pair(SmoothOnHalfSpace3D, plane=HalfSpace3D, shape=SmoothShape3D)
pair(CapsuleOnCapsule3D, a=Capsule3D, b=Sphere3D)


@touching(HalfSpace3D, (Cylinder3D, Torus3D))
def _rims_on_plane(plane: HalfSpace3D, shape: Cylinder3D | Torus3D) -> Sequence[Make]:
    return [
        partial(SphereOnHalfSpace3D, plane=plane, sphere=part)
        if isinstance(part, Sphere3D)
        else partial(SmoothOnHalfSpace3D, plane=plane, shape=part)
        for part in shape.touching()
    ]


@touching(HalfSpace3D, Cornered3D)
def _corners_on_plane(plane: HalfSpace3D, shape: Cornered3D) -> Sequence[Make]:
    return [partial(SphereOnHalfSpace3D, plane=plane, sphere=corner) for corner in shape.corners()]


@touching(Capsule3D, Capsule3D)
def _two_capsules(a: Capsule3D, b: Capsule3D) -> Sequence[Make]:
    """Of their axes, and of the ends of each with the other."""
    short_a, short_b = (c.model_copy(update={"length": (1.0 - SHORTER) * c.length}) for c in (a, b))
    tilt = min(TILT * (a.radius + b.radius) / max(a.length, b.length), 0.5)
    return [
        partial(CapsuleOnCapsule3D, a=short_a, b=short_b, parallel_tilt=tilt),
        *(partial(CapsuleOnCapsule3D, a=b, b=end) for end in a.corners()),
        *(partial(CapsuleOnCapsule3D, a=short_a, b=end) for end in b.corners()),
    ]
