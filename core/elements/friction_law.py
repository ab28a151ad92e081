"""Dry friction of a joint along a measure x, regularised: T tanh(x'/w)."""

from typing import ClassVar

from .joint_friction import JointFrictionForce
from .measured_force import FRICTION, Measure, MeasuredForce, Numbers


class RubbingForce(JointFrictionForce, MeasuredForce):
    """Base of friction along one measure. Regularised, it falls to zero as tanh does, and a joint that should hold
    creeps, by (load/size) times the transition rate at small loads."""

    law: ClassVar[int] = FRICTION

    @property
    def acts_along(self) -> Measure:
        return type(self).measured

    def numbers(self) -> Numbers:
        return (self.preload, self.transition or 0.0, 0.0, 0.0)
