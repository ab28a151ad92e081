"""Attitudes for third opinions in space: unit quaternions that turn with a body's angular velocity."""

from collections.abc import Callable, Sequence

import numpy as np

from ...core.elements import RigidBody3D
from ...models import Scenario
from .mechanism import Array


def only_body(scenario: Scenario) -> RigidBody3D:
    """The rigid body of a scenario that has one alone."""
    (body,) = scenario.model.bodies
    if not isinstance(body, RigidBody3D):
        raise TypeError(f"'{body.name}' of '{scenario.name}' is no RigidBody3D, but a {type(body).__name__}")
    return body


def components(names: Sequence[str], vector: Callable[[float], Array]) -> dict[str, Callable[[float], float]]:
    """Channels from the components of a vector of time, in the order of the names."""

    def component(k: int) -> Callable[[float], float]:
        return lambda t: float(vector(t)[k])

    return {name: component(k) for k, name in enumerate(names)}


def matrix(p: Array) -> Array:
    """Rotation matrix (3, 3) of a quaternion (4,), scalar part first; scaled to unit length."""
    a, b, c, d = p / np.linalg.norm(p)
    return np.array([
        [1.0 - 2.0 * (c * c + d * d), 2.0 * (b * c - a * d), 2.0 * (b * d + a * c)],
        [2.0 * (b * c + a * d), 1.0 - 2.0 * (b * b + d * d), 2.0 * (c * d - a * b)],
        [2.0 * (b * d - a * c), 2.0 * (c * d + a * b), 1.0 - 2.0 * (b * b + c * c)],
    ])  # fmt: skip


def quaternion_rate(p: Array, w: Array) -> Array:
    """p' (4,) of a body that turns with w (3,), rad/s, along its own axes: half the product of p and (0, w)."""
    return 0.5 * np.concatenate([[-p[1:] @ w], p[0] * w + np.cross(p[1:], w)])


def turn_rate(inertia: Array, w: Array, torque: Array) -> Array:
    """w' (3,) by Euler's equations, with principal moments (3,) and a torque (3,) along the body's axes."""
    rate: Array = (torque - np.cross(w, inertia * w)) / inertia
    return rate
