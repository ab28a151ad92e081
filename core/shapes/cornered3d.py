"""Shapes in space that touch half-spaces by corners: boxes, convex polyhedra, capsules, cylinders."""

from itertools import product
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from ..model.base import NonNegative, Positive, Record
from ..model.markers import Marker3D
from .contact3d import Sphere3D
from .rounds3d import Torus3D

FEWEST_VERTICES = 2
FEWEST_RIM_POINTS = 3


class Cornered3D(Record):
    """Base of what touches half-spaces by its corners: the convex hull of spheres of one radius, which may be 0."""

    marker: Marker3D
    """Its middle and axes."""

    def places(self) -> NDArray[np.float64]:
        """Places of the corners (corners, 3) from the marker's point along its axes, m."""
        raise NotImplementedError

    def rounding(self) -> float:
        """Radius of the spheres at the corners, m."""
        return 0.0

    def corners(self) -> tuple[Sphere3D, ...]:
        """Spheres at its corners; of radius 0 they are points."""
        found = []
        for place in np.array(self.marker.point) + self.places() @ self.marker.axes().T:
            x, y, z = place.tolist()
            found.append(Sphere3D(marker=Marker3D(body=self.marker.body, point=(x, y, z)), radius=self.rounding()))
        return tuple(found)


class Box3D(Cornered3D):
    """A box about the marker, its edges along the marker's axes. It touches half-spaces, by its corners."""

    type: Literal["Box3D"] = "Box3D"
    size: tuple[Positive, Positive, Positive]
    """Lengths of the edges along the marker's x, y and z axes, m."""

    def places(self) -> NDArray[np.float64]:
        return np.array(list(product((0.5, -0.5), repeat=3))) * np.array(self.size)


class ConvexPolyhedron3D(Cornered3D):
    """The convex hull of points. It touches half-spaces, by its corners; points within the hull touch nothing."""

    type: Literal["ConvexPolyhedron3D"] = "ConvexPolyhedron3D"
    vertices: tuple[tuple[float, float, float], ...]
    """From the marker's point along its axes, m."""
    radius: NonNegative = 0.0
    """By which corners and edges are rounded, outside the hull of the vertices, m."""

    @field_validator("vertices")
    @classmethod
    def _many_enough(cls, vertices: tuple[tuple[float, float, float], ...]) -> tuple[tuple[float, float, float], ...]:
        if len(vertices) < FEWEST_VERTICES:
            raise ValueError(f"{len(vertices)} vertices are no polyhedron: give all its corners, or take a Sphere3D")
        if len(set(vertices)) < len(vertices):
            twice = next(vertex for vertex in vertices if vertices.count(vertex) > 1)
            raise ValueError(f"the vertex {twice} is given twice: its contacts would say the same; leave one out")
        return vertices

    def places(self) -> NDArray[np.float64]:
        points = np.array(self.vertices)
        span = np.linalg.matrix_rank(points - points[0], tol=1e-9 * np.ptp(points, axis=0).max())
        if span < points.shape[1]:
            return points  # a plate or a rod has no hull in space
        from scipy.spatial import ConvexHull  # scipy takes long to import, and few models need it

        return np.asarray(points[np.sort(ConvexHull(points).vertices)])

    def rounding(self) -> float:
        return self.radius


class Capsule3D(Cornered3D):
    """A cylinder with a hemisphere at each end, about the marker, its axis along the marker's z axis. It touches
    half-spaces, by its ends."""

    type: Literal["Capsule3D"] = "Capsule3D"
    length: Positive
    """Of the cylinder, without the hemispheres, m."""
    radius: Positive
    """m."""

    def places(self) -> NDArray[np.float64]:
        return np.array([[0.0, 0.0, 0.5 * self.length], [0.0, 0.0, -0.5 * self.length]])

    def rounding(self) -> float:
        return self.radius


class Cylinder3D(Cornered3D):
    """A cylinder about the marker, its axis along the marker's z axis. It touches half-spaces, by its rims.

    The point of a rim that touches runs round without bound as an end comes to lie flat, where there is no one point.
    What lies or stands on its ends takes `rim_points` in place of smooth rims: it touches by these.
    """

    type: Literal["Cylinder3D"] = "Cylinder3D"
    radius: Positive
    """m."""
    length: Positive
    """m."""
    rim_points: Annotated[int, Field(ge=0)] = 0
    """Points of each rim that touch, evenly round; 0: smooth rims, for cylinders that roll."""

    @field_validator("rim_points")
    @classmethod
    def _stands(cls, count: int) -> int:
        if 0 < count < FEWEST_RIM_POINTS:
            raise ValueError(f"{count} points of a rim do not hold a cylinder: give {FEWEST_RIM_POINTS} or more, or 0")
        return count

    def places(self) -> NDArray[np.float64]:
        angles = 2.0 * np.pi * np.arange(self.rim_points) / max(self.rim_points, 1)
        rim = [(self.radius * np.cos(a), self.radius * np.sin(a)) for a in angles]
        return np.array([(x, y, z) for z in (0.5 * self.length, -0.5 * self.length) for x, y in rim]).reshape(-1, 3)

    def rims(self) -> tuple[Torus3D, ...]:
        """Its smooth rims; none if it touches by points."""
        if self.rim_points > 0:
            return ()
        found = []
        for side in (0.5, -0.5):
            x, y, z = (np.array(self.marker.point) + side * self.length * self.marker.axes()[:, 2]).tolist()
            marker = self.marker.model_copy(update={"point": (x, y, z)})
            found.append(Torus3D(marker=marker, radius=self.radius))
        return tuple(found)
