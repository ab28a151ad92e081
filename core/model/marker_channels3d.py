"""Channels of markers in space: their motion and attitude from the coordinates of the frames that carry them.

x = R + A u, x' = R' + B(p, u) p', x'' = R'' + B(p, u) p'' + B(p', u) p', with B(p, u) = d(A u)/dp linear in p.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from .attitude import AXES
from .channels import Channel
from .derived import NOT_KNOWN, Columns, Derived, Floats, Places
from .frame3d import ARMS_AT, FRAME, Frame3D, four_of, three_of, vector_of
from .markers import Marker3D
from .rotation3d import along, plus, turned, turning

MOTION = (
    ("x", "m", "position"), ("y", "m", "position"), ("z", "m", "position"),
    ("vx", "m/s", "velocity"), ("vy", "m/s", "velocity"), ("vz", "m/s", "velocity"),
    ("ax", "m/s2", "acceleration"), ("ay", "m/s2", "acceleration"), ("az", "m/s2", "acceleration"),
)  # fmt: skip
NUMBERS = 12
"""Of a marker: its point and its three axes."""
NONE, MATRIX, ANGLES = range(3)
"""How its attitude is shown."""
PLACES = 3 * FRAME + 4
"""Of a marker: of its frame in q, v and a; how its attitude is shown, and the axes of the turns."""


@internal
def angles_of(axes: Any, i: int, j: int, k: int) -> Any:
    """Angles of three turns about axes i, j, k of the turning frame that lead to these axes (a tuple of columns)."""
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    if i == k:
        other = 3 - i - j
        across = math.hypot(axes[j][i], axes[other][i])
        return (
            math.atan2(axes[i][j], -sign * axes[i][other]),
            math.atan2(across, axes[i][i]),
            math.atan2(axes[j][i], sign * axes[other][i]),
        )
    across = math.hypot(axes[i][i], axes[j][i])
    return (
        math.atan2(-sign * axes[k][j], axes[k][k]),
        math.atan2(sign * axes[k][i], across),
        math.atan2(-sign * axes[j][i], axes[i][i]),
    )


@inlined
def _put(out: Any, at: int, x: Any) -> int:
    out[at], out[at + 1], out[at + 2] = x[0], x[1], x[2]
    return at + 3


@internal
def marker_channels3d(row: Any, places: Any, numbers: Any, out: Any) -> None:
    at = 0
    for e in range(len(numbers) // NUMBERS):
        q, u = PLACES * e, vector_of(numbers, NUMBERS * e)
        v, a, shown = q + FRAME, q + 2 * FRAME, q + 3 * FRAME
        p = four_of(row, places, q + ARMS_AT, 1.0)
        pd, pdd = four_of(row, places, v + ARMS_AT, 0.0), four_of(row, places, a + ARMS_AT, 0.0)
        arms = turning(p, u)
        at = _put(out, at, plus(three_of(row, places, q), turned(arms, p)))
        at = _put(out, at, plus(three_of(row, places, v), along(arms, pd)))
        curved = plus(along(arms, pdd), along(turning(pd, u), pd))
        at = _put(out, at, plus(three_of(row, places, a), curved))
        if places[shown] == NONE:
            continue
        x, y, z = (
            turned(turning(p, vector_of(numbers, NUMBERS * e + 3)), p),
            turned(turning(p, vector_of(numbers, NUMBERS * e + 6)), p),
            turned(turning(p, vector_of(numbers, NUMBERS * e + 9)), p),
        )
        if places[shown] == MATRIX:
            for k in range(3):
                at = _put(out, at, (x[k], y[k], z[k]))
        else:
            at = _put(out, at, angles_of((x, y, z), places[shown + 1], places[shown + 2], places[shown + 3]))


class MarkerChannels3D(Derived):
    """The channels of several markers with names and the ways in which their attitude is shown."""

    kernel = marker_channels3d

    def __init__(self, markers: Sequence[tuple[str, Frame3D, str]]) -> None:
        self._markers = markers
        channels: list[Channel] = []
        rates: list[int] = []
        for name, _, attitude in markers:
            first = len(channels)
            channels += [Channel(f"{name}.{what}", unit, f"{text} of marker {name}") for what, unit, text in MOTION]
            rates += [first + k + 3 if k < 6 else NOT_KNOWN for k in range(9)]
            shown = _attitude_channels(name, attitude)
            channels += shown
            rates += [NOT_KNOWN] * len(shown)
        self.channels = tuple(channels)
        self.rate_of = tuple(rates)

    def places(self, at: Places) -> list[int]:
        found = []
        for _, frame, attitude in self._markers:
            found += [*at.of(at.q, frame.index), *at.of(at.v, frame.index), *at.of(at.a, frame.index)]
            turns = attitude not in ("none", "matrix")
            found.append(ANGLES if turns else MATRIX if attitude == "matrix" else NONE)
            found += [list(AXES).index(axis) for axis in attitude] if turns else [0, 0, 0]
        return found

    def numbers(self) -> list[float]:
        return [x for _, frame, _ in self._markers for x in (*frame.marker.point, *frame.axes())]


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


def points_in_space(coordinates: Floats, points: Sequence[Sequence[float]]) -> Floats:
    """Points (n, 3) of a body that has these coordinates (N, 3 or 7): where they are in space (N, n, 3)."""
    index = [k if k < coordinates.shape[1] else -1 for k in range(FRAME)]
    frames = [Frame3D.of(Marker3D(point=(x, y, z)), index) for x, y, z in points]
    still, nothing = np.zeros_like(coordinates), np.zeros((len(coordinates), 0))
    group = MarkerChannels3D([(f"p{k}", frame, "none") for k, frame in enumerate(frames)])
    found = group(Columns(coordinates, still, still, nothing, lambda _: np.zeros(len(coordinates))))
    return found.reshape(len(coordinates), len(frames), len(MOTION))[:, :, :3]
