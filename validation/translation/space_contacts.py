"""Contacts of spheres in space: an ObjectGenericODE2 on the nodes of both bodies, as `user_contacts.py` says.

exudyn's own contacts of spheres in space have other laws of friction; so every law is a user function here. Written
from the geometry, not from the solver's kernels: a cross-check must not share what it checks.
"""

import math
from collections.abc import Callable
from typing import Any

from ...core.contacts.contact3d import SphereOnHalfSpace3D, SphereOnSphere3D
from ...core.laws.friction import LuGreFriction
from ...core.model.markers import GROUND, Marker3D
from ..errors import NotTranslatable
from .contact_laws import is_native
from .formulas import StickingCoulomb
from .registry import Build, translates
from .user_contacts import Force, Numbers, add_user_contact
from .user_gaps import Nodes, UserGap

Vector = tuple[float, float, float]
Arc = tuple[Vector, Vector, float]
"""A place of a, one of b, and how much of the velocity of one on the other counts."""
Touch = Callable[[Numbers], tuple[float, Vector, tuple[Arc, ...]]]
"""Coordinates -> (gap, normal from a to b, what makes up the sliding velocity); plain floats: exudyn calls it often."""
LEAST_SPEED = 1e-12
"""m/s: a sliding velocity below has no direction."""


@translates(SphereOnHalfSpace3D, SphereOnSphere3D)
def sphere_contact(record: SphereOnHalfSpace3D | SphereOnSphere3D, build: Build) -> None:
    """A user function. Raises NotTranslatable for constraint contact, and for friction that sticks."""
    is_native(record, on_flexible=False)
    if isinstance(record.friction, StickingCoulomb):
        raise NotTranslatable(
            f"contact '{record.name}' has Coulomb friction in space, for which no sticking spring in two directions is "
            "written; a force law with a regularised friction is compared"
        )
    if isinstance(record.friction, LuGreFriction):
        raise NotTranslatable(
            f"contact '{record.name}' has LuGre friction in space, whose bristles in two directions are not written "
            "for exudyn; give it a law without bristles, such as BrownMcPhee, for a comparison"
        )
    if record.turning is not None:
        raise NotTranslatable(
            f"contact '{record.name}' has friction against rolling and spinning, which is not written for exudyn: "
            "leave out `turning` for a comparison"
        )
    check_bodies(record, build)
    a, b = record.markers()
    nodes = Nodes(build, (a.body, b.body))
    ends = End(build, a, nodes), End(build, b, nodes)
    if isinstance(record, SphereOnHalfSpace3D):
        touch = _on_plane(*ends, vector(record.plane.marker.axes()[:, 2]), record.sphere.radius)
    else:
        touch = _on_sphere(*ends, record.a.radius, record.b.radius)
    gap = UserGap(tuple(nodes.nodes), nodes.reference, lambda x: (touch(x)[0], [], []))
    add_user_contact(record, build, SpaceForce(record, gap, touch, *ends))


def check_bodies(record: Any, build: Build) -> None:
    """Raise NotTranslatable for a contact, or a force, on a body without a frame of its own."""
    for marker in record.markers():
        if marker.body != GROUND and len(build.bodies[marker.body].reference) not in (3, 7):
            raise NotTranslatable(
                f"'{record.name}' is on '{marker.body}', neither a RigidBody3D nor a PointMass3D: put such a body there"
            )


class SpaceForce(Force):
    """The force of a contact in space, whose friction is against a velocity with two components."""

    def __init__(self, record: Any, gap: UserGap, touch: Touch, a: "End", b: "End") -> None:
        super().__init__(record, gap)
        self.touch, self.a, self.b = touch, a, b

    def parts(self, t: float, q: Numbers, v: Numbers) -> tuple[float, float, float, float, float, Numbers, Numbers]:
        """As in the plane; the gradient of sliding is along the sliding velocity."""
        x = [r + d for r, d in zip(self.gap.reference, q, strict=True)]
        gap, normal, arcs = self.touch(x)
        relative = self._relative(x, v, arcs[0])
        rate = dot(normal, relative)
        nothing, force = [0.0] * len(x), self.normal(gap, rate)
        if force == 0.0:
            return gap, rate, 0.0, 0.0, 0.0, nothing, nothing
        along = self._row(x, normal, arcs[:1])
        if not self.rubs:
            return gap, rate, force, 0.0, 0.0, along, nothing
        for arc in arcs[1:]:
            relative = plus(relative, self._relative(x, v, arc), arc[2])
        slide = plus(relative, normal, -dot(normal, relative))
        speed = math.hypot(*slide)
        if speed < LEAST_SPEED:
            return gap, rate, force, 0.0, speed, along, nothing
        way = slide[0] / speed, slide[1] / speed, slide[2] / speed
        return gap, rate, force, self.tangential(t, speed, force), speed, along, self._row(x, way, arcs)

    def measure(self, t: float, q: Numbers, v: Numbers) -> list[float]:
        """As in the plane, with the size of the friction, which has no sign in space."""
        gap, rate, normal, tangential = super().measure(t, q, v)
        return [gap, rate, normal, abs(tangential)]

    def _relative(self, x: Numbers, v: Numbers, arc: Arc) -> Vector:
        return plus(self.b.velocity(x, v, arc[1]), self.a.velocity(x, v, arc[0]), -1.0)

    def _row(self, x: Numbers, way: Vector, arcs: tuple[Arc, ...]) -> list[float]:
        """What the velocity of b less that of a along a way is of the rates."""
        row = [0.0] * len(x)
        for place_a, place_b, share in arcs:
            self.b.add(row, x, way, place_b, share)
            self.a.add(row, x, way, place_a, -share)
        return row


