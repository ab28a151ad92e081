"""PID controller between planar markers; see `pid_law`."""

from collections.abc import Sequence
from typing import ClassVar, Literal

from ..model.markers import Marker2D
from .base import Numbering, PairElement2D
from .measure2d import pair2d
from .measure3d import Measure, Pair
from .pid_law import PIDLaw


class PIDController2D(PIDLaw, PairElement2D):
    """A force or torque between markers `a` and `b` that brings what it senses to `target`(t): gains on the error, on
    its integral and on its rate.

    It senses the `measure` from `a` to `b`, or what is said by `sensor_a`, `sensor_b` and `sensed`: the angle of a
    pole whose cart it pushes, say. It works against the growth of the driven measure; a gain below zero, along it.
    """

    type: Literal["PIDController2D"] = "PIDController2D"
    symbol: ClassVar[str] = "actuator"
    width: ClassVar[int] = 6

    measure: Measure = "angle"
    """What it drives from `a` to `b`: the angle by a torque, the slide along a's axis or the distance by a force."""
    sensor_a: Marker2D | None = None
    sensor_b: Marker2D | None = None

    def markers(self) -> Sequence[Marker2D]:
        return (self.a, self.b, *(marker for marker in (self.sensor_a, self.sensor_b) if marker is not None))

    def pairs(self, numbering: Numbering) -> tuple[Pair, Pair]:
        driven = pair2d(self.measure, self.a, self.b, numbering, self.width)
        return driven, pair2d(self.senses, self.sensor_a or self.a, self.sensor_b or self.b, numbering, self.width)
