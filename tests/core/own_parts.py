"""A user's own joint, forces, contacts and body, in a module of their own as a user would have them."""

import math
from typing import Any

import numba
from tlismni.core import (
    BodyElement,
    ForceElement,
    Marker2D,
    ScalarContact2D,
    ScalarForce2D,
    ScalarJoint2D,
    scalar_constraint,
    scalar_contact,
    scalar_force,
)
from tlismni.core.compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from tlismni.core.compiled.views import imat, mat, vec
from tlismni.core.elements.base import Row
from tlismni.core.elements.coordinate import Coordinate
from tlismni.core.model.base import NonNegative, Positive


def seen_from(a, b):
    """Where b is in the axes of a."""
    dx, dy = b.x - a.x, b.y - a.y
    return dx * a.ex + dy * a.ey, dy * a.ex - dx * a.ey


seen = numba.njit(error_model="numpy")(seen_from)


def height(a, b, curvature):
    u, w = seen(a, b)
    return w - 0.5 * curvature * u * u


class OnParabola(ScalarJoint2D):
    """Marker b stays on the parabola w = curvature u^2/2 in the axes of marker a."""

    formula = scalar_constraint(height)
    a: Marker2D = Marker2D()
    b: Marker2D
    curvature: float


def distance_over(a, b, curvature):
    u, w = seen(a, b)
    slope = curvature * u
    return (w - 0.5 * slope * u) / math.sqrt(1.0 + slope * slope)


def arc(a, b, curvature):
    """The arc's length at u, and so much of the height that the gradient is the tangent (1, slope)/root."""
    u, w = seen(a, b)
    slope = curvature * u
    root = math.sqrt(1.0 + slope * slope)
    return 0.5 * (u * root + math.log(slope + root) / curvature) + slope / root * (w - 0.5 * slope * u)


class InBowl(ScalarContact2D):
    """A point over a parabola; the gap is the distance to first order."""

    formula = scalar_contact(distance_over, arc)
    a: Marker2D = Marker2D()
    b: Marker2D
    curvature: Positive


def over_plane(a, b, radius):
    return seen(a, b)[1] - radius


def rolled(a, b, radius):
    return seen(a, b)[0] + radius * (b.angle - a.angle)


class WheelOnFloor(ScalarContact2D):
    """The library's disk on a half-plane, from two lines of formula."""

    formula = scalar_contact(over_plane, rolled)
    a: Marker2D = Marker2D()
    b: Marker2D
    radius: NonNegative


def stretch(a, b, natural_length):
    return math.hypot(b.x - a.x, b.y - a.y) - natural_length


def hardening(x, rate, stiffness, cubic, damping):
    return stiffness * x + cubic * x**3 + damping * rate


def held(x, stiffness, cubic):
    return 0.5 * stiffness * x * x + 0.25 * cubic * x**4


class HardeningSpring(ScalarForce2D):
    formula = scalar_force(stretch, hardening, held)
    a: Marker2D = Marker2D()
    b: Marker2D
    natural_length: Positive
    stiffness: NonNegative
    cubic: float = 0.0
    damping: NonNegative = 0.0


@numba.njit(error_model="numpy")
def drag_kernel(job: int, t: float, b: Any) -> None:
    """r += c |v| v for each of the elements."""
    par, coord, v = mat(b.par, b.count, 1), imat(b.coord, b.count, 2), vec(b.v, b.n_extended)
    slot, extra = imat(b.slot_s, b.count, 4), imat(b.extra, b.count, 1)
    for e in range(b.count):
        c, i, j = par[e, 0], coord[e, 0], coord[e, 1]
        x, y = v[i], v[j]
        speed = math.hypot(x, y)
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            r[i] += c * speed * x
            r[j] += c * speed * y
        elif job == TANGENT and speed > 0.0:
            values, c_v = vec(b.values, b.n_values), vec(b.coef, 2)[1]
            values[slot[e, 0]] += c_v * c * (speed + x * x / speed)
            values[slot[e, 1]] += c_v * c * x * y / speed
            values[slot[e, 2]] += c_v * c * x * y / speed
            values[slot[e, 3]] += c_v * c * (speed + y * y / speed)
        elif job == POWER:
            vec(b.a, b.n_extended)[extra[e, 0]] += c * speed**3


class Drag(ForceElement):
    """Air drag c |v| v at the centre of mass, with a kernel written by hand."""

    kernel = drag_kernel
    tangent_pattern = ((0, 0), (0, 1), (1, 0), (1, 1))
    marker: Marker2D
    coefficient: NonNegative

    def markers(self):
        return (self.marker,)

    def row(self, numbering):
        return Row((self.coefficient,), numbering.coordinates(self.marker.body)[:2], (numbering.work("dampers"),))


@numba.njit(error_model="numpy")
def rotor_kernel(job: int, t: float, b: Any) -> None:
    """J a + J' v^2/2, J = j0 + j1 cos(q)."""
    par, coord = mat(b.par, b.count, 2), imat(b.coord, b.count, 1)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    for e in range(b.count):
        k = coord[e, 0]
        c, s = math.cos(q[k]), math.sin(q[k])
        inertia, slope, bend = par[e, 0] + par[e, 1] * c, -par[e, 1] * s, -par[e, 1] * c
        if job == RESIDUAL:
            vec(b.r, b.n_extended)[k] += inertia * a[k] + 0.5 * slope * v[k] ** 2
        elif job == TANGENT:
            coef = vec(b.coef, 2)
            by_place = slope * a[k] + 0.5 * bend * v[k] ** 2
            place = imat(b.slot_s, b.count, 1)[e, 0]
            vec(b.values, b.n_values)[place] += inertia + coef[1] * slope * v[k] + coef[0] * by_place
        elif job == ENERGY:
            vec(b.energy, 3)[0] += 0.5 * inertia * v[k] ** 2


class CrankRotor(BodyElement):
    """A shaft whose inertia changes with its angle: J = mean + swing cos(angle)."""

    kernel = rotor_kernel
    tangent_pattern = ((0, 0),)
    mean: Positive
    swing: float = 0.0
    speed: float = 0.0

    def coordinate_records(self):
        return (Coordinate("angle", "rad", "angular_velocity", "angular_acceleration", 1.0),)

    def initial_state(self):
        return (0.0,), (self.speed,)

    def row(self, numbering):
        return Row((self.mean, self.swing), numbering.coordinates(self.name))
