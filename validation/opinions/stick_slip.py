"""Third opinion on the block on a belt: closed forms for Coulomb's friction, scipy for forces."""

import math

import numpy as np

from ...core.laws import ImpactLaw
from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .common import law_of, opinion_on
from .mechanism import Array, Mechanism, run

LENGTH = 1.0
"""Of the relaxed spring, from the wall to the block, m."""


@opinion("stick_slip")
def stick_slip(scenario: Scenario) -> Opinion | None:
    """Stick and slip in closed form, for Coulomb's friction without damping; by scipy, for forces."""
    p = scenario.parameters
    (contact,) = scenario.model.contacts
    if not isinstance(contact.law, ImpactLaw):
        return _by_force(scenario)
    if p["spring_damping"]:
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


def _by_force(scenario: Scenario) -> Opinion:
    p = scenario.parameters
    m, k, c, belt, g = (
        float(p[name]) for name in ("mass", "spring_stiffness", "spring_damping", "belt_speed", "gravity")
    )

    def force(t: float, q: Array, v: Array) -> Array:
        arm = np.array([LENGTH + q[0], q[1]])
        length = math.hypot(*arm)
        pull = k * (length - LENGTH) + c * float(arm @ v) / length
        return np.array([0.0, -m * g]) - pull / length * arm

    (contact,) = scenario.model.contacts
    block = Mechanism(
        mass=lambda q: m * np.eye(2),
        force=force,
        gaps=lambda q: q[1:],
        gradients=lambda q: np.array([[0.0, 1.0]]),
        laws=(law_of(contact.law, contact.friction),),
        slides=lambda q: np.array([[1.0, 0.0]]),
        belt=-belt,
    )
    course = run(block, (0.0, 0.0), (belt, 0.0), scenario.t_end)
    channels = {"block.x": course.q(0), "block.vx": course.v(0)}
    return opinion_on(course, (contact.name,), channels, "scipy, place and height of the block")
