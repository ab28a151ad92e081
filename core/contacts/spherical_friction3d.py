"""Coulomb friction of spherical joints: a torque within a ball, against the angular velocity w of b on a.

As in `joint_friction_contact.py` it is a contact whose normal force is given; but it has three tangents, the
components of u = L w, L a length of the model, and |F| <= mu N of all three together. Contacts have two tangents at
most, so there are two, with the same load: the first one has two of the tangents, the next one, its companion, has
the third. Both do the same at all times (`events/three_tangents.py`); what slides is braked by the first one alone.

Tangents are counted from the axes of space. What sticks has rows at velocity level along t_1, T_2 and T_3; what slides
has a direction d, and F = -mu N g as on a patch (`patch3d.py`). With c, s of `tangent_angle` and l, k of
`sliding_lean`, cosine and sine of each,

    t_1 = (c, s, 0)   t_2 = (-s, c, 0)   n = (0, 0, 1)   d = l t_1 + k n   T_2 = l t_2 + k n   T_3 = l n - k t_2.

The monitor says the components of F along t_1, T_2 and, of the companion, T_3.
"""

import math
from typing import Any, ClassVar, Literal

from ..compiled.jit import inlined, internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT, line_of
from ..compiled.views import imat, ivec, mat, vec
from ..elements.base import Form, Numbering, Row
from ..elements.joint_friction import JointFrictionForce
from ..elements.relative_spin3d import (
    add_torque,
    add_torque_by,
    add_torque_change,
    add_torque_tangent,
    relative_spin,
    spin_by_coordinate,
)
from ..laws.friction import CoulombFriction
from ..model.rotation3d import dot, four, less, plus, space_axes, times
from ..state.modes import AT_LIMIT, CLOSED, STICKS, memories_at
from .coulomb3d import TURNED
from .geometry_kinds import JOINT, are
from .joint_friction_contact import (
    MEASURE_KIND,
    MEASURED_PAIR,
    SLIDE_GAIN,
    SLIDE_UNIT,
    SPATIAL_COORDINATES,
    SpatialJointFriction,
    press,
)
from .patch3d import direction, turn_of_direction

ROWS, STOP, WIDTH = 3, SPATIAL_COORDINATES, SPATIAL_COORDINATES + 1
"""Rows of gap and tangents; local coordinate of the stop, behind those of the frames; coordinates."""
FIRST, THIRD = 1.0, -1.0
"""In the column of the kind: which of the two contacts it is."""
SLOWEST = 1e-150
"""m/s: below it a speed is none."""


@inlined
def _axes(memory: Any, closed: bool) -> Any:
    """(t_1, t_2, T_2, T_3); those of the axes of space where no instant has chosen others."""
    way, lean = 0.0, 0.0
    if closed and memory.tangent_axis != 0.0:
        way, lean = memory.tangent_angle, memory.sliding_lean
    c, s, level, up = math.cos(way), math.sin(way), math.cos(lean), math.sin(lean)
    return (c, s, 0.0), (-s, c, 0.0), (-level * s, level * c, up), (up * s, -up * c, level)


@internal
def _say_levels(b: Any, row: Any, u: Any, rate: Any, memory: Any, axes: Any, slow: float, first: bool) -> None:
    """The rows of the tangents at all levels; slow < 0: of a contact that does not slide."""
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    t_1, t_2, held_2, held_3 = axes
    phi[row[1]] = phi[row[2]] = 0.0
    if slow < 0.0:
        one = t_1 if first else held_3
        phid[row[1]], phidd[row[1]] = dot(one, u), dot(one, rate)
        phid[row[2]], phidd[row[2]] = (dot(held_2, u), dot(held_2, rate)) if first else (0.0, 0.0)
        return
    p, _, size, _, _, _, c, s = direction(dot(t_1, u), dot(t_2, u), u[2], memory.sliding_lean, slow)
    speed, power = math.sqrt(dot(u, u)), dot(u, rate)
    phid[row[1]], phid[row[2]] = p - TURNED * (size - slow), speed
    phidd[row[1]] = c * dot(t_1, rate) + s * rate[2] - TURNED * power / size
    phidd[row[2]] = power / speed if speed > 0.0 else math.sqrt(dot(rate, rate))


