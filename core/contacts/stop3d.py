"""End stops of joints in space, and ropes: a measure of two markers does not go beyond a limit.

gap = sign (limit - x), x the angle about the z axis of marker a (turns counted), the place along it, or the distance of
the points.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from ..compiled.jit import internal
from ..compiled.views import imat, mat, vec
from ..elements.base import BodyElement, Form, Numbering, Part, Row, no_account
from ..elements.measure3d import ANGLE, DISTANCE, PLACE, columns_of, coordinates_of, measure
from ..elements.spatial_body import start_of_marker
from ..elements.start_angle3d import check_start_angle
from ..elements.turn3d import LOOSE, account_of, turn_part
from ..elements.turning_bodies import refuse_points
from ..model.base import Positive
from ..model.markers import GROUND, Marker3D
from ..model.said_angle import CountedAngle, SaidAngle
from .element import ContactElement
from .geometry_kinds import STOP, are
from .normal2d import act, is_sleeping
from .normal3d import PACKED, PAIR_SIZE, pair_of

STOP_KIND, STOP_SIGN, STOP_LIMIT, STOP_START = 0, 1, 2, 3
"""Columns of the parameters before those of the laws; those of the pair of markers stand behind."""
LEAST = 1e-6
"""Of a rope: distance of its ends at the start."""
ACCOUNT = 6
"""Column of the indices: of the work account that counts turns."""


@internal
def stop3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(PAIR_SIZE), np.empty((PAIR_SIZE, PAIR_SIZE)), np.empty(PACKED)
    q, v, extra = vec(b.q, b.n_extended), vec(b.v, b.n_extended), imat(b.extra, b.count, b.nextra)
    for e in range(b.count):
        if is_sleeping(b, e):
            continue
        par, coord = mat(b.par, b.count, b.npar)[e], imat(b.coord, b.count, PAIR_SIZE)[e]
        about = par[STOP_START] + v[extra[e, ACCOUNT]]
        x = measure(int(par[STOP_KIND]), q, coord, pair_of(b, e), about, gradient, hessian)
        sign, k = par[STOP_SIGN], 0
        for i in range(PAIR_SIZE):
            gradient[i] *= -sign
            for j in range(i, PAIR_SIZE):
                packed[k] = -sign * hessian[i, j]
                k += 1
        act(b, job, e, sign * (par[STOP_LIMIT] - x), gradient, packed)


FORM = Form(
    stop3d_kernel,
    1,
    tuple((i, j) for i in range(PAIR_SIZE) for j in range(PAIR_SIZE)),
    tuple((0, j) for j in range(PAIR_SIZE)),
)


class Stop3D(ContactElement):
    """Base of the stops: contacts without friction of two markers."""

    measured: ClassVar[int]

    a: Marker3D = Marker3D()
    """The first marker."""
    b: Marker3D
    """The second marker."""

    @model_validator(mode="after")
    def _no_friction(self) -> "Stop3D":
        if self.friction is not None:
            raise ValueError(f"'{self.name}' has friction, but nothing slides on it: leave it out")
        return self

    @property
    def sign(self) -> float:
        """Of the gap's growth with the limit."""
        return 1.0

    @property
    def bound(self) -> float:
        """The limit, m or rad."""
        raise NotImplementedError(f"{type(self).__name__} must say its limit")

    def form(self) -> Form:
        return FORM

    def markers(self) -> Sequence[Marker3D]:
        return (self.a, self.b)

    def lengths(self) -> Sequence[float]:
        return () if self.measured == ANGLE else (abs(self.bound),)

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        law = self._law_columns(numbering)
        account, start, counted = no_account(numbering), 0.0, []
        if self.measured == ANGLE:
            account, start = (
                numbering.work(account_of(self.name), LOOSE),
                numbering.start_angle(self.a, self.b, self.name),
            )
            counted = [turn_part(self.name, self.a, self.b, numbering)]
        numbers = (float(self.measured), self.sign, self.bound, start, 0.0, 0.0, 0.0)
        row = Row(
            (*numbers, *law.parameters, *columns_of(self.a, self.b, numbering)),
            coordinates_of(self.a, self.b, numbering),
            (*law.extra, account),
        )
        # the rows of a contact are those of its last part
        return [*counted, Part(FORM, (row,))]


