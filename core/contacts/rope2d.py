"""Rope: two points are not farther apart than its length.

With an impact law the rope does not stretch: it pulls taut with a jerk, and goes slack where its force is zero. With a
force law it is a spring that only pulls, KelvinVoigt's a damped linear one.
"""

import math
from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import model_validator

from ..elements.formula2d import Frame2D
from ..model.base import Positive
from ..model.markers import Marker2D
from .geometry_kinds import ROPE, are
from .scalar_contact2d import ScalarContact, ScalarContact2D, scalar_contact


def slack(a: Frame2D, b: Frame2D, length: float) -> float:
    dx, dy = b.x - a.x, b.y - a.y
    # the last term gives a direction to a slack rope whose ends meet; of a taut one it is rounding
    return length - math.sqrt(dx * dx + dy * dy + 1e-16 * length * length)


class Rope2D(ScalarContact2D):
    """A rope without mass between markers `a` and `b`, of length `length` when it is taut.

    A contact whose gap is its slack: "normal_force" is the tension, "close" and "open" events are when it becomes taut
    and slack. NewtonImpact(restitution=0) is a rope without give; KelvinVoigt a spring and damper that only pull.
    """

    type: Literal["Rope2D"] = "Rope2D"
    symbol: ClassVar[str] = "rope"
    formula: ClassVar[ScalarContact] = scalar_contact(slack)

    a: Marker2D = Marker2D()
    """The first marker."""
    b: Marker2D
    """The second marker."""
    length: Positive
    """m."""

    @model_validator(mode="after")
    def _no_friction(self) -> "Rope2D":
        if self.friction is not None:
            raise ValueError(f"rope '{self.name}' has friction, but nothing slides on it: leave it out")
        return self

    def lengths(self) -> Sequence[float]:
        return (self.length,)


are(ROPE, slack)
