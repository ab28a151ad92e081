"""Planar revolute joint: two markers share a point.

Phi = p_a - p_b, p = (x, y) + R(theta) u.  With rho = R u and J = [[0, -1], [1, 0]]: p' = J rho, p'' = -rho.
"""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.channels import Channel
from .base import JointElement, Numbering, PairElement2D, Row


@internal
def revolute2d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par = mat(b.par, b.count, 4)
    coord = imat(b.coord, b.count, 6)
    row = imat(b.row, b.count, 2)
    q = vec(b.q, b.n_extended)
    v = vec(b.v, b.n_extended)
    a = vec(b.a, b.n_extended)
    lam = vec(b.lam, b.m_extended)
    r = vec(b.r, b.n_extended)
    phi = vec(b.phi, b.m_extended)
    phid = vec(b.phid, b.m_extended)
    phidd = vec(b.phidd, b.m_extended)
    values = vec(b.values, b.n_values)
    coef = vec(b.coef, 2)
    slot_s = imat(b.slot_s, b.count, 36)
    slot_j = imat(b.slot_j, b.count, 12)
    slot_jt = imat(b.slot_jt, b.count, 12)
    for e in range(b.count):
        ta, tb = coord[e, 2], coord[e, 5]
        c, s = math.cos(q[ta]), math.sin(q[ta])
        ax, ay = c * par[e, 0] - s * par[e, 1], s * par[e, 0] + c * par[e, 1]
        c, s = math.cos(q[tb]), math.sin(q[tb])
        bx, by = c * par[e, 2] - s * par[e, 3], s * par[e, 2] + c * par[e, 3]
        k0, k1 = row[e, 0], row[e, 1]
        if job == RESIDUAL:
            xa, ya, xb, yb = coord[e, 0], coord[e, 1], coord[e, 3], coord[e, 4]
            wa, wb = v[ta], v[tb]
            phi[k0] = q[xa] + ax - q[xb] - bx
            phi[k1] = q[ya] + ay - q[yb] - by
            phid[k0] = v[xa] - wa * ay - v[xb] + wb * by
            phid[k1] = v[ya] + wa * ax - v[yb] - wb * bx
            phidd[k0] = a[xa] - a[ta] * ay - wa * wa * ax - a[xb] + a[tb] * by + wb * wb * bx
            phidd[k1] = a[ya] + a[ta] * ax - wa * wa * ay - a[yb] - a[tb] * bx + wb * wb * by
            lx, ly = lam[k0], lam[k1]
            r[xa] += lx
            r[ya] += ly
            r[ta] += ax * ly - ay * lx
            r[xb] -= lx
            r[yb] -= ly
            r[tb] -= bx * ly - by * lx
        else:
            # (Phi_q^T lam)_q: only the curvature of the two points
            values[slot_s[e, 14]] -= coef[0] * (ax * lam[k0] + ay * lam[k1])
            values[slot_s[e, 35]] += coef[0] * (bx * lam[k0] + by * lam[k1])
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


class Revolute2D(PairElement2D, JointElement):
    """Markers `a` and `b` share a point. Its force channels are the force on body b, N."""

    type: Literal["Revolute2D"] = "Revolute2D"
    kernel: ClassVar[Any] = revolute2d_kernel
    constraint_rows: ClassVar[int] = 2
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ((2, 2), (5, 5))
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = (
        (0, 0), (0, 2), (0, 3), (0, 5), (1, 1), (1, 2), (1, 4), (1, 5),
    )  # fmt: skip

    def force_rows(self) -> Sequence[int]:
        return (0, 1)

    def row(self, numbering: Numbering) -> Row:
        return Row(
            (*self.a.point, *self.b.point),
            self.coordinates(numbering),
        )

    def multiplier_channels(self) -> Sequence[Channel]:
        return (
            Channel(f"{self.name}.force_x", "N", "force of the joint on its body b, x"),
            Channel(f"{self.name}.force_y", "N", "force of the joint on its body b, y"),
        )
