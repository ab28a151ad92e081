"""The Hunt-Crossley family: F = K delta^n (1 + D delta'/v0); the laws differ in D(e) alone.

The rebound speed depends on D alone: (1 + D)/(1 - D e_out) = exp(D (1 + e_out)); contact ends at delta = 0 with
F = 0 and F is never tensile, since D e_out < 1.
"""

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ...compiled.jit import compiled
from ...model.base import Positive, Restitution
from .base import ForceLaw


@compiled
def hunt_crossley_formula(d: float, dd: float, v0: float, k: float, n: float, factor: float, p3: float) -> Any:
    elastic = k * d**n
    damped = 1.0 + factor * dd / v0
    return (
        elastic * damped,
        n * k * d ** (n - 1.0) * damped,
        elastic * factor / v0,
        elastic,
        elastic * d / (n + 1.0),
    )


class HuntCrossleyFamily(ForceLaw):
    """Base of the laws F = K delta^n (1 + D delta'/v0)."""

    formula: ClassVar[Any] = hunt_crossley_formula
    stiffness: Positive
    """K, N/m^n."""
    restitution: Restitution
    """Requested coefficient of restitution e; what comes out differs from law to law."""
    exponent: Positive = 1.5
    """n."""

    def damping_factor(self) -> float:
        """D(e), dimensionless."""
        raise NotImplementedError(f"{type(self).__name__} must define its damping factor")

    def parameters(self) -> tuple[float, float, float, float]:
        return self.stiffness, self.exponent, self.damping_factor(), 0.0


class HuntCrossley(HuntCrossleyFamily):
    """Hunt and Crossley (1975): D = 3 (1 - e) / 2."""

    type: Literal["HuntCrossley"] = "HuntCrossley"

    def damping_factor(self) -> float:
        return 1.5 * (1.0 - self.restitution)


class LankaraniNikravesh(HuntCrossleyFamily):
    """Lankarani and Nikravesh (1990): D = 3 (1 - e^2) / 4."""

    type: Literal["LankaraniNikravesh"] = "LankaraniNikravesh"

    def damping_factor(self) -> float:
        return 0.75 * (1.0 - self.restitution**2)


class Flores(HuntCrossleyFamily):
    """Flores et al. (2011): D = 8 (1 - e) / (5 e)."""

    type: Literal["Flores"] = "Flores"
    restitution: Annotated[float, Field(gt=0.0, le=1.0)]

    def damping_factor(self) -> float:
        return 1.6 * (1.0 - self.restitution) / self.restitution


def exact_damping_factor(e: float) -> float:
    """D for which the rebound speed is e v0: root of (1 + D)/(1 - D e) = exp(D (1 + e)), 0 < e <= 1."""
    if e == 1.0:
        return 0.0
    # importing scipy costs more than most runs: only who needs a root pays
    from scipy.optimize import brentq

    def equation(d: float) -> float:
        return math.log1p(d) - math.log1p(-d * e) - d * (1.0 + e)

    return float(brentq(equation, 1e-3 * (1.0 - e), (1.0 - 1e-14) / e, xtol=1e-15, rtol=1e-15))


class Gonthier(HuntCrossleyFamily):
    """Gonthier et al. (2004) with the exact root: the requested restitution is what comes out."""

    type: Literal["Gonthier"] = "Gonthier"
    restitution: Annotated[float, Field(gt=0.0, le=1.0)]

    def damping_factor(self) -> float:
        return exact_damping_factor(self.restitution)
