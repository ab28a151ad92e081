"""Contacts in space: spheres and half-spaces, a law along the normal, and friction."""

import math
from collections.abc import Mapping, Sequence
from functools import cache, partial
from typing import Any, ClassVar, Literal, cast

import numpy as np
from pydantic import model_validator

from ..elements.base import BodyElement, Form, Numbering, Row
from ..elements.measure3d import DISTANCE, PLACE, columns_of, coordinates_of
from ..elements.turning_bodies import refuse_points
from ..laws.friction import CoulombFriction, LuGreFriction, TurningFriction
from ..model.base import Name, NonNegative, Vector3
from ..model.markers import Marker3D
from ..rounding import LEAST_DEFLECTION, STILL
from .bristle3d import BRISTLE_INDICES, bristle_sphere3d_kernel
from .coulomb3d import gripping_sphere3d_kernel
from .element import ContactElement
from .friction3d import rubbing_sphere3d_kernel
from .frictionless3d import sphere3d_kernel
from .moving_point3d import HOLLOW, ON_MESH, POINT_OF_CABLE, SEGMENTS, SUPPORT
from .normal3d import PAIR_SIZE
from .pair_table import Make, no_pair, pair, touching
from .shape import Shape3D
from .support3d import SUPPORT_NUMBERS
from .surface3d import FIRST_ATTITUDE, SECOND_ATTITUDE

_ALONG, _IN_SPACE = ("bristle_x", "bristle_y"), ("bristle_x", "bristle_y", "bristle_z")
BRISTLES = {
    PLACE: _ALONG, SUPPORT: _ALONG, POINT_OF_CABLE: _ALONG, DISTANCE: _IN_SPACE, HOLLOW: _IN_SPACE,
    SEGMENTS: _IN_SPACE, ON_MESH: _IN_SPACE,
}  # fmt: skip
"""Components of the bristles' deflection along the axes of the first marker, by the kind of the gap."""


class HalfSpace3D(Shape3D):
    """The half-space behind a plane through the marker; its outward normal is the marker's z axis: a half-space on the
    ground without attitude is a floor."""

    type: Literal["HalfSpace3D"] = "HalfSpace3D"
    marker: Marker3D = Marker3D()
    """On its surface; its z axis is the outward normal."""


class Sphere3D(Shape3D):
    """A sphere about the marker; radius 0 is a point."""

    type: Literal["Sphere3D"] = "Sphere3D"
    marker: Marker3D
    """Its centre."""
    radius: NonNegative = 0.0
    """m."""


@cache
def _entries(rows: int, columns: int) -> tuple[tuple[int, int], ...]:
    """All entries of a matrix; the same tuple for all contacts of a group."""
    return tuple((i, j) for i in range(rows) for j in range(columns))


