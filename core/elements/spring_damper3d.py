"""Springs and dampers in space along a measure of two markers: F = k (x - x_0) + c x', against the growth of x."""

from collections.abc import Sequence
from typing import ClassVar, Literal

from ..model.base import NonNegative
from ..model.signals import Signal
from .base import Numbering
from .measure3d import ANGLE, DISTANCE, PLACE
from .measured_force3d import NO_SIGNAL, SPRING, CountingForce3D, MeasuredForce3D


class _Spring3D(MeasuredForce3D):
    """Base of springs along a measure."""

    law: ClassVar[int] = SPRING

    stiffness: NonNegative
    """N/m, of a torsion spring N m/rad."""
    damping: NonNegative = 0.0
    """N s/m, of a torsion spring N m s/rad."""

    def reference(self) -> float:
        """The measure without force."""
        raise NotImplementedError

    def numbers(self) -> tuple[float, float, float, float]:
        return (self.stiffness, self.damping, self.reference(), 0.0)


class SpringDamper3D(_Spring3D):
    """Spring and damper between the points of markers `a` and `b`, along the line through them.

    Stiffness in N/m, damping in N s/m.
    """

    type: Literal["SpringDamper3D"] = "SpringDamper3D"

    natural_length: NonNegative | Signal
    """m, a number or a time function, an input too. The direction of the force is that of the line: the markers must
    not meet (a Bushing3D's may)."""

    def kind(self) -> int:
        return DISTANCE

    def lengths(self) -> Sequence[float]:
        return (self.reference(),) if self.reference() > 0.0 else ()

    def signals(self) -> Sequence[Signal]:
        return () if isinstance(self.natural_length, int | float) else (self.natural_length,)

    def signal_in(self, numbering: Numbering) -> int:
        return next((numbering.signal(signal) for signal in self.signals()), NO_SIGNAL)

    def reference(self) -> float:
        """The natural length, m; 0 where a time function says it."""
        return float(self.natural_length) if isinstance(self.natural_length, int | float) else 0.0


class AxialSpring3D(_Spring3D):
    """Spring and damper along the z axis of marker `a`, as in a Prismatic3D or a Cylindrical3D with the same markers.

    Stiffness in N/m, damping in N s/m.
    """

    type: Literal["AxialSpring3D"] = "AxialSpring3D"

    natural_position: float = 0.0
    """Place of b along the axis without force, m."""

    def kind(self) -> int:
        return PLACE

    def reference(self) -> float:
        return self.natural_position


class TorsionSpring3D(_Spring3D, CountingForce3D):
    """Spring and damper about the z axis of marker `a`, as in a Revolute3D or a Cylindrical3D with the same markers.

    Stiffness in N m/rad, damping in N m s/rad. The angle is that of b's x axis from a's, turns counted.
    """

    type: Literal["TorsionSpring3D"] = "TorsionSpring3D"

    natural_angle: float = 0.0
    """Angle without torque, rad."""

    def kind(self) -> int:
        return ANGLE

    def reference(self) -> float:
        return self.natural_angle
