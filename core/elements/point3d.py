"""Primitive "point": two points in space are one. Phi = x_a - x_b, x = R + A u."""

from collections.abc import Sequence
from typing import Any, ClassVar

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.frame3d import FRAME
from ..model.markers import Marker3D
from ..model.rotation3d import add_bend, columns_at, constant, onto, turns
from .base import Form
from .primitive3d import PA, PB, RA, RB, SIZE, Primitive, block


@internal
def point3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par, coord, row = mat(b.par, b.count, 8), imat(b.coord, b.count, 14), imat(b.row, b.count, 3)
    lam = vec(b.lam, b.m_extended)
    for e in range(b.count):
        k = row[e, 0]
        force = (lam[k], lam[k + 1], lam[k + 2])
        for side in range(2):
            sign = 1.0 - 2.0 * side
            first, rest, u = 7 * side, par[e, side], constant(par[e], 2 + 3 * side)
            if job == RESIDUAL:
                q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
                phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
                columns, arm, arm_rate, arm_second = turns(b, coord[e], first + 3, rest, u)
                r, moment = vec(b.r, b.n_extended), onto(columns, force)
                for i in range(3):
                    c = coord[e, first + i]
                    phi[k + i] = q[c] + arm[i] if side == 0 else phi[k + i] - q[c] - arm[i]
                    phid[k + i] = v[c] + arm_rate[i] if side == 0 else phid[k + i] - v[c] - arm_rate[i]
                    phidd[k + i] = a[c] + arm_second[i] if side == 0 else phidd[k + i] - a[c] - arm_second[i]
                    r[c] += sign * force[i]
                for i in range(4):
                    r[coord[e, first + 3 + i]] += sign * moment[i]
            else:
                values, slot = vec(b.values, b.n_values), imat(b.slot_s + 8 * 196 * e, 14, 14)
                columns, _ = columns_at(b, coord[e], first + 3, rest, u)
                slot_j, slot_jt = imat(b.slot_j, b.count, 42)[e], imat(b.slot_jt, b.count, 42)[e]
                add_bend(values, slot, first + 3, sign * vec(b.coef, 2)[0], force, u)
                for i in range(3):
                    at = 14 * i + first
                    values[slot_j[at + i]] += sign
                    values[slot_jt[at + i]] += sign
                    for j in range(4):
                        values[slot_j[at + 3 + j]] += sign * columns[j][i]
                        values[slot_jt[at + 3 + j]] += sign * columns[j][i]


@internal
def point_load(row: Any, places: Any, numbers: Any, out: Any) -> None:
    for k in range(3):
        out[k] += row[places[2 * FRAME + k]]


class Point(Primitive):
    """The points of both markers are one; 3 rows."""

    carries_force: ClassVar[bool] = True
    load: ClassVar[Any] = point_load
    form: ClassVar[Form] = Form(
        point3d_kernel,
        3,
        (*block(PA, 4, PA, 4), *block(PB, 4, PB, 4)),
        tuple((i, j) for i in range(3) for j in (RA + i, *range(PA, RB), RB + i, *range(PB, SIZE))),
    )

    def parameters(self, a: Marker3D, b: Marker3D) -> Sequence[float]:
        return (*a.point, *b.point)
