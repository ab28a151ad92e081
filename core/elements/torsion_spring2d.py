"""Torsion spring and rotational damper between two markers: T = k (phi - phi0) + c phi'."""

from typing import ClassVar, Literal

from ..model.base import NonNegative
from .base import PairElement2D
from .formula2d import Frame2D
from .scalar_force2d import ScalarForce, ScalarForce2D, scalar_force


def twist(a: Frame2D, b: Frame2D, natural_angle: float) -> float:
    return b.angle - a.angle - natural_angle


def torque(x: float, rate: float, stiffness: float, damping: float) -> float:
    return stiffness * x + damping * rate


def energy(x: float, stiffness: float) -> float:
    return 0.5 * stiffness * x * x


class TorsionSpring2D(ScalarForce2D, PairElement2D):
    """Torsion spring and damper: turns marker `b` back to `natural_angle` from marker `a`.

    Without stiffness it is the damping of a revolute joint. The angle counts turns; the torque on b's body is
    -(k (phi - phi0) + c phi'), the opposite one acts on a's.
    """

    type: Literal["TorsionSpring2D"] = "TorsionSpring2D"
    formula: ClassVar[ScalarForce] = scalar_force(twist, torque, energy)

    stiffness: NonNegative = 0.0
    """N m/rad."""
    damping: NonNegative = 0.0
    """N m s/rad."""
    natural_angle: float = 0.0
    """Angle from a's first axis to b's at which the spring is free, rad."""
