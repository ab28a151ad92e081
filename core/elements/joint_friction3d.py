"""Dry friction of a joint in space: a torque or force against the motion.

As `joint_friction2d`: Coulomb's, or regularised by choice.
"""

from typing import Literal

from .friction_law import RubbingForce
from .joint_friction import SlidingFriction, TurningFriction
from .measured_force3d import MeasuredForce3D


class RevoluteFriction3D(TurningFriction, RubbingForce, MeasuredForce3D):
    """Dry friction of a Revolute3D or Cylindrical3D with the same markers, about the z axis of marker `a`: `torque`,
    and `coefficient` times `radius` times the force of the `joint`."""

    type: Literal["RevoluteFriction3D"] = "RevoluteFriction3D"


class SlideFriction3D(SlidingFriction, RubbingForce, MeasuredForce3D):
    """Dry friction of a Prismatic3D or Cylindrical3D with the same markers, along the z axis of marker `a`: `force`,
    and `coefficient` times the force of the `joint` across that axis."""

    type: Literal["SlideFriction3D"] = "SlideFriction3D"
