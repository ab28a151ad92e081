"""Third opinion on the block on a belt: closed forms, for Coulomb's friction without damping."""

import math

from ...core.contact.laws import ImpactLaw
from ...models import Scenario
from ..third_opinion import Opinion, opinion


@opinion("stick_slip")
def stick_slip(scenario: Scenario) -> Opinion | None:
    """Stick and slip in closed form, for Coulomb's friction without damping."""
    p = scenario.parameters
    (contact,) = scenario.model.contacts
    if not isinstance(contact.law, ImpactLaw) or p["spring_damping"]:
        return None
    m, k, v, g = (float(p[name]) for name in ("mass", "spring_stiffness", "belt_speed", "gravity"))
    static = float(p["friction"] if p["static_friction"] is None else p["static_friction"]) * m * g / k
    kinetic, w = float(p["friction"]) * m * g / k, math.sqrt(k / m)
    slip = 2.0 / w * (math.pi - math.atan((static - kinetic) * w / v))
    period = slip + 2.0 * (static - kinetic) / v

    def state(t: float) -> tuple[float, float]:
        if t <= static / v:
            return v * t, v
        since = math.fmod(t - static / v, period)
        if since < slip:
            c, s = math.cos(w * since), math.sin(w * since)
            return kinetic + (static - kinetic) * c + v / w * s, -(static - kinetic) * w * s + v * c
        return 2.0 * kinetic - static + v * (since - slip), v

    return Opinion(
        "closed form",
        {"impulse of the whole run": m * g * scenario.t_end},
        {"block.x": lambda t: state(t)[0], "block.vx": lambda t: state(t)[1]},
    )
