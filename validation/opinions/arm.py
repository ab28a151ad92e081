"""Third opinion on the arm with its end stop: Lagrange's equations in three angles, by scipy."""

import math
from collections.abc import Callable

import numpy as np

from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .common import law_of, opinion_on
from .mechanism import Array, Mechanism, run


@opinion("arm_stop")
def arm_stop(scenario: Scenario) -> Opinion | None:
    """The column's angle, and those of both links from the level, downwards (p, a, b).

    About the vertical M_p = J + sum m r^2 + I cos^2 + I_axial sin^2, r the distances of the centres of mass from it; in
    the arm's plane a double pendulum. None with friction.
    """
    p = scenario.parameters
    if float(p["friction"]) > 0.0:
        return None
    g, k, c = (float(p[name]) for name in ("gravity", "shoulder_stiffness", "shoulder_damping"))
    (l1, m1, i1, j1), (l2, m2, i2, j2) = (
        _link(*(p[f"{name}_{what}"] for what in ("length", "mass", "inertia", "axial_inertia")))
        for name in ("upper", "lower")
    )
    column, radius, table = (float(p[name]) for name in ("column_inertia", "tip_radius", "table"))

    def about(a: float, b: float) -> tuple[float, float, float]:
        """M_p and its derivatives by a and b."""
        ca, sa, cb, sb = math.cos(a), math.sin(a), math.cos(b), math.sin(b)
        far = l1 * ca + 0.5 * l2 * cb
        found = column + (0.25 * m1 * l1**2 + i1) * ca**2 + j1 * sa**2 + m2 * far**2 + i2 * cb**2 + j2 * sb**2
        by_a = 2.0 * (j1 - i1 - 0.25 * m1 * l1**2) * ca * sa - 2.0 * m2 * far * l1 * sa
        return found, by_a, 2.0 * (j2 - i2) * cb * sb - m2 * far * l2 * sb

    def mass(q: Array) -> Array:
        coupled = 0.5 * m2 * l1 * l2 * math.cos(q[1] - q[2])
        return np.array([
            [about(q[1], q[2])[0], 0.0, 0.0],
            [0.0, (0.25 * m1 + m2) * l1**2 + i1, coupled],
            [0.0, coupled, 0.25 * m2 * l2**2 + i2],
        ])  # fmt: skip

    def force(t: float, q: Array, v: Array) -> Array:
        _, by_a, by_b = about(q[1], q[2])
        swing = 0.5 * m2 * l1 * l2 * math.sin(q[1] - q[2])
        weight_a, weight_b = g * l1 * (0.5 * m1 + m2) * math.cos(q[1]), 0.5 * g * m2 * l2 * math.cos(q[2])
        return np.array([
            -(by_a * v[1] + by_b * v[2]) * v[0],
            0.5 * by_a * v[0] ** 2 - swing * v[2] ** 2 + weight_a - k * q[1] - c * v[1],
            0.5 * by_b * v[0] ** 2 + swing * v[1] ** 2 + weight_b,
        ])  # fmt: skip

    gap: dict[str, Callable[[Array], float]] = {
        "table": lambda q: -l1 * math.sin(q[1]) - l2 * math.sin(q[2]) - radius - table,
        "elbow_table": lambda q: -l1 * math.sin(q[1]) - radius - table,
        "elbow_stop": lambda q: q[2] - q[1] - float(p["elbow_limit"]),
    }
    slope: dict[str, Callable[[Array], list[float]]] = {
        "table": lambda q: [0.0, -l1 * math.cos(q[1]), -l2 * math.cos(q[2])],
        "elbow_table": lambda q: [0.0, -l1 * math.cos(q[1]), 0.0],
        "elbow_stop": lambda q: [0.0, -1.0, 1.0],
    }
    names = [contact.name for contact in scenario.model.contacts]
    arm = Mechanism(
        mass=mass, force=force, gaps=lambda q: np.array([gap[name](q) for name in names]),
        gradients=lambda q: np.array([slope[name](q) for name in names]),
        laws=tuple(law_of(contact.law) for contact in scenario.model.contacts),
    )  # fmt: skip
    a, b, rate_a, rate_b = (float(p[name]) for name in ("shoulder_angle", "elbow_angle", "shoulder_rate", "elbow_rate"))
    course = run(arm, (0.0, a, a + b), (float(p["turn_rate"]), rate_a, rate_a + rate_b), scenario.t_end)

    def reach(t: float) -> float:
        _, a, b = course.state(t)[0]
        return l1 * math.cos(a) + 0.5 * l2 * math.cos(b)

    turn, upper, lower = (course.q(k) for k in range(3))
    channels: dict[str, Callable[[float], float]] = {
        "lower.x": lambda t: reach(t) * math.cos(turn(t)),
        "lower.y": lambda t: reach(t) * math.sin(turn(t)),
        "lower.z": lambda t: -l1 * math.sin(upper(t)) - 0.5 * l2 * math.sin(lower(t)),
        "shoulder.angle": upper,
        "elbow.angle": lambda t: lower(t) - upper(t),
        "column.angular_velocity_z": course.v(0),
    }
    return opinion_on(course, names, channels, "scipy, the angles of column and links")


def _link(length: object, mass: object, across: object, along: object) -> tuple[float, float, float, float]:
    """(length, mass, inertia across, inertia along), with those of a rod where none is given."""
    size, heavy = float(str(length)), float(str(mass))
    return (
        size,
        heavy,
        heavy * size**2 / 12.0 if across is None else float(str(across)),
        0.01 * heavy * size**2 if along is None else float(str(along)),
    )
