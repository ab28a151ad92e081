"""Third opinion on the cradle in space: x and y of the balls under their strings' ends, by scipy."""

from collections.abc import Callable

import numpy as np

from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .common import law_of, opinion_on
from .mechanism import Array, Mechanism, run


@opinion("spatial_cradle")
def spatial_cradle(scenario: Scenario) -> Opinion | None:
    """Each ball hangs at z = -sqrt(L^2 - x^2 - y^2), so that M = m (1 + z_q^T z_q) and the force is
    -m (g + v^T z_qq v) z_q. None with friction, and where balls touch as they hang."""
    p = scenario.parameters
    if float(p["friction"]) > 0.0 or float(p["gap"]) == 0.0:
        return None
    model, length, radius = scenario.model, float(p["length"]), float(p["radius"])
    mass, gravity, count = float(p["mass"]), float(p["gravity"]), int(p["balls"])
    ends = np.zeros((count, 2))
    ends[:, 0] = np.arange(count) * (2.0 * radius + float(p["gap"]))

    def depth(q: Array) -> tuple[Array, Array]:
        """z (balls,) and its gradients (balls, 2)."""
        x = q.reshape(-1, 2)
        z = -np.sqrt(length**2 - np.sum(x * x, axis=1))
        return z, -x / z[:, None]

    def whole(q: Array) -> Array:
        _, rise = depth(q)
        found = np.zeros((2 * count, 2 * count))
        for k in range(count):
            found[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = mass * (np.eye(2) + np.outer(rise[k], rise[k]))
        return found

    def force(t: float, q: Array, v: Array) -> Array:
        z, rise = depth(q)
        u = v.reshape(-1, 2)
        # z z_qq = -1 - z_q z_q^T
        bend = -(np.sum(u * u, axis=1) + np.sum(u * rise, axis=1) ** 2) / z
        found: Array = (-mass * (gravity + bend)[:, None] * rise).ravel()
        return found

    def between(q: Array) -> tuple[Array, Array]:
        """Gaps (contacts,) and their gradients (contacts, coordinates)."""
        z, rise = depth(q)
        place = np.column_stack([q.reshape(-1, 2) + ends, z])
        way = np.diff(place, axis=0)
        distance = np.linalg.norm(way, axis=1)
        rows = np.zeros((count - 1, 2 * count))
        for k, n in enumerate(way / distance[:, None]):
            rows[k, 2 * k : 2 * k + 2] = -n[:2] - n[2] * rise[k]
            rows[k, 2 * k + 2 : 2 * k + 4] = n[:2] + n[2] * rise[k + 1]
        return distance - 2.0 * radius, rows

    cradle = Mechanism(
        mass=whole, force=force, gaps=lambda q: between(q)[0], gradients=lambda q: between(q)[1],
        laws=tuple(law_of(contact.law) for contact in model.contacts),
    )  # fmt: skip
    states = [body.initial_state() for body in model.bodies]
    start = np.array([q[:2] for q, _ in states]) - ends
    course = run(cradle, start.ravel().tolist(), [x for _, v in states for x in v[:2]], scenario.t_end)
    channels: dict[str, Callable[[float], float]] = {}
    for k in range(count):
        channels[f"ball{k + 1}.x"] = _shifted(course.q(2 * k), float(ends[k, 0]))
        channels[f"ball{k + 1}.y"] = course.q(2 * k + 1)
        channels[f"ball{k + 1}.vx"] = course.v(2 * k)
    return opinion_on(course, [c.name for c in model.contacts], channels, "scipy, x and y of the balls")


def _shifted(course: Callable[[float], float], by: float) -> Callable[[float], float]:
    return lambda t: course(t) + by
