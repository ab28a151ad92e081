"""Force or torque between two bodies in space as a time function or an input; see `load_law`."""

from typing import ClassVar, Literal

from .load_law import LoadLaw
from .measured_force3d import Measure, MeasuredForce3D


class RelativeLoad3D(LoadLaw, MeasuredForce3D):
    """`load`(t) between markers `a` and `b`: a force or torque that makes a measure grow where it is positive.

    measure "angle": a torque about the z axis of a on b's body, and against it on a's, N m, an ideal motor; "slide": a
    force on b along that axis, N; "distance": a force that pushes the points apart, N, a cylinder whose pressure is
    given.
    """

    type: Literal["RelativeLoad3D"] = "RelativeLoad3D"
    symbol: ClassVar[str] = "actuator"

    measure: Measure = "angle"
    """What it moves: the angle of b about the z axis of a, its place along it, or the distance of the points."""
