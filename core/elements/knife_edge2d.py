"""Knife edge in the plane: a point moves only along a direction of its body. A velocity-level row, without positions.

With tau = (cos phi, sin phi), phi = theta + angle, n = J tau and the point x = R + A u:
  n . x' = n . R' + c theta' = 0,   c = tau . (A u), constant;   its rate: n . R'' + c theta'' - theta' tau . R'.
(Neimark and Fufaev 1972, Dynamics of Nonholonomic Systems.) The row is minus that, so that its multiplier is the force
on the body along n.
"""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.channels import Channel
from ..model.markers import Marker2D
from .base import JointElement, Numbering, Row


@internal
def knife_edge2d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par, coord, row = mat(b.par, b.count, 2), imat(b.coord, b.count, 3), imat(b.row, b.count, 1)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    for e in range(b.count):
        x, y, turn, k = coord[e, 0], coord[e, 1], coord[e, 2], row[e, 0]
        lam = vec(b.lam, b.m_extended)[k]
        c, s, lever = math.cos(q[turn] + par[e, 0]), math.sin(q[turn] + par[e, 0]), par[e, 1]
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            vec(b.phi, b.m_extended)[k] = 0.0
            vec(b.phid, b.m_extended)[k] = s * v[x] - c * v[y] - lever * v[turn]
            bend = v[turn] * (c * v[x] + s * v[y])
            vec(b.phidd, b.m_extended)[k] = s * a[x] - c * a[y] - lever * a[turn] + bend
            r[x] += lam * s
            r[y] -= lam * c
            r[turn] -= lam * lever
        else:
            values, slot = vec(b.values, b.n_values), imat(b.slot_s, b.count, 9)[e]
            factor = vec(b.coef, 2)[0] * lam
            values[slot[2]] += factor * c
            values[slot[5]] += factor * s
            for slots in (imat(b.slot_j, b.count, 3)[e], imat(b.slot_jt, b.count, 3)[e]):
                values[slots[0]] += s
                values[slots[1]] -= c
                values[slots[2]] -= lever


class KnifeEdge2D(JointElement):
    """A skate, a blade or the axle of a small wheel: the point of `marker` moves along the marker's direction only.

    It is held at velocity level alone: the body can get anywhere, but not by every way.
    """

    type: Literal["KnifeEdge2D"] = "KnifeEdge2D"
    kernel: ClassVar[Any] = knife_edge2d_kernel
    constraint_rows: ClassVar[int] = 1
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ((0, 2), (1, 2))
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = ((0, 0), (0, 1), (0, 2))
    rate_rows: ClassVar[Sequence[int]] = (0,)

    marker: Marker2D
    """Where the edge touches; its first axis is along the edge."""

    def markers(self) -> Sequence[Marker2D]:
        return (self.marker,)

    def row(self, numbering: Numbering) -> Row:
        (x, y), angle = self.marker.point, self.marker.angle
        return Row((angle, math.cos(angle) * x + math.sin(angle) * y), numbering.frame(self.marker))

    def multiplier_channels(self) -> Sequence[Channel]:
        text = "force of the edge on its body, to the left of the marker's direction"
        return (Channel(f"{self.name}.force", "N", text),)
