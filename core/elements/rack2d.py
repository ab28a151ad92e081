"""Rack and pinion: a wheel's pitch circle rolls on a line.

Phi = s + r (theta_a - theta_b) - (its value at the start), s the place of the wheel's centre along the rack's axis.
"""

from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

from pydantic import model_validator

from .base import Numbering, PairElement2D
from .formula2d import Frame2D
from .geometry2d import place
from .scalar_joint2d import ScalarConstraint, ScalarJoint2D, scalar_constraint


def rolled(a: Frame2D, b: Frame2D, radius: float, phase: float) -> float:
    along = (a.x - b.x) * b.ex + (a.y - b.y) * b.ey
    return along + radius * (a.angle - b.angle) - phase


class Rack2D(ScalarJoint2D, PairElement2D):
    """The pitch circle about marker `a`, the wheel's centre, rolls without slip on the first axis of the rack, `b`.

    What holds the wheel at its height over the rack are other joints. A wheel that turns counter-clockwise goes
    backwards on a rack below it. Channel: the force between the teeth.
    """

    type: Literal["Rack2D"] = "Rack2D"
    formula: ClassVar[ScalarConstraint] = scalar_constraint(rolled)
    multiplier: ClassVar[tuple[str, str, str]] = (
        "tooth_force", "N", "force between the teeth; positive: it drives the wheel back along the rack's axis",
    )  # fmt: skip
    derived: ClassVar[tuple[str, ...]] = ("phase",)

    radius: float
    """Of the wheel's pitch circle, m; negative if the rack is above the wheel."""

    @model_validator(mode="after")
    def _check(self) -> "Rack2D":
        if self.radius == 0.0:
            raise ValueError(f"rack '{self.name}': radius = 0 does not roll: give the radius of the pitch circle")
        if self.a.body == self.b.body:
            raise ValueError(f"rack '{self.name}': wheel and rack are both on '{self.a.body}': give it two bodies")
        return self

    def lengths(self) -> Sequence[float]:
        return (abs(self.radius),)

    def numbers(self, numbering: Numbering) -> Mapping[str, float]:
        """What the formula says at the start."""
        a, b = (numbering.initial(marker.body) for marker in (self.a, self.b))
        centre, origin = place(self.a.point, a), place(self.b.point, b)
        ex, ey = place((1.0, 0.0), (0.0, 0.0, b[2] + self.b.angle))
        along = (centre[0] - origin[0]) * ex + (centre[1] - origin[1]) * ey
        return {"phase": along + self.radius * (a[2] + self.a.angle - b[2] - self.b.angle)}
