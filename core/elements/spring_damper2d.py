"""Springs and dampers between planar markers, along a measure of these: F = k (x - x_0) + c x', against its growth.

The natural length l0 of a `SpringDamper2D` may be a time function: what moves it puts in the power -k (l - l0) l0'.
"""

from typing import ClassVar, Literal

from ..model.base import NonNegative
from ..model.signals import Signal
from .measured_force import Measure, MeasuredForce2D
from .spring_law import SpringLaw


class SpringDamper2D(SpringLaw, MeasuredForce2D):
    """Spring and damper between markers `a` and `b`."""

    type: Literal["SpringDamper2D"] = "SpringDamper2D"
    symbol: ClassVar[str] = "spring"
    own_measure: ClassVar[Measure | None] = "distance"

    stiffness: NonNegative
    """N/m."""
    damping: NonNegative = 0.0
    """N s/m."""
    natural_length: NonNegative | Signal
    """m, a number or a time function, an input too. The force has the direction of the line: the markers must not meet
    (a Bushing2D's may)."""


class SlideSpring2D(SpringLaw, MeasuredForce2D):
    """Spring and damper along the first axis of marker `a`: pulls marker `b` to `natural_position` on it.

    Without stiffness it is the damping of a prismatic joint. It may pass through any position, zero too; across the
    axis it does nothing. The force on b is -(k (s - s0) + c s') along a's axis, the opposite one acts on a's body at
    b's point.
    """

    type: Literal["SlideSpring2D"] = "SlideSpring2D"
    symbol: ClassVar[str] = "spring"
    own_measure: ClassVar[Measure | None] = "slide"

    stiffness: NonNegative = 0.0
    """N/m."""
    damping: NonNegative = 0.0
    """N s/m."""
    natural_position: float = 0.0
    """Of b along a's first axis, where the spring is free, m."""


class TorsionSpring2D(SpringLaw, MeasuredForce2D):
    """Torsion spring and damper: turns marker `b` back to `natural_angle` from marker `a`.

    Without stiffness it is the damping of a revolute joint. The angle counts turns; the torque on b's body is
    -(k (phi - phi0) + c phi'), the opposite one acts on a's.
    """

    type: Literal["TorsionSpring2D"] = "TorsionSpring2D"
    symbol: ClassVar[str] = "coil"
    own_measure: ClassVar[Measure | None] = "angle"

    stiffness: NonNegative = 0.0
    """N m/rad."""
    damping: NonNegative = 0.0
    """N m s/rad."""
    natural_angle: float = 0.0
    """Angle from a's first axis to b's at which the spring is free, rad."""
