"""The records of contacts with an ANCF cable in space. Their kernels are in `cable_contact3d.py`."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated, Any, ClassVar, Literal, cast

from pydantic import Field, model_validator

from ..elements.base import BodyElement, Numbering, Row
from ..elements.cable3d import Cable3D
from ..elements.cable_kernel3d import NODAL_IN_SPACE
from ..elements.cable_shape import weights
from ..elements.material_point3d import MaterialPoint3D
from ..elements.named_body import body_named
from ..model.base import Name, NonNegative
from ..model.markers import Marker3D
from .bristle3d import bristle_cable3d_kernel
from .cable_contact3d import cable3d_contact_kernel, gripping_cable3d_kernel, rubbing_cable3d_kernel
from .cable_foot3d import FOOT_VECTORS, FOOT_WIDTH
from .contact3d import Contact3D, HalfSpace3D, Sphere3D
from .moving_point3d import ON_CABLE, POINT_OF_CABLE
from .pair_table import Make, touching
from .shape import Shape3D


class CableLine3D(Shape3D):
    """A cable as a shape of a `ContactGroup3D`: spheres touch it anywhere, half-spaces by evenly spaced points."""

    type: Literal["CableLine3D"] = "CableLine3D"
    cable: Name
    """Name of the Cable3D."""
    thickness: NonNegative = 0.0
    """Distance of the cable's surface from its axis, m."""
    points: Annotated[int, Field(ge=2)]
    """That touch half-spaces, from end to end. Two an element and one more are its nodes and the middles between."""

    @property
    def places(self) -> tuple[float, ...]:
        """Where they are, in parts of the cable's length."""
        return tuple(k / (self.points - 1) for k in range(self.points))


class CableContact3D(Contact3D):
    """Base of contacts with a cable: it is the second shape, and friction acts on its axis."""

    kernel: ClassVar[Any] = cable3d_contact_kernel
    rubbing_kernel: ClassVar[Any] = rubbing_cable3d_kernel
    gripping_kernel: ClassVar[Any] = gripping_cable3d_kernel
    bristle_kernel: ClassVar[Any] = bristle_cable3d_kernel
    width: ClassVar[int] = FOOT_WIDTH

    cable: Name
    """Name of the Cable3D."""
    thickness: NonNegative = 0.0
    """Distance of the cable's surface from its axis, m."""

    @model_validator(mode="after")
    def _has_no_torsion(self) -> "CableContact3D":
        if self.turning is not None:
            raise ValueError(
                f"contact '{self.name}' has friction against turning, but a cable has no torsion and cannot be turned "
                "about its axis: leave out `turning`"
            )
        return self

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        """Refuse what is no cable."""
        body_named(self.name, "a contact", self.cable, Cable3D, bodies)

    def acts_on(self) -> frozenset[str]:
        return super().acts_on() | {self.cable}

    def lengths(self) -> Sequence[float]:
        return (*super().lengths(), self.thickness)

    def _row_on(
        self, numbering: Numbering, marker: Marker3D, radius: float, element: int, at: Sequence[float],
        pieces: tuple[int, int],
    ) -> Row:  # fmt: skip
        """Row of an element of the cable with what is about a marker; at : weights of its nodes' vectors in the point
        that touches; pieces : which element this is of how many."""
        cable, own = cast(Cable3D, numbering.bodies[self.cable]), numbering.coordinates(self.cable)
        row = self._row_of(numbering, marker, Marker3D(), radius, self.thickness)
        return Row(
            (*row.parameters, *at, cable.length / cable.elements),
            (*numbering.frame(marker), *own[6 * element : 6 * element + NODAL_IN_SPACE]), (*row.extra, *pieces),
        )  # fmt: skip


class SphereOnCable3D(CableContact3D):
    """Contact of a sphere (or point) with a cable anywhere along it: gap = distance from its axis - radii.

    The place of contact moves from element to element without a jump. One place of contact: a sphere that touches the
    cable twice, in a bend narrower than itself, is not covered. Friction acts on the cable's axis.

    Raises
    ------
    ModelError : for a point on a cable without thickness; for a sphere on a point of the cable itself.
    """

    type: Literal["SphereOnCable3D"] = "SphereOnCable3D"
    kind: ClassVar[int] = ON_CABLE

    sphere: Sphere3D
    """The sphere."""

    @model_validator(mode="after")
    def _check_shapes(self) -> "SphereOnCable3D":
        if not self.sphere.radius + self.thickness > 0.0:
            raise ValueError(
                f"contact '{self.name}': the sphere's radius and the cable's thickness are both 0, and a point would "
                "pass a line unseen: give one of them a size"
            )
        return self

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        """Refuse what is no cable, and its own points."""
        super().check_in(bodies)
        on = bodies.get(self.sphere.marker.body)
        if isinstance(on, MaterialPoint3D) and on.body == self.cable:
            raise ValueError(
                f"contact '{self.name}': its sphere is on '{on.name}', a point of '{self.cable}' itself: the two would "
                "touch for ever; give the sphere another body"
            )

    def extent(self) -> float:
        return self.sphere.radius + self.thickness

    def markers(self) -> Sequence[Marker3D]:
        return (self.sphere.marker,)

    def rows(self, numbering: Numbering) -> Sequence[Row]:
        """One row an element of the cable."""
        count, none = cast(Cable3D, numbering.bodies[self.cable]).elements, (0.0,) * FOOT_VECTORS
        return [
            self._row_on(numbering, self.sphere.marker, self.sphere.radius, k, none, (k, count)) for k in range(count)
        ]


class CableOnHalfSpace3D(CableContact3D):
    """Contact of a point of a cable with a half-space: gap = height of its axis there over the plane - `thickness`.

    A cable that lies on a plane touches along itself, where it has no one lowest point: it takes contacts of as many
    points as should lie on it, at nodes and between them. `CableLine3D` of a `ContactGroup3D` makes them. Friction acts
    on the cable's axis.
    """

    type: Literal["CableOnHalfSpace3D"] = "CableOnHalfSpace3D"
    kind: ClassVar[int] = POINT_OF_CABLE

    plane: HalfSpace3D
    """The half-space."""
    place: Annotated[float, Field(ge=0.0, le=1.0)]
    """Where the point is along the undeformed cable, in parts of its length, dimensionless: from 0 to 1."""

    def markers(self) -> Sequence[Marker3D]:
        return (self.plane.marker,)

    def row(self, numbering: Numbering) -> Row:
        cable = cast(Cable3D, numbering.bodies[self.cable])
        element, x = cable.find(self.place * cable.length)
        at = weights(x, cable.length / cable.elements, 0).tolist()
        return self._row_on(numbering, self.plane.marker, 0.0, element, at, (0, 1))


@touching(CableLine3D, Sphere3D)
def _sphere_on_line(line: CableLine3D, sphere: Sphere3D) -> Sequence[Make]:
    return [partial(SphereOnCable3D, cable=line.cable, thickness=line.thickness, sphere=sphere)]


@touching(HalfSpace3D, CableLine3D)
def _points_on_plane(plane: HalfSpace3D, line: CableLine3D) -> Sequence[Make]:
    fields = {"plane": plane, "cable": line.cable, "thickness": line.thickness}
    return [partial(CableOnHalfSpace3D, **fields, place=place) for place in line.places]
