"""Channels of markers in space: their motion and attitude from the coordinates of the frames that carry them.

x = R + A u, x' = R' + B(p, u) p', x'' = R'' + B(p, u) p'' + B(p', u) p', with B(p, u) = d(A u)/dp linear in p. All is
written out component by component, so that one sample gives the same bits as many.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .attitude import AXES
from .channels import Channel
from .derived import NOT_KNOWN, Columns
from .markers import Marker3D

Floats = NDArray[np.float64]
Vector = tuple[Any, Any, Any]
MOTION = (
    ("x", "m", "position"), ("y", "m", "position"), ("z", "m", "position"),
    ("vx", "m/s", "velocity"), ("vy", "m/s", "velocity"), ("vz", "m/s", "velocity"),
    ("ax", "m/s2", "acceleration"), ("ay", "m/s2", "acceleration"), ("az", "m/s2", "acceleration"),
)  # fmt: skip


def turning(p: Any, u: Any, x: Any) -> Vector:
    """B(p, u) x for Euler parameters p, a vector u and four numbers x, arrays or not."""
    e0, e, x0, y = p[0], p[1:], x[0], x[1:]
    eu, ey, uy = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] for a, b in ((e, u), (e, y), (u, y)))
    exu, yxu = _cross(e, u), _cross(y, u)
    found = [2.0 * (x0 * (e0 * u[i] + exu[i]) + eu * y[i] + e[i] * uy - u[i] * ey + e0 * yxu[i]) for i in range(3)]
    return found[0], found[1], found[2]


def _cross(a: Any, b: Any) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def turned(p: Any, u: Any) -> Vector:
    """A(p) u."""
    x, y, z = turning(p, u, p)
    return 0.5 * x, 0.5 * y, 0.5 * z


@dataclass(frozen=True)
class Frame3D:
    """A marker and where the coordinates of its body's frame stand: indices (7,), -1 for those that it lacks."""

    marker: Marker3D
    index: tuple[int, ...]

    @classmethod
    def of(cls, marker: Marker3D, index: Sequence[int]) -> "Frame3D":
        """The same, from any sequence."""
        return cls(marker, tuple(index))

    def place(self, q: Floats) -> tuple[list[Any], list[Any]]:
        """R and p over samples of coordinates (N, n)."""
        x = [q[:, k] if k >= 0 else np.full(len(q), r) for k, r in zip(self.index, self.marker.rest, strict=True)]
        return x[:3], x[3:]

    def rates(self, v: Floats) -> tuple[list[Any], list[Any]]:
        """The rates of R and p, of velocities or accelerations."""
        x = [v[:, k] if k >= 0 else np.zeros(len(v)) for k in self.index]
        return x[:3], x[3:]

    def point(self, q: Floats) -> Floats:
        """The marker's point (N, 3)."""
        position, p = self.place(q)
        arm = turned(p, self.marker.point)
        return np.stack([position[i] + arm[i] for i in range(3)], axis=1)

    def velocity(self, columns: Columns) -> Floats:
        """The rate of the marker's point (N, 3)."""
        (_, p), (rate, pd) = self.place(columns.q), self.rates(columns.v)
        arm = turning(p, self.marker.point, pd)
        return np.stack([rate[i] + arm[i] for i in range(3)], axis=1)

    def axes(self, q: Floats) -> Floats:
        """The marker's axes as columns (N, 3, 3)."""
        _, p = self.place(q)
        return np.stack([np.stack(turned(p, axis), axis=1) for axis in self.marker.axes().T], axis=2)


def angles_of(axes: Floats, sequence: str) -> Floats:
    """Angles (N, 3) of three turns about axes of the turning frame that lead to these axes (N, 3, 3)."""
    i, j, k = (list(AXES).index(axis) for axis in sequence)
    if i == k:
        other = 3 - i - j
        sign = 1.0 if (j - i) % 3 == 1 else -1.0
        across = np.hypot(axes[:, i, j], axes[:, i, other])
        first = np.arctan2(axes[:, j, i], -sign * axes[:, other, i])
        second = np.arctan2(across, axes[:, i, i])
        third = np.arctan2(axes[:, i, j], sign * axes[:, i, other])
    else:
        sign = 1.0 if (j - i) % 3 == 1 else -1.0
        across = np.hypot(axes[:, i, i], axes[:, i, j])
        first = np.arctan2(-sign * axes[:, j, k], axes[:, k, k])
        second = np.arctan2(sign * axes[:, i, k], across)
        third = np.arctan2(-sign * axes[:, i, j], axes[:, i, i])
    return np.stack([first, second, third], axis=1)


class MarkerChannels3D:
    """The channels of several markers with names and the ways in which their attitude is shown."""

    def __init__(self, places: Sequence[tuple[str, Frame3D, str]]) -> None:
        self._places = places
        channels: list[Channel] = []
        rates: list[int] = []
        for name, _, attitude in places:
            first = len(channels)
            channels += [Channel(f"{name}.{what}", unit, f"{text} of marker {name}") for what, unit, text in MOTION]
            rates += [first + k + 3 if k < 6 else NOT_KNOWN for k in range(9)]
            shown = _attitude_channels(name, attitude)
            channels += shown
            rates += [NOT_KNOWN] * len(shown)
        self.channels = tuple(channels)
        self.rate_of = tuple(rates)

    def __call__(self, columns: Columns) -> Floats:
        """All channels (N, channels)."""
        found: list[Any] = []
        for _, frame, attitude in self._places:
            position, p = frame.place(columns.q)
            velocity, pd = frame.rates(columns.v)
            acceleration, pdd = frame.rates(columns.a)
            u = frame.marker.point
            arm, rate = turned(p, u), turning(p, u, pd)
            second, bent = turning(p, u, pdd), turning(pd, u, pd)
            found += [position[i] + arm[i] for i in range(3)]
            found += [velocity[i] + rate[i] for i in range(3)]
            found += [acceleration[i] + (second[i] + bent[i]) for i in range(3)]
            if attitude == "matrix":
                axes = frame.axes(columns.q)
                found += [axes[:, i, j] for i in range(3) for j in range(3)]
            elif attitude != "none":
                found += [*angles_of(frame.axes(columns.q), attitude).T]
        return np.stack(found, axis=1)


def _attitude_channels(name: str, attitude: str) -> list[Channel]:
    if attitude == "none":
        return []
    if attitude == "matrix":
        return [
            Channel(f"{name}.axis_{i}{j}", "1", f"component along {i} of the {j} axis of marker {name}")
            for i in "xyz"
            for j in "xyz"
        ]
    return [
        Channel(f"{name}.angle_{k + 1}", "rad", f"turn {k + 1} of marker {name}, about {axis}")
        for k, axis in enumerate(attitude)
    ]
