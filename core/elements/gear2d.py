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
from .base import Numbering, PairElement2D
from .formula2d import Frame2D
from .geometry2d import place
from .scalar_joint2d import ScalarConstraint, ScalarJoint2D, scalar_constraint

APART = 0.01
"""How much, relative to the larger radius, the distance of the centres may differ from the sum of the radii."""


def lag(a: Frame2D, b: Frame2D, radius_a: float, radius_b: float, phase: float) -> float:
    direction = math.atan2(b.y - a.y, b.x - a.x)
    arc = radius_a * (a.angle - direction) + radius_b * (b.angle - direction) - phase
    period = 2.0 * math.pi * (radius_a + radius_b)
    turns = math.floor(arc / period + 0.5)
    return arc - period * turns


class Gear2D(ScalarJoint2D, PairElement2D):
    """The pitch circles about markers `a` and `b`, the wheels' centres, roll on each other without slip.

    omega_a radius_a = -omega_b radius_b, seen from what holds the centres (a revolute joint each, on the ground or on
    a carrier). A wheel with inner teeth has a negative radius: the wheels then turn the same way. Channel: the force
    between the teeth; torque of the gear on each body about its centre = -radius x force.
    """

    type: Literal["Gear2D"] = "Gear2D"
    formula: ClassVar[ScalarConstraint] = scalar_constraint(lag)
    multiplier: ClassVar[tuple[str, str, str]] = (
        "tooth_force", "N", "force between the teeth; positive: its torque on a wheel of positive radius is negative",
    )  # fmt: skip

    derived: ClassVar[tuple[str, ...]] = ("phase",)

    radius_a: float
    """Radius of the pitch circle about `a`, m; negative for inner teeth."""
    radius_b: float
    """Radius of the pitch circle about `b`, m; negative for inner teeth."""

    @model_validator(mode="after")
    def _check_radii(self) -> "Gear2D":
        a, b = self.radius_a, self.radius_b
        if a == 0.0 or b == 0.0 or (a < 0.0 and b < 0.0) or a + b == 0.0:
            raise ValueError(
                f"gear '{self.name}': radius_a = {a:g} and radius_b = {b:g} m are no gear pair: give two radii that "
                "are not zero; for a wheel with inner teeth a negative one, larger than the other"
            )
        if self.a.body == self.b.body:
            raise ValueError(f"gear '{self.name}': both wheels are on '{self.a.body}': give it two bodies")
        return self

    def lengths(self) -> Sequence[float]:
        return abs(self.radius_a), abs(self.radius_b)

    def numbers(self, numbering: Numbering) -> Mapping[str, float]:
        """The arc that has passed at the start.

        Raises
        ------
        ModelError : if the centres are not as far apart as the radii say.
        """
        starts = [numbering.initial(marker.body) for marker in (self.a, self.b)]
        a, b = (place(marker.point, start) for marker, start in zip((self.a, self.b), starts, strict=True))
        needed, found = abs(self.radius_a + self.radius_b), math.dist(a, b)
        if abs(found - needed) > APART * max(abs(self.radius_a), abs(self.radius_b)):
            raise ModelError(
                f"the centres of gear '{self.name}' start {found:.6g} m apart, and its radii {self.radius_a:g} and "
                f"{self.radius_b:g} m need {needed:.6g} m: move a marker, or change a radius"
            )
        direction = math.atan2(b[1] - a[1], b[0] - a[0])
        turned = [s[2] + marker.angle - direction for marker, s in zip((self.a, self.b), starts, strict=True)]
        return {"phase": self.radius_a * turned[0] + self.radius_b * turned[1]}
