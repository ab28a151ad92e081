"""Planar distance joint: two markers keep their distance.

Phi = (d . d - L^2) / (2 L): polynomial, regular for L > 0, and with |Phi_q| = 1 as for |d| - L.
"""

from collections.abc import Sequence
from typing import ClassVar, Literal

from ..model.base import Positive
from .base import PairElement2D
from .formula2d import Frame2D
from .scalar_joint2d import ScalarConstraint, ScalarJoint2D, scalar_constraint


def excess_length(a: Frame2D, b: Frame2D, length: float) -> float:
    dx, dy = b.x - a.x, b.y - a.y
    return (dx * dx + dy * dy - length * length) * (0.5 / length)


class Distance2D(ScalarJoint2D, PairElement2D):
    """Markers `a` and `b` keep the distance `length` (a massless rod). Channel: force in it, tension positive."""

    type: Literal["Distance2D"] = "Distance2D"
    symbol: ClassVar[str] = "rod"
    arrow: ClassVar[str] = "tension"
    formula: ClassVar[ScalarConstraint] = scalar_constraint(excess_length)
    multiplier: ClassVar[tuple[str, str, str]] = ("tension", "N", "force in the rod, tension positive")

    length: Positive
    """m."""

    def lengths(self) -> Sequence[float]:
        return (self.length,)
