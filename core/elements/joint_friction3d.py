"""Dry friction of a joint in space that is preloaded: a torque or force of given size against the motion.

As `joint_friction2d`: below the transition rate it falls to zero as tanh does, so that the joint creeps where it should
hold.
"""

from typing import ClassVar, Literal

from ..model.base import NonNegative, Positive
from .measure3d import ANGLE, PLACE
from .measured_force3d import FRICTION, MeasuredForce3D


class RevoluteFriction3D(MeasuredForce3D):
    """Dry friction of a Revolute3D or Cylindrical3D with the same markers, about the z axis of marker `a`."""

    type: Literal["RevoluteFriction3D"] = "RevoluteFriction3D"
    law: ClassVar[int] = FRICTION

    torque: NonNegative
    """While it turns, N m."""
    transition_rate: Positive
    """Rate at which 76 % of the torque act, rad/s."""

    def kind(self) -> int:
        return ANGLE

    def numbers(self) -> tuple[float, float, float, float]:
        return (self.torque, self.transition_rate, 0.0, 0.0)


class SlideFriction3D(MeasuredForce3D):
    """Dry friction of a Prismatic3D or Cylindrical3D with the same markers, along the z axis of marker `a`."""

    type: Literal["SlideFriction3D"] = "SlideFriction3D"
    law: ClassVar[int] = FRICTION

    force: NonNegative
    """While it slides, N."""
    transition_speed: Positive
    """Speed at which 76 % of the force act, m/s."""

    def kind(self) -> int:
        return PLACE

    def numbers(self) -> tuple[float, float, float, float]:
        return (self.force, self.transition_speed, 0.0, 0.0)
