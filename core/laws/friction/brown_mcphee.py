"""Smooth friction with a Stribeck peak (Brown and McPhee 2016)."""

import math
from typing import Any, ClassVar, Literal

from ...compiled.jit import compiled
from ...model.base import Positive
from .base import FrictionLaw, FrictionParameters
from .coefficients import StaticAndKinetic


@compiled
def brown_mcphee_formula(
    v: float, normal: float, kinetic: float, excess: float, vt: float, p3: float, p4: float
) -> Any:
    x = v / vt
    t = math.tanh(4.0 * x)
    # |x| and sgn x of the published form cancel: both terms are odd in x
    bell = 0.25 * x * x + 0.75
    factor = kinetic * t + excess * x / (bell * bell)
    slope = 4.0 * kinetic * (1.0 - t * t) + excess * (bell - x * x) / (bell * bell * bell)
    return -factor * normal, -slope * normal / vt, -factor


class BrownMcPheeFriction(StaticAndKinetic, FrictionLaw):
    """F_t = -F_n [mu tanh(4 x) + (mu_s - mu) x/(x^2/4 + 3/4)^2], x = v_t/v_s.

    The second term peaks at v_s, where the first is 0.9993 mu: the largest friction is mu_s F_n to 0.07 % of mu F_n.
    """

    type: Literal["BrownMcPhee"] = "BrownMcPhee"
    formula: ClassVar[Any] = brown_mcphee_formula
    transition_speed: Positive
    """v_s, m/s: friction is largest there."""

    def parameters(self) -> FrictionParameters:
        return self.coefficient, self.sticking_coefficient - self.coefficient, self.transition_speed, 0.0, 0.0
