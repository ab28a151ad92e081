"""Dry friction of a spherical joint: a torque against the angular velocity w of its second body on the first.

Coulomb's (`contacts/spherical_friction3d.py`), or regularised by choice, M = -T tanh(|w|/w_s) w/|w| on body b.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.rotation3d import dot, four, plus, space_axes, times
from .base import BodyElement, Numbering, Row, full_pattern
from .joint_friction import TurningFriction
from .measure3d import Pair3D, columns_of, coordinates_of
from .relative_spin3d import add_torque, add_torque_change, add_torque_tangent, relative_spin, spin_by_coordinate
from .turning_bodies import refuse_points

TORQUE, TRANSITION, PAIR = 0, 1, 2
"""Columns: T, w_s and the first of the pair of markers."""
SLOW = 1e-150
"""Of w_s: below it the law is linear."""


@internal
def regularised_spherical3d_kernel(job: int, t: float, b: Any) -> None:
    par, coord, extra = mat(b.par, b.count, b.npar), imat(b.coord, b.count, 14), imat(b.extra, b.count, 1)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    for e in range(b.count):
        pair, slow = vec(b.par + 8 * (e * b.npar + PAIR), 2), par[e, TRANSITION]
        w = relative_spin(q, v, coord[e], pair)
        speed = math.sqrt(dot(w, w))
        part = math.tanh(speed / slow)
        slope = par[e, TORQUE] * (1.0 - part * part) / slow
        over = par[e, TORQUE] * part / speed if speed > SLOW * slow else slope
        if job == RESIDUAL:
            add_torque(b, coord[e], pair, times(-over, w))
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * 196 * e, 14, 14)
            axes_a, axes_b = space_axes(four(q, coord[e], 3, pair[0])), space_axes(four(q, coord[e], 10, pair[1]))
            spin_a, spin_b = space_axes(four(v, coord[e], 3, 0.0)), space_axes(four(v, coord[e], 10, 0.0))
            add_torque_tangent(b, coord[e], pair, slot, times(-over, w))
            along = (slope - over) / (speed * speed) if speed > SLOW * slow else 0.0
            for j in range(14):
                by = spin_by_coordinate(j, coef[0], coef[1], axes_a, axes_b, spin_a, spin_b)
                change = plus(times(-over, by), times(-along * dot(w, by), w))
                add_torque_change(values, slot, j, axes_a, axes_b, change)
        elif job == POWER:
            vec(b.a, b.n_extended)[extra[e, 0]] += over * speed * speed


class SphericalFriction3D(TurningFriction, Pair3D):
    """Dry friction of a Spherical3D with the same markers, against the angular velocity of body b on body a: `torque`,
    and `coefficient` times `radius` times the force of the `joint`. It holds all turns of the joint, with a torque in
    any direction up to that size."""

    type: Literal["SphericalFriction3D"] = "SphericalFriction3D"
    kernel: ClassVar[Any] = regularised_spherical3d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = full_pattern(14)
    is_spherical: ClassVar[bool] = True

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        super().check_in(bodies)
        refuse_points(self.name, self.markers(), bodies, "use a RigidBody3D")

    def row(self, numbering: Numbering) -> Row:
        numbers = (self.preload, self.transition or 0.0, *columns_of(self.a, self.b, numbering))
        return Row(numbers, coordinates_of(self.a, self.b, numbering), (numbering.work("dampers"),))
