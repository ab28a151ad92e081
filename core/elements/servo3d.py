"""Servo between two bodies in space; see `servo_law`."""

from typing import ClassVar, Literal

from .measured_force3d import CountingForce3D, Measure
from .servo_law import ServoLaw


class Servo3D(ServoLaw, CountingForce3D):
    """Drives the angle of marker `b` about the z axis of marker `a`, its place along it or their distance (`measure`)
    to `target`(t).

    A position servo has a `gain` and a `rate_gain`; a velocity servo has `of_rate` and a `rate_gain` alone.
    """

    type: Literal["Servo3D"] = "Servo3D"
    symbol: ClassVar[str] = "actuator"

    measure: Measure = "angle"
    """What it moves."""
