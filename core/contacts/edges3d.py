"""Contacts of boxes, convex polyhedra and capsules with each other: corners on faces, edges across edges.

The shapes are hulls of spheres, whose radii add up to more than 0. The distance of two of them is the least one of the
corners of each from the hull of the other's, and of the edges of both from each other, less the radii. All of these are
smooth where shapes touch, since the hulls themselves stay the radii apart.
"""

from collections.abc import Sequence
from functools import lru_cache, partial
from typing import Annotated, Any, ClassVar, Literal, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from ..elements.base import Numbering, Row
from ..elements.spatial_body import start_of_marker
from ..errors import ModelError
from ..laws import ForceLaw
from ..model.markers import Marker3D
from ..model.signals import Signal
from ..model.words import an
from .contact3d import Contact3D
from .cornered3d import Box3D, Capsule3D, ConvexPolyhedron3D
from .edge_parts import Edged3D, edge_sorts, edges_of
from .edges_nearest3d import EDGES
from .hull_faces import faces_of
from .mesh_contact3d import gripping_mesh3d_kernel, mesh3d_kernel, rubbing_mesh3d_kernel
from .mesh_parts import normals_of
from .moving_point3d import ON_MESH
from .moving_surface import Numbers
from .on_mesh3d import on_faces
from .overlap3d import apart
from .pair_table import Make, touching
from .round3d import CapsuleOnCapsule3D

ROUND = 1e-3
"""Of its smallest edge: radius of the edges of a box that is given none, where two sharp shapes touch."""
SHORTER = 5e-4
"""Of the sum of the radii: by so much edges are shorter at both ends, where corners touch: no two contacts say the
same. There the gap is less than the distance by the square of it over twice the radii at most, 1.3e-7 of their sum."""
TILT = 0.01
"""Of the sum of the radii over the longest edge: sine of the angle below which corners carry in place of edges."""

EdgedShape3D = Annotated[Box3D | ConvexPolyhedron3D | Capsule3D, Field(discriminator="type")]


class EdgesOnEdges3D(Contact3D):
    """Contact of edges of one shape with edges of another: gap = distance of the nearest two - both radii.

    Edges of one sort have no face in common, so that one pair of them touches at a time. Corners have contacts of their
    own: `contacts_between` and `ContactGroup3D` make all of them. Edges that are nearly parallel draw back, by up to
    0.002 of the sum of the radii, where corners touch.

    By a force law edges may sink into each other by less than both radii: at that depth they have no normal.

    Raises
    ------
    ModelError : for shapes without radius, a sort that a shape has not, and shapes that overlap at the start by more
        than their radii.
    """

    type: Literal["EdgesOnEdges3D"] = "EdgesOnEdges3D"
    kernel: ClassVar[Any] = mesh3d_kernel
    rubbing_kernel: ClassVar[Any] = rubbing_mesh3d_kernel
    gripping_kernel: ClassVar[Any] = gripping_mesh3d_kernel
    kind: ClassVar[int] = ON_MESH

    a: EdgedShape3D
    """The first shape."""
    b: EdgedShape3D
    """The second one."""
    sort_a: Annotated[int, Field(ge=0)] = 0
    """Which edges of the first shape."""
    sort_b: Annotated[int, Field(ge=0)] = 0
    """Which edges of the second one."""

    @model_validator(mode="after")
    def _check_shapes(self) -> "EdgesOnEdges3D":
        if not self.a.rounding() + self.b.rounding() > 0.0:
            raise ValueError(
                f"contact '{self.name}' is of sharp edges, which have no normal where they meet: give one of the "
                "shapes a radius (`edge_radius` of a box, `radius` of a polyhedron)"
            )
        for shape, sort in ((self.a, self.sort_a), (self.b, self.sort_b)):
            count = len(edge_sorts(shape))
            if sort >= count:
                raise ValueError(
                    f"contact '{self.name}' is of edges of sort {sort} of {an(type(shape).__name__)} that has {count} "
                    "sorts, numbered from 0: take contacts_between or a ContactGroup3D, which make a contact for each"
                )
        return self

    def lengths(self) -> Sequence[float]:
        return (self.a.rounding(), self.b.rounding(), _reach(self.a), _reach(self.b))

    def extent(self) -> float:
        return self.a.rounding() + self.b.rounding()

    def markers(self) -> Sequence[Marker3D]:
        return (self.a.marker, self.b.marker)

    def row(self, numbering: Numbering) -> Row:
        self._check_start(numbering)
        radii = self.extent()
        edges = [
            _edges_on_body(shape, edge_sorts(shape)[sort], SHORTER * radii)
            for shape, sort in ((self.a, self.sort_a), (self.b, self.sort_b))
        ]
        longest = max(2.0 * float(table[:, -1].max()) for table in edges)
        tables = [*edges, *(_faces_on_body(shape) for shape in (self.a, self.b))]
        numbers = [float(len(table)) for table in tables] + [float(x) for table in tables for x in table.ravel()]
        first = numbering.signal(cast(Signal, Numbers(numbers)))
        row = self._row_of(
            numbering, self.a.marker, self.b.marker, self.a.rounding(), self.b.rounding(),
            extents=(_reach(self.a), _reach(self.b)), tilt=min(TILT * radii / max(longest, radii), 0.5),
        )  # fmt: skip
        return Row(row.parameters, row.coordinates, (*row.extra, first, 0, EDGES))

    def _check_start(self, numbering: Numbering) -> None:
        places = []
        for shape in (self.a, self.b):
            point, axes = start_of_marker(shape.marker, numbering.bodies)
            places.append(point + shape.places() @ axes.T)
        if _apart(self.a, self.b, places[0].tobytes(), places[1].tobytes()) <= 0.0:
            raise ModelError(
                f"contact '{self.name}': the {type(self.a).__name__} on '{self.a.marker.body}' and the "
                f"{type(self.b).__name__} on '{self.b.marker.body}' overlap at the start by more than their edges are "
                "rounded: nothing says which way they come apart. Move one of the bodies, or leave the pair out "
                "(`except_bodies` of a group)"
            )


