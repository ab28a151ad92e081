"""Force and friction laws in plain Python, for exudyn's user functions.

Written from the published forms, not from the solver's kernels: a cross-check must not share what it checks. Only a
law of a user's own has nothing but its own formula, which then runs on both sides.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ...core.laws import CarvalhoMartins, ForceLaw, Hertz, HuntCrossley, KelvinVoigt, KuwabaraKono, Tsuji
from ...core.laws.friction import AmbrosioFriction, BrownMcPheeFriction, StepFriction, TanhFriction, ThrelfallFriction
from ...core.laws.hunt_crossley import HuntCrossleyFamily

NormalForce = Callable[[float, float, float], float]
"""(penetration m, its rate m/s, approach speed m/s) -> N."""
FrictionForce = Callable[[float, float], float]
"""(sliding speed m/s, normal force N) -> N along the sliding direction, against the speed."""


def normal_force(law: ForceLaw) -> NormalForce:
    """The force of a contact law, which pushes where it is positive."""
    k: float
    if type(law) is KelvinVoigt:
        k, c = law.stiffness, law.damping
        return lambda d, dd, v0: k * d + c * dd
    if type(law) is Tsuji:
        k, c = law.stiffness, law.damping_constant()
        return lambda d, dd, v0: k * d**1.5 + c * d**0.25 * dd
    if type(law) is KuwabaraKono:
        k, tau = law.stiffness, law.relaxation_time
        return lambda d, dd, v0: k * (d**1.5 + 1.5 * tau * math.sqrt(d) * dd)
    if type(law) is Hertz:
        k, n = law.stiffness, law.exponent
        return lambda d, dd, v0: k * d**n
    if isinstance(law, HuntCrossleyFamily) and type(law).formula is HuntCrossleyFamily.formula:
        k, n, chi = law.stiffness, law.exponent, _dissipation(law)
        least = -math.inf if law.release_rule == "gap" else 0.0
        return lambda d, dd, v0: k * d**n * max(1.0 + chi * dd / v0, least)
    return lambda d, dd, v0: law.evaluate(d, dd, v0)[0]


def spring_energy(law: ForceLaw) -> Callable[[float], float]:
    """What the spring of a contact law holds at a penetration, m, in J."""
    if isinstance(law, HuntCrossleyFamily) and type(law).formula is HuntCrossleyFamily.formula:
        k, n = law.stiffness, law.exponent
        return lambda d: k * d ** (n + 1.0) / (n + 1.0)
    return law.elastic_energy


def _dissipation(law: Any) -> float:
    e = law.restitution
    if type(law) is HuntCrossley:
        return 1.5 * (1.0 - e)
    if type(law) is CarvalhoMartins:
        return 1.5 * (1.0 - e) * (11.0 - e) / (1.0 + 9.0 * e) if e > 1.0 / 3.0 else (1.0 - e * e) / e
    return float(law.damping_factor())


def friction_force(law: Any) -> FrictionForce:
    """The force of a regularised friction law."""
    if type(law) is TanhFriction:
        mu, vs = law.coefficient, law.transition_speed
        return lambda v, n: -mu * n * math.tanh(v / vs)
    if type(law) is ThrelfallFriction:
        mu, vs = law.coefficient, law.transition_speed
        return lambda v, n: -mu * n * (1.0 - math.exp(-3.0 * abs(v) / vs)) * math.copysign(1.0, v)
    if type(law) is AmbrosioFriction:
        mu, low, high = law.coefficient, law.lower_speed, law.upper_speed
        return lambda v, n: -mu * n * min(max((abs(v) - low) / (high - low), 0.0), 1.0) * math.copysign(1.0, v)
    if type(law) is BrownMcPheeFriction:
        mu, more, vs = law.coefficient, law.sticking_coefficient - law.coefficient, law.transition_speed

        def brown_mcphee(v: float, n: float) -> float:
            x = abs(v) / vs
            return -n * (mu * math.tanh(4.0 * x) + more * x / (0.25 * x * x + 0.75) ** 2) * math.copysign(1.0, v)

        return brown_mcphee
    if type(law) is StepFriction:
        mu, most = law.coefficient, law.sticking_coefficient
        first, last = law.stiction_speed, law.sliding_speed

        def step(v: float, n: float) -> float:
            if abs(v) < first:
                return -n * most * (2.0 * _smooth((v + first) / (2.0 * first)) - 1.0)
            share = _smooth(min((abs(v) - first) / (last - first), 1.0))
            return -n * (most + (mu - most) * share) * math.copysign(1.0, v)

        return step
    return lambda v, n: law.evaluate(v, n)[0]


@dataclass(frozen=True)
class StickingCoulomb:
    """Coulomb's friction with a stiff spring and damper while it sticks: the penalty form of the set-valued law.

    A contact's `friction` in models that the cross-check makes for exudyn; no law of the vocabulary.
    """

    coefficient: float
    sticking_coefficient: float
    stiffness: float
    """N/m."""
    damping: float
    """N s/m."""
    type: str = "Coulomb (stick by penalty)"


def _smooth(x: float) -> float:
    return x * x * (3.0 - 2.0 * x)


def lugre(law: Any) -> Callable[[float, float, float], tuple[float, float]]:
    """(deflection m, sliding speed m/s, normal force > 0 in N) -> (rate of the deflection, friction force)."""
    s0, s1, s2 = law.bristle_stiffness, law.bristle_damping, law.viscous_damping
    mu, most, vs = law.coefficient, law.sticking_coefficient, law.stribeck_speed

    def force(z: float, v: float, n: float) -> tuple[float, float]:
        g = n * (mu + (most - mu) * math.exp(-((v / vs) ** 2)))
        rate = v - s0 * abs(v) * z / g
        return rate, -(s0 * z + s1 * rate + s2 * v)

    return force
