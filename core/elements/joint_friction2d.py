"""Dry friction of a joint: a torque or force against the motion.

It is Coulomb's: at rest the joint holds whatever is below its static friction, for as long as it takes. With a
transition rate the law is regularised: the friction falls to zero as tanh does, and a joint that should hold creeps, by
(load/size) times the transition rate at small loads.
"""

import math
from typing import ClassVar, Literal

from pydantic import model_validator

from ..model.base import NonNegative, Positive
from .base import PairElement2D
from .joint_friction import JointFrictionForce, check_radius
from .measures2d import slide, turn
from .scalar_force2d import ScalarForce, ScalarForce2D, scalar_force


def rubbing_torque(x: float, rate: float, torque: float, transition_rate: float) -> float:
    return torque * math.tanh(rate / transition_rate) + 0.0 * x


def rubbing_force(x: float, rate: float, force: float, transition_speed: float) -> float:
    return force * math.tanh(rate / transition_speed) + 0.0 * x


class RevoluteFriction2D(JointFrictionForce, ScalarForce2D, PairElement2D):
    """Dry friction of a revolute joint between the bodies of markers `a` and `b`: `torque`, and `coefficient` times
    `radius` times the force of the `joint`, which a bearing of that radius has (Haug 1989, Computer Aided Kinematics
    and Dynamics of Mechanical Systems, section 10.2)."""

    type: Literal["RevoluteFriction2D"] = "RevoluteFriction2D"
    formula: ClassVar[ScalarForce] = scalar_force(turn, rubbing_torque)
    measured: ClassVar[Literal["angle", "slide"]] = "angle"

    torque: NonNegative = 0.0
    """While it turns, N m, whatever the joint carries."""
    radius: Positive | None = None
    """Of the bearing, m; needed with a coefficient."""
    transition_rate: Positive | None = None
    """Of a regularised law, the rate at which 76 % of the torque act, rad/s; none: the law is Coulomb's."""

    @model_validator(mode="after")
    def _has_radius(self) -> "RevoluteFriction2D":
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


class SlideFriction2D(JointFrictionForce, ScalarForce2D, PairElement2D):
    """Dry friction of a prismatic joint along the first axis of marker `a`: `force`, and `coefficient` times the normal
    force of the `joint`."""

    type: Literal["SlideFriction2D"] = "SlideFriction2D"
    formula: ClassVar[ScalarForce] = scalar_force(slide, rubbing_force)
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
