"""Friction with a state: the deflection z of bristles (LuGre; Canudas de Wit, Olsson, Astrom and Lischinsky 1995).

z' = v - s0 |v| z/g(v),  F_t = -(s0 z + s1 z' + s2 v),  g = F_n (mu + (mu_s - mu) exp(-(v/v_s)^2)).
At constant speed z goes to g/s0 sgn v, so that F_t = -(g sgn v + s2 v); |z| never exceeds mu_s F_n/s0.
"""

import math
from typing import Any, Literal

from ...compiled.jit import compiled, internal
from ...model.base import NonNegative, Positive
from .coefficients import StaticAndKinetic


@compiled
def lugre_formula(
    z: float, v: float, normal: float, s0: float, s1: float, s2: float, kinetic: float, static: float, vs: float
) -> Any:
    """(z', dz'/dz, dz'/dv, dz'/dF_n, F_t, dF_t/dz, dF_t/dv, dF_t/dF_n) at deflection z (m), speed v (m/s), F_n (N).

    Without normal force there is no friction, and z stays as it is.
    """
    if not normal > 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    x = v / vs
    excess = (static - kinetic) * math.exp(-x * x)
    mu = kinetic + excess
    g = mu * normal
    pull = s0 * z / g
    sign = 1.0 if v >= 0.0 else -1.0
    speed = abs(v)
    rate = v - pull * speed
    rate_z = -s0 * speed / g
    # dg/dv = -2 x excess F_n/vs
    rate_v = 1.0 - pull * sign - pull * speed * 2.0 * x * excess / (vs * mu)
    rate_n = pull * speed / normal
    return (
        rate,
        rate_z,
        rate_v,
        rate_n,
        -(s0 * z + s1 * rate + s2 * v),
        -(s0 + s1 * rate_z),
        -(s1 * rate_v + s2),
        -s1 * rate_n,
    )


@internal
def lugre_slip(speed: float, normal: float, s0: float, kinetic: float, static: float, vs: float) -> Any:
    """(h, dh/d speed, dh/dF_n), 1/s, at F_n > 0: bristles slip by h z as z' = u - h z, whatever the direction of u.

    h = s0 |u|/g(|u|, F_n). In one dimension that is `lugre_formula`.
    """
    x = speed / vs
    excess = (static - kinetic) * math.exp(-x * x)
    mu = kinetic + excess
    each = s0 / (mu * normal)
    h = each * speed
    return h, each + h * 2.0 * x * excess / (vs * mu), -h / normal


class LuGreFriction(StaticAndKinetic):
    """Bristles of stiffness s0 and damping s1 that bend until they slip, and viscous friction s2.

    Coefficients are absolute, not for each newton of normal force; a stiff equation, the more so the smaller F_n.
    """

    type: Literal["LuGre"] = "LuGre"
    coefficient: Positive
    """mu while sliding, dimensionless."""
    stribeck_speed: Positive
    """v_s, m/s: the excess of static friction has fallen to 37 % there."""
    bristle_stiffness: Positive
    """s0, N/m."""
    bristle_damping: NonNegative = 0.0
    """s1, N s/m."""
    viscous_damping: NonNegative = 0.0
    """s2, N s/m."""

    def parameters(self) -> tuple[float, float, float, float, float, float]:
        """(s0, s1, s2, mu, mu_s, v_s)."""
        return (
            self.bristle_stiffness,
            self.bristle_damping,
            self.viscous_damping,
            self.coefficient,
            self.sticking_coefficient,
            self.stribeck_speed,
        )

    def evaluate(self, deflection: float, speed: float, normal_force: float) -> tuple[float, ...]:
        """What `lugre_formula` returns, from Python."""
        result = lugre_formula(float(deflection), float(speed), float(normal_force), *self.parameters())
        return tuple(float(x) for x in result)

    def steady_deflection(self, speed: float, normal_force: float) -> float:
        """z at which z' = 0 for a constant speed (m/s) and normal force (N), m."""
        if speed == 0.0:
            return 0.0
        excess = (self.sticking_coefficient - self.coefficient) * math.exp(-((speed / self.stribeck_speed) ** 2))
        return math.copysign((self.coefficient + excess) * normal_force / self.bristle_stiffness, speed)