class LimitStop3D(Stop3D):
    """Base of the stops that hold a measure below or above a limit. Each declares the fields itself: their order is
    that of its JSON."""

    if TYPE_CHECKING:
        limit: float
        side: Literal["upper", "lower"]

    @property
    def sign(self) -> float:
        return 1.0 if self.side == "upper" else -1.0

    @property
    def bound(self) -> float:
        return self.limit


class AngleStop3D(LimitStop3D):
    """The angle of marker `b` about the z axis of marker `a` (x axis to x axis, turns counted) stays below or above
    `limit`, as the `angle` of a hinge with the same markers.

    A contact in rad: its normal force is a torque, N m, impulses are N m s, and stiffnesses of force laws N m/rad. A
    joint with two limits has two stops.
    """

    type: Literal["AngleStop3D"] = "AngleStop3D"
    measured: ClassVar[int] = ANGLE

    limit: float
    """rad."""
    side: Literal["upper", "lower"] = "upper"
    """Whether the angle stays below the limit or above it."""
    start_angle: float | None = None
    """The angle at the start, rad, whole turns included; left out: as a joint, a driver or another element about the
    same axis says, or the turns by which attitudes are given, else between -pi and pi."""

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        refuse_points(self.name, self.markers(), bodies, "use a RigidBody3D")
        check_start_angle(self.name, self.a, self.b, self.start_angle, bodies)

    def counted_angles(self) -> Sequence[CountedAngle]:
        """Its angle."""
        return (CountedAngle(f"{self.name}.angle", self.a, self.b),)

    def said_angles(self, inputs: Mapping[str, float], t: float) -> Sequence[SaidAngle]:
        """What it says of the angle at the start."""
        return () if self.start_angle is None else (SaidAngle(self.a, self.b, self.start_angle, f"'{self.name}'"),)

    def units_in(self, bodies: Mapping[str, BodyElement]) -> tuple[str, str]:
        return "rad", "rad"


class SlideStop3D(LimitStop3D):
    """The place of marker `b` along the z axis of marker `a`, as the `position` of a slider with the same markers,
    stays below or above `limit`."""

    type: Literal["SlideStop3D"] = "SlideStop3D"
    measured: ClassVar[int] = PLACE

    limit: float
    """m."""
    side: Literal["upper", "lower"] = "upper"
    """Whether the place stays below the limit or above it."""


class Rope3D(Stop3D):
    """A rope without mass between markers `a` and `b`, of length `length` when it is taut; see `Rope2D`."""

    type: Literal["Rope3D"] = "Rope3D"
    symbol: ClassVar[str] = "rope"
    touch: ClassVar[str] = "rope"
    measured: ClassVar[int] = DISTANCE

    length: Positive
    """m."""

    @property
    def bound(self) -> float:
        return self.length

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        _refuse_meeting(f"the ends of rope '{self.name}'", self, bodies)


class DistanceStop3D(LimitStop3D):
    """The distance of the points of markers `a` and `b` stays below or above `limit`; see `Rope3D`."""

    type: Literal["DistanceStop3D"] = "DistanceStop3D"
    symbol: ClassVar[str] = "rope"
    measured: ClassVar[int] = DISTANCE

    limit: Positive
    """m."""
    side: Literal["upper", "lower"] = "upper"
    """Whether the distance stays below the limit or above it."""

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        _refuse_meeting(f"the markers of '{self.name}'", self, bodies)


def _refuse_meeting(ends: str, stop: Stop3D, bodies: Mapping[str, BodyElement]) -> None:
    """Raise ValueError if the ends of a distance meet at the start."""
    if not all(marker.body == GROUND or marker.body in bodies for marker in stop.markers()):
        return  # the model says which name is unknown
    (x, _), (y, _) = (start_of_marker(marker, bodies) for marker in stop.markers())
    if float(np.linalg.norm(y - x)) < LEAST * stop.bound:
        raise ValueError(f"{ends} meet at the start, where it has no direction: start with one of them a little aside")


are(STOP, stop3d_kernel)
