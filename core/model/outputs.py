"""Outputs that a model shows beyond those that its parts have by themselves."""

from dataclasses import dataclass
from typing import Literal

from .base import Name, Record
from .markers import Marker2D


class MarkerOutput2D(Record):
    """Position, velocity and acceleration of a marker, and its angle's unless it is on a point mass.

    Channels NAME.x, .y, .angle, .vx, .vy, .angular_velocity, .ax, .ay, .angular_acceleration, in the inertial frame.
    """

    type: Literal["MarkerOutput2D"] = "MarkerOutput2D"
    name: Name
    marker: Marker2D


@dataclass(frozen=True)
class MarkerPlace:
    """A marker output: the coordinates of the frame that carries it (-1: it has none, that is zero)."""

    name: str
    marker: Marker2D
    coordinates: tuple[int, int, int]
