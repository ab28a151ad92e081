"""Dry friction of a joint: a torque or force against the motion.

It is Coulomb's: at rest the joint holds whatever is below its static friction, for as long as it takes. With a
transition rate the law is regularised: the friction falls to zero as tanh does, and a joint that should hold creeps, by
(load/size) times the transition rate at small loads.
"""

import math
from typing import ClassVar, Literal

from .base import PairElement2D
from .joint_friction import SlidingFriction, TurningFriction
from .measures2d import slide, turn
from .scalar_force2d import ScalarForce, ScalarForce2D, scalar_force


def rubbing_torque(x: float, rate: float, torque: float, transition_rate: float) -> float:
    return torque * math.tanh(rate / transition_rate) + 0.0 * x


def rubbing_force(x: float, rate: float, force: float, transition_speed: float) -> float:
    return force * math.tanh(rate / transition_speed) + 0.0 * x


class RevoluteFriction2D(TurningFriction, ScalarForce2D, PairElement2D):
    """Dry friction of a revolute joint between the bodies of markers `a` and `b`: `torque`, and `coefficient` times
    `radius` times the force of the `joint`, which a bearing of that radius has (Haug 1989, Computer Aided Kinematics
    and Dynamics of Mechanical Systems, section 10.2)."""

    type: Literal["RevoluteFriction2D"] = "RevoluteFriction2D"
    formula: ClassVar[ScalarForce] = scalar_force(turn, rubbing_torque)


class SlideFriction2D(SlidingFriction, ScalarForce2D, PairElement2D):
    """Dry friction of a prismatic joint along the first axis of marker `a`: `force`, and `coefficient` times the normal
    force of the `joint`."""

    type: Literal["SlideFriction2D"] = "SlideFriction2D"
    formula: ClassVar[ScalarForce] = scalar_force(slide, rubbing_force)
