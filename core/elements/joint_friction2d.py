"""Dry friction of a joint that is preloaded: a torque or force of given size against the motion.

Below the transition rate it falls to zero as tanh does, so that the joint creeps where it should hold: by
(load/size) times the transition rate at small loads. What holds for good is friction of a contact.
"""

import math
from typing import ClassVar, Literal

from ..model.base import NonNegative, Positive
from .base import PairElement2D
from .measures2d import slide, turn
from .scalar_force2d import ScalarForce, ScalarForce2D, scalar_force


def rubbing_torque(x: float, rate: float, torque: float, transition_rate: float) -> float:
    return torque * math.tanh(rate / transition_rate) + 0.0 * x


def rubbing_force(x: float, rate: float, force: float, transition_speed: float) -> float:
    return force * math.tanh(rate / transition_speed) + 0.0 * x


class RevoluteFriction2D(ScalarForce2D, PairElement2D):
    """Dry friction of a revolute joint between the bodies of markers `a` and `b`."""

    type: Literal["RevoluteFriction2D"] = "RevoluteFriction2D"
    formula: ClassVar[ScalarForce] = scalar_force(turn, rubbing_torque)

    torque: NonNegative
    """While it turns, N m."""
    transition_rate: Positive
    """Rate at which 76 % of the torque act, rad/s."""


class SlideFriction2D(ScalarForce2D, PairElement2D):
    """Dry friction of a prismatic joint along the first axis of marker `a`."""

    type: Literal["SlideFriction2D"] = "SlideFriction2D"
    formula: ClassVar[ScalarForce] = scalar_force(slide, rubbing_force)

    force: NonNegative
    """While it slides, N."""
    transition_speed: Positive
    """Speed at which 76 % of the force act, m/s."""
