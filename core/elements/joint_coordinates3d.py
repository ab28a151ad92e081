"""The ways in which a joint in space moves, turning about an axis or sliding along one, and their channels."""

import math
from dataclasses import dataclass
from typing import Any, Literal

from ..compiled.jit import internal
from ..model.attitude import EulerParameters, product
from ..model.channels import Channel
from ..model.derived import NOT_KNOWN, Derived, Places
from ..model.frame3d import ARMS_AT, FRAME, Frame3D, four_of, in_space, point_of, three_of, vector_of
from ..model.markers import Marker3D
from ..model.rotation3d import along, cross, dot, less, plus, space_rate, times, turning

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
        space_rate(four_of(row, places, ARMS_AT, 1.0), four_of(row, places, VELOCITY + ARMS_AT, 0.0)),
        space_rate(four_of(row, places, FRAME + ARMS_AT, 1.0), four_of(row, places, VELOCITY + FRAME + ARMS_AT, 0.0)),
    )
    out[1] = 2.0 * dot(less(of_b, of_a), z)


@internal
def _velocity(row: Any, places: Any, first: int, u: Any) -> Any:
    """Rate of the point u of the frame whose places begin at `first`."""
    p, rate = four_of(row, places, first + ARMS_AT, 1.0), four_of(row, places, VELOCITY + first + ARMS_AT, 0.0)
    return plus(three_of(row, places, VELOCITY + first), along(turning(p, u), rate))


@internal
def joint_position(row: Any, places: Any, numbers: Any, out: Any) -> None:
    a, b, z = vector_of(numbers, 0), vector_of(numbers, 3), in_space(row, places, 0, vector_of(numbers, 6))
    d = less(point_of(row, places, FRAME, b), point_of(row, places, 0, a))
    rate = less(_velocity(row, places, FRAME, b), _velocity(row, places, 0, a))
    turning_a = space_rate(four_of(row, places, ARMS_AT, 1.0), four_of(row, places, VELOCITY + ARMS_AT, 0.0))
    out[0], out[1] = dot(z, d), dot(z, rate) + dot(times(2.0, cross(turning_a, z)), d)


class _JointCoordinate(Derived):
    rate_of = (1, NOT_KNOWN)

    def __init__(self, a: Frame3D, b: Frame3D) -> None:
        self._a, self._b = a, b

    def places(self, at: Places) -> list[int]:
        both = (self._a.index, self._b.index)
        found = [place for first in (at.q, at.v) for index in both for place in at.of(first, index)]
        return [*found, *(at.work(name) for name in self.accounts)]


@dataclass(frozen=True)
class JointCoordinate:
    """One way in which a joint moves: the angle of marker b about the z axis of marker a, or its place along it.

    The markers are on the bodies of the joint's own, turned so that the z axis is the axis of this motion; of the angle
    about an axis that is fixed to the second body, marker a is there.
    """

    name: str
    """Its channel is JOINT.name."""
    rate: str
    """That of its rate."""
    kind: Literal["angle", "place"]
    a: Marker3D
    b: Marker3D
    text: str
    """What it is."""
    account: str = ""
    """Of an angle: the name of the account that counts its turns (`turn3d`) is that of an element of this name."""


class JointAngle(_JointCoordinate):
    """Angle (rad) from the x axis of marker a to that of marker b about the z axis of marker a, and its rate.

    The axes tell it but for whole turns; the account `account` tells these. `start` is the angle at its beginning.
    """

    kernel = joint_angle

    def __init__(self, joint: str, of: JointCoordinate, a: Frame3D, b: Frame3D, start: float, account: str) -> None:
        super().__init__(a, b)
        self._start, self.accounts = start, (account,)
        self.channels = (
            Channel(f"{joint}.{of.name}", "rad", f"{of.text} of {joint}, turns counted"),
            Channel(f"{joint}.{of.rate}", "rad/s", f"rate of the {of.text} of {joint}"),
        )

    def numbers(self) -> list[float]:
        return [self._start, *self._a.axes(), *self._b.axes()[:3]]


class JointPosition(_JointCoordinate):
    """Place (m) of the point of marker b along the z axis of marker a, and its rate."""

    kernel = joint_position

    def __init__(self, joint: str, of: JointCoordinate, a: Frame3D, b: Frame3D) -> None:
        super().__init__(a, b)
        self.channels = (
            Channel(f"{joint}.{of.name}", "m", f"{of.text} of {joint}"),
            Channel(f"{joint}.{of.rate}", "m/s", f"rate of the {of.text} of {joint}"),
        )

    def numbers(self) -> list[float]:
        return [*self._a.marker.point, *self._b.marker.point, *self._a.axes()[6:]]


def turned_marker(marker: Marker3D, z: Literal["x", "y", "z", "-y"]) -> Marker3D:
    """The same place with other axes: the new z axis is this one of the old axes; of "x" the new x axis is the old y,
    of "y" the old z, of "-y" the old x."""
    parameters = {
        "x": (0.5, 0.5, 0.5, 0.5), "y": (0.5, -0.5, -0.5, -0.5), "-y": (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0),
    }  # fmt: skip
    if z == "z":
        return marker
    attitude = EulerParameters(values=product(marker.attitude.parameters(), parameters[z]))
    return Marker3D(body=marker.body, point=marker.point, attitude=attitude)
