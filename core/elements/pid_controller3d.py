"""PID controller between markers in space; see `pid_law`."""

from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

from pydantic import model_validator

from ..model.markers import Marker3D
from .base import BodyElement, Numbering
from .measure3d import Measure, Pair, Pair3D, pair3d
from .pid_law import PIDLaw, PIDSensing
from .primitive3d import SIZE
from .turn3d import CountsTurns3D
from .turning_bodies import refuse_points


class SensedTurns3D(CountsTurns3D, PIDSensing):
    """What a controller in space says of the angle that it senses."""

    start_angle: float | None = None
    """Of a sensed angle, rad: the one at the start, whole turns included; left out: as a joint, a driver or another
    element about the same axis says, or the turns by which attitudes are given, else between -pi and pi."""


class PIDController3D(PIDLaw, SensedTurns3D, Pair3D):
    """A force or torque between markers `a` and `b` that brings what it senses to `target`(t): gains on the error, on
    its integral and on its rate.

    It senses the `measure` from `a` to `b`, or what is said by `sensor_a`, `sensor_b` and `sensed`: the angle of a
    pole whose cart it pushes, say. It works against the growth of the driven measure; a gain below zero, along it.
    """

    type: Literal["PIDController3D"] = "PIDController3D"
    symbol: ClassVar[str] = "actuator"
    width: ClassVar[int] = SIZE

    measure: Measure = "angle"
    """What it drives from `a` to `b`: the angle about the z axis of a by a torque, the place along it or the distance
    by a force."""
    sensor_a: Marker3D | None = None
    sensor_b: Marker3D | None = None

    @model_validator(mode="after")
    def _check(self) -> "PIDController3D":
        if self.start_angle is not None and self.senses != "angle":
            raise ValueError(f"controller '{self.name}' senses no angle: leave `start_angle` out")
        return self

    @property
    def sensing(self) -> tuple[Marker3D, Marker3D]:
        """The markers that it senses."""
        return self.sensor_a or self.a, self.sensor_b or self.b

    def counted_pair(self) -> tuple[Marker3D, Marker3D] | None:
        return self.sensing if self.senses == "angle" else None

    def markers(self) -> Sequence[Marker3D]:
        return (self.a, self.b, *(marker for marker in (self.sensor_a, self.sensor_b) if marker is not None))

    def pairs(self, numbering: Numbering) -> tuple[Pair, Pair]:
        return pair3d(self.measure, self.a, self.b, numbering), pair3d(self.senses, *self.sensing, numbering)

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        for what, pair in ((self.measure, (self.a, self.b)), (self.senses, self.sensing)):
            if what == "angle":
                refuse_points(self.name, pair, bodies, "use a RigidBody3D")
        super().check_in(bodies)
