"""Coulomb's friction with a dead band and a ramp (Ambrosio 2003)."""

from typing import Any, ClassVar, Literal

from pydantic import ValidationInfo, field_validator

from ...compiled.jit import compiled
from ...model.base import NonNegative, Positive
from .base import FrictionCoefficient, FrictionLaw, FrictionParameters


@compiled
def ambrosio_formula(v: float, normal: float, mu: float, v0: float, v1: float, p3: float, p4: float) -> Any:
    speed, sign = abs(v), (1.0 if v >= 0.0 else -1.0)
    if speed <= v0:
        return 0.0, 0.0, 0.0
    if speed >= v1:
        return -mu * normal * sign, 0.0, -mu * sign
    ramp = (speed - v0) / (v1 - v0)
    return -mu * normal * ramp * sign, -mu * normal / (v1 - v0), -mu * ramp * sign


class AmbrosioFriction(FrictionLaw):
    """F_t = -c_d mu F_n sgn v_t, c_d = 0 below v_0, (|v_t| - v_0)/(v_1 - v_0) between, 1 above v_1.

    Without friction in the dead band, so a body at rest slides off with v_0; continuous, with corners at v_0 and v_1.
    """

    type: Literal["Ambrosio"] = "Ambrosio"
    formula: ClassVar[Any] = ambrosio_formula
    coefficient: FrictionCoefficient
    """mu, dimensionless."""
    lower_speed: NonNegative = 0.0
    """v_0, m/s."""
    upper_speed: Positive
    """v_1 > v_0, m/s."""

    @field_validator("upper_speed")
    @classmethod
    def _above_lower(cls, value: float, info: ValidationInfo) -> float:
        lower = info.data.get("lower_speed")
        if lower is not None and value <= lower:
            raise ValueError(f"{value:g} is not above lower_speed = {lower:g}: friction rises between the two speeds")
        return value

    def parameters(self) -> FrictionParameters:
        return self.coefficient, self.lower_speed, self.upper_speed, 0.0, 0.0
