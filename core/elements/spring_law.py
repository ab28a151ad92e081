"""Linear spring and damper along a measure: F = k (x - x_0) + c x'."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar

from ..model.signals import Signal
from .measured_force import SPRING, Measure, MeasuredForce, Numbers

NATURAL: Mapping[Measure, str] = {
    "distance": "natural_length", "slide": "natural_position", "angle": "natural_angle"
}  # fmt: skip
"""Field that says the measure without force."""


class SpringLaw(MeasuredForce):
    """Base of the springs. Each declares the fields itself: their order is that of its JSON."""

    law: ClassVar[int] = SPRING
    noun: ClassVar[str] = "spring"

    if TYPE_CHECKING:
        stiffness: float
        damping: float

    @property
    def natural(self) -> float | Signal:
        """The measure without force, m or rad, a number or a time function."""
        found: float | Signal = getattr(self, NATURAL[self.acts_along])
        return found

    def reference(self) -> float:
        """The measure without force; 0 where a time function says it."""
        return float(self.natural) if isinstance(self.natural, int | float) else 0.0

    def lengths(self) -> Sequence[float]:
        return (self.reference(),) if self.acts_along == "distance" and self.reference() > 0.0 else ()

    def signals(self) -> Sequence[Signal]:
        return () if isinstance(self.natural, int | float) else (self.natural,)

    def numbers(self) -> Numbers:
        return (self.stiffness, self.damping, self.reference(), 0.0)
