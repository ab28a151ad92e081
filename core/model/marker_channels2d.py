"""Channels of planar markers: their motion from that of the frames that carry them.

With u the marker's place in the frame, p = A(theta) u and w = theta': x = R + p, x' = R' + w k x p,
x'' = R'' + w' k x p - w^2 p.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import compiled, internal
from .channels import Channel
from .derived import NOT_KNOWN, Columns
from .markers import Marker2D

_CHANNELS = (
    ("x", "m", "position"), ("y", "m", "position"), ("angle", "rad", "angle"),
    ("vx", "m/s", "velocity"), ("vy", "m/s", "velocity"), ("angular_velocity", "rad/s", "rate of the angle"),
    ("ax", "m/s2", "acceleration"), ("ay", "m/s2", "acceleration"),
    ("angular_acceleration", "rad/s2", "second rate of the angle"),
)  # fmt: skip
"""In the order x, y, angle of each level."""
MARKER_SIZE = 9


@internal
def planar_motion(sample: Any, columns: Any, u: float, v: float, angle: float, out: Any) -> None:
    """All nine (9,) of a marker at (u, v) of its frame, from one sample; `columns` (9,): -1 is zero."""
    for k in range(MARKER_SIZE):
        out[k] = sample[columns[k]] if columns[k] >= 0 else 0.0
    c, s, w, growth = np.cos(out[2]), np.sin(out[2]), out[5], out[8]
    px, py = c * u - s * v, s * u + c * v
    out[0] += px
    out[1] += py
    out[2] += angle
    out[3] -= w * py
    out[4] += w * px
    out[6] = out[6] - growth * py - w * w * px
    out[7] = out[7] + growth * px - w * w * py


@compiled
def all_markers(samples: Any, columns: Any, offsets: Any, angles: Any, out: Any) -> None:
    """All nine of each marker (N, markers, 9)."""
    for i in range(len(samples)):
        for k in range(len(angles)):
            planar_motion(samples[i], columns[k], offsets[k, 0], offsets[k, 1], angles[k], out[i, k])


@dataclass(frozen=True)
class MarkerPlace2D:
    """A marker that is shown: the coordinates of the frame that carries it (-1: it has none, that is zero)."""

    name: str
    marker: Marker2D
    coordinates: Sequence[int]


class MarkerChannels2D:
    """The channels of several markers."""

    def __init__(self, places: Sequence[MarkerPlace2D]) -> None:
        kept = [k % 3 < 2 or p.coordinates[2] >= 0 for p in places for k in range(MARKER_SIZE)]
        self._kept = np.array(kept, dtype=bool)
        self.channels = tuple(
            Channel(f"{place.name}.{name}", unit, f"{text} of marker {place.name}")
            for place in places
            for k, (name, unit, text) in enumerate(_CHANNELS)
            if k % 3 < 2 or place.coordinates[2] >= 0
        )
        # the rate of a channel is three places behind it, among those that are kept too
        number = np.cumsum(kept) - 1
        self.rate_of = tuple(int(number[k + 3]) if k % 9 < 6 else NOT_KNOWN for k in range(len(kept)) if kept[k])
        self._index = np.array([p.coordinates for p in places], dtype=np.int64).reshape(-1, 3)
        self._offset = np.array([p.marker.point for p in places], dtype=np.float64).reshape(-1, 2)
        self._angle = np.array([p.marker.angle for p in places], dtype=np.float64)

    def __call__(self, columns: Columns) -> NDArray[np.float64]:
        """All channels (N, channels)."""
        found = np.zeros((len(columns), len(self._angle), MARKER_SIZE))
        if len(self._angle):
            n = columns.q.shape[1]
            rows = np.concatenate([columns.q, columns.v, columns.a], axis=1)
            all_markers(rows, self._columns((0, n, 2 * n)), self._offset, self._angle, found)
        return found.reshape(len(columns), -1)[:, self._kept]

    def _columns(self, starts: tuple[int, int, int]) -> NDArray[np.int64]:
        """Of x, y, angle, their rates and second rates (markers, 9), where q, v and a begin at `starts`; -1: zero."""
        return np.concatenate([np.where(self._index >= 0, start + self._index, -1) for start in starts], axis=1)

    def index_arrays(self, starts: tuple[int, int, int], first: int) -> dict[str, NDArray[Any]]:
        """What compiled code needs to fill in these channels, the first of which is channel number `first`; q, v and a
        begin in columns `starts` of a sample."""
        channel = np.where(self._kept, first + np.cumsum(self._kept) - 1, -1).astype(np.int64)
        return {
            "marker_columns": self._columns(starts), "marker_offsets": self._offset, "marker_angles": self._angle,
            "marker_channels": channel,
        }  # fmt: skip

    @property
    def count(self) -> int:
        """How many markers."""
        return len(self._angle)
