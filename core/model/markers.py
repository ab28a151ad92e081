"""Markers: points of bodies, to which joints, forces, shapes and sensors are attached."""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .attitude import UPRIGHT, Attitude, rotation_matrix
from .base import Name, Record, Vector2, Vector3

GROUND = "ground"


class Marker(Record):
    """Base of the markers: a place on a body."""

    rest: ClassVar[tuple[float, ...]]
    """Coordinates of a frame that carries such markers and has not moved: the ground's. What a body lacks of them, a
    point mass its attitude, stays at this."""

    body: Name = GROUND
    """Name of the body, or "ground"."""
    point: tuple[float, ...]
    """Position in the frame of the body, m."""

    @property
    def at_origin(self) -> bool:
        """Whether it is at the origin of its body's frame."""
        return not any(self.point)


class Marker2D(Marker):
    """A point of a body with a direction.

    On the ground, `point` and `angle` are given in the inertial frame.
    """

    rest: ClassVar[tuple[float, ...]] = (0.0, 0.0, 0.0)

    point: Vector2 = (0.0, 0.0)
    """Position in the frame of the body, m. A point mass has only (0, 0)."""
    angle: float = 0.0
    """Direction of the marker's first axis in the frame of the body, rad."""


class Marker3D(Marker):
    """A point of a body in space, with three axes.

    On the ground, `point` and `attitude` are given in the inertial frame.
    """

    rest: ClassVar[tuple[float, ...]] = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)

    point: Vector3 = (0.0, 0.0, 0.0)
    """Position in the frame of the body, m. A point mass has only (0, 0, 0)."""
    attitude: Attitude = UPRIGHT
    """Of the marker's axes in the frame of the body; left out, they are the body's."""

    def axes(self) -> NDArray[np.float64]:
        """Its axes as columns (3, 3), in the frame of the body."""
        return rotation_matrix(self.attitude.parameters())
