"""Joints in space that tie two coordinates of joints together: Phi = c_1 x_1 + c_2 x_2 - (its value at the start).

x is an angle about or a place along the z axis of a marker, turns counted; only how far it has gone since the start
matters, so that nobody need say with how many turns it starts. What the joint exerts on the bodies follows from the
gradients of both.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.channels import Channel
from ..model.derived import Derived
from ..model.markers import Marker3D
from ..model.said_angle import CountedAngle
from .base import BodyElement, Form, JointElement, Numbering, Part, Row, no_account
from .geometry2d import along
from .joint3d import channels_of, ends_of
from .joint_coordinates3d import JointCoordinate
from .measure3d import ANGLE, PLACE, columns_of, coordinates_of, measure
from .spatial_body import angle_between, start_of_marker
from .turn3d import LOOSE, account_of, turn_part
from .turning_bodies import refuse_points

Pair = tuple[Marker3D, Marker3D]


@internal
def relation3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par, coord, row = mat(b.par, b.count, 59), imat(b.coord, b.count, 28), imat(b.row, b.count, 1)
    extra = imat(b.extra, b.count, 2)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    gradient, hessian = np.empty(14), np.empty((14, 14))
    for e in range(b.count):
        k = row[e, 0]
        lam = vec(b.lam, b.m_extended)[k]
        phi, phid, phidd = -par[e, 58], 0.0, 0.0
        for side in range(2):
            own, where = par[e, 29 * side : 29 * side + 29], coord[e, 14 * side : 14 * side + 14]
            factor, about = own[26], own[28] + v[extra[e, side]]
            x = measure(int(own[27]), q, where, own, about, gradient, hessian)
            if job == RESIDUAL:
                r = vec(b.r, b.n_extended)
                phi += factor * x
                phid += factor * along(gradient, v, where)
                phidd += factor * along(gradient, a, where)
                for i in range(14):
                    r[where[i]] += factor * lam * gradient[i]
                    for j in range(14):
                        phidd += factor * hessian[i, j] * v[where[i]] * v[where[j]]
            else:
                values, scale = vec(b.values, b.n_values), factor * lam * vec(b.coef, 2)[0]
                slot = imat(b.slot_s + 8 * 784 * e, 28, 28)
                slot_j, slot_jt = imat(b.slot_j, b.count, 28)[e], imat(b.slot_jt, b.count, 28)[e]
                for i in range(14):
                    at = 14 * side + i
                    values[slot_j[at]] += factor * gradient[i]
                    values[slot_jt[at]] += factor * gradient[i]
                    for j in range(14):
                        values[slot[at, 14 * side + j]] += scale * hessian[i, j]
        if job == RESIDUAL:
            vec(b.phi, b.m_extended)[k] = phi
            vec(b.phid, b.m_extended)[k] = phid
            vec(b.phidd, b.m_extended)[k] = phidd


FORM = Form(
    relation3d_kernel,
    1,
    tuple((14 * side + i, 14 * side + j) for side in range(2) for i in range(14) for j in range(14)),
    tuple((0, j) for j in range(28)),
)


class Relation3D(JointElement):
    """Base of these joints: a subclass says its two coordinates, and the unit in which its multiplier is a force."""

    def terms(self) -> Sequence[tuple[float, int, Pair]]:
        """Factor, kind (ANGLE or PLACE) and markers of both coordinates."""
        raise NotImplementedError(f"{type(self).__name__} must say which coordinates it ties together")

    def markers(self) -> Sequence[Marker3D]:
        return list(dict.fromkeys(marker for _, _, pair in self.terms() for marker in pair))

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        for _, _, (a, b) in self.terms():
            if a.body == b.body:
                raise ValueError(
                    f"'{self.name}' needs the motion of a marker on '{b.body}' as seen from another body, but both of "
                    "its markers are there: put the one whose z axis is the axis on the frame or the ground"
                )
        for _, kind, pair in self.terms():
            if kind == ANGLE:
                refuse_points(self.name, pair, bodies, "use a RigidBody3D")

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        parameters: list[float] = []
        coordinates: list[int] = []
        accounts: list[int] = []
        turning: list[Part] = []
        phase = 0.0
        for k, (factor, kind, (a, b)) in enumerate(self.terms(), 1):
            account, start = no_account(numbering), _start(kind, a, b, numbering)
            if kind == ANGLE:
                name = f"{self.name}.{k}"
                account = numbering.work(account_of(name), LOOSE)
                turning.append(turn_part(name, a, b, numbering))
            parameters += [*columns_of(a, b, numbering), factor, float(kind), start]
            coordinates += coordinates_of(a, b, numbering)
            accounts.append(account)
            phase += factor * start
        return [Part(FORM, (Row((*parameters, phase), coordinates, accounts),)), *turning]


def _start(kind: int, a: Marker3D, b: Marker3D, numbering: Numbering) -> float:
    """The coordinate at the start."""
    if kind == ANGLE:
        return angle_between(a, b, numbering.bodies)
    (x, axes), (y, _) = (start_of_marker(marker, numbering.bodies) for marker in (a, b))
    return float(axes[:, 2] @ (y - x))


class Gear3D(Relation3D):
    """Two wheels that roll on each other: radius_a angle_a + radius_b angle_b stays what it is at the start (1 row).

    `wheel_a` turns about the z axis of `frame_a`, `wheel_b` about that of `frame_b`, as in a Revolute3D each; the axes
    may stand at any angle (bevel gears), the frames may be one carrier that moves. Wheels with teeth outside and
    parallel axes turn against each other; where one turns the other way about its z axis, or has teeth inside, its
    radius is negative.
    """

    type: Literal["Gear3D"] = "Gear3D"
    symbol: ClassVar[str] = "gears"
    frame_a: Marker3D
    """In which wheel a turns."""
    wheel_a: Marker3D
    """Wheel a; its z axis is the axis of turning."""
    frame_b: Marker3D
    """In which wheel b turns."""
    wheel_b: Marker3D
    """Wheel b; its z axis is the axis of turning."""
    radius_a: float
    """Radius of the pitch circle, or number of teeth, of wheel a."""
    radius_b: float
    """Radius of the pitch circle, or number of teeth, of wheel b."""

    @model_validator(mode="after")
    def _check(self) -> "Gear3D":
        if self.radius_a == 0.0 or self.radius_b == 0.0:
            raise ValueError(f"gear '{self.name}' has a radius of 0 m: both wheels need one, positive or negative")
        return self

    def terms(self) -> Sequence[tuple[float, int, Pair]]:
        return (
            (self.radius_a, ANGLE, (self.frame_a, self.wheel_a)),
            (self.radius_b, ANGLE, (self.frame_b, self.wheel_b)),
        )

    def multiplier_channels(self) -> Sequence[Channel]:
        text = "force between the teeth; its torque on a wheel is -radius times it"
        return (Channel(f"{self.name}.tooth_force", "N", text),)


class RackAndPinion3D(Relation3D):
    """A wheel that rolls on a rack: the rack's position grows by radius times the wheel's angle (1 row).

    `wheel` turns about the z axis of `frame`, as in a Revolute3D; `rack` moves along the z axis of `guide`, as in a
    Prismatic3D.
    """

    type: Literal["RackAndPinion3D"] = "RackAndPinion3D"
    symbol: ClassVar[str] = "rack"
    frame: Marker3D
    """In which the wheel turns."""
    wheel: Marker3D
    """The wheel; its z axis is the axis of turning."""
    guide: Marker3D
    """In which the rack slides."""
    rack: Marker3D
    """The rack; it slides along the z axis."""
    radius: float
    """m; negative where the rack goes back as the wheel turns forward."""

    def terms(self) -> Sequence[tuple[float, int, Pair]]:
        return (-self.radius, ANGLE, (self.frame, self.wheel)), (1.0, PLACE, (self.guide, self.rack))

    def multiplier_channels(self) -> Sequence[Channel]:
        return (Channel(f"{self.name}.tooth_force", "N", "force of the rack on the wheel's teeth, along the rack"),)


class Screw3D(Relation3D):
    """Marker `b` goes along the z axis of marker `a` by `lead` a turn about it (1 row), as in a Cylindrical3D with the
    same markers."""

    type: Literal["Screw3D"] = "Screw3D"
    symbol: ClassVar[str] = "sleeve"
    a: Marker3D
    """The first marker."""
    b: Marker3D
    """The second marker."""
    lead: float
    """Length a turn, m; negative for a left-hand thread."""

    def terms(self) -> Sequence[tuple[float, int, Pair]]:
        return (-self.lead / (2.0 * math.pi), ANGLE, (self.a, self.b)), (1.0, PLACE, (self.a, self.b))

    def coordinates(self) -> Sequence[JointCoordinate]:
        """The ways in which it moves that have channels."""
        return (
            JointCoordinate("angle", "angular_velocity", "angle", self.a, self.b, "angle", f"{self.name}.1"),
            JointCoordinate("position", "velocity", "place", self.a, self.b, "place of b along the axis"),
        )

    def ends_of(self, coordinate: str) -> dict[str, Marker3D]:
        """Markers `a` and `b` of "angle" or "position", for what acts on it. Raises ModelError for any other."""
        return ends_of(self.name, "Screw3D", self.coordinates(), coordinate)

    def counted_angles(self) -> Sequence[CountedAngle]:
        """Its angle."""
        return (CountedAngle(f"{self.name}.angle", self.a, self.b),)

    def derived_channels(self, numbering: Numbering, rows: Sequence[int]) -> Sequence[Derived]:
        return channels_of(self.name, self.coordinates(), numbering)

    def multiplier_channels(self) -> Sequence[Channel]:
        return (Channel(f"{self.name}.thread_force", "N", "axial force of the body b on the thread of a"),)
