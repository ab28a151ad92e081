"""Shapes in space that touch half-spaces by corners: boxes, convex polyhedra, capsules, cylinders."""

from collections.abc import Sequence
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator, model_validator

from ..model.base import NonNegative, Positive
from ..model.markers import Marker3D
from .contact3d import Sphere3D
from .rings3d import RIM_POINTS, RimPoints, Torus3D, check_rim_points
from .shape import Shape3D
from .support3d import SmoothShape3D

FEWEST_VERTICES = 2


class Cornered3D(Shape3D):
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
    """A box about the marker, its edges along the marker's axes. It touches spheres, boxes, polyhedra and capsules, and
    half-spaces by its corners."""

    type: Literal["Box3D"] = "Box3D"
    size: tuple[Positive, Positive, Positive]
    """Lengths of the edges along the marker's x, y and z axes, m."""
    edge_radius: NonNegative = 0.0
    """Radius by which corners and edges are rounded, within the size, m; 0: sharp. Where two shapes without any radius
    touch, boxes are rounded by a thousandth of their smallest edge."""

    @model_validator(mode="after")
    def _is_round_within(self) -> "Box3D":
        if not 2.0 * self.edge_radius < min(self.size):
            raise ValueError(
                f"an edge_radius of {self.edge_radius:g} m leaves no face of a box whose smallest edge is "
                f"{min(self.size):g} m: make it less than {0.5 * min(self.size):g} m, or take a Sphere3D or Capsule3D"
            )
        return self

    def places(self) -> NDArray[np.float64]:
        return np.array(list(product((0.5, -0.5), repeat=3))) * (np.array(self.size) - 2.0 * self.edge_radius)

    def rounding(self) -> float:
        return self.edge_radius


class ConvexPolyhedron3D(Cornered3D):
    """The convex hull of points. It touches spheres, boxes, polyhedra and capsules, and half-spaces by its corners;
    points within it touch nothing."""

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
    spheres, capsules, boxes and polyhedra, and half-spaces by its ends."""

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
    """A cylinder about the marker, its axis along the marker's z axis. It touches half-spaces, by
    its rims, and spheres.

    It rolls on its rims. Where one of its ends lies flatter than 2.9 degrees, points of the rim carry it: these strike
    in turns, and so it comes to rest.
    """

    type: Literal["Cylinder3D"] = "Cylinder3D"
    radius: Positive
    """m."""
    length: Positive
    """m."""
    rim_points: RimPoints = RIM_POINTS
    """Points of each rim that carry where it lies flat, evenly round; 0: rims alone, at every tilt, for cylinders that
    roll: the point that touches runs round without bound as an end comes to lie flat."""

    @field_validator("rim_points")
    @classmethod
    def _stands(cls, count: int) -> int:
        return check_rim_points(count)

    def places(self) -> NDArray[np.float64]:
        """Points of its rims from the marker's point along its axes, m."""
        angles = 2.0 * np.pi * np.arange(self.rim_points) / max(self.rim_points, 1)
        rim, half = np.column_stack((np.cos(angles), np.sin(angles))), 0.5 * self.length
        ends = [np.column_stack((self.radius * rim, np.full(self.rim_points, z))) for z in (half, -half)]
        return np.concatenate(ends)

    def rims(self) -> tuple[Torus3D, Torus3D]:
        """Its rims, as disks at its ends."""
        made = []
        for side in (0.5, -0.5):
            x, y, z = (np.array(self.marker.point) + side * self.length * self.marker.axes()[:, 2]).tolist()
            marker = self.marker.model_copy(update={"point": (x, y, z)})
            made.append(Torus3D(marker=marker, radius=self.radius, rim_points=self.rim_points))
        return made[0], made[1]

    def touching(self) -> Sequence[SmoothShape3D | Sphere3D]:
        """What of it touches a half-space: its rims, and their points."""
        parts = [rim.touching() for rim in self.rims()]
        return (*(part[0] for part in parts), *(point for part in parts for point in part[1:]))
