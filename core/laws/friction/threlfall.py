"""Coulomb's friction smoothed by an exponential (Threlfall 1978)."""

import math
from typing import Any, ClassVar, Literal

from ...compiled.jit import compiled
from ...model.base import Positive
from .base import FrictionCoefficient, FrictionLaw, FrictionParameters


@compiled
def threlfall_formula(v: float, normal: float, mu: float, vr: float, p2: float, p3: float, p4: float) -> Any:
    decay = math.exp(-3.0 * abs(v) / vr)
    factor = mu * (1.0 - decay) * (1.0 if v >= 0.0 else -1.0)
    return -factor * normal, -3.0 * mu * normal * decay / vr, -factor


class ThrelfallFriction(FrictionLaw):
    """F_t = -mu F_n (1 - exp(-3 |v_t|/v_r)) sgn v_t: its slope is continuous, its curvature jumps at rest."""

    type: Literal["Threlfall"] = "Threlfall"
    formula: ClassVar[Any] = threlfall_formula
    coefficient: FrictionCoefficient
    """mu, dimensionless."""
    transition_speed: Positive
    """v_r, m/s: 95 % of the full friction is reached there."""

    def parameters(self) -> FrictionParameters:
        return self.coefficient, self.transition_speed, 0.0, 0.0, 0.0
