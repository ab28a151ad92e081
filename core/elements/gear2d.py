"""Planar gear pair: the pitch circles about two markers roll on each other.

Phi = r_a (theta_a - phi) + r_b (theta_b - phi) - (its value at the start), phi the direction from a to b: the arcs that
have passed the pitch point, seen from the line of centres. So it does not matter what holds the centres apart, pins on
the ground or a carrier that turns, and the reactions at the pins are those of a force between the teeth. phi is known
but for whole turns, which are taken off.
"""

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

from pydantic import model_validator

from ..errors import ModelError
from .base import Numbering
from .measure2d import ends2d
from .rolling_pair2d import RollingPair2D, arcs
from .scalar_joint2d import ScalarConstraint, scalar_constraint

APART = 0.01
"""How much, relative to the larger radius, the distance of the centres may differ from the sum of the radii."""


class Gear2D(RollingPair2D):
    """The pitch circles about markers `a` and `b`, the wheels' centres, roll on each other without slip.

    omega_a radius_a = -omega_b radius_b, seen from what holds the centres (a revolute joint each, on the ground or on
    a carrier). A wheel with inner teeth has a negative radius: the wheels then turn the same way. Channel: the force
    between the teeth; torque of the gear on each body about its centre = -radius x force.
    """

    type: Literal["Gear2D"] = "Gear2D"
    symbol: ClassVar[str] = "gears"
    formula: ClassVar[ScalarConstraint] = scalar_constraint(arcs)
    multiplier: ClassVar[tuple[str, str, str]] = (
        "tooth_force", "N", "force between the teeth; positive: its torque on a wheel of positive radius is negative",
    )  # fmt: skip

    radius_a: float
    """Radius of the pitch circle about `a`, m; negative for inner teeth."""
    radius_b: float
    """Radius of the pitch circle about `b`, m; negative for inner teeth."""

    @property
    def turning_b(self) -> float:
        """Radius of a pulley b on a belt that would turn it the same way, m."""
        return -self.radius_b

    @model_validator(mode="after")
    def _check_radii(self) -> "Gear2D":
        a, b = self.radius_a, self.radius_b
        if a == 0.0 or b == 0.0 or (a < 0.0 and b < 0.0) or a + b == 0.0:
            raise ValueError(
                f"gear '{self.name}': radius_a = {a:g} and radius_b = {b:g} m are no gear pair: give two radii that "
                "are not zero; for a wheel with inner teeth a negative one, larger than the other"
            )
        return self

    def lengths(self) -> Sequence[float]:
        return abs(self.radius_a), abs(self.radius_b)

    def numbers(self, numbering: Numbering) -> Mapping[str, float]:
        """The arc that has passed at the start.

        Raises
        ------
        ModelError : if the centres are not as far apart as the radii say.
        """
        a, b = ends2d(self.a, self.b, numbering)
        needed, found = abs(self.radius_a + self.radius_b), math.dist(a, b)
        if abs(found - needed) > APART * max(abs(self.radius_a), abs(self.radius_b)):
            raise ModelError(
                f"the centres of gear '{self.name}' start {found:.6g} m apart, and its radii {self.radius_a:g} and "
                f"{self.radius_b:g} m need {needed:.6g} m: move a marker, or change a radius"
            )
        return super().numbers(numbering)
