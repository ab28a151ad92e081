"""Markers: points of bodies, to which joints, forces, shapes and sensors are attached."""

from .base import Name, Record, Vector2

GROUND = "ground"


class Marker2D(Record):
    """A point of a body with a direction.

    On the ground, `point` and `angle` are given in the inertial frame.
    """

    body: Name = GROUND
    """Name of the body, or "ground"."""
    point: Vector2 = (0.0, 0.0)
    """Position in the frame of the body, m. A point mass has only (0, 0)."""
    angle: float = 0.0
    """Direction of the marker's first axis in the frame of the body, rad."""
