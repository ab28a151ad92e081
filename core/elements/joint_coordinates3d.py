"""Channels of a joint in space that turns about the z axis of its markers, or slides along it."""

import math
from typing import Any

from ..compiled.jit import internal
from ..model.channels import Channel
from ..model.derived import NOT_KNOWN, Derived, Places
from ..model.frame3d import ARM, FRAME, Frame3D, four_of, in_space, point_of, three_of, vector_of
from ..model.rotation3d import along, cross, dot, less, plus, space_rate, times, turning
from .turn3d import account_of

TURN = 2.0 * math.pi
VELOCITY, ACCOUNT = 2 * FRAME, 4 * FRAME
"""Where among the places those of velocities and of the account begin: both frames in q come first."""


@internal
def joint_angle(row: Any, places: Any, numbers: Any, out: Any) -> None:
    x, y, z = (
        in_space(row, places, 0, vector_of(numbers, 1)), in_space(row, places, 0, vector_of(numbers, 4)),
        in_space(row, places, 0, vector_of(numbers, 7)),
    )  # fmt: skip
    of_b = in_space(row, places, FRAME, vector_of(numbers, 10))
    angle = math.atan2(dot(y, of_b), dot(x, of_b))
    about = numbers[0] + row[places[ACCOUNT]]
    out[0] = angle + TURN * math.floor((about - angle) / TURN + 0.5)
    of_a, of_b = (
        space_rate(four_of(row, places, ARM, 1.0), four_of(row, places, VELOCITY + ARM, 0.0)),
        space_rate(four_of(row, places, FRAME + ARM, 1.0), four_of(row, places, VELOCITY + FRAME + ARM, 0.0)),
    )
    out[1] = 2.0 * dot(less(of_b, of_a), z)


@internal
def _velocity(row: Any, places: Any, first: int, u: Any) -> Any:
    """Rate of the point u of the frame whose places begin at `first`."""
    p, rate = four_of(row, places, first + ARM, 1.0), four_of(row, places, VELOCITY + first + ARM, 0.0)
    return plus(three_of(row, places, VELOCITY + first), along(turning(p, u), rate))


@internal
def joint_position(row: Any, places: Any, numbers: Any, out: Any) -> None:
    a, b, z = vector_of(numbers, 0), vector_of(numbers, 3), in_space(row, places, 0, vector_of(numbers, 6))
    d = less(point_of(row, places, FRAME, b), point_of(row, places, 0, a))
    rate = less(_velocity(row, places, FRAME, b), _velocity(row, places, 0, a))
    turning_a = space_rate(four_of(row, places, ARM, 1.0), four_of(row, places, VELOCITY + ARM, 0.0))
    out[0], out[1] = dot(z, d), dot(z, rate) + dot(times(2.0, cross(turning_a, z)), d)


class _JointCoordinate(Derived):
    rate_of = (1, NOT_KNOWN)

    def __init__(self, a: Frame3D, b: Frame3D) -> None:
        self._a, self._b = a, b

    def places(self, at: Places) -> list[int]:
        both = (self._a.index, self._b.index)
        found = [place for first in (at.q, at.v) for index in both for place in at.of(first, index)]
        return [*found, *(at.work(name) for name in self.accounts)]


class JointAngle(_JointCoordinate):
    """Angle (rad) from the x axis of marker a to that of marker b about the z axis of marker a, and its rate.

    The axes tell it but for whole turns; the joint's account tells these. `start` is the angle at its beginning.
    """

    kernel = joint_angle

    def __init__(self, name: str, a: Frame3D, b: Frame3D, start: float) -> None:
        super().__init__(a, b)
        self._start, self.accounts = start, (account_of(name),)
        self.channels = (
            Channel(f"{name}.angle", "rad", f"angle of {name}, turns counted"),
            Channel(f"{name}.angular_velocity", "rad/s", f"rate of the angle of {name}"),
        )

    def numbers(self) -> list[float]:
        return [self._start, *self._a.axes(), *self._b.axes()[:3]]


class JointPosition(_JointCoordinate):
    """Place (m) of the point of marker b along the z axis of marker a, and its rate."""

    kernel = joint_position

    def __init__(self, name: str, a: Frame3D, b: Frame3D) -> None:
        super().__init__(a, b)
        self.channels = (
            Channel(f"{name}.position", "m", f"place of b along the axis of {name}"),
            Channel(f"{name}.velocity", "m/s", f"rate of the position of {name}"),
        )

    def numbers(self) -> list[float]:
        return [*self._a.marker.point, *self._b.marker.point, *self._a.axes()[6:]]
