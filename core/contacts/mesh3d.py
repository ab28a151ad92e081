"""Bodies of triangles: read from files of meshes, checked, with mass and inertia; they touch half-spaces."""

from collections import Counter
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from ..errors import ModelError
from ..extras import require
from ..model.markers import Marker3D
from .cornered3d import Cornered3D

FLAT = 1e-12
"""Of the square of the mesh's size: a triangle of less area is none."""
FEWEST_FACES = 4


class TriangleMesh3D(Cornered3D):
    """A closed surface of triangles about the marker. It touches spheres, and half-spaces by the
    corners of its convex hull.

    The corners of each triangle go round counter-clockwise, seen from outside. `read_mesh` reads one from a file.
    """

    type: Literal["TriangleMesh3D"] = "TriangleMesh3D"
    vertices: tuple[tuple[float, float, float], ...]
    """From the marker's point along its axes, m."""
    faces: tuple[tuple[int, int, int], ...]
    """Numbers of the vertices of each triangle, from 0."""

    @model_validator(mode="after")
    def _is_a_closed_surface(self) -> "TriangleMesh3D":
        points, faces = np.array(self.vertices), np.array(self.faces)
        if len(self.faces) < FEWEST_FACES:
            raise ValueError(f"{len(self.faces)} triangles enclose nothing: a mesh has {FEWEST_FACES} or more")
        if faces.min() < 0 or faces.max() >= len(points):
            raise ValueError(
                f"the mesh has {len(points)} vertices, numbered from 0, but a triangle names vertex "
                f"{faces.max() if faces.max() >= len(points) else faces.min()}"
            )
        corners = points[faces]
        area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        if area.min() <= FLAT * float(np.ptp(points, axis=0).max()) ** 2:
            raise ValueError(f"triangle {int(area.argmin())} of the mesh has no area: leave it out, merge its vertices")
        self._check_edges()
        if self.volume() <= 0.0:
            raise ValueError(
                "the normals of the mesh point inwards (its triangles enclose "
                f"{self.volume():g} m^3): turn all triangles round, (a, b, c) to (a, c, b)"
            )
        return self

    def _check_edges(self) -> None:
        """Each edge belongs to two triangles, which go along it in opposite directions."""
        edges = Counter(edge for a, b, c in self.faces for edge in ((a, b), (b, c), (c, a)))
        twice = next((edge for edge, count in edges.items() if count > 1), None)
        if twice is not None:
            raise ValueError(
                f"two triangles of the mesh go along the edge from vertex {twice[0]} to {twice[1]} in the same "
                "direction: the normal of one of them is inverted, or three triangles meet there; turn it round"
            )
        alone = [(a, b) for a, b in edges if (b, a) not in edges]
        if alone:
            raise ValueError(
                f"the mesh has holes: {len(alone)} edges belong to one triangle alone, the first from vertex "
                f"{alone[0][0]} to {alone[0][1]}; close them, and merge vertices at the same place"
            )

    def volume(self) -> float:
        """m^3; negative where normals point inwards."""
        return float(np.linalg.det(np.array(self.vertices)[np.array(self.faces)]).sum() / 6.0)

    def solid(self, density: float) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
        """Mass (kg), centre of mass (3,) from the marker along its axes (m), and inertia tensor (3, 3) about the centre
        (kg m^2) of the body that it encloses; density in kg/m^3.

        Each triangle makes a tetrahedron with the marker's point; the second moments of a tetrahedron 0, a, b, c of
        volume V are V/20 (s s^T + a a^T + b b^T + c c^T), s = a + b + c.
        """
        corners = np.array(self.vertices)[np.array(self.faces)]
        parts = np.linalg.det(corners) / 6.0
        sums = corners.sum(axis=1)
        volume = parts.sum()
        centre = (parts[:, None] * sums).sum(axis=0) / (4.0 * volume)
        moments = np.einsum("k,ki,kj->ij", parts, sums, sums) + np.einsum("k,kci,kcj->ij", parts, corners, corners)
        about = moments / 20.0 - volume * np.outer(centre, centre)
        return density * volume, centre, density * (np.trace(about) * np.eye(3) - about)

    def places(self) -> NDArray[np.float64]:
        from scipy.spatial import ConvexHull  # scipy takes long to import, and few models need it

        points = np.array(self.vertices)
        return np.asarray(points[np.sort(ConvexHull(points).vertices)])


def read_mesh(file: str | Path, marker: Marker3D, scale: float = 1.0) -> TriangleMesh3D:
    """A mesh from a file of triangles (STL, OBJ, PLY, OFF, glTF), by trimesh.

    Parameters
    ----------
    marker : where the origin and axes of the file are on the body.
    scale : length of the file's unit, m: 0.001 for millimetres.

    Raises
    ------
    ModelError : if it cannot be read, has holes or inverted normals.
    MissingExtraError : without trimesh.
    """
    require("reading a mesh", "mesh", trimesh="")
    import trimesh

    try:
        read: Any = trimesh.load(str(file), force="mesh")
    except Exception as error:  # trimesh raises what its readers raise
        raise ModelError(f"{file} cannot be read as a mesh: {error}") from error
    if len(getattr(read, "faces", ())) == 0:
        raise ModelError(f"{file} has no triangles: export the surface of the body, not points or curves")
    # files such as STL write each corner once for each triangle
    read.merge_vertices()
    vertices = [(float(x), float(y), float(z)) for x, y, z in scale * np.asarray(read.vertices)]
    return TriangleMesh3D(marker=marker, vertices=tuple(vertices), faces=tuple(map(tuple, read.faces.tolist())))
