"""What servos of the plane and of space have in common."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pydantic import model_validator

from ..model.signals import Signal
from .base import ForceElement


class ServoLaw(ForceElement):
    """Base of the servos. Each declares the fields itself: their order is that of its JSON."""

    if TYPE_CHECKING:
        target: Signal
        gain: float
        rate_gain: float
        of_rate: bool
        largest: float | None

    @model_validator(mode="after")
    def _check(self) -> "ServoLaw":
        if self.of_rate and self.gain > 0.0:
            raise ValueError(
                f"servo '{self.name}' follows a rate and has a gain on the position: leave one of them out"
            )
        if self.gain == 0.0 and self.rate_gain == 0.0:
            raise ValueError(f"servo '{self.name}' has neither gain nor rate_gain, so it does nothing: give one")
        return self

    def numbers(self) -> tuple[float, float, float, float]:
        """Of its law, for the kernels."""
        return (self.gain, self.rate_gain, float(self.of_rate), self.largest or 0.0)

    def signals(self) -> Sequence[Signal]:
        return (self.target,)
