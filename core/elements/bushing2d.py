"""Linear bushing between two markers: force on their relative position, torque on their relative angle.

With d = r_b - r_a (points of the markers) and phi = theta_b + angle_b - theta_a - angle_a, on b:
F = -k d - c d', T = -k_r phi - c_r phi'. Generalised forces are -(d d/d q)^T F, with d d/d q = J,
J_theta_a = -J rho_a, J_theta_b = J rho_b (rho the offsets R u), whose derivatives are rho_a and -rho_b.
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import NonNegative
from .base import ForceElement, Numbering, PairElement2D, Row
from .geometry2d import FULL_PATTERN, add_hessian, along, arms, half_square_distance


@internal
def bushing2d_kernel(job: int, t: float, b: Any) -> None:
    par = mat(b.par, b.count, 9)
    coord = imat(b.coord, b.count, 6)
    extra = imat(b.extra, b.count, 1)
    q = vec(b.q, b.n_extended)
    v = vec(b.v, b.n_extended)
    for e in range(b.count):
        k, c, k_turn, c_turn = par[e, 4], par[e, 5], par[e, 6], par[e, 7]
        half, gradient, hessian = half_square_distance(q, coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3])
        ta, tb = coord[e, 2], coord[e, 5]
        ax, ay, bx, by = arms(q, coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3])
        along_x = (-1.0, 0.0, ay, 1.0, 0.0, -by)
        along_y = (0.0, -1.0, -ax, 0.0, 1.0, bx)
        rate_x, rate_y = along(along_x, v, coord[e]), along(along_y, v, coord[e])
        turn, turn_rate = q[tb] - q[ta] + par[e, 8], v[tb] - v[ta]
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for i in range(6):
                r[coord[e, i]] += k * gradient[i] + c * (along_x[i] * rate_x + along_y[i] * rate_y)
            torque = k_turn * turn + c_turn * turn_rate
            r[ta] -= torque
            r[tb] += torque
        elif job == TANGENT:
            values = vec(b.values, b.n_values)
            coef = vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * 36 * e, 6, 6)
            add_hessian(values, slot, gradient, hessian, coef[0] * k)
            for i in range(6):
                for j in range(6):
                    values[slot[i, j]] += coef[1] * c * (along_x[i] * along_x[j] + along_y[i] * along_y[j])
                # d' depends on the angles through the offsets
                values[slot[i, 2]] += coef[0] * c * v[ta] * (along_x[i] * ax + along_y[i] * ay)
                values[slot[i, 5]] -= coef[0] * c * v[tb] * (along_x[i] * bx + along_y[i] * by)
            values[slot[2, 2]] += coef[0] * c * (ax * rate_x + ay * rate_y)
            values[slot[5, 5]] -= coef[0] * c * (bx * rate_x + by * rate_y)
            stiff = coef[0] * k_turn + coef[1] * c_turn
            values[slot[2, 2]] += stiff
            values[slot[2, 5]] -= stiff
            values[slot[5, 2]] -= stiff
            values[slot[5, 5]] += stiff
        elif job == ENERGY:
            vec(b.energy, 3)[2] += k * half + 0.5 * k_turn * turn * turn
        elif job == POWER:
            lost = c * (rate_x * rate_x + rate_y * rate_y) + c_turn * turn_rate * turn_rate
            vec(b.a, b.n_extended)[extra[e, 0]] += lost


class Bushing2D(PairElement2D, ForceElement):
    """Elastic bushing: pulls the points of markers `a` and `b` together, equally in all directions.

    The markers may coincide: that is where the force is zero. The equal and opposite forces act at the two points;
    their difference leaves a moment of the damping force (none of the elastic one), small with the deflection.
    The rotational part acts on the angle between the markers' first axes, counted on beyond a turn; a point mass
    has none, its marker's axis does not turn.
    """

    type: Literal["Bushing2D"] = "Bushing2D"
    symbol: ClassVar[str] = "bushing"
    kernel: ClassVar[Any] = bushing2d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL_PATTERN

    stiffness: NonNegative
    """N/m, in every direction."""
    damping: NonNegative = 0.0
    """N s/m, in every direction."""
    rotational_stiffness: NonNegative = 0.0
    """N m/rad."""
    rotational_damping: NonNegative = 0.0
    """N m s/rad."""

    def row(self, numbering: Numbering) -> Row:
        return Row(
            (
                *self.a.point, *self.b.point, self.stiffness, self.damping, self.rotational_stiffness,
                self.rotational_damping, self.b.angle - self.a.angle,
            ),
            self.coordinates(numbering),
            (numbering.work("dampers"),),
        )  # fmt: skip
