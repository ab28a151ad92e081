"""Channels of a body that turns in space: its angular velocity and acceleration.

w = 2 E p' and w' = 2 E p'' in space, with E = [-e, e0 I + e~]; in the body 2 G p', with G = [-e, e0 I - e~].
"""

from collections.abc import Sequence
from typing import Any

from ..compiled.jit import internal
from .channels import Channel
from .derived import NOT_KNOWN, Derived, Places
from .frame3d import four_of
from .rotation3d import body_rate, space_rate


@internal
def angular_velocity(row: Any, places: Any, numbers: Any, out: Any) -> None:
    p, pd, pdd = (
        four_of(row, places, 0, 1.0), four_of(row, places, 4, 0.0), four_of(row, places, 8, 0.0)
    )  # fmt: skip
    of_space, growth, of_body = space_rate(p, pd), space_rate(p, pdd), body_rate(p, pd)
    for i in range(3):
        out[i], out[3 + i], out[6 + i] = 2.0 * of_space[i], 2.0 * growth[i], 2.0 * of_body[i]


class AngularVelocity(Derived):
    """Angular velocity in space and in the body's axes (rad/s), angular acceleration in space (rad/s^2)."""

    kernel = angular_velocity

    def __init__(self, name: str, index: Sequence[int]) -> None:
        self._index = tuple(index)
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

    def places(self, at: Places) -> list[int]:
        return [place for first in (at.q, at.v, at.a) for place in at.of(first, self._index)]