class End:
    """A marker's point as a function of the coordinates, and how the body's matter moves with the rates."""

    def __init__(self, build: Build, marker: Marker3D, nodes: Nodes) -> None:
        self.point = marker.point
        self.at = [] if marker.body == GROUND else nodes.indices(build.bodies[marker.body].all_nodes)
        self.turns = len(self.at) == 7

    def place(self, x: Numbers) -> Vector:
        """The point in space."""
        if not self.at:
            return self.point
        return plus(self._origin(x), self.turned(x, self.point), 1.0)

    def _origin(self, x: Numbers) -> Vector:
        i, j, k = self.at[:3]
        return x[i], x[j], x[k]

    def turned(self, x: Numbers, way: Vector) -> Vector:
        """A vector of the body along the axes of space: u + 2 (e0 e x u + e x (e x u))."""
        if not self.turns:
            return way
        e0, e1, e2, e3 = (x[k] for k in self.at[3:])
        across = cross((e1, e2, e3), way)
        return plus(plus(way, across, 2.0 * e0), cross((e1, e2, e3), across), 2.0)

    def velocity(self, x: Numbers, v: Numbers, place: Vector) -> Vector:
        """Of the body's matter at a place: R' + w x arm with w = 2 (e0 e' - e0' e + e x e')."""
        if not self.at:
            return 0.0, 0.0, 0.0
        found = self._origin(v)
        if not self.turns:
            return found
        e0, e1, e2, e3 = (x[k] for k in self.at[3:])
        d0, d1, d2, d3 = (v[k] for k in self.at[3:])
        e, d = (e1, e2, e3), (d1, d2, d3)
        half = plus(plus(cross(e, d), d, e0), e, -d0)
        return plus(found, cross(half, plus(place, self._origin(x), -1.0)), 2.0)

    def add(self, row: list[float], x: Numbers, way: Vector, place: Vector, sign: float) -> None:
        """Add the gradient of that velocity along `way` with respect to the rates."""
        for k, value in zip(self.at, way, strict=False):
            row[k] += sign * value
        if not self.turns:
            return
        self.add_turn(row, x, cross(plus(place, self._origin(x), -1.0), way), sign)

    def add_turn(self, row: list[float], x: Numbers, axis: Vector, sign: float) -> None:
        """Add the gradient of w . axis with respect to the rates, w = 2 (e0 e' - e0' e + e x e')."""
        if not self.turns:
            return
        e0, e1, e2, e3 = (x[k] for k in self.at[3:])
        turn = plus(cross(axis, (e1, e2, e3)), axis, e0)
        row[self.at[3]] -= sign * 2.0 * dot((e1, e2, e3), axis)
        for k, value in zip(self.at[4:], turn, strict=True):
            row[k] += sign * 2.0 * value


def _on_plane(a: End, b: End, axis: Vector, radius: float) -> Touch:
    def touch(x: Numbers) -> tuple[float, Vector, tuple[Arc, ...]]:
        normal, centre = a.turned(x, axis), b.place(x)
        height = dot(normal, plus(centre, a.place(x), -1.0))
        lowest = plus(centre, normal, -radius)
        return height - radius, normal, ((lowest, lowest, 1.0),)

    return touch


def _on_sphere(a: End, b: End, radius_a: float, radius_b: float) -> Touch:
    """The sliding velocity is the rate of the arcs that they roll: s (x_b' - x_a') - w_b x R_b n - w_a x R_a n with
    s = (R_a + R_b)/|d|. Friction at one place for both has other levers where they overlap: 5 % at a tenth of R."""

    def touch(x: Numbers) -> tuple[float, Vector, tuple[Arc, ...]]:
        first, second = a.place(x), b.place(x)
        way, radii = plus(second, first, -1.0), radius_a + radius_b
        distance = math.hypot(*way)
        normal = way[0] / distance, way[1] / distance, way[2] / distance
        rolls = plus(first, normal, radius_a), plus(second, normal, -radius_b), 1.0
        return distance - radii, normal, (rolls, (first, second, radii / distance - 1.0))

    return touch


def vector(values: Any) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z


def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def plus(a: Vector, b: Vector, factor: float) -> Vector:
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]
