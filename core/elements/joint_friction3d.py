"""Dry friction of a joint in space: a torque or force against the motion.

As `joint_friction2d`: Coulomb's, or regularised by choice.
"""

from typing import ClassVar, Literal

from pydantic import model_validator

from ..model.base import NonNegative, Positive
from .joint_friction import JointFrictionForce, check_radius
from .measure3d import ANGLE, PLACE
from .measured_force3d import FRICTION, MeasuredForce3D


class _Friction3D(JointFrictionForce, MeasuredForce3D):
    """Base of both."""

    law: ClassVar[int] = FRICTION

    def kind(self) -> int:
        return ANGLE if type(self).measured == "angle" else PLACE

    def numbers(self) -> tuple[float, float, float, float]:
        return (self.preload, self.transition or 0.0, 0.0, 0.0)


class RevoluteFriction3D(_Friction3D):
    """Dry friction of a Revolute3D or Cylindrical3D with the same markers, about the z axis of marker `a`: `torque`,
    and `coefficient` times `radius` times the force of the `joint`."""

    type: Literal["RevoluteFriction3D"] = "RevoluteFriction3D"
    measured: ClassVar[Literal["angle", "slide"]] = "angle"

    torque: NonNegative = 0.0
    """While it turns, N m, whatever the joint carries."""
    radius: Positive | None = None
    """Of the bearing, m; needed with a coefficient."""
    transition_rate: Positive | None = None
    """Of a regularised law, the rate at which 76 % of the torque act, rad/s; none: the law is Coulomb's."""

    @model_validator(mode="after")
    def _has_radius(self) -> "RevoluteFriction3D":
        check_radius(self, self.radius)
        return self

    @property
    def preload(self) -> float:
        return self.torque

    @property
    def transition(self) -> float | None:
        return self.transition_rate

    @property
    def arm(self) -> float:
        return self.coefficient * (self.radius or 0.0)


class SlideFriction3D(_Friction3D):
    """Dry friction of a Prismatic3D or Cylindrical3D with the same markers, along the z axis of marker `a`: `force`,
    and `coefficient` times the force of the `joint` across that axis."""

    type: Literal["SlideFriction3D"] = "SlideFriction3D"
    measured: ClassVar[Literal["angle", "slide"]] = "slide"

    force: NonNegative = 0.0
    """While it slides, N, whatever the joint carries."""
    transition_speed: Positive | None = None
    """Of a regularised law, the speed at which 76 % of the force act, m/s; none: the law is Coulomb's."""

    @property
    def preload(self) -> float:
        return self.force

    @property
    def transition(self) -> float | None:
        return self.transition_speed