class Contact3D(ContactElement):
    """Base of the contacts in space.

    Class attributes: `kernel` without friction, `rubbing_kernel` with a regularised law, `gripping_kernel` with
    Coulomb's, `bristle_kernel` with LuGre's; `kind`, the measure of both markers that the gap is, less the radii;
    `width`, the number of coordinates that it depends on.
    """

    symbol: ClassVar[str] = "shapes"

    kernel: ClassVar[Any] = sphere3d_kernel
    rubbing_kernel: ClassVar[Any] = rubbing_sphere3d_kernel
    gripping_kernel: ClassVar[Any] = gripping_sphere3d_kernel
    bristle_kernel: ClassVar[Any] = bristle_sphere3d_kernel
    kind: ClassVar[int]
    width: ClassVar[int] = PAIR_SIZE

    turning: TurningFriction | None = None
    """What resists rolling and spinning; left out: nothing."""
    surface_direction: Vector3 | None = None
    """Direction in which `surface_speed` goes, dimensionless, in the axes of the marker of the shape whose surface
    moves; of any length but zero. Its part along the normal pulls nothing."""
    surface_body: Name | None = None
    """Name of the body whose surface moves, or "ground"; left out: that of the first shape."""

    @property
    def resists_turning(self) -> bool:
        return self.turning is not None

    @model_validator(mode="after")
    def _slides_with_friction(self) -> "Contact3D":
        if self.turning is not None and self.friction is None:
            raise ValueError(
                f"contact '{self.name}' has friction against turning, but slides without any: give it `friction` too"
            )
        return self

    @model_validator(mode="after")
    def _friction_in_space(self) -> "Contact3D":
        if isinstance(self.friction, LuGreFriction) and type(self).kind not in BRISTLES:
            raise ValueError(
                f"contact '{self.name}' is a {type(self).__name__}, along which the bristles of LuGre friction are not "
                "carried: in space they are for all shapes on half-spaces, for spheres, capsules, boxes and polyhedra "
                "on each other, in spheres and on meshes; give it one of the other laws, such as BrownMcPhee"
            )
        if isinstance(self.friction, LuGreFriction) and self.turning is not None and self.turning.friction_radius > 0.0:
            raise ValueError(
                f"contact '{self.name}' has LuGre friction, whose bristles bend along the tangents and do not twist, "
                "and a friction_radius, which makes friction against sliding and spinning one: give `spinning` in its "
                "place, or one of the other laws, such as BrownMcPhee"
            )
        return self

    @model_validator(mode="after")
    def _surface_has_direction(self) -> "Contact3D":
        speed, direction = self.surface_speed, self.surface_direction
        if speed is None and (direction is not None or self.surface_body is not None):
            raise ValueError(f"contact '{self.name}' says what surface moves, but has no `surface_speed`: give it too")
        if speed is not None and (direction is None or not math.hypot(*direction) > 0.0):
            raise ValueError(
                f"contact '{self.name}' has a surface_speed and the surface_direction {direction}: in space it "
                "needs one of a length that is not zero, such as (1.0, 0.0, 0.0), in the axes of the marker"
            )
        if self.surface_body is not None and self.surface_body not in [m.body for m in self.markers()]:
            raise ValueError(
                f"contact '{self.name}' has no marker on '{self.surface_body}' whose surface could move: "
                f"surface_body is one of {[m.body for m in self.markers()]}"
            )
        return self

    def _surface_direction(self) -> tuple[float, int, Vector3]:
        bodies = [marker.body for marker in self.markers()]
        number = 0 if self.surface_body is None else bodies.index(self.surface_body)
        given = np.array(self.surface_direction, dtype=np.float64)
        x, y, z = cast(Marker3D, self.markers()[number]).axes() @ (given / np.linalg.norm(given))
        # what moves on the second shape moves the other way past the first one
        return (1.0, FIRST_ATTITUDE, (x, y, z)) if number == 0 else (-1.0, SECOND_ATTITUDE, (x, y, z))

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        super().check_in(bodies)
        if self.turning is not None:
            instead = "leave `turning` out, or use a RigidBody3D"
            refuse_points(self.name, self.markers(), bodies, instead)

    def spheres(self) -> Sequence[Sphere3D]:
        """The spheres among its shapes."""
        return tuple(shape for shape in self.shapes() if isinstance(shape, Sphere3D))

    def form(self) -> Form:
        """A contact with Coulomb friction has rows of both tangents behind that of the gap, with another law of
        friction one of the sliding speed."""
        kind, n = type(self), self.width
        if isinstance(self.friction, CoulombFriction):
            return Form(kind.gripping_kernel, 3, _entries(n, n), _entries(3, n), (1, 2))
        kernel, rows = (kind.kernel, 1) if self.friction is None else (kind.rubbing_kernel, 2)
        if isinstance(self.friction, LuGreFriction):
            kernel = kind.bristle_kernel
        size = n + len(self.internal_coordinates())
        return Form(kernel, rows, _entries(size, size), _entries(1, n))

    def internal_coordinates(self) -> Sequence[str]:
        return BRISTLES[type(self).kind] if isinstance(self.friction, LuGreFriction) else ()

    def rows(self, numbering: Numbering) -> Sequence[Row]:
        row = self.row(numbering)
        if not isinstance(self.friction, LuGreFriction):
            return (row,)
        more = (LEAST_DEFLECTION * numbering.length, self.friction.parameters()[-1])
        # spheres and meshes share a kernel, and its table of indices
        extra = (*row.extra, *(0,) * (BRISTLE_INDICES - len(row.extra)))
        return (Row((*row.parameters, *more), (*row.coordinates, *numbering.internal(self.name)), extra),)

    def lengths(self) -> Sequence[float]:
        return tuple(sphere.radius for sphere in self.spheres())

    def _row_of(
        self, numbering: Numbering, a: Marker3D, b: Marker3D, radius_a: float, radius_b: float, *,
        extents: tuple[float, float] = (0.0, 0.0), numbers: tuple[float, ...] = (0.0,) * SUPPORT_NUMBERS,
        address: int = 0, tilt: float = 0.0,
    ) -> Row:  # fmt: skip
        """Row of the markers a and b; extents : how far points of contact may be from them, m; numbers, address : of a
        smooth shape's formula; tilt : sine of the angle below which segments draw back."""
        law = self._law_columns(numbering)
        # small against all speeds that weight causes
        still = STILL * math.sqrt(numbering.length * (math.hypot(*numbering.gravity) or numbering.length))
        geometry = (float(self.kind), radius_a, radius_b, still, *extents, tilt)
        turning = (0.0, 0.0, 1.0, 0.0) if self.turning is None else self.turning.parameters()
        return Row(
            (*geometry, *law.parameters, *columns_of(a, b, numbering), *numbers, *turning),
            coordinates_of(a, b, numbering), (*law.extra, address),
        )  # fmt: skip


