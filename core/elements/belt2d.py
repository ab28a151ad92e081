"""Belt drive: two pulleys are turned by one belt that neither slips nor stretches.

Phi = r_a (theta_a - phi) -+ r_b (theta_b - phi) - (its value at the start), phi the direction from a to b: minus for an
open belt, plus for a crossed one. As with gears, it does not matter what holds the centres.
"""

from collections.abc import Sequence
from typing import ClassVar, Literal

from ..model.base import Positive
from .rolling_pair2d import RollingPair2D, arcs
from .scalar_joint2d import ScalarConstraint, scalar_constraint


class Belt2D(RollingPair2D):
    """A belt over pulleys about markers `a` and `b`: omega_a radius_a = omega_b radius_b, or minus that if crossed.

    The pulleys' pins take no pretension from it. Channel: the difference of the forces in its two straight parts.
    """

    type: Literal["Belt2D"] = "Belt2D"
    symbol: ClassVar[str] = "belts"
    sides: ClassVar[str] = "both pulleys are"
    formula: ClassVar[ScalarConstraint] = scalar_constraint(arcs)
    multiplier: ClassVar[tuple[str, str, str]] = (
        "belt_force", "N", "force that the belt carries over; positive: its torque on pulley a is negative",
    )  # fmt: skip

    radius_a: Positive
    """m."""
    radius_b: Positive
    """m."""
    crossed: bool = False
    """The pulleys turn against each other."""

    @property
    def turning_b(self) -> float:
        """Radius of b, negative for a crossed belt, m."""
        return -self.radius_b if self.crossed else self.radius_b

    def lengths(self) -> Sequence[float]:
        return self.radius_a, self.radius_b
