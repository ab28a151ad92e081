"""Force or torque between two bodies in space as a time function or an input: f(t) along the growth of a measure."""

from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

from ..model.signals import Signal
from .base import BodyElement, Numbering
from .measured_force3d import LOAD, MEASURE_KINDS, Measure3D, MeasuredForce3D


class RelativeLoad3D(MeasuredForce3D):
    """`load`(t) between markers `a` and `b`: a force or torque that makes a measure grow where it is positive.

    measure "angle": a torque about the z axis of a on b's body, and against it on a's, N m, an ideal motor; "slide": a
    force on b along that axis, N; "distance": a force that pushes the points apart, N, a cylinder whose pressure is
    given.
    """

    type: Literal["RelativeLoad3D"] = "RelativeLoad3D"
    law: ClassVar[int] = LOAD

    measure: Measure3D = "angle"
    """What it moves: the angle of b about the z axis of a, its place along it, or the distance of the points."""
    load: Signal
    """Over time, N m or N; positive makes the measure grow."""

    def kind(self) -> int:
        return MEASURE_KINDS[self.measure]

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        if self.a.body == self.b.body:
            raise ValueError(
                f"load '{self.name}': both markers are on '{self.a.body}', which would feel nothing of it: give it two "
                "bodies, or ground and a body"
            )
        super().check_in(bodies)

    def signals(self) -> Sequence[Signal]:
        return (self.load,)

    def signal_in(self, numbering: Numbering) -> int:
        return numbering.signal(self.load)
