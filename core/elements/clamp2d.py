"""Planar clamp: two markers share a point and a direction.

Phi = (p_a - p_b, theta_b - theta_a - relative_angle): a revolute joint and a third row that is linear.
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.channels import Channel
from .base import JointElement, Numbering, PairElement2D, Row
from .geometry2d import arms


@internal
def clamp2d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par, coord, row = mat(b.par, b.count, 5), imat(b.coord, b.count, 6), imat(b.row, b.count, 3)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    lam, r, values = vec(b.lam, b.m_extended), vec(b.r, b.n_extended), vec(b.values, b.n_values)
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    c_q = vec(b.coef, 2)[0]
    slot_s = imat(b.slot_s, b.count, 36)
    slot_j, slot_jt = imat(b.slot_j, b.count, 18), imat(b.slot_jt, b.count, 18)
    for e in range(b.count):
        xa, ya, ta, xb, yb, tb = coord[e, 0], coord[e, 1], coord[e, 2], coord[e, 3], coord[e, 4], coord[e, 5]
        k0, k1, k2 = row[e, 0], row[e, 1], row[e, 2]
        ax, ay, bx, by = arms(q, coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3])
        lx, ly = lam[k0], lam[k1]
        if job == RESIDUAL:
            wa, wb = v[ta], v[tb]
            phi[k0], phi[k1] = q[xa] + ax - q[xb] - bx, q[ya] + ay - q[yb] - by
            phi[k2] = q[ta] - q[tb] + par[e, 4]
            phid[k0] = v[xa] - wa * ay - v[xb] + wb * by
            phid[k1] = v[ya] + wa * ax - v[yb] - wb * bx
            phid[k2] = wa - wb
            phidd[k0] = a[xa] - a[ta] * ay - wa * wa * ax - a[xb] + a[tb] * by + wb * wb * bx
            phidd[k1] = a[ya] + a[ta] * ax - wa * wa * ay - a[yb] - a[tb] * bx + wb * wb * by
            phidd[k2] = a[ta] - a[tb]
            r[xa] += lx
            r[ya] += ly
            r[ta] += ax * ly - ay * lx + lam[k2]
            r[xb] -= lx
            r[yb] -= ly
            r[tb] -= bx * ly - by * lx + lam[k2]
        else:
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
                values[slot[e, 14]] += 1.0
                values[slot[e, 17]] -= 1.0


class Clamp2D(PairElement2D, JointElement):
    """Markers `a` and `b` are one: same point, and no turning against each other (a weld).

    Its force and torque channels are those on body b, N and N m about the common point.
    """

    type: Literal["Clamp2D"] = "Clamp2D"
    kernel: ClassVar[Any] = clamp2d_kernel
    constraint_rows: ClassVar[int] = 3
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ((2, 2), (5, 5))
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = (
        (0, 0), (0, 2), (0, 3), (0, 5), (1, 1), (1, 2), (1, 4), (1, 5), (2, 2), (2, 5),
    )  # fmt: skip

    relative_angle: float | None = None
    """theta_b - theta_a of the bodies, rad; left out: as in the start configuration."""

    def row(self, numbering: Numbering) -> Row:
        relative = self.relative_angle
        if relative is None:
            relative = numbering.initial(self.b.body)[2] - numbering.initial(self.a.body)[2]
        return Row((*self.a.point, *self.b.point, relative), self.coordinates(numbering))

    def multiplier_channels(self) -> Sequence[Channel]:
        return (
            Channel(f"{self.name}.force_x", "N", "force of the clamp on its body b, x"),
            Channel(f"{self.name}.force_y", "N", "force of the clamp on its body b, y"),
            Channel(f"{self.name}.torque", "N.m", "torque of the clamp on its body b"),
        )
