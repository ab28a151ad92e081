"""The record of a planar cable of gradient-deficient cubic ANCF elements. Its kernel is in `cable_kernel.py`."""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from ..model.base import NonNegative, Vector2
from .base import Numbering, Row
from .cable_body import SLOPE_SCALE, CableBody
from .cable_kernel import MOST_POINTS, NODAL, cable2d_kernel
from .cable_shape import POINTS, gauss_places, weights
from .coordinate import Coordinate
from .flexible_body import FlexibleBody, PointShape, Section, along_axis

FULL_PATTERN = tuple((i, j) for i in range(NODAL) for j in range(NODAL))


class Cable2D(CableBody, FlexibleBody):
    """A cable or beam (shear-rigid, large deformation) of `elements` equal ANCF elements in a row.

    Node k = 0 ... elements has the absolute coordinates x{k}, y{k} and the slope dr/ds, slope_x{k} and slope_y{k}, s
    the length along the undeformed body. Strains: axial |r'| - 1 and material curvature (r' x r'')/|r'|^2. Channels are
    NAME.x3, .vx3, .ax3, ..., NAME.slope_x3, .d_slope_x3, .dd_slope_x3; those of points between the nodes come with a
    MaterialPoint2D.

    Raises
    ------
    ModelError : for a shape with another number of nodes, or one with a slope of zero.
    """

    type: Literal["Cable2D"] = "Cable2D"
    kernel: ClassVar[Any] = cable2d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL_PATTERN

    bending_damping: NonNegative = 0.0
    """Bending moment per rate of the curvature, N m^2 s."""
    reference_strain: float = 0.0
    """Axial strain without force, dimensionless."""
    reference_curvature: float = 0.0
    """Curvature without moment, 1/m."""
    relaxed: Literal["straight", "start"] = "straight"
    """Where it is free of stress but for the reference values: straight, or in the shape in which it starts."""
    integration: Literal["full", "reduced"] = "full"
    """Gauss points of an element: 5 for the axial and 3 for the bending strain, or 4 and 2."""
    position: Vector2 = (0.0, 0.0)
    """Where its first node starts, m."""
    angle: float = 0.0
    """Its direction at the start, rad."""
    shape: tuple[tuple[float, float, float, float], ...] | None = None
    """(x, y, slope_x, slope_y) of each node at the start, before it is turned by `angle` and moved to `position`; left
    out: straight and unstrained."""
    velocity: Vector2 = (0.0, 0.0)
    """Initial velocity of the place `position`, m/s."""
    angular_velocity: float = 0.0
    """It starts turning about `position` as if rigid, rad/s."""

    def coordinate_records(self) -> Sequence[Coordinate]:
        records = []
        for k in range(self.elements + 1):
            records += [
                Coordinate(f"x{k}", "m", f"vx{k}", f"ax{k}"),
                Coordinate(f"y{k}", "m", f"vy{k}", f"ay{k}"),
                Coordinate(f"slope_x{k}", "1", f"d_slope_x{k}", f"dd_slope_x{k}", SLOPE_SCALE),
                Coordinate(f"slope_y{k}", "1", f"d_slope_y{k}", f"dd_slope_y{k}", SLOPE_SCALE),
            ]
        return records

    def start_shape(self) -> NDArray[np.float64]:
        """x, y, slope_x, slope_y (nodes, 4) at the start."""
        count = self.elements + 1
        if self.shape is None:
            own = np.zeros((count, 4))
            own[:, 0], own[:, 2] = np.linspace(0.0, self.length, count), 1.0
        else:
            own = np.array(self.shape)
        c, s = math.cos(self.angle), math.sin(self.angle)
        turn = np.array([[c, s], [-s, c]])
        return np.hstack([own[:, :2] @ turn + np.asarray(self.position), own[:, 2:] @ turn])

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        q = self.start_shape()
        arm = q.copy()
        arm[:, :2] -= self.position
        v = self.angular_velocity * np.stack([-arm[:, 1], arm[:, 0], -arm[:, 3], arm[:, 2]], axis=1)
        v[:, :2] += self.velocity
        return tuple(q.ravel().tolist()), tuple(v.ravel().tolist())

    def extent(self) -> Sequence[tuple[float, float]]:
        places = self.start_shape()[:, :2]
        return [(float(x), float(y)) for x, y in (places.min(axis=0), places.max(axis=0))]

    def rows(self, numbering: Numbering) -> Sequence[Row]:
        """One row an element."""
        own = numbering.coordinates(self.name)
        axial, bending = POINTS[self.integration]
        fixed = (
            self.length / self.elements, self.mass_per_length, self.axial_stiffness, self.bending_stiffness,
            self.axial_damping, self.bending_damping, *numbering.gravity[:2], float(axial), float(bending),
        )  # fmt: skip
        extra = (numbering.work("dampers"),)
        relaxed = self._relaxed_strains()
        return [Row((*fixed, *relaxed[e]), own[4 * e : 4 * e + NODAL], extra) for e in range(self.elements)]

    def _relaxed_strains(self) -> NDArray[np.float64]:
        """Axial strain and curvature without force (elements, 2 MOST_POINTS) at the Gauss points."""
        found = np.zeros((self.elements, 2, MOST_POINTS))
        for k, (count, reference) in enumerate(
            zip(POINTS[self.integration], (self.reference_strain, self.reference_curvature), strict=True)
        ):
            found[:, k, :count] = reference
            if self.relaxed == "start":
                found[:, k, :count] += np.array(self.strains_at(self.start_shape(), gauss_places(count))[k])
        return found.reshape(self.elements, -1)

    def strains_at(self, nodes: NDArray[np.float64], places: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Axial strain and curvature (elements, places) at `places` in [0, 1] of every element, for nodes
        (nodes, 4)."""
        length = self.length / self.elements
        vectors = np.stack([nodes[:-1, :2], nodes[:-1, 2:], nodes[1:, :2], nodes[1:, 2:]], axis=1)
        first, second = (np.array([weights(float(x), length, d) for x in places]) for d in (1, 2))
        a, b = np.einsum("pk,ekc->epc", first, vectors), np.einsum("pk,ekc->epc", second, vectors)
        square = np.sum(a * a, axis=2)
        return np.sqrt(square) - 1.0, (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]) / square

    def material_point(self, point: tuple[float, float]) -> PointShape:
        """The point (s, 0), s m along the undeformed cable. Raises ModelError beyond it, and off its axis."""
        s, off = point
        if off != 0.0:
            raise ModelError(f"a material point of cable '{self.name}' lies on its axis, not {off:g} m off it: give "
                             f"({s:g}, 0), and (0, {off:g}) as the point of a marker on it")  # fmt: skip
        e, x = self.find(s)
        length = self.length / self.elements
        names = tuple(f"{what}{k}" for k in (e, e + 1) for what in ("x", "y", "slope_x", "slope_y"))
        shape, slope = (np.asarray(np.kron(weights(x, length, d), np.eye(2)), dtype=np.float64) for d in (0, 1))
        return PointShape(None, names, (0.0, 0.0), (0.0, 0.0), shape, slope)

    def drawn_points(self) -> Sequence[tuple[float, float]]:
        # its nodes; a cubic between two of them may be bent
        return along_axis(self.length, self.elements) if self.elements > 1 else along_axis(self.length)

    def section(self, points: NDArray[np.float64], q: NDArray[np.float64], v: NDArray[np.float64]) -> Section:
        """Strains and forces at `points`; of two elements that meet there the one behind counts."""
        length = self.length / self.elements
        found = [self.find(float(s)) for s in points]
        first, second = (np.array([weights(x, length, d) for _, x in found]) for d in (1, 2))
        ends = np.array([[e, e + 1] for e, _ in found])
        # vectors r0, s0, r1, s1 of the element of each point: (N, points, 4, 2)
        nodal = [x.reshape(len(x), -1, 2, 2)[:, ends].reshape(len(x), len(found), 4, 2) for x in (q, v)]
        a, b, da, db = (np.einsum("pk,npkc->npc", w, x) for x in nodal for w in (first, second))
        square = np.sum(a * a, axis=2)
        size = np.sqrt(square)
        bend = (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]) / square
        stretching = np.sum(a * da, axis=2)
        bending = da[..., 0] * b[..., 1] - da[..., 1] * b[..., 0] + a[..., 0] * db[..., 1] - a[..., 1] * db[..., 0]
        bending = (bending - 2.0 * bend * stretching) / square
        strain0, bend0 = self._relaxed_at(found)
        return Section(
            size - 1.0,
            bend,
            self.axial_stiffness * (size - 1.0 - strain0) + self.axial_damping * stretching / size,
            self.bending_stiffness * (bend - bend0) + self.bending_damping * bending,
        )

    def _relaxed_at(self, found: Sequence[tuple[int, float]]) -> tuple[Any, Any]:
        """Axial strain and curvature without force at points (element, place)."""
        if self.relaxed == "straight":
            return self.reference_strain, self.reference_curvature
        strain, bend = self.strains_at(self.start_shape(), [x for _, x in found])
        own = [e for e, _ in found], range(len(found))
        return self.reference_strain + strain[own], self.reference_curvature + bend[own]
