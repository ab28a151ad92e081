"""Channels of markers: their motion from that of the frames that carry them.

With u the marker's place in the frame, p = A(theta) u and w = theta': x = R + p, x' = R' + w k x p,
x'' = R'' + w' k x p - w^2 p.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..model.channels import Channel
from ..model.outputs import MarkerPlace

_CHANNELS = (
    ("x", "m", "position"), ("y", "m", "position"), ("angle", "rad", "angle"),
    ("vx", "m/s", "velocity"), ("vy", "m/s", "velocity"), ("angular_velocity", "rad/s", "rate of the angle"),
    ("ax", "m/s2", "acceleration"), ("ay", "m/s2", "acceleration"),
    ("angular_acceleration", "rad/s2", "second rate of the angle"),
)  # fmt: skip
"""In the order x, y, angle of each level."""


class MarkerChannels:
    """The channels of all markers, as functions of samples whose q, v and a begin in columns `starts`."""

    def __init__(self, places: Sequence[MarkerPlace], starts: tuple[int, int, int]) -> None:
        self.channels = tuple(
            Channel(f"{place.name}.{name}", unit, f"{text} of marker {place.name}")
            for place in places
            for k, (name, unit, text) in enumerate(_CHANNELS)
            if k % 3 < 2 or place.coordinates[2] >= 0
        )
        self._kept = np.array([k % 3 < 2 or p.coordinates[2] >= 0 for p in places for k in range(9)], dtype=bool)
        index = np.array([p.coordinates for p in places], dtype=np.intp).reshape(-1, 3).T
        self._columns = [np.where(index >= 0, start + index, 0) for start in starts]
        self._there = index >= 0
        self._offset = np.array([p.marker.point for p in places], dtype=np.float64).reshape(-1, 2).T
        self._angle = np.array([p.marker.angle for p in places], dtype=np.float64)

    def __call__(self, samples: NDArray[np.float64]) -> NDArray[np.float64]:
        """All channels (N, channels) of samples (N, columns)."""
        return self._all(samples).reshape(len(samples), -1)[:, self._kept]

    def rates(self, sample: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rates of all channels (channels,) of one sample, NaN for the accelerations."""
        found = self._all(sample[None, :])[0]
        rates = np.full_like(found, np.nan)
        rates[:, :6] = found[:, 3:]
        return rates.ravel()[self._kept]

    def _all(self, samples: NDArray[np.float64]) -> NDArray[np.float64]:
        """All nine of each marker (N, markers, 9)."""
        (x, y, angle), (vx, vy, w), (ax, ay, growth) = (
            np.where(self._there[:, None], samples[:, columns].transpose(1, 0, 2), 0.0) for columns in self._columns
        )
        c, s = np.cos(angle), np.sin(angle)
        px, py = c * self._offset[0] - s * self._offset[1], s * self._offset[0] + c * self._offset[1]
        found = np.stack([
            x + px, y + py, angle + self._angle,
            vx - w * py, vy + w * px, w,
            ax - growth * py - w * w * px, ay + growth * px - w * w * py, growth,
        ], axis=-1)  # fmt: skip
        return found
