"""Hertz (1881): F = K delta^n, no dissipation."""

from typing import Any, ClassVar, Literal

from ..compiled.jit import compiled
from ..model.base import Positive
from .base import ForceLaw, LawParameters


@compiled
def hertz_formula(d: float, dd: float, v0: float, k: float, n: float, p2: float, p3: float) -> Any:
    f = k * d**n
    return f, n * k * d ** (n - 1.0), 0.0, f, f * d / (n + 1.0)


class Hertz(ForceLaw):
    """F = K delta^n."""

    type: Literal["Hertz"] = "Hertz"
    formula: ClassVar[Any] = hertz_formula
    stiffness: Positive
    """K, N/m^n."""
    exponent: Positive = 1.5
    """n."""

    def parameters(self) -> LawParameters:
        return self.stiffness, self.exponent, 0.0, 0.0
