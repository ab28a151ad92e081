"""Third opinion on the woodpecker: Glocker's three coordinates, impacts and friction by trying all modes."""

import numpy as np

from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .coulomb import Rubbing, run
from .mechanism import Array

SLEEVE, BIRD = (3e-4, 5e-9), (4.5e-3, 7e-7)
"""Masses (kg) and moments of inertia (kg m^2)."""
SPRING, SPRING_ARM, BIRD_ARM = 5.6e-3, 10e-3, 15e-3
POLE, BORE, EDGE = 2.5e-3, 3.1e-3, 5.8e-3
BEAK_UP, BEAK_OUT = 20e-3, 20.1e-3
"""Spring N m/rad; arms, radii of pole and sleeve, half height of the sleeve, place of the beak, m."""
START, RATES = (0.0, -(BORE - POLE) / EDGE, -0.2788), (-0.3411, 0.0, -7.4583)


@opinion("woodpecker")
def woodpecker(scenario: Scenario) -> Opinion | None:
    """Height of the sleeve, angles of sleeve and bird, from the kinetic energy
    m_s y'^2/2 + J_s s'^2/2 + m_b (y' + a s' + b p')^2/2 + J_b p'^2/2, a and b the arms to spring and bird."""
    p = scenario.parameters
    mu, e, gravity = float(p["friction"]), float(p["restitution"]), float(p["gravity"])
    arms = np.array([1.0, SPRING_ARM, BIRD_ARM])
    mass = np.diag([SLEEVE[0], SLEEVE[1], BIRD[1]]) + BIRD[0] * np.outer(arms, arms)
    weight = -gravity * (BIRD[0] * arms + np.array([SLEEVE[0], 0.0, 0.0]))
    twist = np.array([0.0, 1.0, -1.0])

    def force(q: Array, v: Array) -> Array:
        return weight - SPRING * float(twist @ q) * twist

    clearance, reach = BORE - POLE, SPRING_ARM + BIRD_ARM - BEAK_OUT - POLE
    system = Rubbing(
        mass,
        force,
        offsets=np.array([reach, clearance, clearance]),
        gradients=np.array([[0.0, 0.0, -BEAK_UP], [0.0, EDGE, 0.0], [0.0, -EDGE, 0.0]]),
        slides=np.array([[1.0, SPRING_ARM, BIRD_ARM - BEAK_OUT], [1.0, BORE, 0.0], [1.0, BORE, 0.0]]),
        friction=np.full(3, mu),
        restitution=np.array([e, 0.0, 0.0]),
    )
    course = run(system, START, RATES, scenario.t_end)
    channels = {"toy.y": course.q(0), "toy.sleeve": course.q(1), "toy.bird": course.q(2), "toy.d_bird": course.v(2)}
    return Opinion(
        "scipy, the toy's three coordinates",
        {f"{name}: impulse of the whole run": float(x)
         for name, x in zip(("beak", "lower", "upper"), course.impulses, strict=True)},
        channels,
    )  # fmt: skip
