"""Coulomb friction of joints: a contact whose normal force is given.

The friction of a joint has no shapes that press. Its gap is k w, w an internal coordinate of unit mass, which a load N
presses onto the stop w >= 0: so w = 0 and the multiplier of the gap's row is -N at all times, and an impact, which
takes no time, finds no friction of the joint. The sliding distance is the way of the joint, or its angle times a length
of the model; mu is 1. What sticks, slips and stops there is decided as in any contact with friction. k^2 is the inverse
of a mass of the model, so that gap and tangent have inverse masses of one size.

N is a constant, and a part of the force |F| that the joint carries, from its multipliers. While the contact is open, as
at an instant whose forces are sought, N follows in `events/following_loads.py`; so the inverse masses of contacts know
nothing of it.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT, line_of
from ..compiled.views import imat, ivec, mat, vec
from ..elements.base import BodyElement, Form, Numbering, PairElement2D, Part, Row
from ..elements.joint_friction import JointFrictionForce
from ..elements.measure2d import pair2d, width2d
from ..elements.measure3d import ANGLE, WHOLE_TURN, Pair, pack, pair3d
from ..elements.measures import measure_of
from ..laws import NewtonImpact
from ..laws.friction import CoulombFriction
from ..model.base import Name, NonNegative
from ..model.markers import Marker2D, Marker3D
from ..state.modes import CLOSED, memories_at
from .element import ContactElement
from .geometry_kinds import JOINT, are
from .sliding2d import act_sliding

CONSTANT_LOAD, REACTION_SHARE, MEASURE_KIND, SLIDE_UNIT, SLIDE_GAIN, MEASURED_PAIR = 16, 17, 18, 19, 20, 21
"""Columns of the constant part of N, of the part of |F| in N, of the kind of the measure, of the sliding distance by a
unit of it, of k, and the first of the pair of markers."""
OWN_ROWS = 2
"""Of gap and sliding distance; those of the joint's force stand behind."""
SPATIAL_COORDINATES = 14


@internal
def press(b: Any, job: int, e: int, own_rows: int, stop: int) -> None:
    """What the load on the stop adds for `job`, whose place is the local coordinate `stop`; rows of the joint stand
    behind the `own_rows`."""
    par, w = mat(b.par, b.count, b.npar)[e], imat(b.coord, b.count, b.ncoord)[e, stop]
    lam, row, force = vec(b.lam, b.m_extended), imat(b.row, b.count, b.nrow)[e], 0.0
    for k in range(own_rows, b.nrow):
        force += lam[row[k]] ** 2
    force = math.sqrt(force)
    if job == RESIDUAL:
        vec(b.r, b.n_extended)[w] += par[SLIDE_GAIN] * (par[CONSTANT_LOAD] + par[REACTION_SHARE] * force)
    elif job == TANGENT and force > 0.0:
        memory = memories_at(b.memory, b.n_memory)[imat(b.extra, b.count, b.nextra)[e, 0]]
        slots, values = b.ncoord * b.nrow, vec(b.values, b.n_values)
        of_rows = ivec(b.slot_jt + 8 * line_of(b, e) * slots, slots)
        for k in range(own_rows, b.nrow if memory.mode == CLOSED else own_rows):
            values[of_rows[b.ncoord * k + stop]] += par[SLIDE_GAIN] * par[REACTION_SHARE] * lam[row[k]] / force


