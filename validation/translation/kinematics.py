"""Gap, gap rate and normal of a contact from the motion of its bodies: vectorised over time.

Written from the geometry, not from the solver's kernels: a cross-check must not share what it checks.
"""

from dataclasses import dataclass, field

import numpy as np

from ...core.contacts.contact2d import Disk2D, HalfPlane2D
from ...core.model.markers import Marker2D

Pair = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class BodyStates:
    """Motion of one body: arrays over time, m, rad, m/s, rad/s. A point mass has angle 0."""

    x: np.ndarray
    y: np.ndarray
    angle: np.ndarray
    vx: np.ndarray
    vy: np.ndarray
    angular_velocity: np.ndarray


@dataclass(frozen=True)
class States:
    """Motion of all bodies; bodies that are not there (the ground) rest at the origin."""

    size: int
    bodies: dict[str, BodyStates] = field(default_factory=dict)

    def of(self, body: str) -> BodyStates:
        zero = np.zeros(self.size)
        return self.bodies.get(body, BodyStates(zero, zero, zero, zero, zero, zero))

    def point(self, marker: Marker2D) -> tuple[Pair, Pair]:
        """Position and velocity of a marker."""
        b = self.of(marker.body)
        ux, uy = marker.point
        c, s = np.cos(b.angle), np.sin(b.angle)
        rx, ry = c * ux - s * uy, s * ux + c * uy
        return (b.x + rx, b.y + ry), (b.vx - b.angular_velocity * ry, b.vy + b.angular_velocity * rx)


@dataclass(frozen=True)
class GapMotion:
    """Gap (m), its rate (m/s) and the unit normal from the first shape to the second."""

    gap: np.ndarray
    rate: np.ndarray
    normal: Pair


def gap_motion(shapes: tuple[HalfPlane2D | Disk2D, Disk2D], states: States) -> GapMotion:
    """Gap between two shapes over time."""
    first, second = shapes
    (ax, ay), (avx, avy) = states.point(first.marker)
    (bx, by), (bvx, bvy) = states.point(second.marker)
    dx, dy, dvx, dvy = bx - ax, by - ay, bvx - avx, bvy - avy
    if isinstance(first, HalfPlane2D):
        body = states.of(first.marker.body)
        direction = body.angle + first.marker.angle
        nx, ny = -np.sin(direction), np.cos(direction)
        w = body.angular_velocity
        rate = nx * dvx + ny * dvy + w * (-ny * dx + nx * dy)
        return GapMotion(nx * dx + ny * dy - second.radius, rate, (nx, ny))
    distance = np.hypot(dx, dy)
    nx, ny = dx / distance, dy / distance
    return GapMotion(distance - first.radius - second.radius, nx * dvx + ny * dvy, (nx, ny))
