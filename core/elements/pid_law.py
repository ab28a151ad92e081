"""What PID controllers of the plane and of space have in common."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pydantic import model_validator

from ..model.markers import Marker
from ..model.signals import Signal
from .base import ForceElement, Numbering


class PIDLaw(ForceElement):
    """Base of the controllers. Each declares the fields itself: their order is that of its JSON."""

    if TYPE_CHECKING:
        target: Signal
        sensor_a: Marker | None
        sensor_b: Marker | None
        gain: float
        integral_gain: float
        rate_gain: float
        largest: float | None

    @model_validator(mode="after")
    def _check_gains(self) -> "PIDLaw":
        if self.gain == 0.0 and self.integral_gain == 0.0 and self.rate_gain == 0.0:
            raise ValueError(f"controller '{self.name}' has no gain, so it does nothing: give it one")
        if self.integral_gain * self.gain < 0.0 or (self.integral_gain != 0.0 and self.gain == 0.0):
            raise ValueError(
                f"controller '{self.name}' has integral_gain = {self.integral_gain:g} and gain = {self.gain:g}: these "
                "must have one sign, and an integral gain needs a gain beside it (their quotient is the integral time)"
            )
        if (self.sensor_a is None) != (self.sensor_b is None):
            raise ValueError(f"controller '{self.name}' has one sensor marker: give it both, or none to sense a and b")
        return self

    def numbers(self, numbering: Numbering, angle: bool) -> tuple[float, float, float, float, float]:
        """Of its law, for the kernels, where it senses an angle or a length: gain, share of z in the error, gain of the
        rate, largest force (0: any), pace of z."""
        # z in radians is a length as large as the mechanism for a radian
        unit = numbering.length if angle else 1.0
        pace = unit * self.integral_gain / self.gain if self.integral_gain else 0.0
        return (self.gain, 1.0 / unit, self.rate_gain, self.largest or 0.0, pace)

    def internal_coordinates(self) -> Sequence[str]:
        return ("integral",)

    def signals(self) -> Sequence[Signal]:
        return (self.target,)
