"""Primitive "dot1": two directions keep an angle. Phi = a . b - c, a = A_a u, b = A_b w unit vectors."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.frame3d import FRAME, in_space, vector_of
from ..model.markers import Marker3D
from ..model.rotation3d import add_bend, columns_at, constant, cross, dot, onto, turns
from .base import Form
from .primitive3d import AXIS, PA, PB, RB, SIZE, Axis, Primitive, block


@internal
def add_product_force(b: Any, coord: Any, of_a: Any, of_b: Any, x: Any, y: Any, force: float) -> None:
    """r += force d(x . y)/dq of the directions x = A_a u and y = A_b w with these columns."""
    r, by_a, by_b = vec(b.r, b.n_extended), onto(of_a, y), onto(of_b, x)
    for i in range(4):
        r[coord[3 + i]] += force * by_a[i]
        r[coord[10 + i]] += force * by_b[i]


@internal
def add_product_tangent(b: Any, e: int, rests: Any, u: Any, w: Any, lam: float, g: float) -> None:
    """Tangent of element e, whose row is g (A_a u . A_b w) and more, with the multiplier lam."""
    coord, values, slot = (
        imat(b.coord, b.count, 14)[e], vec(b.values, b.n_values), imat(b.slot_s + 8 * 196 * e, 14, 14)
    )  # fmt: skip
    slot_j, slot_jt = imat(b.slot_j, b.count, 14)[e], imat(b.slot_jt, b.count, 14)[e]
    of_a, x = columns_at(b, coord, 3, rests[0], u)
    of_b, y = columns_at(b, coord, 10, rests[1], w)
    factor = vec(b.coef, 2)[0] * lam * g
    add_bend(values, slot, 3, factor, y, u)
    add_bend(values, slot, 10, factor, x, w)
    by_a, by_b = onto(of_a, y), onto(of_b, x)
    for i in range(4):
        for j in range(4):
            mixed = factor * dot(of_a[i], of_b[j])
            values[slot[3 + i, 10 + j]] += mixed
            values[slot[10 + j, 3 + i]] += mixed
        values[slot_j[3 + i]] += g * by_a[i]
        values[slot_jt[3 + i]] += g * by_a[i]
        values[slot_j[10 + i]] += g * by_b[i]
        values[slot_jt[10 + i]] += g * by_b[i]


@internal
def dot1_3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par, coord, row = mat(b.par, b.count, 9), imat(b.coord, b.count, 14), imat(b.row, b.count, 1)
    for e in range(b.count):
        k = row[e, 0]
        lam = vec(b.lam, b.m_extended)[k]
        u, w = constant(par[e], 2), constant(par[e], 5)
        if job == RESIDUAL:
            of_a, x, x_rate, x_second = turns(b, coord[e], 3, par[e, 0], u)
            of_b, y, y_rate, y_second = turns(b, coord[e], 10, par[e, 1], w)
            vec(b.phi, b.m_extended)[k] = dot(x, y) - par[e, 8]
            vec(b.phid, b.m_extended)[k] = dot(x_rate, y) + dot(x, y_rate)
            vec(b.phidd, b.m_extended)[k] = dot(x_second, y) + 2.0 * dot(x_rate, y_rate) + dot(x, y_second)
            add_product_force(b, coord[e], of_a, of_b, x, y, lam)
        else:
            add_product_tangent(b, e, par[e], u, w, lam, 1.0)


ROTATIONS = (*block(PA, 4, PA, 4), *block(PB, 4, PB, 4), *block(PA, 4, PB, 4))
"""Pairs of Euler parameters."""
BY_ROTATION = tuple((0, j) for j in (*range(PA, RB), *range(PB, SIZE)))


@internal
def dot1_load(row: Any, places: Any, numbers: Any, out: Any) -> None:
    a, b = in_space(row, places, 0, vector_of(numbers, 0)), in_space(row, places, FRAME, vector_of(numbers, 3))
    torque = cross(a, b)
    for k in range(3):
        out[3 + k] += row[places[2 * FRAME]] * torque[k]


@dataclass(frozen=True)
class Dot1(Primitive):
    """An axis of marker a and one of marker b keep the cosine `value`; 1 row."""

    axis_a: Axis
    axis_b: Axis
    value: float = 0.0
    holds_axes: ClassVar[bool] = True
    load: ClassVar[Any] = dot1_load
    form: ClassVar[Form] = Form(dot1_3d_kernel, 1, ROTATIONS, BY_ROTATION)

    def parameters(self, a: Marker3D, b: Marker3D) -> Sequence[float]:
        return (*a.axes()[:, AXIS[self.axis_a]], *b.axes()[:, AXIS[self.axis_b]], self.value)