@internal
def _rub(b: Any, job: int, e: int) -> None:
    """What element e adds for `job`, beside its load."""
    par, extra = mat(b.par, b.count, b.npar)[e], imat(b.extra, b.count, b.nextra)[e]
    coord, row, k = imat(b.coord, b.count, WIDTH)[e], imat(b.row, b.count, b.nrow)[e], extra[0]
    memory, first, arm = memories_at(b.memory, b.n_memory)[k], par[MEASURE_KIND] == FIRST, par[SLIDE_UNIT]
    q, v, a, lam = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended), vec(b.lam, b.m_extended)
    pair, closed, w = vec(b.par + 8 * (e * b.npar + MEASURED_PAIR), 2), memory.mode == CLOSED, coord[STOP]
    if job != RESIDUAL and not closed:
        return
    slides, sticks = closed and abs(memory.slide_mode) == 1.0, closed and memory.slide_mode == STICKS
    at_limit, normal = closed and memory.slide_mode == AT_LIMIT, lam[row[0]]
    axes, slow = _axes(memory, closed), max(memory.slow_sliding, SLOWEST) if slides else -1.0
    t_1, t_2, held_2, held_3 = axes
    u = times(arm, relative_spin(q, v, coord, pair))
    along, share, pull = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if slides:
        _, _, _, g_d, g_y, g_e, c, s = direction(dot(t_1, u), dot(t_2, u), u[2], memory.sliding_lean, slow)
        along = plus(times(c * g_d - s * g_e, t_1), plus(times(g_y, t_2), (0.0, 0.0, s * g_d + c * g_e)))
        share = times(-memory.friction_ratio, along)
        pull = times(normal, share)
    elif first and (sticks or at_limit):
        pull = times(-lam[row[1]], t_1)
        if sticks:
            pull = less(pull, times(lam[row[2]], held_2))
        else:
            share = times(-memory.friction_ratio, held_2)
            pull = plus(pull, times(normal, share))
    elif sticks or at_limit:
        pull = times(-lam[row[1]], held_3)
    if job == RESIDUAL:
        rate, monitor = times(arm, relative_spin(q, a, coord, pair)), vec(b.monitor, b.n_monitor)
        _say_levels(b, row, u, rate, memory, axes, slow, first)
        gain, r = par[SLIDE_GAIN], vec(b.r, b.n_extended)
        vec(b.phi, b.m_extended)[row[0]] = gain * q[w]
        vec(b.phid, b.m_extended)[row[0]], vec(b.phidd, b.m_extended)[row[0]] = gain * v[w], gain * a[w]
        monitor[k] = -normal if closed else 0.0
        # (of an open contact nobody asks for friction, but for the axis that its tangents are counted from)
        monitor[b.n_memory + k] = dot(pull, t_1 if first else held_3) if closed else 1.0
        monitor[2 * b.n_memory + k] = dot(pull, held_2) if closed and first else 0.0
        if closed:
            r[w] += gain * normal
            if first or not slides:
                add_torque(b, coord, pair, times(arm, pull))
    elif job == POWER:
        a[extra[2]] -= normal
        if first:
            a[extra[3]] -= dot(pull, u)
    elif job == TANGENT:
        _add_tangent(b, e, coord, row, memory, axes, u, slow, first, pull, share)


