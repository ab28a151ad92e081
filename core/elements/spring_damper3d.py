"""Springs and dampers in space along a measure of two markers: F = k (x - x_0) + c x', against the growth of x."""

from typing import ClassVar, Literal

from ..model.base import NonNegative
from ..model.signals import Signal
from .measured_force3d import CountingForce3D, Measure, MeasuredForce3D
from .spring_law import SpringLaw


class _Spring3D(MeasuredForce3D):
    """Base of springs along a measure."""

    stiffness: NonNegative
    """N/m, of a torsion spring N m/rad."""
    damping: NonNegative = 0.0
    """N s/m, of a torsion spring N m s/rad."""


class SpringDamper3D(SpringLaw, _Spring3D):
    """Spring and damper between the points of markers `a` and `b`, along the line through them.

    Stiffness in N/m, damping in N s/m.
    """

    type: Literal["SpringDamper3D"] = "SpringDamper3D"
    symbol: ClassVar[str] = "spring"
    own_measure: ClassVar[Measure | None] = "distance"

    natural_length: NonNegative | Signal
    """m, a number or a time function, an input too. The direction of the force is that of the line: the markers must
    not meet (a Bushing3D's may)."""


class AxialSpring3D(SpringLaw, _Spring3D):
    """Spring and damper along the z axis of marker `a`, as in a Prismatic3D or a Cylindrical3D with the same markers.

    Stiffness in N/m, damping in N s/m.
    """

    type: Literal["AxialSpring3D"] = "AxialSpring3D"
    symbol: ClassVar[str] = "spring"
    own_measure: ClassVar[Measure | None] = "slide"

    natural_position: float = 0.0
    """Place of b along the axis without force, m."""


class TorsionSpring3D(SpringLaw, _Spring3D, CountingForce3D):
    """Spring and damper about the z axis of marker `a`, as in a Revolute3D or a Cylindrical3D with the same markers.

    Stiffness in N m/rad, damping in N m s/rad. The angle is that of b's x axis from a's, turns counted.
    """

    type: Literal["TorsionSpring3D"] = "TorsionSpring3D"
    symbol: ClassVar[str] = "coil"
    own_measure: ClassVar[Measure | None] = "angle"

    natural_angle: float = 0.0
    """Angle without torque, rad."""
