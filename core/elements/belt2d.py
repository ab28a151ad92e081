"""Belt drive: two pulleys are turned by one belt that neither slips nor stretches.

Phi = r_a (theta_a - phi) -+ r_b (theta_b - phi) - (its value at the start), phi the direction from a to b: minus for an
open belt, plus for a crossed one. As with gears, it does not matter what holds the centres.
"""

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

from pydantic import model_validator

from ..model.base import Positive
from .base import Numbering, PairElement2D
from .formula2d import Frame2D
from .geometry2d import place
from .scalar_joint2d import ScalarConstraint, ScalarJoint2D, scalar_constraint


def passed(a: Frame2D, b: Frame2D, radius_a: float, turning_b: float, phase: float) -> float:
    direction = math.atan2(b.y - a.y, b.x - a.x)
    arc = radius_a * (a.angle - direction) - turning_b * (b.angle - direction) - phase
    period = 2.0 * math.pi * (radius_a - turning_b)
    if period == 0.0:
        return arc
    turns = math.floor(arc / period + 0.5)
    return arc - period * turns


class Belt2D(ScalarJoint2D, PairElement2D):
    """A belt over pulleys about markers `a` and `b`: omega_a radius_a = omega_b radius_b, or minus that if crossed.

    The pulleys' pins take no pretension from it. Channel: the difference of the forces in its two straight parts.
    """

    type: Literal["Belt2D"] = "Belt2D"
    formula: ClassVar[ScalarConstraint] = scalar_constraint(passed)
    multiplier: ClassVar[tuple[str, str, str]] = (
        "belt_force", "N", "force that the belt carries over; positive: its torque on pulley a is negative",
    )  # fmt: skip
    derived: ClassVar[tuple[str, ...]] = ("phase",)

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

    @model_validator(mode="after")
    def _check(self) -> "Belt2D":
        if self.a.body == self.b.body:
            raise ValueError(f"belt '{self.name}': both pulleys are on '{self.a.body}': give it two bodies")
        return self

    def lengths(self) -> Sequence[float]:
        return self.radius_a, self.radius_b

    def numbers(self, numbering: Numbering) -> Mapping[str, float]:
        """What has passed at the start."""
        starts = [numbering.initial(marker.body) for marker in (self.a, self.b)]
        a, b = (place(marker.point, start) for marker, start in zip((self.a, self.b), starts, strict=True))
        direction = math.atan2(b[1] - a[1], b[0] - a[0])
        turned = [s[2] + marker.angle - direction for marker, s in zip((self.a, self.b), starts, strict=True)]
        return {"phase": self.radius_a * turned[0] - self.turning_b * turned[1]}
