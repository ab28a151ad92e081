"""Planar revolute joint: two markers share a point.

Phi = p_a - p_b, p = (x, y) + R(theta) u.  With rho = R u and J = [[0, -1], [1, 0]]: p' = J rho, p'' = -rho.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.channels import Channel
from .base import JointElement, Numbering, PairElement2D, Row
from .geometry2d import arms


@internal
def hold_points(job: int, b: Any) -> None:
    """The first two rows of each element: points of both bodies, the first four parameters, are one."""
    par, coord, row = mat(b.par, b.count, b.npar), imat(b.coord, b.count, 6), imat(b.row, b.count, b.nrow)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    lam, r, values = vec(b.lam, b.m_extended), vec(b.r, b.n_extended), vec(b.values, b.n_values)
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    c_q, slot_s = vec(b.coef, 2)[0], imat(b.slot_s, b.count, 36)
    slot_j, slot_jt = imat(b.slot_j, b.count, 6 * b.nrow), imat(b.slot_jt, b.count, 6 * b.nrow)
    for e in range(b.count):
        xa, ya, ta, xb, yb, tb = coord[e, 0], coord[e, 1], coord[e, 2], coord[e, 3], coord[e, 4], coord[e, 5]
        k0, k1 = row[e, 0], row[e, 1]
        ax, ay, bx, by = arms(q, coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3])
        lx, ly = lam[k0], lam[k1]
        if job == RESIDUAL:
            wa, wb = v[ta], v[tb]
            phi[k0], phi[k1] = q[xa] + ax - q[xb] - bx, q[ya] + ay - q[yb] - by
            phid[k0] = v[xa] - wa * ay - v[xb] + wb * by
            phid[k1] = v[ya] + wa * ax - v[yb] - wb * bx
            phidd[k0] = a[xa] - a[ta] * ay - wa * wa * ax - a[xb] + a[tb] * by + wb * wb * bx
            phidd[k1] = a[ya] + a[ta] * ax - wa * wa * ay - a[yb] - a[tb] * bx + wb * wb * by
            r[xa] += lx
            r[ya] += ly
            r[ta] += ax * ly - ay * lx
            r[xb] -= lx
            r[yb] -= ly
            r[tb] -= bx * ly - by * lx
        else:
            # (Phi_q^T lam)_q: only the curvature of the two points
            values[slot_s[e, 14]] -= c_q * (ax * lx + ay * ly)
            values[slot_s[e, 35]] += c_q * (bx * lx + by * ly)
            for transposed in range(2):
                slot = slot_jt if transposed else slot_j
                values[slot[e, 0]] += 1.0
                values[slot[e, 2]] -= ay
                values[slot[e, 3]] -= 1.0
                values[slot[e, 5]] += by
                values[slot[e, 7]] += 1.0
                values[slot[e, 8]] += ax
                values[slot[e, 10]] -= 1.0
                values[slot[e, 11]] -= bx


@internal
def hold_angle(job: int, b: Any, local: int, sign: float) -> None:
    """Row `local` of each element: theta_b - theta_a is what its last parameter says. The row is `sign` times that."""
    par, coord, row = mat(b.par, b.count, b.npar), imat(b.coord, b.count, 6), imat(b.row, b.count, b.nrow)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    r, values = vec(b.r, b.n_extended), vec(b.values, b.n_values)
    slot_j, slot_jt = imat(b.slot_j, b.count, 6 * b.nrow), imat(b.slot_jt, b.count, 6 * b.nrow)
    for e in range(b.count):
        ta, tb, k = coord[e, 2], coord[e, 5], row[e, local]
        if job == RESIDUAL:
            vec(b.phi, b.m_extended)[k] = sign * (q[tb] - q[ta] - par[e, b.npar - 1])
            vec(b.phid, b.m_extended)[k] = sign * (v[tb] - v[ta])
            vec(b.phidd, b.m_extended)[k] = sign * (a[tb] - a[ta])
            torque = sign * vec(b.lam, b.m_extended)[k]
            r[tb] += torque
            r[ta] -= torque
        else:
            for transposed in range(2):
                slot = slot_jt if transposed else slot_j
                values[slot[e, 6 * local + 2]] -= sign
                values[slot[e, 6 * local + 5]] += sign


@internal
def revolute2d_kernel(job: int, t: float, b: Any) -> None:
    if job == RESIDUAL or job == TANGENT:
        hold_points(job, b)


class Revolute2D(PairElement2D, JointElement):
    """Markers `a` and `b` share a point. Its force channels are the force on body b, N."""

    type: Literal["Revolute2D"] = "Revolute2D"
    symbol: ClassVar[str] = "hinge"
    arrow: ClassVar[str] = "components"
    kernel: ClassVar[Any] = revolute2d_kernel
    constraint_rows: ClassVar[int] = 2
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ((2, 2), (5, 5))
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = (
        (0, 0), (0, 2), (0, 3), (0, 5), (1, 1), (1, 2), (1, 4), (1, 5),
    )  # fmt: skip

    def force_rows(self) -> Sequence[int]:
        return (0, 1)

    def row(self, numbering: Numbering) -> Row:
        return Row((*self.a.point, *self.b.point), self.coordinates(numbering))

    def multiplier_channels(self) -> Sequence[Channel]:
        return (
            Channel(f"{self.name}.force_x", "N", "force of the joint on its body b, x"),
            Channel(f"{self.name}.force_y", "N", "force of the joint on its body b, y"),
        )


class AngleHeld2D(PairElement2D, JointElement):
    """Base of planar joints that keep the relative angle of the bodies."""

    if TYPE_CHECKING:
        relative_angle: float | None

    def held_angle(self, numbering: Numbering) -> float:
        """theta_b - theta_a, rad: as it says, or as in the start configuration."""
        if self.relative_angle is not None:
            return self.relative_angle
        return numbering.initial(self.b.body)[2] - numbering.initial(self.a.body)[2]
