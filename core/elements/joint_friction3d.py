"""Dry friction of a joint in space: a torque or force against the motion.

As `joint_friction2d`: Coulomb's, or regularised by choice.
"""

from typing import ClassVar, Literal

from .joint_friction import JointFrictionForce, SlidingFriction, TurningFriction
from .measure3d import ANGLE, PLACE
from .measured_force3d import FRICTION, MeasuredForce3D


class _Friction3D(JointFrictionForce, MeasuredForce3D):
    """Base of both."""

    law: ClassVar[int] = FRICTION

    def kind(self) -> int:
        return ANGLE if type(self).measured == "angle" else PLACE

    def numbers(self) -> tuple[float, float, float, float]:
        return (self.preload, self.transition or 0.0, 0.0, 0.0)


class RevoluteFriction3D(TurningFriction, _Friction3D):
    """Dry friction of a Revolute3D or Cylindrical3D with the same markers, about the z axis of marker `a`: `torque`,
    and `coefficient` times `radius` times the force of the `joint`."""

    type: Literal["RevoluteFriction3D"] = "RevoluteFriction3D"


class SlideFriction3D(SlidingFriction, _Friction3D):
    """Dry friction of a Prismatic3D or Cylindrical3D with the same markers, along the z axis of marker `a`: `force`,
    and `coefficient` times the force of the `joint` across that axis."""

    type: Literal["SlideFriction3D"] = "SlideFriction3D"
