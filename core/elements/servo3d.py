"""Servo between two bodies in space: a spring and damper whose end a time function or an input moves; see `servo2d`."""

from typing import ClassVar, Literal

from ..model.base import NonNegative, Positive
from ..model.signals import Signal
from .base import Numbering
from .measured_force3d import MEASURE_KINDS, SERVO, CountingForce3D, Measure3D
from .servo_law import ServoLaw


class Servo3D(ServoLaw, CountingForce3D):
    """Drives the angle of marker `b` about the z axis of marker `a`, its place along it or their distance (`measure`)
    to `target`(t).

    A position servo has a `gain` and a `rate_gain`; a velocity servo has `of_rate` and a `rate_gain` alone.
    """

    type: Literal["Servo3D"] = "Servo3D"
    law: ClassVar[int] = SERVO

    measure: Measure3D = "angle"
    """What it moves."""
    target: Signal
    """rad or m over s; with `of_rate` rad/s or m/s."""
    gain: NonNegative = 0.0
    """N m/rad or N/m."""
    rate_gain: NonNegative = 0.0
    """N m s/rad or N s/m."""
    of_rate: bool = False
    """Whether `target` is a rate, not a position."""
    largest: Positive | None = None
    """Largest force or torque that it gives, N or N m; left out: it gives any."""

    def kind(self) -> int:
        return MEASURE_KINDS[self.measure]

    def signal_in(self, numbering: Numbering) -> int:
        return numbering.signal(self.target)
