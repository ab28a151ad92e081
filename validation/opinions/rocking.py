"""Third opinion on the rocking block: Housner's angle for the constraint, scipy in x, y and the angle for forces."""

import math

import numpy as np

from ...core.laws import ImpactLaw
from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .common import law_of, opinion_on
from .mechanism import Array, Course, Mechanism, run

SAMPLES = 400


@opinion("rocking_block")
def rocking_block(scenario: Scenario) -> Opinion | None:
    """With restitution 0 and friction that holds, or by force."""
    (left, _) = scenario.model.contacts
    if not isinstance(left.law, ImpactLaw):
        return _by_force(scenario)
    return _housner(scenario) if left.law.restitution == 0.0 else None


def _housner(scenario: Scenario) -> Opinion | None:
    """a'' = -p^2 sin(alpha - |a|) sgn a on a corner, and a' (1 - 3/2 sin^2 alpha) from corner to corner.

    G. W. Housner, "The behavior of inverted pendulum structures during earthquakes", Bull. Seism. Soc. Am. 53 (1963)
    403. Each corner's impulse is what the weight and the change of the centre's vertical speed take. None if the
    corners would slip.
    """
    p = scenario.parameters
    width, height, mass, gravity = (float(p[name]) for name in ("width", "height", "mass", "gravity"))
    half, alpha = 0.5 * math.hypot(width, height), math.atan2(width, height)
    kept, square = 1.0 - 1.5 * math.sin(alpha) ** 2, 0.75 * gravity / half
    holds = float(p["friction"] if p["static_friction"] is None else p["static_friction"])

    def rises(side: float, angle: float, rate: float) -> float:
        """Vertical speed of the centre, m/s, while the block stands on its right (side 1) or left (-1) corner."""
        return rate * (-0.5 * side * width * math.cos(angle) - 0.5 * height * math.sin(angle))

    course, impulses = Course(size=1), {1.0: 0.0, -1.0: 0.0}
    side, y = 1.0, np.array([-float(p["tilt"]), 0.0])
    slip = kept_slip = 0.5 * height * (1.0 - kept) / (0.5 * width * (1.0 + kept))
    while course.end < scenario.t_end:

        def bends(t: float, y: Array, side: float = side) -> list[float]:
            return [y[1], side * square * math.sin(alpha + side * y[0])]

        def level(t: float, y: Array) -> float:
            return float(y[0])

        level.terminal, level.direction = True, side  # type: ignore[attr-defined]
        start = course.end
        last, level_at = course.go_on(bends, y, scenario.t_end, [level])
        samples = course.pieces[-1](np.linspace(start, course.end, SAMPLES))
        slip = max(slip, _ratio(samples, side, width, height, square, alpha, gravity))
        impulses[side] += mass * (gravity * (course.end - start) + rises(side, *last) - rises(side, *y))
        if level_at is None:
            break
        y = np.array([0.0, kept * float(last[1])])
        impulses[-side] += mass * (rises(-side, *y) - rises(side, 0.0, float(last[1])))
        side = -side
    if max(slip, kept_slip) > holds:
        return None
    return Opinion(
        "Housner's block",
        {f"{name}: impulse of the whole run": impulses[s] for name, s in (("right", 1.0), ("left", -1.0))},
        {"block.angle": course.q(0), "block.angular_velocity": course.v(0)},
    )


def _ratio(
    y: Array, side: float, width: float, height: float, square: float, alpha: float, gravity: float
) -> float:  # fmt: skip
    """Largest |friction|/normal force at the corner on which the block stands."""
    angle, rate = y
    bend = side * square * np.sin(alpha + side * angle)
    x = -0.5 * side * width * np.cos(angle) - 0.5 * height * np.sin(angle)
    z = -0.5 * side * width * np.sin(angle) + 0.5 * height * np.cos(angle)
    across, up = -bend * z - rate**2 * x, bend * x - rate**2 * z
    return float(np.max(np.abs(across / (gravity + up))))


def _by_force(scenario: Scenario) -> Opinion:
    """Contact and friction at both corners."""
    p = scenario.parameters
    width, height, mass, gravity = (float(p[name]) for name in ("width", "height", "mass", "gravity"))
    inertia = mass * (width**2 + height**2) / 12.0
    corners = np.array([[-0.5 * width, -0.5 * height], [0.5 * width, -0.5 * height]])

    def arms(angle: float) -> tuple[Array, Array]:
        """From the centre to the corners, x (2,) and y (2,)."""
        c, s = math.cos(angle), math.sin(angle)
        return c * corners[:, 0] - s * corners[:, 1], s * corners[:, 0] + c * corners[:, 1]

    def rows(x: float, y: float, turn: Array) -> Array:
        return np.column_stack([np.full(2, x), np.full(2, y), turn])

    contacts = scenario.model.contacts
    block = Mechanism(
        mass=lambda q: np.diag([mass, mass, inertia]),
        force=lambda t, q, v: np.array([0.0, -mass * gravity, 0.0]),
        gaps=lambda q: q[1] + arms(q[2])[1],
        gradients=lambda q: rows(0.0, 1.0, arms(q[2])[0]),
        laws=tuple(law_of(c.law, c.friction) for c in contacts),
        slides=lambda q: rows(1.0, 0.0, -arms(q[2])[1]),
    )
    tilt = float(p["tilt"])
    x, y = arms(-tilt)
    course = run(block, (0.5 * width - x[1], -y[1], -tilt), (0.0, 0.0, 0.0), scenario.t_end)
    channels = {"block.angle": course.q(2), "block.angular_velocity": course.v(2)}
    return opinion_on(course, [c.name for c in contacts], channels, "scipy, place and angle of the block")