@internal
def joint_friction_kernel(job: int, t: float, b: Any) -> None:
    """Friction along a measure s, whose coordinates stand behind that of the stop."""
    n, par, q = b.ncoord - 1, mat(b.par, b.count, b.npar), vec(b.q, b.n_extended)
    gradient, square = np.empty(n), np.empty((n, n))
    tangent, hessian = np.zeros(n + 1), np.zeros((n + 1) * (n + 2) // 2)
    for e in range(b.count):
        kind, size, gain = int(par[e, MEASURE_KIND]), par[e, SLIDE_UNIT], par[e, SLIDE_GAIN]
        own, pair = (
            ivec(b.coord + 8 * (e * b.ncoord + 1), n),
            vec(b.par + 8 * (e * b.npar + MEASURED_PAIR), b.npar - MEASURED_PAIR),
        )
        s = measure_of(kind, q, own, pair, 0.0, gradient, square, True)
        for i in range(n):
            tangent[1 + i] = gradient[i]
        pack(square, hessian[n + 1 :])
        press(b, job, e, OWN_ROWS, 0)
        gap = q[imat(b.coord, b.count, b.ncoord)[e, 0]] * gain
        # planar bodies count turns
        period = size * WHOLE_TURN if kind == ANGLE else 0.0
        act_sliding(b, job, t, e, gap, np.full(1, gain), vec(b.q, 0), size * s, size * tangent, size * hessian, period)


class JointFriction(ContactElement):
    """Base of the friction of joints as contacts. Class attribute: `kernel`."""

    kernel: ClassVar[Any] = joint_friction_kernel
    has_shapes: ClassVar[bool] = False

    law: NewtonImpact = NewtonImpact(restitution=0.0)
    """Of the stop of w, which never opens."""
    measured: Literal["angle", "slide"]
    """What it works against."""
    preload: NonNegative
    """Friction while the joint moves without a force, N m or N."""
    joint: Name | None
    """The joint whose force presses too."""
    arm: NonNegative
    """Friction by that force, m, or without a dimension."""

    def form_with(self, felt: int) -> Form:
        """Kernel and patterns, with so many rows of the joint."""
        n = self.width() + 1
        full = tuple((i, j) for i in range(1, n) for j in range(1, n))
        felt_rows = ((OWN_ROWS + k, 0) for k in range(felt))
        return Form(type(self).kernel, OWN_ROWS, full, ((0, 0), *((1, j) for j in range(1, n)), *felt_rows))

    def form(self) -> Form:
        return self.form_with(0)

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        felt: list[int] = []
        if self.joint is not None:
            rows = numbering.constraint_rows(self.joint)
            felt = [rows[k] for k in numbering.joints[self.joint].force_rows()]
        return (Part(self.form_with(len(felt)), (self.row(numbering),), felt),)

    def internal_coordinates(self) -> Sequence[str]:
        return ("stop",)

    def units_in(self, bodies: Mapping[str, BodyElement]) -> tuple[str, str]:
        return "m", "rad" if self.measured == "angle" else "m"

    def size_in(self, length: float) -> float:
        return length if self.measured == "angle" else 1.0

    def _gain(self, numbering: Numbering) -> float:
        """k: of the masses that it is between, of the whole model's if these have none, kg^-1/2."""
        bodies = numbering.bodies
        own = [bodies[m.body].typical_mass() for m in self.markers() if m.body in bodies]
        masses = [m for m in own if m > 0.0] or [m for b in bodies.values() if (m := b.typical_mass()) > 0.0] or [1.0]
        return 1.0 / math.sqrt(min(masses))

    def row(self, numbering: Numbering) -> Row:
        law, size = self._law_columns(numbering), self.size_in(numbering.length)
        pair, numbers = self.pair(numbering), self._numbers(size)
        own = (float(pair.kind), size, self._gain(numbering), *pair.columns)
        parameters = (*(0.0,) * 7, *law.parameters, *numbers, *own)
        return Row(parameters, (*numbering.internal(self.name), *pair.coordinates), law.extra)

    def pair(self, numbering: Numbering) -> Pair:
        """Its measure in the tables."""
        raise NotImplementedError(f"{type(self).__name__} must say what its markers are")

    def width(self) -> int:
        """Number of coordinates of the measure."""
        raise NotImplementedError(f"{type(self).__name__} must say how many coordinates its measure has")

    def _numbers(self, size: float) -> tuple[float, float]:
        """CONSTANT_LOAD and REACTION_SHARE."""
        return self.preload / size, self.arm / size


class JointFriction2D(JointFriction):
    """Friction of a joint between the bodies of planar markers."""

    type: Literal["JointFriction2D"] = "JointFriction2D"

    a: Marker2D
    """The first marker."""
    b: Marker2D
    """The second marker."""

    def markers(self) -> Sequence[Marker2D]:
        return (self.a, self.b)

    def pair(self, numbering: Numbering) -> Pair:
        return pair2d(self.measured, self.a, self.b, numbering)

    def width(self) -> int:
        return width2d(self.measured)


class SpatialJointFriction(JointFriction):
    """Base of friction of a joint between the bodies of markers in space."""

    a: Marker3D
    """The first marker."""
    b: Marker3D
    """The second marker."""

    def markers(self) -> Sequence[Marker3D]:
        return (self.a, self.b)

    def pair(self, numbering: Numbering) -> Pair:
        return pair3d(self.measured, self.a, self.b, numbering)

    def width(self) -> int:
        return SPATIAL_COORDINATES


class JointFriction3D(SpatialJointFriction):
    """Friction of a joint about or along the z axis of marker `a`."""

    type: Literal["JointFriction3D"] = "JointFriction3D"


def contact_of(friction: JointFrictionForce) -> JointFriction:
    """The contact that a set-valued friction of a joint is."""
    kind = JointFriction2D if isinstance(friction, PairElement2D) else JointFriction3D
    a, b = friction.markers()
    return kind(
        name=friction.name, a=a, b=b, measured=type(friction).measured, preload=friction.preload, joint=friction.joint,
        arm=friction.arm, friction=CoulombFriction(coefficient=1.0, static_coefficient=friction.static_ratio),
    )  # fmt: skip


are(JOINT, joint_friction_kernel)
