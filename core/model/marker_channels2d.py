"""Channels of planar markers: their motion from that of the frames that carry them.

With u the marker's place in the frame, p = A(theta) u and w = theta': x = R + p, x' = R' + w k x p,
x'' = R'' + w' k x p - w^2 p.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..compiled.jit import internal
from .channels import Channel
from .derived import NOT_KNOWN, Derived, Places
from .frame3d import three_of, vector_of
from .markers import Marker2D

_CHANNELS = (
    ("x", "m", "position"), ("y", "m", "position"), ("angle", "rad", "angle"),
    ("vx", "m/s", "velocity"), ("vy", "m/s", "velocity"), ("angular_velocity", "rad/s", "rate of the angle"),
    ("ax", "m/s2", "acceleration"), ("ay", "m/s2", "acceleration"),
    ("angular_acceleration", "rad/s2", "second rate of the angle"),
)  # fmt: skip
"""In the order x, y, angle of each level."""
MARKER_SIZE = 9


PLACES = 2 * MARKER_SIZE
"""Of a marker: where its nine arguments stand, then which channels they are (-1: none)."""
NUMBERS = 3
"""Of a marker: its place in the frame and its angle there."""


@internal
def marker_channels2d(row: Any, places: Any, numbers: Any, out: Any) -> None:
    for e in range(len(numbers) // NUMBERS):
        first, (u, v, angle) = PLACES * e, vector_of(numbers, NUMBERS * e)
        (x, y, theta), (vx, vy, w) = three_of(row, places, first), three_of(row, places, first + 3)
        ax, ay, growth = three_of(row, places, first + 6)
        c, s = math.cos(theta), math.sin(theta)
        px, py = c * u - s * v, s * u + c * v
        found = (
            x + px, y + py, theta + angle, vx - w * py, vy + w * px, w,
            ax - growth * py - w * w * px, ay + growth * px - w * w * py, growth,
        )  # fmt: skip
        for k in range(MARKER_SIZE):
            if places[first + MARKER_SIZE + k] >= 0:
                out[places[first + MARKER_SIZE + k]] = found[k]


@dataclass(frozen=True)
class MarkerPlace2D:
    """A marker that is shown: the coordinates of the frame that carries it (-1: it has none, that is zero)."""

    name: str
    marker: Marker2D
    coordinates: Sequence[int]


class MarkerChannels2D(Derived):
    """The channels of several markers."""

    kernel = marker_channels2d

    def __init__(self, markers: Sequence[MarkerPlace2D]) -> None:
        self._markers = markers
        # a point mass has no angle
        kept = [k % 3 < 2 or p.coordinates[2] >= 0 for p in markers for k in range(MARKER_SIZE)]
        self.channels = tuple(
            Channel(f"{place.name}.{name}", unit, f"{text} of marker {place.name}")
            for place in markers
            for k, (name, unit, text) in enumerate(_CHANNELS)
            if k % 3 < 2 or place.coordinates[2] >= 0
        )
        number = np.cumsum(kept) - 1
        self._channel = np.where(kept, number, -1).tolist()
        # the rate of a channel is three places behind it, among those that are kept too
        self.rate_of = tuple(int(number[k + 3]) if k % 9 < 6 else NOT_KNOWN for k in range(len(kept)) if kept[k])

    def places(self, at: Places) -> list[int]:
        found: list[int] = []
        for k, marker in enumerate(self._markers):
            for first in (at.q, at.v, at.a):
                found += at.of(first, marker.coordinates)
            found += self._channel[MARKER_SIZE * k : MARKER_SIZE * (k + 1)]
        return found

    def numbers(self) -> list[float]:
        return [x for place in self._markers for x in (*place.marker.point, place.marker.angle)]
