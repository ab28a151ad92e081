"""Kelvin-Voigt: F = K delta + c delta'."""

from typing import Any, ClassVar, Literal

from ..compiled.jit import compiled
from ..model.base import NonNegative, Positive
from .base import LawParameters, ReleasedLaw


@compiled
def kelvin_voigt_formula(d: float, dd: float, v0: float, k: float, c: float, p2: float, p3: float) -> Any:
    return k * d + c * dd, k, c, k * d, 0.5 * k * d * d


class KelvinVoigt(ReleasedLaw):
    """F = K delta + c delta'. The force jumps by c v0 at first contact, which is not physical but is the law.

    With release rule "force" contact ends at F = 0, before the penetration is zero; with "gap" at zero penetration
    after the force has been tensile, with restitution exp(-pi zeta/sqrt(1 - zeta^2)), zeta = c/(2 sqrt(K m)) < 1,
    and never for zeta >= 1.
    """

    type: Literal["KelvinVoigt"] = "KelvinVoigt"
    formula: ClassVar[Any] = kelvin_voigt_formula
    stiffness: Positive
    """K, N/m."""
    damping: NonNegative
    """c, N s/m."""

    def parameters(self) -> LawParameters:
        return self.stiffness, self.damping, 0.0, 0.0