class SphereOnHalfSpace3D(Contact3D):
    """Contact of a sphere (or point) with a half-space: gap = height of the centre over the plane - radius."""

    type: Literal["SphereOnHalfSpace3D"] = "SphereOnHalfSpace3D"
    touch: ClassVar[str] = "half-space"
    kind: ClassVar[int] = PLACE

    plane: HalfSpace3D
    """The half-space."""
    sphere: Sphere3D
    """The sphere."""

    def row(self, numbering: Numbering) -> Row:
        return self._row_of(numbering, self.plane.marker, self.sphere.marker, 0.0, self.sphere.radius)

    def markers(self) -> Sequence[Marker3D]:
        return (self.plane.marker, self.sphere.marker)


class SphereOnSphere3D(Contact3D):
    """Contact of two spheres: gap = distance of the centres - sum of the radii."""

    type: Literal["SphereOnSphere3D"] = "SphereOnSphere3D"
    touch: ClassVar[str] = "spheres"
    kind: ClassVar[int] = DISTANCE

    a: Sphere3D
    """The first sphere."""
    b: Sphere3D
    """The second sphere."""

    @model_validator(mode="after")
    def _not_two_points(self) -> "SphereOnSphere3D":
        if not self.a.radius + self.b.radius > 0.0:
            raise ValueError(
                f"contact '{self.name}' is between two points, whose distance is never negative: give one a radius"
            )
        return self

    def extent(self) -> float:
        return self.a.radius + self.b.radius

    def row(self, numbering: Numbering) -> Row:
        return self._row_of(numbering, self.a.marker, self.b.marker, self.a.radius, self.b.radius)

    def markers(self) -> Sequence[Marker3D]:
        return (self.a.marker, self.b.marker)


pair(SphereOnHalfSpace3D, plane=HalfSpace3D, sphere=Sphere3D)
no_pair(HalfSpace3D, HalfSpace3D, "both reach to infinity; take a box for the one that moves")


@touching(Sphere3D, Sphere3D)
def _two_spheres(a: Sphere3D, b: Sphere3D) -> Sequence[Make]:
    """Two points never touch."""
    return [partial(SphereOnSphere3D, a=a, b=b)] if a.radius + b.radius > 0.0 else []
