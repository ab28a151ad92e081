"""Springs and dampers in space along a measure of two markers: F = k (x - x_0) + c x', against the growth of x."""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..errors import ConsistencyError
from ..model.base import NonNegative, Positive
from ..model.markers import Marker3D
from ..rounding import MEETING
from .base import ForceElement, Numbering, Part, Row
from .measure3d import ANGLE, DISTANCE, PLACE, add_force_tangent, columns_of, coordinates_of, measure, product
from .spatial_body import angle_between, start_of_marker
from .turn3d import LOOSE, account_of, turn_part

FULL = tuple((i, j) for i in range(14) for j in range(14))


@internal
def spring_damper3d_kernel(job: int, t: float, b: Any) -> None:
    par, coord, extra = mat(b.par, b.count, 31), imat(b.coord, b.count, 14), imat(b.extra, b.count, 2)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    gradient, hessian = np.empty(14), np.empty((14, 14))
    for e in range(b.count):
        k, c = par[e, 26], par[e, 27]
        about = par[e, 29] + v[extra[e, 1]]
        x = measure(int(par[e, 30]), q, coord[e], par[e], about, gradient, hessian) - par[e, 28]
        rate = product(gradient, v, coord[e])
        force = k * x + c * rate
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for i in range(14):
                r[coord[e, i]] += force * gradient[i]
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * 196 * e, 14, 14)
            by_value, by_rate = coef[0] * k + coef[1] * c, coef[0] * c
            add_force_tangent(values, slot, gradient, hessian, v, coord[e], coef[0] * force, by_value, by_rate)
        elif job == ENERGY:
            vec(b.energy, 3)[2] += 0.5 * k * x * x
        elif job == POWER:
            vec(b.a, b.n_extended)[extra[e, 0]] += c * rate * rate


class Pair3D(ForceElement):
    """Base of what acts between two markers in space."""

    a: Marker3D
    b: Marker3D

    def markers(self) -> Sequence[Marker3D]:
        return (self.a, self.b)


class _Spring3D(Pair3D):
    """Base of springs along a measure."""

    kernel: ClassVar[Any] = spring_damper3d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL
    kind: ClassVar[int]

    stiffness: NonNegative
    damping: NonNegative = 0.0

    def reference(self) -> float:
        """The measure without force."""
        raise NotImplementedError

    def row(self, numbering: Numbering) -> Row:
        turns = self.kind == ANGLE
        start = angle_between(self.a, self.b, numbering.bodies) if turns else 0.0
        account = numbering.work(account_of(self.name), LOOSE) if turns else numbering.frame(Marker3D())[0]
        law = (self.stiffness, self.damping, self.reference(), start, float(self.kind))
        extra = (numbering.work("dampers"), account)
        return Row((*columns_of(self.a, self.b, numbering), *law), coordinates_of(self.a, self.b, numbering), extra)


class SpringDamper3D(_Spring3D):
    """Spring and damper between the points of markers `a` and `b`, along the line through them.

    Stiffness in N/m, damping in N s/m.
    """

    type: Literal["SpringDamper3D"] = "SpringDamper3D"
    kind: ClassVar[int] = DISTANCE

    natural_length: Positive
    """m. The direction of the force is that of the line: the markers must not meet."""

    def lengths(self) -> Sequence[float]:
        return (self.natural_length,)

    def reference(self) -> float:
        return self.natural_length

    def row(self, numbering: Numbering) -> Row:
        """Raises ConsistencyError if the markers meet at the start: the force would have no direction."""
        a, b = (start_of_marker(marker, numbering.bodies)[0] for marker in (self.a, self.b))
        found = math.dist(a, b)
        if found <= MEETING * max(self.natural_length, float(np.max(np.abs([a, b])))):
            raise ConsistencyError(
                f"spring '{self.name}' starts with length {found:.3g} m: its markers on '{self.a.body}' and "
                f"'{self.b.body}' are both at ({a[0]:g}, {a[1]:g}, {a[2]:g}), so its force has no direction; start "
                "with the markers apart, or use a Bushing3D"
            )
        return super().row(numbering)


class AxialSpring3D(_Spring3D):
    """Spring and damper along the z axis of marker `a`, as in a Prismatic3D or a Cylindrical3D with the same markers.

    Stiffness in N/m, damping in N s/m.
    """

    type: Literal["AxialSpring3D"] = "AxialSpring3D"
    kind: ClassVar[int] = PLACE

    natural_position: float = 0.0
    """Place of b along the axis without force, m."""

    def reference(self) -> float:
        return self.natural_position


class TorsionSpring3D(_Spring3D):
    """Spring and damper about the z axis of marker `a`, as in a Revolute3D or a Cylindrical3D with the same markers.

    Stiffness in N m/rad, damping in N m s/rad. The angle is that of b's x axis from a's, turns counted.
    """

    type: Literal["TorsionSpring3D"] = "TorsionSpring3D"
    kind: ClassVar[int] = ANGLE

    natural_angle: float = 0.0
    """Angle without torque, rad."""

    def reference(self) -> float:
        return self.natural_angle

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        return [*super().parts(numbering), turn_part(self.name, self.a, self.b, numbering)]
