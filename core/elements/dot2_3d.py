"""Primitive "dot2": a point keeps its place along a direction of the other body. Phi = a . (x_b - x_a) - f(t).

a = A_a n, x = R + A u. Second derivatives by the product rule; a . x_a depends on p_a alone, by its norm.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.frame3d import FRAME, in_space, vector_of
from ..model.markers import Marker3D
from ..model.motion import evaluate_motion
from ..model.rotation3d import add_bend, columns_at, constant, dot, less, onto, plus, three, turns
from ..model.signals import INPUT_SIZE, Constant, Signal
from .base import Form, Numbering
from .primitive3d import AXIS, PA, PB, RA, RB, SIZE, Axis, Primitive, account, block


@internal
def dot2_3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    par, coord, row = mat(b.par, b.count, 11), imat(b.coord, b.count, 14), imat(b.row, b.count, 1)
    extra = imat(b.extra, b.count, 2)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    for e in range(b.count):
        k = row[e, 0]
        lam = vec(b.lam, b.m_extended)[k]
        n, u, w = constant(par[e], 2), constant(par[e], 5), constant(par[e], 8)
        f, f_rate, f_second = evaluate_motion(pool, inputs, extra[e, 0], t)
        if job == POWER:
            a[extra[e, 1]] -= lam * f_rate
        elif job == RESIDUAL:
            of_n, x, x_rate, x_second = turns(b, coord[e], 3, par[e, 0], n)
            of_u, arm_a, arm_a_rate, arm_a_second = turns(b, coord[e], 3, par[e, 0], u)
            of_w, arm_b, arm_b_rate, arm_b_second = turns(b, coord[e], 10, par[e, 1], w)
            d = plus(less(three(q, coord[e], 7), three(q, coord[e], 0)), less(arm_b, arm_a))
            d_rate = plus(less(three(v, coord[e], 7), three(v, coord[e], 0)), less(arm_b_rate, arm_a_rate))
            d_second = plus(less(three(a, coord[e], 7), three(a, coord[e], 0)), less(arm_b_second, arm_a_second))
            vec(b.phi, b.m_extended)[k] = dot(x, d) - f
            vec(b.phid, b.m_extended)[k] = dot(x_rate, d) + dot(x, d_rate) - f_rate
            vec(b.phidd, b.m_extended)[k] = dot(x_second, d) + 2.0 * dot(x_rate, d_rate) + dot(x, d_second) - f_second
            r, by_n, by_u, by_w = vec(b.r, b.n_extended), onto(of_n, d), onto(of_u, x), onto(of_w, x)
            for i in range(3):
                r[coord[e, i]] -= lam * x[i]
                r[coord[e, 7 + i]] += lam * x[i]
            for i in range(4):
                r[coord[e, 3 + i]] += lam * (by_n[i] - by_u[i])
                r[coord[e, 10 + i]] += lam * by_w[i]
        else:
            values, slot = vec(b.values, b.n_values), imat(b.slot_s + 8 * 196 * e, 14, 14)
            slot_j, slot_jt = imat(b.slot_j, b.count, 14)[e], imat(b.slot_jt, b.count, 14)[e]
            of_n, x = columns_at(b, coord[e], 3, par[e, 0], n)
            of_u, arm_a = columns_at(b, coord[e], 3, par[e, 0], u)
            of_w, arm_b = columns_at(b, coord[e], 10, par[e, 1], w)
            d = plus(less(three(q, coord[e], 7), three(q, coord[e], 0)), less(arm_b, arm_a))
            factor = vec(b.coef, 2)[0] * lam
            add_bend(values, slot, 3, factor, d, n)
            add_bend(values, slot, 3, -factor, x, u)
            add_bend(values, slot, 10, factor, x, w)
            by_n, by_u, by_w = onto(of_n, d), onto(of_u, x), onto(of_w, x)
            for j in range(4):
                for i in range(3):
                    bent = factor * of_n[j][i]
                    values[slot[i, 3 + j]] -= bent
                    values[slot[3 + j, i]] -= bent
                    values[slot[7 + i, 3 + j]] += bent
                    values[slot[3 + j, 7 + i]] += bent
                for i in range(4):
                    own = factor * dot(of_n[i], of_u[j])
                    values[slot[3 + i, 3 + j]] -= own
                    values[slot[3 + j, 3 + i]] -= own
                    mixed = factor * dot(of_n[i], of_w[j])
                    values[slot[3 + i, 10 + j]] += mixed
                    values[slot[10 + j, 3 + i]] += mixed
                values[slot_j[3 + j]] += by_n[j] - by_u[j]
                values[slot_jt[3 + j]] += by_n[j] - by_u[j]
                values[slot_j[10 + j]] += by_w[j]
                values[slot_jt[10 + j]] += by_w[j]
            for i in range(3):
                values[slot_j[i]] -= x[i]
                values[slot_jt[i]] -= x[i]
                values[slot_j[7 + i]] += x[i]
                values[slot_jt[7 + i]] += x[i]


AT_POINT = Constant(value=0.0)


@internal
def dot2_load(row: Any, places: Any, numbers: Any, out: Any) -> None:
    axis = in_space(row, places, 0, vector_of(numbers, 0))
    for k in range(3):
        out[k] -= row[places[2 * FRAME]] * axis[k]


@dataclass(frozen=True)
class Dot2(Primitive):
    """The point of marker b is `distance` along an axis of marker a from its point; 1 row."""

    axis: Axis
    distance: Signal = AT_POINT
    carries_force: ClassVar[bool] = True
    load: ClassVar[Any] = dot2_load
    form: ClassVar[Form] = Form(
        dot2_3d_kernel,
        1,
        (
            *block(RA, 3, PA, 4), *block(RB, 3, PA, 4), *block(PA, 4, PA, 4), *block(PA, 4, PB, 4),
            *block(PB, 4, PB, 4),
        ),
        tuple((0, j) for j in range(SIZE)),
    )  # fmt: skip

    def signals(self) -> Sequence[Signal]:
        return (self.distance,)

    def parameters(self, a: Marker3D, b: Marker3D) -> Sequence[float]:
        return (*a.axes()[:, AXIS[self.axis]], *a.point, *b.point)

    def extra(self, numbering: Numbering) -> Sequence[int]:
        return (numbering.motion(self.distance), account(numbering, self.distance))
