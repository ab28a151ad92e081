"""Point masses and rigid bodies in space: inertia, weight and the norm of the Euler parameters.

r_R = m R'' - m g    r_p = 4 G^T J G p'' + 2 G^T (w x J w) + 2 p lam    Phi = p.p - 1
with w = 2 G p', J about the centre of mass, in the body. With the gyroscopic term in this form lam is zero without
loads. The norm is not brought back to 1 by scaling: it is a constraint like others, and the largest Euler parameter is
mostly its dependent coordinate.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from ..compiled.jit import inlined, internal
from ..compiled.kernels import ENERGY, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.angular_velocity import AngularVelocity
from ..model.attitude import UPRIGHT, Attitude, EulerParameters, product, rotation_matrix
from ..model.base import Positive, Vector3
from ..model.derived import Derived
from ..model.markers import GROUND, Marker, Marker3D
from ..model.rotation3d import (
    add_torque_bend,
    body_axes,
    body_rate,
    cross,
    dot,
    four,
    of_body_torque,
    plus,
    three,
    times,
)
from ..rounding import TRIANGLE
from .base import BodyElement, Numbering, Row
from .coordinate import Coordinate, X, Y, Z

EULER = tuple(Coordinate(f"e{k}", "1", f"e{k}_rate", f"e{k}_acceleration", 1.0, turns=True) for k in range(4))


@inlined
def inertia_times(par: Any, w: Any) -> Any:
    """J w, with J = par[1:7] (xx, yy, zz, xy, xz, yz)."""
    return (
        par[1] * w[0] + par[4] * w[1] + par[5] * w[2],
        par[4] * w[0] + par[2] * w[1] + par[6] * w[2],
        par[5] * w[0] + par[6] * w[1] + par[3] * w[2],
    )


@internal
def point_mass3d_kernel(job: int, t: float, b: Any) -> None:
    par, coord = mat(b.par, b.count, 4), imat(b.coord, b.count, 3)  # mass, weight
    for e in range(b.count):
        if job == RESIDUAL:
            a, r = vec(b.a, b.n_extended), vec(b.r, b.n_extended)
            for i in range(3):
                r[coord[e, i]] += par[e, 0] * a[coord[e, i]] - par[e, 1 + i]
        elif job == TANGENT:
            values, slot = vec(b.values, b.n_values), imat(b.slot_s, b.count, 9)
            for i in range(3):
                values[slot[e, 4 * i]] += par[e, 0]
        elif job == ENERGY:
            q, v, energy = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.energy, 3)
            for i in range(3):
                energy[0] += 0.5 * par[e, 0] * v[coord[e, i]] ** 2
                energy[1] -= par[e, 1 + i] * q[coord[e, i]]


@internal
def rigid_body3d_kernel(job: int, t: float, b: Any) -> None:
    par, coord = mat(b.par, b.count, 10), imat(b.coord, b.count, 7)  # mass, inertia (6), weight (3)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    for e in range(b.count):
        m = par[e, 0]
        p, pd = four(q, coord[e], 3, 0.0), four(v, coord[e], 3, 0.0)
        w = times(2.0, body_rate(p, pd))
        momentum = inertia_times(par[e], w)
        if job == ENERGY:
            energy, velocity = vec(b.energy, 3), three(v, coord[e], 0)
            energy[0] += 0.5 * (m * dot(velocity, velocity) + dot(w, momentum))
            for i in range(3):
                energy[1] -= par[e, 7 + i] * q[coord[e, i]]
        elif job == RESIDUAL:
            a, r = vec(b.a, b.n_extended), vec(b.r, b.n_extended)
            k = imat(b.row, b.count, 1)[e, 0]
            pdd = four(a, coord[e], 3, 0.0)
            for i in range(3):
                r[coord[e, i]] += m * a[coord[e, i]] - par[e, 7 + i]
            turn = plus(inertia_times(par[e], times(4.0, body_rate(p, pdd))), times(2.0, cross(w, momentum)))
            force, lam = of_body_torque(p, turn), vec(b.lam, b.m_extended)[k]
            norm, rate, second = -1.0, 0.0, 0.0
            for i in range(4):
                r[coord[e, 3 + i]] += force[i] + 2.0 * p[i] * lam
                norm += p[i] * p[i]
                rate += 2.0 * p[i] * pd[i]
                second += 2.0 * (p[i] * pdd[i] + pd[i] * pd[i])
            vec(b.phi, b.m_extended)[k] = norm
            vec(b.phid, b.m_extended)[k] = rate
            vec(b.phidd, b.m_extended)[k] = second
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * 49 * e, 7, 7)
            slot_j, slot_jt = imat(b.slot_j, b.count, 7)[e], imat(b.slot_jt, b.count, 7)[e]
            lam = vec(b.lam, b.m_extended)[imat(b.row, b.count, 1)[e, 0]]
            pdd = four(vec(b.a, b.n_extended), coord[e], 3, 0.0)
            for i in range(3):
                values[slot[i, i]] += m
            axes, by_rate, by_second = body_axes(p), body_axes(pd), body_axes(pdd)
            # r_p = G^T y(p, p', p'') + 2 p lam with y = 4 J G p'' + 2 w x J w, and G(p) b = -G(b) p
            y = plus(inertia_times(par[e], times(4.0, body_rate(p, pdd))), times(2.0, cross(w, momentum)))
            for j in range(4):
                of_mass = times(4.0, inertia_times(par[e], axes[j]))
                wj = times(2.0, axes[j])
                of_v = times(2.0, plus(cross(wj, momentum), cross(w, inertia_times(par[e], wj))))
                wj = times(-2.0, by_rate[j])
                of_q = times(2.0, plus(cross(wj, momentum), cross(w, inertia_times(par[e], wj))))
                of_q = plus(of_q, times(-4.0, inertia_times(par[e], by_second[j])))
                total = plus(of_mass, plus(times(coef[1], of_v), times(coef[0], of_q)))
                for i in range(4):
                    values[slot[3 + i, 3 + j]] += dot(axes[i], total)
                values[slot[3 + j, 3 + j]] += 2.0 * coef[0] * lam
                values[slot_j[3 + j]] += 2.0 * p[j]
                values[slot_jt[3 + j]] += 2.0 * p[j]
            add_torque_bend(values, slot, times(coef[0], y), 1.0)


class SpatialFrame(BodyElement):
    """Base of what moves like a rigid body in space: coordinates x, y, z and (but for point masses) four Euler
    parameters. Markers can be put on it."""

    carries: ClassVar[type[Marker] | None] = Marker3D


class SpatialBody(SpatialFrame):
    """Base of the bodies in space."""

    mass: Positive
    """Mass, kg."""
    position: Vector3 = (0.0, 0.0, 0.0)
    """Initial position of the centre of mass, m."""
    velocity: Vector3 = (0.0, 0.0, 0.0)
    """Initial velocity of the centre of mass, m/s."""

    def extent(self) -> Sequence[tuple[float, ...]]:
        return (self.position,)

    def typical_mass(self) -> float:
        return self.mass

    def weight(self, numbering: Numbering) -> tuple[float, ...]:
        """N, in the directions of space."""
        return tuple(self.mass * g for g in numbering.gravity)

    def marker_at(self, point: Vector3, attitude: Attitude = UPRIGHT) -> Marker3D:
        """The marker on this body that is at `point` (m) with `attitude` in space where the body starts."""
        return marker_on(self, point, attitude)


def start_of_marker(marker: Marker3D, bodies: Mapping[str, BodyElement]) -> tuple[np.ndarray, np.ndarray]:
    """Point (3,) and axes (3, 3) as columns of a marker in space at the start, m."""
    own = () if marker.body == GROUND else bodies[marker.body].start_in(bodies)[0][: len(marker.rest)]
    q = (*own, *marker.rest[len(own) :])
    turn = rotation_matrix(q[3:])
    return np.array(q[:3]) + turn @ np.array(marker.point), turn @ marker.axes()


def angle_between(a: Marker3D, b: Marker3D, bodies: Mapping[str, BodyElement]) -> float:
    """Angle from the x axis of marker a to that of marker b about the z axis of marker a at the start, rad."""
    (_, of_a), (_, of_b) = start_of_marker(a, bodies), start_of_marker(b, bodies)
    return math.atan2(of_a[:, 1] @ of_b[:, 0], of_a[:, 0] @ of_b[:, 0])


def marker_on(body: SpatialFrame, point: Vector3, attitude: Attitude) -> Marker3D:
    """The marker on `body` that is at `point` (m) with `attitude` in space where the body starts."""
    q = (*body.initial_state()[0], *Marker3D.rest[3:])
    turn = rotation_matrix(q[3:7])
    x, y, z = (turn.T @ (np.array(point) - q[:3])).tolist()
    back = (q[3], -q[4], -q[5], -q[6])
    own = EulerParameters(values=product(back, attitude.parameters()))
    return Marker3D(body=body.name, point=(x, y, z), attitude=own)


class PointMass3D(SpatialBody):
    """A point mass with coordinates x, y, z."""

    type: Literal["PointMass3D"] = "PointMass3D"
    kernel: ClassVar[Any] = point_mass3d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ((0, 0), (1, 1), (2, 2))

    @property
    def linear(self) -> bool:
        return True

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (X, Y, Z)

    def check_marker(self, user: str, marker: Marker) -> None:
        super().check_marker(user, marker)
        if not marker.at_origin:
            raise ValueError(
                f"'{user}' has a marker at {marker.point} of point mass '{self.name}', which has no extension: use "
                "(0, 0, 0), or a RigidBody3D"
            )

    def row(self, numbering: Numbering) -> Row:
        return Row((self.mass, *self.weight(numbering)), numbering.coordinates(self.name)[:3])

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        return self.position, self.velocity


class RigidBody3D(SpatialBody):
    """A rigid body in space: its centre of mass x, y, z and its attitude by four Euler parameters.

    Its frame lies in the centre of mass. The norm of the Euler parameters is a constraint of the body itself; the
    direction in which they point is their start's, p and -p mean the same.
    """

    type: Literal["RigidBody3D"] = "RigidBody3D"
    kernel: ClassVar[Any] = rigid_body3d_kernel
    constraint_rows: ClassVar[int] = 1
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = (
        (0, 0), (1, 1), (2, 2), *((3 + i, 3 + j) for i in range(4) for j in range(4)),
    )  # fmt: skip
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = ((0, 3), (0, 4), (0, 5), (0, 6))

    inertia: Vector3
    """Moments of inertia J_xx, J_yy, J_zz about the centre of mass, in the body's axes, kg m^2."""
    inertia_products: Vector3 = (0.0, 0.0, 0.0)
    """The other entries of the inertia tensor, J_xy, J_xz, J_yz (J_xy = -integral of x y dm), kg m^2."""
    attitude: Attitude = UPRIGHT
    """Initial attitude of the body's axes in space."""
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)
    """Initial angular velocity, rad/s, in the axes that `angular_velocity_in` names."""
    angular_velocity_in: Literal["body", "space"] = "body"
    """Axes of `angular_velocity`: those of the body, or of space."""

    @model_validator(mode="after")
    def _check(self) -> "RigidBody3D":
        a, b, c = np.linalg.eigvalsh(self.inertia_tensor()).tolist()
        shown = f"'{self.name}' has principal moments of inertia {a:.6g}, {b:.6g} and {c:.6g} kg m^2"
        if not a > 0.0:
            raise ValueError(
                f"{shown}: all must be positive. A body without extension across an axis is a PointMass3D, or gets the "
                "small moment that its thickness gives it"
            )
        if c > (a + b) * (1.0 + TRIANGLE):
            raise ValueError(
                f"{shown}, and no body has one larger than the sum of the other two (triangle inequality): check "
                "whether they are meant about the centre of mass, and the signs of inertia_products"
            )
        return self

    def inertia_tensor(self) -> np.ndarray:
        """J (3, 3) about the centre of mass, in the body's axes, kg m^2."""
        (xx, yy, zz), (xy, xz, yz) = self.inertia, self.inertia_products
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (X, Y, Z, *EULER)

    def derived_channels(self, numbering: Numbering, rows: Sequence[int]) -> Sequence[Derived]:
        return (AngularVelocity(self.name, numbering.coordinates(self.name)[3:]),)

    def row(self, numbering: Numbering) -> Row:
        parameters = (self.mass, *self.inertia, *self.inertia_products, *self.weight(numbering))
        return Row(parameters, numbering.coordinates(self.name))

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        p = self.attitude.parameters()
        rates = parameter_rates(p, self.angular_velocity, self.angular_velocity_in)
        return (*self.position, *p), (*self.velocity, *rates)


def parameter_rates(p: Sequence[float], w: Vector3, axes: str) -> tuple[float, ...]:
    """Rates of Euler parameters p with angular velocity w, rad/s, in the axes of the "body" or of "space": p' = G^T w/2
    or E^T w/2."""
    e0, x, y, z = p
    along = -0.5 * math.fsum(a * b for a, b in zip((x, y, z), w, strict=True))
    sign = 1.0 if axes == "body" else -1.0
    c = (y * w[2] - z * w[1], z * w[0] - x * w[2], x * w[1] - y * w[0])
    return (along, *(0.5 * (e0 * w[i] + sign * c[i]) for i in range(3)))
