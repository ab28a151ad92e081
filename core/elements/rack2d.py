"""Rack and pinion: a wheel's pitch circle rolls on a line.

Phi = s + r (theta_a - theta_b) - (its value at the start), s the place of the wheel's centre along the rack's axis.
"""

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import model_validator

from .formula2d import Frame2D
from .rolling_pair2d import RollingPair2D
from .scalar_joint2d import ScalarConstraint, scalar_constraint


def rolled(a: Frame2D, b: Frame2D, radius: float, phase: float) -> float:
    along = (a.x - b.x) * b.ex + (a.y - b.y) * b.ey
    return along + radius * (a.angle - b.angle) - phase


class Rack2D(RollingPair2D):
    """The pitch circle about marker `a`, the wheel's centre, rolls without slip on the first axis of the rack, `b`.

    What holds the wheel at its height over the rack are other joints. A wheel that turns counter-clockwise goes
    backwards on a rack below it. Channel: the force between the teeth.
    """

    type: Literal["Rack2D"] = "Rack2D"
    symbol: ClassVar[str] = "rack"
    sides: ClassVar[str] = "wheel and rack are both"
    formula: ClassVar[ScalarConstraint] = scalar_constraint(rolled)
    multiplier: ClassVar[tuple[str, str, str]] = (
        "tooth_force", "N", "force between the teeth; positive: it drives the wheel back along the rack's axis",
    )  # fmt: skip

    radius: float
    """Of the wheel's pitch circle, m; negative if the rack is above the wheel."""

    @model_validator(mode="after")
    def _check(self) -> "Rack2D":
        if self.radius == 0.0:
            raise ValueError(f"rack '{self.name}': radius = 0 does not roll: give the radius of the pitch circle")
        return self

    def lengths(self) -> Sequence[float]:
        return (abs(self.radius),)
