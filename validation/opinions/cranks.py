"""Third opinions on the slider-cranks: Lagrange's equation in the crank's angle, by scipy."""

import cmath
from collections.abc import Callable

import numpy as np

from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .common import law_of, opinion_on
from .mechanism import Array, Course, Mechanism, run

STEP = 1e-30
"""Of derivatives in the complex plane (Squire and Trapp, 1998), which have no rounding to speak of."""


class Crank:
    """Crank r, rod l on it, slider on the x axis: places by the crank's angle a, and M(a) a'' + M'(a) a'^2/2 = Q."""

    def __init__(self, scenario: Scenario) -> None:
        p = scenario.parameters
        self.r, self.l, self.crank, self.rod, self.slider_mass, self.gravity = (
            float(p[name])
            for name in ("crank_length", "rod_length", "crank_mass", "rod_mass", "slider_mass", "gravity")
        )
        self.flywheel, self.torque = float(p.get("flywheel_inertia", 0.0)), float(p.get("torque", 0.0))

    def rod_angle(self, a: complex) -> complex:
        """rad."""
        return cmath.asin(-self.r / self.l * cmath.sin(a))

    def slider(self, a: complex) -> complex:
        """x, m."""
        return self.r * cmath.cos(a) + self.l * cmath.cos(self.rod_angle(a))

    def slider_slope(self, a: complex) -> complex:
        """dx/da, m."""
        return -self.r * cmath.sin(a) - self.l * cmath.sin(self.rod_angle(a)) * self._rod_slope(a)

    def _rod_slope(self, a: complex) -> complex:
        return -self.r * cmath.cos(a) / (self.l * cmath.cos(self.rod_angle(a)))

    def inertia(self, a: complex) -> complex:
        """M(a), kg m^2."""
        turn = self._rod_slope(a)
        # the rod's middle: half of what its two ends move
        x = 0.5 * (self.slider_slope(a) - self.r * cmath.sin(a))
        y = 0.5 * self.r * cmath.cos(a)
        rod = self.rod * (x * x + y * y + self.l**2 / 12.0 * turn * turn)
        return self.crank * self.r**2 / 3.0 + self.flywheel + rod + self.slider_mass * self.slider_slope(a) ** 2

    def force(self, t: float, q: Array, v: Array) -> Array:
        """Q - M' a'^2/2, N m."""
        a = float(q[0])
        slope = self.inertia(a + 1j * STEP).imag / STEP
        weight = 0.5 * (self.crank + self.rod) * self.gravity * self.r * cmath.cos(a).real
        return np.array([self.torque - weight - 0.5 * slope * v[0] ** 2])

    def mass(self, q: Array) -> Array:
        """(1, 1)."""
        return np.array([[self.inertia(float(q[0])).real]])

    def channels(self, course: Course) -> dict[str, Callable[[float], float]]:
        """Of the whole mechanism."""
        a, w = course.q(0), course.v(0)
        return {
            "crank.angle": a,
            "crank.angular_velocity": w,
            "rod.angle": lambda t: self.rod_angle(a(t)).real,
            "slider.x": lambda t: self.slider(a(t)).real,
            "slider.vx": lambda t: self.slider_slope(a(t)).real * w(t),
        }


@opinion("slider_crank")
def slider_crank(scenario: Scenario) -> Opinion | None:
    """Without contact; None for an elastic wrist pin."""
    p, crank = scenario.parameters, Crank(scenario)
    if p["bushing_stiffness"]:
        return None
    course = run(
        Mechanism(crank.mass, crank.force), (float(p["crank_angle"]),), (float(p["crank_speed"]),), scenario.t_end
    )
    return Opinion("scipy, the crank's angle", {}, crank.channels(course))


@opinion("slider_crank_stop")
def slider_crank_stop(scenario: Scenario) -> Opinion | None:
    """With the stop, which the slider touches at the stop angle."""
    p, crank = scenario.parameters, Crank(scenario)
    stop = crank.slider(float(p["stop_angle"])).real
    (contact,) = scenario.model.contacts
    mechanism = Mechanism(
        crank.mass,
        crank.force,
        gaps=lambda q: np.array([stop - crank.slider(float(q[0])).real]),
        gradients=lambda q: np.array([[-crank.slider_slope(float(q[0])).real]]),
        laws=(law_of(contact.law),),
    )
    course = run(mechanism, (float(p["crank_angle"]),), (float(p["crank_speed"]),), scenario.t_end)
    return opinion_on(course, (contact.name,), crank.channels(course), "scipy, the crank's angle")
