"""The record of a contact between a sphere and a mesh of triangles. Its kernels are in `mesh_contact3d.py`."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated, Any, ClassVar, Literal, cast

import numpy as np
from pydantic import Field, model_validator

from ..elements.base import Numbering, Row
from ..model.base import NonNegative
from ..model.markers import Marker3D
from ..model.signals import Signal
from .contact3d import Contact3D, Sphere3D
from .cornered3d import Box3D, ConvexPolyhedron3D
from .hull_faces import faces_of
from .mesh3d import TriangleMesh3D
from .mesh_contact3d import gripping_mesh3d_kernel, mesh3d_kernel, rubbing_mesh3d_kernel
from .mesh_nearest3d import STRIDE, table_of
from .mesh_parts import Points, parts_of
from .moving_point3d import ON_MESH
from .moving_surface import Numbers
from .pair_table import Make, touching


def mesh_parts(mesh: TriangleMesh3D) -> tuple[tuple[int, ...], ...]:
    """Numbers of the triangles of each part of a mesh that a sphere touches at one place; of a convex one all."""
    return parts_of(mesh.vertices, mesh.faces)


class SphereOnMesh3D(Contact3D):
    """Contact of a sphere with a part of a mesh: gap = distance of its centre from the nearest point - radius,
    less the rounding of the mesh.

    The part is a convex piece of the surface, over whose faces, edges and corners the sphere rolls without a jump. A
    convex mesh is one part; of another mesh each part has a contact of its own: `contacts_between` and
    `ContactGroup3D` make them. In a hollow the sphere touches several. By a force law a sphere may sink into a part
    by less than its radius: with its centre behind it, it would be beside another side of the body.

    Raises
    ------
    ModelError : for a point, which has no direction at an edge; for a part that the mesh has not.
    """

    type: Literal["SphereOnMesh3D"] = "SphereOnMesh3D"
    kernel: ClassVar[Any] = mesh3d_kernel
    rubbing_kernel: ClassVar[Any] = rubbing_mesh3d_kernel
    gripping_kernel: ClassVar[Any] = gripping_mesh3d_kernel
    kind: ClassVar[int] = ON_MESH

    mesh: TriangleMesh3D
    """The mesh."""
    sphere: Sphere3D
    """The sphere."""
    part: Annotated[int, Field(ge=0)] = 0
    """Number of the part of the mesh, in the order of its triangles."""
    rounding: NonNegative = 0.0
    """By which the mesh is thicker all round, with round edges and corners, m."""

    @model_validator(mode="after")
    def _check_shapes(self) -> "SphereOnMesh3D":
        if not self.sphere.radius + self.rounding > 0.0:
            raise ValueError(
                f"contact '{self.name}' is of a point with a mesh, at whose edges it has no normal: give the "
                "sphere a radius, or the mesh a rounding"
            )
        count = len(mesh_parts(self.mesh))
        if self.part >= count:
            raise ValueError(
                f"contact '{self.name}' is with part {self.part} of a mesh that has {count}, numbered from 0: take "
                "contacts_between or a ContactGroup3D, which make a contact for each"
            )
        return self

    def lengths(self) -> Sequence[float]:
        return (self.sphere.radius, self._reach())

    def extent(self) -> float:
        return self.sphere.radius + self.rounding

    def markers(self) -> Sequence[Marker3D]:
        return (self.mesh.marker, self.sphere.marker)

    def row(self, numbering: Numbering) -> Row:
        marker, parts = self.mesh.marker, mesh_parts(self.mesh)
        placed = np.array(marker.point) + np.array(self.mesh.vertices) @ marker.axes().T
        table = table_of(cast(Points, tuple(map(tuple, placed.tolist()))), self.mesh.faces, parts[self.part])
        first = numbering.signal(cast(Signal, Numbers(table)))
        row = self._row_of(
            numbering, marker, self.sphere.marker, self.rounding, self.sphere.radius, extents=(self._reach(), 0.0)
        )
        return Row(row.parameters, row.coordinates, (*row.extra, first, len(table) // STRIDE, int(len(parts) > 1)))

    def _reach(self) -> float:
        """How far a corner of the mesh is from its marker, m."""
        return float(np.linalg.norm(np.array(self.mesh.vertices), axis=1).max())


@touching(Sphere3D, TriangleMesh3D)
def _parts_of_mesh(sphere: Sphere3D, mesh: TriangleMesh3D) -> Sequence[Make]:
    return [partial(SphereOnMesh3D, mesh=mesh, part=k, sphere=sphere) for k in range(len(mesh_parts(mesh)))]


@touching(Sphere3D, (Box3D, ConvexPolyhedron3D))
def on_faces(sphere: Sphere3D, shape: Box3D | ConvexPolyhedron3D) -> Sequence[Make]:
    """Of a sphere with the faces of a shape."""
    return [partial(SphereOnMesh3D, mesh=faces_of(shape), rounding=shape.rounding(), sphere=sphere)]
