"""Independent reference of `double_pendulum_wall`: both angles by DOP853, blows by the reduced mass matrix.

With the angles a, b of the rods from the x axis, the tip's x - wall - radius is the gap g. Between the blows Lagrange's
equations of two slender rods; at a blow M (w+ - w-) = P dg/dq with P = -(1 + e) g'^- / (dg/dq M^-1 dg/dq). Nothing is
shared with the solver: neither coordinates, nor constraints, nor event location.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from ...models import Scenario, load

Array = NDArray[np.float64]

TOLERANCE = 3e-14
"""rtol and atol of DOP853."""
LONGEST = 0.02
"""Longest step, s: no blow is stepped over."""
POLISH = 3
"""Newton steps onto the touch, each with an integration of its own, from where the dense output has found it."""
NAMES = ("upper.angle", "lower.angle", "upper.angular_velocity", "lower.angular_velocity")


@dataclass(frozen=True)
class Blow:
    """A blow: time (s), approach speed (m/s), impulse (N s), loss of energy (J)."""

    t: float
    approach_speed: float
    impulse: float
    energy_loss: float


@dataclass(frozen=True)
class Course:
    """A motion: its end (a, b, a', b'), its blows, and when (s) the tip left the wall again if it had stayed there."""

    end: Array
    blows: tuple[Blow, ...]
    openings: tuple[float, ...]


@dataclass(frozen=True)
class DoublePendulum:
    """Two rods and a wall, with the parameters of the scenario `double_pendulum_wall`."""

    parameters: Mapping[str, Any]

    @classmethod
    def of(cls, scenario: Scenario | None = None) -> "DoublePendulum":
        """That of a scenario; None: with its defaults."""
        return cls(dict((scenario or load("double_pendulum_wall")).parameters))

    def mass(self, a: float, b: float) -> Array:
        """Mass matrix of the angles (2, 2), kg m^2."""
        p = self.parameters
        l1, l2, m1, m2 = p["upper_length"], p["lower_length"], p["upper_mass"], p["lower_mass"]
        couple = 0.5 * m2 * l1 * l2 * math.cos(a - b)
        return np.array([[(m1 / 3.0 + m2) * l1**2, couple], [couple, m2 * l2**2 / 3.0]])

    def accelerations(self, y: Array) -> Array:
        """Second rates of the angles (2,), rad/s^2, at (a, b, a', b')."""
        p = self.parameters
        l1, l2, m1, m2, g = (p[k] for k in ("upper_length", "lower_length", "upper_mass", "lower_mass", "gravity"))
        a, b, u, w = y
        turning = 0.5 * m2 * l1 * l2 * math.sin(a - b)
        load_a = -turning * w**2 - g * (0.5 * m1 + m2) * l1 * math.cos(a)
        load_b = turning * u**2 - 0.5 * g * m2 * l2 * math.cos(b)
        return np.asarray(np.linalg.solve(self.mass(a, b), [load_a, load_b]))

    def gap(self, y: Array) -> float:
        """Gap at the wall, m."""
        p = self.parameters
        tip = p["upper_length"] * math.cos(y[0]) + p["lower_length"] * math.cos(y[1])
        return float(tip - p["wall"] - p["radius"])

    def gradient(self, y: Array) -> Array:
        """Of the gap over the angles (2,), m/rad."""
        p = self.parameters
        return np.array([-p["upper_length"] * math.sin(y[0]), -p["lower_length"] * math.sin(y[1])])

    def energy(self, y: Array) -> float:
        """Kinetic and potential energy, J."""
        p = self.parameters
        l1, l2, m1, m2, g = (p[k] for k in ("upper_length", "lower_length", "upper_mass", "lower_mass", "gravity"))
        height = (0.5 * m1 + m2) * l1 * math.sin(y[0]) + 0.5 * m2 * l2 * math.sin(y[1])
        return float(0.5 * y[2:] @ self.mass(y[0], y[1]) @ y[2:] + g * height)

    def start(self) -> Array:
        """(a, b, a', b') at the start."""
        return np.array([self.parameters["upper_angle"], self.parameters["lower_angle"], 0.0, 0.0])

    def strike(self, t: float, y: Array) -> tuple[Array, Blow]:
        """The state after a blow, and the blow."""
        e = self.parameters["restitution"]
        gradient = self.gradient(y)
        approach = -float(gradient @ y[2:])
        response = np.linalg.solve(self.mass(y[0], y[1]), gradient)
        impulse = (1.0 + e) * approach / float(gradient @ response)
        after = np.concatenate([y[:2], y[2:] + impulse * response])
        return after, Blow(t, approach, impulse, 0.5 * (1.0 - e) * impulse * approach)

    def force(self, y: Array) -> float:
        """Force of the wall while the tip slides along it, N: M q'' = Q + F dg/dq with g'' = 0."""
        gradient = self.gradient(y)
        response = np.linalg.solve(self.mass(y[0], y[1]), gradient)
        return -self._gap_acceleration(y, self.accelerations(y)) / float(gradient @ response)

    def solve(self, t_end: float, tolerance: float = TOLERANCE) -> Course:
        """The motion to `t_end`. With restitution the blows must not accumulate; without, the tip stays at the wall
        until the force on it vanishes."""
        t, y = 0.0, self.start()
        blows: list[Blow] = []
        openings: list[float] = []
        while True:
            found = self._go(t, t_end, y, tolerance, self.gap)
            if found.status != 1:
                return Course(np.asarray(found.y[:, -1]), tuple(blows), tuple(openings))
            touch = float(found.t_events[0][0])
            y = self._go(t, touch, y, tolerance).y[:, -1]
            for _ in range(POLISH):
                step = -self.gap(y) / float(self.gradient(y) @ y[2:])
                y = self._go(touch, touch + step, y, tolerance).y[:, -1]
                touch += step
            y, blow = self.strike(touch, y)
            blows.append(blow)
            t = touch
            if self.parameters["restitution"] == 0.0 and self.force(y) > 0.0:
                found = self._go(t, t_end, y, tolerance, self.force)
                t, y = float(found.t[-1]), found.y[:, -1]
                openings.append(t if found.status == 1 else math.inf)

    def _gap_acceleration(self, y: Array, accelerations: Array) -> float:
        p = self.parameters
        curving = p["upper_length"] * math.cos(y[0]) * y[2] ** 2 + p["lower_length"] * math.cos(y[1]) * y[3] ** 2
        return float(self.gradient(y) @ accelerations - curving)

    def _go(self, t: float, t_end: float, y: Array, tolerance: float, until: Any = None) -> Any:
        """Motion from t to t_end, or to where `until`, the gap or the force of a wall that the tip slides along,
        becomes negative."""
        slides = until == self.force

        def ends(t: float, y: Array) -> float:
            return float(until(y))

        def motion(t: float, y: Array) -> list[float]:
            rates = self.accelerations(y)
            if slides:
                rates = rates + self.force(y) * np.linalg.solve(self.mass(y[0], y[1]), self.gradient(y))
            return [y[2], y[3], *rates]

        ends.terminal, ends.direction = True, -1.0  # type: ignore[attr-defined]
        return solve_ivp(
            motion, (t, t_end), y, "DOP853", rtol=tolerance, atol=tolerance, max_step=LONGEST,
            events=ends if until else None,
        )  # fmt: skip
