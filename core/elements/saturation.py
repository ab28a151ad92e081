"""The force of what saturates: F (1 + (F/L)^8)^(-1/8), L its largest, smooth, so that nothing has to be located."""

import math

from ..compiled.jit import inlined

FULL = 1e4
"""Asked force over the largest one beyond which the difference from that is below rounding."""


@inlined
def saturated(force: float, limit: float) -> tuple[float, float]:
    """The force that comes out of an asked one, and how much of a change of that comes out."""
    part = force / limit
    if abs(part) > FULL:
        return math.copysign(limit, force), 0.0
    spare = 1.0 / (1.0 + part**8)
    return force * spare**0.125, spare**1.125


@inlined
def slope_rate(force: float, limit: float) -> float:
    """How the slope of `saturated` changes with the asked force."""
    part = force / limit
    if abs(part) > FULL:
        return 0.0
    return -9.0 * part**7 / limit * (1.0 + part**8) ** -2.125
