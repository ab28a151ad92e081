"""The record of a cable in space of gradient-deficient cubic ANCF elements. Its kernel is in `cable_kernel3d.py`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from ..model.attitude import UPRIGHT, Attitude, rotation_matrix
from ..model.base import Vector3
from .base import Numbering, Row
from .cable_body import SLOPE_SCALE, CableBody
from .cable_kernel3d import NODAL_IN_SPACE, cable3d_kernel
from .cable_shape import POINTS, weights
from .coordinate import Coordinate

AXES = "xyz"


@dataclass(frozen=True)
class CablePoint:
    """A point of a cable: place = shape . (r0, s0, r1, s1) of its element's nodes, tangent = slope . (the same)."""

    names: tuple[str, ...]
    """Of the twelve coordinates, three of each vector."""
    shape: NDArray[np.float64]
    """(4,)."""
    slope: NDArray[np.float64]
    """(4,)."""


class Cable3D(CableBody):
    """A cable or thin beam in space (shear-rigid, large deformation) of `elements` equal ANCF elements in a row.

    It resists stretching and bending, the same in all directions, but not torsion. Node k = 0 ... elements has the
    absolute coordinates x{k}, y{k}, z{k} and the slope dr/ds, slope_x{k}, slope_y{k}, slope_z{k}, s the length along
    the undeformed body. Strains: axial |r'| - 1 and material curvature |r' x r''|/|r'|^2. Joints and forces take a
    MaterialPoint3D of it; CableClamp3D holds a point of it and the direction there.

    Raises
    ------
    ModelError : for a shape with another number of nodes, or one with a slope of zero.
    """

    type: Literal["Cable3D"] = "Cable3D"
    kernel: ClassVar[Any] = cable3d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = tuple(
        (i, j) for i in range(NODAL_IN_SPACE) for j in range(NODAL_IN_SPACE)
    )

    reference_strain: float = 0.0
    """Axial strain without force, dimensionless."""
    integration: Literal["full", "reduced"] = "full"
    """Gauss points of an element: 5 for the axial and 3 for the bending strain, or 4 and 2."""
    position: Vector3 = (0.0, 0.0, 0.0)
    """Where its first node starts, m."""
    attitude: Attitude = UPRIGHT
    """Attitude of the axes in which `shape` is given; without a shape its first axis is the cable's direction."""
    shape: tuple[tuple[float, float, float, float, float, float], ...] | None = None
    """(x, y, z, slope_x, slope_y, slope_z) of each node at the start, before it is turned by `attitude` and moved to
    `position`; left out: straight and unstrained."""
    velocity: Vector3 = (0.0, 0.0, 0.0)
    """Initial velocity of the place `position`, m/s."""
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)
    """It starts turning about `position` as if rigid, rad/s, in the axes of space."""

    def coordinate_records(self) -> Sequence[Coordinate]:
        records = []
        for k in range(self.elements + 1):
            records += [Coordinate(f"{c}{k}", "m", f"v{c}{k}", f"a{c}{k}") for c in AXES]
            records += [
                Coordinate(f"slope_{c}{k}", "1", f"d_slope_{c}{k}", f"dd_slope_{c}{k}", SLOPE_SCALE) for c in AXES
            ]
        return records

    def start_shape(self) -> NDArray[np.float64]:
        """Place and slope (nodes, 2, 3) at the start."""
        count = self.elements + 1
        if self.shape is None:
            own = np.zeros((count, 2, 3))
            own[:, 0, 0], own[:, 1, 0] = np.linspace(0.0, self.length, count), 1.0
        else:
            own = np.array(self.shape).reshape(count, 2, 3)
        own = own @ rotation_matrix(self.attitude.parameters()).T
        own[:, 0] += self.position
        return own

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        q = self.start_shape()
        arm = q.copy()
        arm[:, 0] -= self.position
        v = np.cross(self.angular_velocity, arm)
        v[:, 0] += self.velocity
        return tuple(q.ravel().tolist()), tuple(v.ravel().tolist())

    def extent(self) -> Sequence[tuple[float, ...]]:
        places = self.start_shape()[:, 0]
        return [tuple(x.tolist()) for x in (places.min(axis=0), places.max(axis=0))]

    def rows(self, numbering: Numbering) -> Sequence[Row]:
        """One row an element."""
        own = numbering.coordinates(self.name)
        parameters = (
            self.length / self.elements, self.mass_per_length, self.axial_stiffness, self.bending_stiffness,
            self.axial_damping, self.reference_strain, *numbering.gravity, *map(float, POINTS[self.integration]),
        )  # fmt: skip
        extra = (numbering.work("dampers"),)
        return [Row(parameters, own[6 * e : 6 * e + NODAL_IN_SPACE], extra) for e in range(self.elements)]

    def point(self, s: float) -> CablePoint:
        """The point s m along the undeformed cable. Raises ModelError beyond it."""
        e, x = self.find(s)
        length = self.length / self.elements
        names = tuple(f"{what}{c}{k}" for k in (e, e + 1) for what in ("", "slope_") for c in AXES)
        return CablePoint(names, weights(x, length, 0), weights(x, length, 1))
