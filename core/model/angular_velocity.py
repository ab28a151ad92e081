"""Channels of a body that turns in space: its angular velocity and acceleration.

w = 2 E p' and w' = 2 E p'' in space, with E = [-e, e0 I + e~]; in the body 2 G p', with G = [-e, e0 I - e~].
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .channels import Channel
from .derived import NOT_KNOWN, Columns


class AngularVelocity:
    """Angular velocity in space and in the body's axes (rad/s), angular acceleration in space (rad/s^2)."""

    def __init__(self, name: str, index: Sequence[int]) -> None:
        self._index = list(index)
        self.channels = tuple(
            Channel(f"{name}.{what}_{axis}", unit, f"{text} of {name}, along {axis}{where}")
            for what, unit, text, where in (
                ("angular_velocity", "rad/s", "angular velocity", " of space"),
                ("angular_acceleration", "rad/s2", "angular acceleration", " of space"),
                ("body_angular_velocity", "rad/s", "angular velocity", " of the body"),
            )
            for axis in "xyz"
        )
        self.rate_of = (3, 4, 5, *(NOT_KNOWN,) * 6)

    def __call__(self, columns: Columns) -> NDArray[np.float64]:
        """All channels (N, 9)."""
        p, pd, pdd = (level[:, self._index].T for level in (columns.q, columns.v, columns.a))
        return np.stack([*_doubled(p, pd, 1.0), *_doubled(p, pdd, 1.0), *_doubled(p, pd, -1.0)], axis=1)


def _doubled(p: Any, x: Any, sign: float) -> list[Any]:
    """2 E x (sign 1) or 2 G x (sign -1)."""
    crossed = (p[2] * x[3] - p[3] * x[2], p[3] * x[1] - p[1] * x[3], p[1] * x[2] - p[2] * x[1])
    return [2.0 * (p[0] * x[i + 1] - p[i + 1] * x[0] + sign * crossed[i]) for i in range(3)]
