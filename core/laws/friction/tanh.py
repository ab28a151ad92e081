"""Coulomb's friction smoothed by a hyperbolic tangent: F_t = -mu F_n tanh(v_t/v_s)."""

import math
from typing import Any, ClassVar, Literal

from ...compiled.jit import compiled
from ...model.base import Positive
from .base import FrictionCoefficient, FrictionLaw, FrictionParameters


@compiled
def tanh_formula(v: float, normal: float, mu: float, vs: float, p2: float, p3: float, p4: float) -> Any:
    t = math.tanh(v / vs)
    return -mu * normal * t, -mu * normal * (1.0 - t * t) / vs, -mu * t


class TanhFriction(FrictionLaw):
    """F_t = -mu F_n tanh(v_t/v_s): smooth everywhere. Under a load F it creeps with v_s artanh(F/(mu F_n))."""

    type: Literal["Tanh"] = "Tanh"
    formula: ClassVar[Any] = tanh_formula
    coefficient: FrictionCoefficient
    """mu, dimensionless."""
    transition_speed: Positive
    """v_s, m/s: 76 % of the full friction is reached there."""

    def parameters(self) -> FrictionParameters:
        return self.coefficient, self.transition_speed, 0.0, 0.0, 0.0
