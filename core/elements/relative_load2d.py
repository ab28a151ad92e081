"""Force or torque between two planar bodies as a time function or an input; see `load_law`."""

from typing import ClassVar, Literal

from .load_law import LoadLaw
from .measure2d import MeasuredElement2D
from .measured_force import MeasuredForce2D


class RelativeLoad2D(LoadLaw, MeasuredForce2D, MeasuredElement2D):
    """`load`(t) between markers `a` and `b`: a force or torque that makes a measure grow where it is positive.

    measure "angle": a torque on b's body, and against it on a's, N m, an ideal motor; "slide": a force on b along a's
    first axis, N; "distance": a force that pushes the points apart, N, a cylinder whose pressure is given.
    """

    type: Literal["RelativeLoad2D"] = "RelativeLoad2D"
    symbol: ClassVar[str] = "actuator"
