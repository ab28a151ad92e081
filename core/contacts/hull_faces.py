"""The surfaces of boxes and convex polyhedra as triangles, for contacts of what touches them by its side."""

from functools import lru_cache

import numpy as np

from ..errors import ModelError
from .cornered3d import Box3D, ConvexPolyhedron3D
from .mesh3d import TriangleMesh3D

QUADS = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
"""Corners of the faces of a box as `Box3D.places` has them, counter-clockwise from outside."""


@lru_cache(maxsize=1024)
def faces_of(shape: Box3D | ConvexPolyhedron3D) -> TriangleMesh3D:
    """Its surface, without rounding.

    Raises
    ------
    ModelError : if its vertices lie in one plane: it encloses nothing.
    """
    points = shape.places()
    if isinstance(shape, Box3D):
        faces = [face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))]
    else:
        faces = _hull(shape, points)
    vertices = tuple((float(x), float(y), float(z)) for x, y, z in points)
    return TriangleMesh3D(marker=shape.marker, vertices=vertices, faces=tuple(faces))


def _hull(shape: ConvexPolyhedron3D, points: np.ndarray) -> list[tuple[int, int, int]]:
    """Triangles of the convex hull, counter-clockwise from outside."""
    if np.linalg.matrix_rank(points - points[0], tol=1e-9 * float(np.ptp(points, axis=0).max())) < points.shape[1]:
        raise ModelError(
            f"the {len(points)} vertices of a ConvexPolyhedron3D on '{shape.marker.body}' lie in one plane: it has no "
            "sides that spheres touch; give it a thickness, or take a capsule in place of a rod"
        )
    from scipy.spatial import ConvexHull  # scipy takes long to import, and few models need it

    hull, faces = ConvexHull(points), []
    for (a, b, c), plane in zip(hull.simplices.tolist(), hull.equations, strict=True):
        outwards = np.cross(points[b] - points[a], points[c] - points[a]) @ plane[:3] > 0.0
        faces.append((a, b, c) if outwards else (a, c, b))
    return faces
