"""Friction by cubic steps between rest, the edge of sticking and sliding, as in ADAMS."""

from typing import Any, ClassVar, Literal

from pydantic import ValidationInfo, field_validator

from ...compiled.jit import compiled
from ...model.base import Positive
from .base import FrictionLaw, FrictionParameters
from .coefficients import StaticAndKinetic


@compiled
def step_formula(v: float, normal: float, kinetic: float, static: float, vs: float, vd: float, p4: float) -> Any:
    speed, sign = abs(v), (1.0 if v >= 0.0 else -1.0)
    if speed < vs:
        # the step from -vs to vs, written about its middle
        x = v / vs
        factor, slope = 0.5 * static * x * (3.0 - x * x), 1.5 * static * (1.0 - x * x) / vs
    elif speed < vd:
        x = (speed - vs) / (vd - vs)
        factor = sign * (static + (kinetic - static) * x * x * (3.0 - 2.0 * x))
        slope = (kinetic - static) * 6.0 * x * (1.0 - x) / (vd - vs)
    else:
        factor, slope = sign * kinetic, 0.0
    return -factor * normal, -slope * normal, -factor


class StepFriction(StaticAndKinetic, FrictionLaw):
    """F_t = -mu(v_t) F_n: mu rises from -mu_s at -v_s to mu_s at v_s, then falls to mu at v_d, by cubic steps."""

    type: Literal["Step"] = "Step"
    formula: ClassVar[Any] = step_formula
    stiction_speed: Positive
    """v_s, m/s: friction is mu_s F_n there."""
    sliding_speed: Positive
    """v_d > v_s, m/s: friction is mu F_n from there on."""

    @field_validator("sliding_speed")
    @classmethod
    def _above_stiction(cls, value: float, info: ValidationInfo) -> float:
        lower = info.data.get("stiction_speed")
        if lower is not None and value <= lower:
            raise ValueError(f"{value:g} is not above stiction_speed = {lower:g}: friction falls between the two")
        return value

    def parameters(self) -> FrictionParameters:
        return self.coefficient, self.sticking_coefficient, self.stiction_speed, self.sliding_speed, 0.0
