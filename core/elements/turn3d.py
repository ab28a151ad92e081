"""The turns of a joint in space, counted.

The axes tell an angle but for whole turns. These are counted by a work account, as all accounts a part of the state:
the integral of the relative angular velocity about the z axis of marker a. It is used only to tell which of the angles
that differ by whole turns is meant, so that its own error does not matter while it is below half a turn.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..compiled.jit import internal
from ..compiled.kernels import POWER
from ..compiled.views import imat, mat, vec
from ..model.markers import Marker3D
from ..model.rotation3d import columns_at, constant, dot, four, less, space_rate
from ..model.said_angle import CountedAngle, SaidAngle
from .base import BodyElement, Element, Form, Numbering, Part, Row, no_account
from .start_angle3d import check_start_angle

LOOSE = 100.0
"""rad; what the error control takes for the size of such an account, so that it does not shorten steps."""


@internal
def turn3d_kernel(job: int, t: float, b: Any) -> None:
    if job != POWER:
        return
    par, coord, extra = mat(b.par, b.count, 5), imat(b.coord, b.count, 14), imat(b.extra, b.count, 1)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    for e in range(b.count):
        _, axis = columns_at(b, coord[e], 3, par[e, 0], constant(par[e], 2))
        of_a = space_rate(four(q, coord[e], 3, par[e, 0]), four(v, coord[e], 3, 0.0))
        of_b = space_rate(four(q, coord[e], 10, par[e, 1]), four(v, coord[e], 10, 0.0))
        vec(b.a, b.n_extended)[extra[e, 0]] += 2.0 * dot(less(of_b, of_a), axis)


FORM = Form(turn3d_kernel, 0, (), ())


def account_of(joint: str) -> str:
    """Name of the account of a joint's angle."""
    return f"{joint}.turned"


def turn_part(joint: str, a: Marker3D, b: Marker3D, numbering: Numbering) -> Part:
    """What counts the turns of a joint, as tables."""
    rest = (numbering.at_rest(a)[3], numbering.at_rest(b)[3])
    coordinates = (*numbering.frame(a), *numbering.frame(b))
    account = numbering.work(account_of(joint), LOOSE)
    return Part(FORM, (Row((*rest, *a.axes()[:, 2]), coordinates, (account,)),))


class CountsTurns3D(Element):
    """Base of what counts the turns of an angle. Each declares `start_angle` itself: its place is that in its JSON."""

    if TYPE_CHECKING:
        start_angle: float | None

    def counted_pair(self) -> tuple[Marker3D, Marker3D] | None:
        """Markers of the angle, that of b about the z axis of a; None if it acts on no angle."""
        raise NotImplementedError(f"{type(self).__name__} must say which angle it counts")

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        super().check_in(bodies)
        pair = self.counted_pair()
        if pair is not None:
            check_start_angle(self.name, *pair, self.start_angle, bodies)
        elif self.start_angle is not None:
            raise ValueError(f"'{self.name}' acts on no angle: leave `start_angle` out")

    def counted_angles(self) -> Sequence[CountedAngle]:
        """Its angle, if it acts on one."""
        pair = self.counted_pair()
        return () if pair is None else (CountedAngle(f"{self.name}.angle", *pair),)

    def said_angles(self, inputs: Mapping[str, float], t: float) -> Sequence[SaidAngle]:
        """What it says of the angle at the start."""
        pair = self.counted_pair()
        if pair is None or self.start_angle is None:
            return ()
        return (SaidAngle(*pair, self.start_angle, f"'{self.name}'"),)

    def turns(self, numbering: Numbering) -> tuple[float, int]:
        """Angle at the start, rad, whole turns included, and index of the account of its turns."""
        pair = self.counted_pair()
        if pair is None:
            return 0.0, no_account(numbering)
        return numbering.start_angle(*pair, self.name), numbering.work(account_of(self.name), LOOSE)

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        pair = self.counted_pair()
        counted = () if pair is None else (turn_part(self.name, *pair, numbering),)
        return (*super().parts(numbering), *counted)
