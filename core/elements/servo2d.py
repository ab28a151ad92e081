"""Servo between two planar bodies; see `servo_law`."""

from typing import ClassVar, Literal

from .measure2d import MeasuredElement2D
from .measured_force import MeasuredForce2D
from .servo_law import ServoLaw


class Servo2D(ServoLaw, MeasuredForce2D, MeasuredElement2D):
    """Drives the angle, way or distance from marker `a` to `b` (`measure`, as in `RelativeMotor2D`) to `target`(t).

    A position servo has a `gain` and a `rate_gain`; a velocity servo has `of_rate` and a `rate_gain` alone.
    """

    type: Literal["Servo2D"] = "Servo2D"
    symbol: ClassVar[str] = "actuator"
