"""Point masses and rigid bodies in the plane: inertia and weight.

r += M a - m g with M = diag(m, m, J), J about the centre of mass.
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Positive, Vector2
from ..model.markers import Marker, Marker2D
from .base import BodyElement, Numbering, Row
from .coordinate import Coordinate, X, Y


@internal
def planar_body_kernel(job: int, t: float, b: Any) -> None:
    par = mat(b.par, b.count, 5)
    coord = imat(b.coord, b.count, 3)
    if job == RESIDUAL:
        a = vec(b.a, b.n_extended)
        r = vec(b.r, b.n_extended)
        for e in range(b.count):
            i, j, k = coord[e, 0], coord[e, 1], coord[e, 2]
            r[i] += par[e, 0] * a[i] - par[e, 2]
            r[j] += par[e, 0] * a[j] - par[e, 3]
            r[k] += par[e, 1] * a[k]
    elif job == TANGENT:
        values = vec(b.values, b.n_values)
        slot = imat(b.slot_s, b.count, 9)
        for e in range(b.count):
            values[slot[e, 0]] += par[e, 0]
            values[slot[e, 4]] += par[e, 0]
            values[slot[e, 8]] += par[e, 1]
    elif job == ENERGY:
        q = vec(b.q, b.n_extended)
        v = vec(b.v, b.n_extended)
        energy = vec(b.energy, 3)
        for e in range(b.count):
            i, j, k = coord[e, 0], coord[e, 1], coord[e, 2]
            energy[0] += 0.5 * (par[e, 0] * (v[i] * v[i] + v[j] * v[j]) + par[e, 1] * v[k] * v[k])
            energy[1] -= par[e, 2] * q[i] + par[e, 3] * q[j]


ANGLE_COORDINATE = Coordinate("angle", "rad", "angular_velocity", "angular_acceleration", 1.0)


class PlanarFrame(BodyElement):
    """Base of what moves like a rigid body in the plane: coordinates x, y and (but for point masses) angle. Markers
    can be put on it."""

    carries: ClassVar[type[Marker] | None] = Marker2D


class PlanarBody(PlanarFrame):
    """Base of the planar bodies."""

    kernel: ClassVar[Any] = planar_body_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ((0, 0), (1, 1), (2, 2))

    mass: Positive
    """Mass, kg."""
    position: Vector2 = (0.0, 0.0)
    """Initial position of the centre of mass, m."""
    velocity: Vector2 = (0.0, 0.0)
    """Initial velocity of the centre of mass, m/s."""

    def extent(self) -> Sequence[tuple[float, float]]:
        return (self.position,)

    def typical_mass(self) -> float:
        return self.mass

    def _row(self, numbering: Numbering, inertia: float) -> Row:
        gx, gy, _ = numbering.gravity
        return Row((self.mass, inertia, self.mass * gx, self.mass * gy, 0.0), numbering.coordinates(self.name))


class PointMass2D(PlanarBody):
    """A point mass with coordinates x, y."""

    type: Literal["PointMass2D"] = "PointMass2D"

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (X, Y)

    def check_marker(self, user: str, marker: Marker) -> None:
        super().check_marker(user, marker)
        if not marker.at_origin:
            raise ValueError(
                f"'{user}' has a marker at {marker.point} of point mass '{self.name}', which has no extension: use "
                "(0, 0), or a RigidBody2D"
            )

    def row(self, numbering: Numbering) -> Row:
        return self._row(numbering, 0.0)

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        return self.position, self.velocity


class RigidBody2D(PlanarBody):
    """A rigid body with coordinates x, y (centre of mass) and angle."""

    type: Literal["RigidBody2D"] = "RigidBody2D"

    inertia: Positive
    """Moment of inertia about the centre of mass, kg m^2."""
    angle: float = 0.0
    """Initial angle, rad."""
    angular_velocity: float = 0.0
    """Initial angular velocity, rad/s."""

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (X, Y, ANGLE_COORDINATE)

    def row(self, numbering: Numbering) -> Row:
        return self._row(numbering, self.inertia)

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        return (*self.position, self.angle), (*self.velocity, self.angular_velocity)
