"""Spring and damper along the axis of a prismatic joint: F = k (s - s0) + c s'."""

from typing import ClassVar, Literal

from ..model.base import NonNegative
from .base import PairElement2D
from .formula2d import Frame2D
from .scalar_force2d import ScalarForce, ScalarForce2D, scalar_force
from .torsion_spring2d import energy, torque


def way(a: Frame2D, b: Frame2D, natural_position: float) -> float:
    return (b.x - a.x) * a.ex + (b.y - a.y) * a.ey - natural_position


class SlideSpring2D(ScalarForce2D, PairElement2D):
    """Spring and damper along the first axis of marker `a`: pulls marker `b` to `natural_position` on it.

    Without stiffness it is the damping of a prismatic joint. It may pass through any position, zero too; across the
    axis it does nothing. The force on b is -(k (s - s0) + c s') along a's axis, the opposite one acts on a's body at
    b's point.
    """

    type: Literal["SlideSpring2D"] = "SlideSpring2D"
    formula: ClassVar[ScalarForce] = scalar_force(way, torque, energy)

    stiffness: NonNegative = 0.0
    """N/m."""
    damping: NonNegative = 0.0
    """N s/m."""
    natural_position: float = 0.0
    """Of b along a's first axis, where the spring is free, m."""