@internal
def _add_tangent(
    b: Any, e: int, coord: Any, row: Any, memory: Any, axes: Any, u: Any, slow: float, first: bool, pull: Any,
    share: Any,
) -> None:  # fmt: skip
    """Its derivatives, while it is closed."""
    par, coef, lam = mat(b.par, b.count, b.npar)[e], vec(b.coef, 2), vec(b.lam, b.m_extended)
    q, v, values, pair = (
        vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.values, b.n_values),
        vec(b.par + 8 * (e * b.npar + MEASURED_PAIR), 2),
    )  # fmt: skip
    arm, line, rows = par[SLIDE_UNIT], line_of(b, e), WIDTH * b.nrow
    slot = imat(b.slot_s + 8 * WIDTH * WIDTH * line, WIDTH, WIDTH)
    slot_j, slot_jt = ivec(b.slot_j + 8 * rows * line, rows), ivec(b.slot_jt + 8 * rows * line, rows)
    values[slot_j[STOP]] += par[SLIDE_GAIN]
    values[slot_jt[STOP]] += par[SLIDE_GAIN]
    t_1, t_2, held_2, held_3 = axes
    if slow < 0.0:
        sticks, at_limit = memory.slide_mode == STICKS, memory.slide_mode == AT_LIMIT
        for k in range(1, ROWS):
            if not (sticks or (at_limit and k == 1)) or (k == 2 and not first):
                continue
            axis = held_2 if k == 2 else t_1 if first else held_3
            for slots in (slot_j, slot_jt):
                add_torque_by(b, coord, pair, slots[WIDTH * k : WIDTH * (k + 1)], times(-arm, axis))
    elif not first:
        return
    add_torque_by(b, coord, pair, slot_jt[:WIDTH], times(arm, share))
    add_torque_tangent(b, coord, pair, slot, times(arm, pull))
    if slow < 0.0:
        return
    way = direction(dot(t_1, u), dot(t_2, u), u[2], memory.sliding_lean, slow)
    axes_a, axes_b = space_axes(four(q, coord, 3, pair[0])), space_axes(four(q, coord, 10, pair[1]))
    spin_a, spin_b = space_axes(four(v, coord, 3, 0.0)), space_axes(four(v, coord, 10, 0.0))
    load = -memory.friction_ratio * lam[row[0]] * arm
    for j in range(SPATIAL_COORDINATES):
        by = times(arm, spin_by_coordinate(j, coef[0], coef[1], axes_a, axes_b, spin_a, spin_b))
        g_1, g_2, g_3 = turn_of_direction(way, dot(t_1, by), dot(t_2, by), by[2])
        change = plus(times(load * g_1, t_1), times(load * g_2, t_2))
        add_torque_change(values, slot, j, axes_a, axes_b, plus(change, (0.0, 0.0, load * g_3)))


@internal
def spherical_friction3d_kernel(job: int, t: float, b: Any) -> None:
    for e in range(b.count):
        press(b, job, e, ROWS, STOP)
        _rub(b, job, e)


class SphericalJointFriction3D(SpatialJointFriction):
    """Friction of a spherical joint between the bodies of markers in space: one of the two contacts that it is."""

    type: Literal["SphericalJointFriction3D"] = "SphericalJointFriction3D"
    kernel: ClassVar[Any] = spherical_friction3d_kernel
    companion: ClassVar[int] = 1
    which: ClassVar[float] = FIRST

    def form_with(self, felt: int) -> Form:
        full = tuple((i, j) for i in range(SPATIAL_COORDINATES) for j in range(SPATIAL_COORDINATES))
        tangents = tuple((row, j) for row in range(1, ROWS) for j in range(SPATIAL_COORDINATES))
        # a force that goes with the load: its derivative stands beside that of the gap
        gap = tuple((0, j) for j in range(WIDTH))
        felt_rows = ((ROWS + k, STOP) for k in range(felt))
        return Form(type(self).kernel, ROWS, full, (*gap, *tangents, *felt_rows), (1, 2))

    def row(self, numbering: Numbering) -> Row:
        law, size = self._law_columns(numbering), self.size_in(numbering.length)
        _, columns, coordinates = self.pair(numbering)
        which = (type(self).which, size, self._gain(numbering))
        parameters = (*(0.0,) * 7, *law.parameters, *self._numbers(size), *which, *columns)
        return Row(parameters, (*coordinates, *numbering.internal(self.name)), law.extra)


class ThirdTangent3D(SphericalJointFriction3D):
    """The other one, with the third tangent."""

    companion: ClassVar[int] = -1
    which: ClassVar[float] = THIRD


def contacts_of(friction: JointFrictionForce) -> tuple[SphericalJointFriction3D, SphericalJointFriction3D]:
    """The contacts that a set-valued friction of a spherical joint is."""
    a, b = friction.markers()
    first = SphericalJointFriction3D(
        name=friction.name, a=a, b=b, measured="angle", preload=friction.preload,
        joint=friction.joint, arm=friction.arm,
        friction=CoulombFriction(coefficient=1.0, static_coefficient=friction.static_ratio),
    )  # fmt: skip
    # (a name that no element can have)
    third = ThirdTangent3D.model_construct(**{**dict(first), "name": f"{friction.name}.third"})
    return first, third


are(JOINT, spherical_friction3d_kernel)
