"""End stop of a joint that turns: the angle between two bodies does not go beyond a limit."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from pydantic import model_validator

from ..elements.base import BodyElement
from ..elements.formula2d import Frame2D
from ..model.markers import Marker2D
from .geometry_kinds import TURN, are
from .scalar_contact2d import ScalarContact, ScalarContact2D, scalar_contact


def room(a: Frame2D, b: Frame2D, limit: float, sign: float) -> float:
    return sign * (limit - (b.angle - a.angle))


class AngleStop2D(ScalarContact2D):
    """The angle from marker `a` to marker `b` (their first axes, counting turns) stays below or above `limit`.

    A contact in rad: its normal force is a torque, N m, impulses are N m s, and stiffnesses of force laws N m/rad. A
    joint with two limits has two stops.
    """

    type: Literal["AngleStop2D"] = "AngleStop2D"
    symbol: ClassVar[str] = "angle-stop"
    formula: ClassVar[ScalarContact] = scalar_contact(room)

    a: Marker2D = Marker2D()
    """The first marker."""
    b: Marker2D
    """The second marker."""
    limit: float
    """rad."""
    side: Literal["upper", "lower"] = "upper"
    """Whether the angle stays below the limit or above it."""

    @property
    def sign(self) -> float:
        """Of the gap's growth with the limit."""
        return 1.0 if self.side == "upper" else -1.0

    @model_validator(mode="after")
    def _no_friction(self) -> "AngleStop2D":
        if self.friction is not None:
            raise ValueError(f"stop '{self.name}' has friction, but nothing slides on it: leave it out")
        return self

    def units_in(self, bodies: Mapping[str, BodyElement]) -> tuple[str, str]:
        return "rad", "rad"


are(TURN, room)