@lru_cache(maxsize=256)
def _apart(a: Edged3D, b: Edged3D, places_a: bytes, places_b: bytes) -> float:
    return apart(a, b, np.frombuffer(places_a).reshape(-1, 3), np.frombuffer(places_b).reshape(-1, 3))


def _reach(shape: Edged3D) -> float:
    """How far a place is from its marker, m."""
    return float(np.linalg.norm(shape.places(), axis=1).max())


def _faces_on_body(shape: Edged3D) -> NDArray[np.float64]:
    """Outward normal and place along it of each face (faces, 4) in the frame of the body; of a capsule none."""
    if isinstance(shape, Capsule3D):
        return np.empty((0, 4))
    mesh, axes = faces_of(shape), shape.marker.axes()
    points = np.array(shape.marker.point) + np.array(mesh.vertices) @ axes.T
    triangles = np.array(mesh.faces)
    normals = normals_of(points, triangles)
    places = np.sum(normals * points[triangles[:, 0]], axis=1)
    _, first = np.unique(np.round(normals, 9), axis=0, return_index=True)
    return np.column_stack((normals, places))[np.sort(first)]


def _edges_on_body(shape: Edged3D, numbers: Sequence[int], shorter: float) -> NDArray[np.float64]:
    """Middle, direction and half the length of edges (numbers, 7) in the frame of the body, without `shorter` at both
    ends."""
    places = np.array(shape.marker.point) + shape.places() @ shape.marker.axes().T
    ends = np.array([[places[i] for i in edges_of(shape)[k]] for k in numbers])
    ways = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(ways, axis=1, keepdims=True)
    return np.hstack([ends.mean(axis=1), ways / length, np.maximum(0.5 * length - shorter, 0.0)])


@touching((Box3D, ConvexPolyhedron3D), (Box3D, ConvexPolyhedron3D, Capsule3D))
@touching(Capsule3D, (Box3D, ConvexPolyhedron3D))
def _corners_and_edges(a: Edged3D, b: Edged3D) -> Sequence[Make]:
    """Of two shapes of which one at least is no capsule.

    Raises
    ------
    ModelError : for two polyhedra without radius, and for one whose vertices lie in one plane.
    """
    made_round = not a.rounding() + b.rounding() > 0.0
    if made_round:
        a, b = _rounded(a), _rounded(b)
    if not a.rounding() + b.rounding() > 0.0:
        raise ModelError(
            f"the polyhedra on '{a.marker.body}' and '{b.marker.body}' have sharp edges, which have no normal where "
            "they meet: give one of them a `radius`, a thousandth of its size say, by which it is thicker all round"
        )
    found: list[Make] = []
    for one, other in ((a, b), (b, a)):
        if isinstance(other, Capsule3D):
            found += [partial(CapsuleOnCapsule3D, a=other, b=corner) for corner in one.corners()]
        else:
            found += [make for corner in one.corners() for make in on_faces(corner, other)]
    sorts = len(edge_sorts(a)), len(edge_sorts(b))
    return found + [
        partial(_across, made_round, a=a, b=b, sort_a=i, sort_b=j) for i in range(sorts[0]) for j in range(sorts[1])
    ]


def _rounded(shape: Edged3D) -> Edged3D:
    return shape.model_copy(update={"edge_radius": ROUND * min(shape.size)}) if isinstance(shape, Box3D) else shape


def _across(made_round: bool, **fields: Any) -> EdgesOnEdges3D:
    """The contact of edges of two shapes; made_round : shapes without any radius have been rounded for it alone.

    Raises
    ------
    ModelError : for a force law, if they have been.
    """
    if made_round and isinstance(fields["law"], ForceLaw):
        raise ModelError(
            f"contact '{fields['name']}' is of sharp shapes, which a {type(fields['law']).__name__} lets sink into "
            "each other: edges pass through one another where they sink in by more than both are rounded. Give one of "
            "them a radius that is larger (`edge_radius` of a box), or take a law such as NewtonImpact"
        )
    return EdgesOnEdges3D(**fields)
