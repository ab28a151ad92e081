"""Dry friction of a planar joint: a torque or force against the motion.

It is Coulomb's: at rest the joint holds whatever is below its static friction, for as long as it takes. With a
transition rate the law is regularised (`friction_law`).
"""

from typing import Literal

from .friction_law import RubbingForce
from .joint_friction import SlidingFriction, TurningFriction
from .measured_force import MeasuredForce2D


class RevoluteFriction2D(TurningFriction, RubbingForce, MeasuredForce2D):
    """Dry friction of a revolute joint between the bodies of markers `a` and `b`: `torque`, and `coefficient` times
    `radius` times the force of the `joint`, which a bearing of that radius has (Haug 1989, Computer Aided Kinematics
    and Dynamics of Mechanical Systems, section 10.2)."""

    type: Literal["RevoluteFriction2D"] = "RevoluteFriction2D"


class SlideFriction2D(SlidingFriction, RubbingForce, MeasuredForce2D):
    """Dry friction of a prismatic joint along the first axis of marker `a`: `force`, and `coefficient` times the normal
    force of the `joint`."""

    type: Literal["SlideFriction2D"] = "SlideFriction2D"
