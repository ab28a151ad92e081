"""Space on paper: an axonometric view, seen from the side on which all three axes come towards the eye."""

import math

import numpy as np
from numpy.typing import NDArray

from ...core.elements import RigidBody3D, SpatialFrame
from ...core.model.base import in_space
from ...core.model.markers import Marker3D
from ...core.multibody_model import Model
from .shapes import Point

Floats = NDArray[np.float64]
AXES = 0.5
"""Length of the axes that show how a body turns on which nothing does, in parts of its radius of gyration."""


class View:
    """How a model's places in space are seen: the axis that is most against gravity points up, z without gravity."""

    def __init__(self, model: Model) -> None:
        gravity = np.abs(in_space(model.gravity))
        up = int(np.argmax(gravity)) if np.any(gravity) else 2
        first, second = np.roll(np.arange(3), -(up + 1))[:2]
        self.matrix = np.zeros((2, 3))
        """From places in space to those on paper."""
        self.matrix[0, first], self.matrix[0, second] = -math.sqrt(0.5), math.sqrt(0.5)
        self.matrix[1, first] = self.matrix[1, second] = -math.sqrt(1.0 / 6.0)
        self.matrix[1, up] = math.sqrt(2.0 / 3.0)

    def __call__(self, place: Floats) -> Floats:
        """Places in space (..., 3) on paper (..., 2)."""
        seen: Floats = np.asarray(place) @ self.matrix.T
        return seen

    def point(self, place: Floats) -> Point:
        """One of them."""
        x, y = self(place).tolist()
        return x, y


def star(model: Model, body: SpatialFrame) -> Floats:
    """A line (points, 3) in the frame of a body that shows it: from its centre to all places where others are attached
    and back; of one with no two such places in line with it, along its axes too."""
    attached = {
        marker.point
        for element in model.elements()
        for marker in element.markers()
        if marker.body == body.name and isinstance(marker, Marker3D)
    }
    ends = [np.array(point) for point in sorted(attached) if any(point)]
    if len(ends) < 2 and isinstance(body, RigidBody3D):
        reach = AXES * math.sqrt(max(body.inertia) / body.mass)
        ends += [sign * reach * axis for axis in np.eye(3) for sign in (1.0, -1.0)]
    line = [np.zeros(3)]
    for end in ends:
        line += [end, np.zeros(3)]
    return np.array(line)
