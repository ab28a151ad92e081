"""Servo between two bodies: a spring and damper whose end a time function or an input moves.

F = gain (x - f(t)) + rate_gain (x' - f'(t)) works against the growth of x: a position servo. Without gain and with the
rate as target (`of_rate`), F = rate_gain (x' - f(t)): a velocity servo. All of its power counts as put in.

A servo that saturates gives F (1 + (F/L)^8)^(-1/8) instead, L its largest force: F itself while that is below L/2 (to
5e-4), and no more than L. It is smooth, so that nothing has to be located.
"""

from collections.abc import Sequence
from typing import ClassVar

from pydantic import model_validator

from ..model.base import NonNegative, Positive
from ..model.signals import Signal
from .measured_force import SERVO, Measure, MeasuredForce, Numbers


class ServoLaw(MeasuredForce):
    """Base of the servos."""

    law: ClassVar[int] = SERVO
    noun: ClassVar[str] = "servo"
    dissipates: ClassVar[bool] = False

    type: str
    measure: Measure = "angle"
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

    @model_validator(mode="after")
    def _check(self) -> "ServoLaw":
        if self.of_rate and self.gain > 0.0:
            raise ValueError(
                f"servo '{self.name}' follows a rate and has a gain on the position: leave one of them out"
            )
        if self.gain == 0.0 and self.rate_gain == 0.0:
            raise ValueError(f"servo '{self.name}' has neither gain nor rate_gain, so it does nothing: give one")
        return self

    def numbers(self) -> Numbers:
        return (self.gain, self.rate_gain, float(self.of_rate), self.largest or 0.0)

    def signals(self) -> Sequence[Signal]:
        return (self.target,)
