"""Kelvin-Voigt: F = K delta + c delta', released when the force would become tensile."""

from typing import Any, ClassVar, Literal

from ...compiled.jit import compiled
from ...model.base import NonNegative, Positive
from .base import ForceLaw


@compiled
def kelvin_voigt_formula(d: float, dd: float, v0: float, k: float, c: float, p2: float, p3: float) -> Any:
    return k * d + c * dd, k, c, k * d, 0.5 * k * d * d


class KelvinVoigt(ForceLaw):
    """F = K delta + c delta' >= 0.

    The force jumps by c v0 at first contact, which is not physical but is the law; contact ends at F = 0, with
    the restitution of `numerics` section 6.1 (release without adhesion), not exp(-pi zeta / sqrt(1 - zeta^2)).
    """

    type: Literal["KelvinVoigt"] = "KelvinVoigt"
    formula: ClassVar[Any] = kelvin_voigt_formula
    release: ClassVar[str] = "force"
    stiffness: Positive
    """K, N/m."""
    damping: NonNegative
    """c, N s/m."""

    def parameters(self) -> tuple[float, float, float, float]:
        return self.stiffness, self.damping, 0.0, 0.0
