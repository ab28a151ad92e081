"""Primitive "distance": two points keep their distance, a massless rod. Phi = (d.d - l(t)^2)/2, d = x_b - x_a."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.frame3d import FRAME, point_of, vector_of
from ..model.markers import Marker3D
from ..model.motion import evaluate_motion
from ..model.rotation3d import add_bend, columns_at, constant, dot, less, onto, plus, three, turns
from ..model.signals import INPUT_SIZE, Signal
from .base import Form, Numbering
from .primitive3d import SIZE, Primitive, account


@internal
def distance3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    par, coord, row = mat(b.par, b.count, 8), imat(b.coord, b.count, 14), imat(b.row, b.count, 1)
    extra = imat(b.extra, b.count, 2)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    for e in range(b.count):
        k = row[e, 0]
        lam = vec(b.lam, b.m_extended)[k]
        u, w = constant(par[e], 2), constant(par[e], 5)
        l, l_rate, l_second = evaluate_motion(pool, inputs, extra[e, 0], t)
        if job == POWER:
            a[extra[e, 1]] -= lam * l * l_rate
        elif job == RESIDUAL:
            of_u, arm_a, arm_a_rate, arm_a_second = turns(b, coord[e], 3, par[e, 0], u)
            of_w, arm_b, arm_b_rate, arm_b_second = turns(b, coord[e], 10, par[e, 1], w)
            d = plus(less(three(q, coord[e], 7), three(q, coord[e], 0)), less(arm_b, arm_a))
            d_rate = plus(less(three(v, coord[e], 7), three(v, coord[e], 0)), less(arm_b_rate, arm_a_rate))
            d_second = plus(less(three(a, coord[e], 7), three(a, coord[e], 0)), less(arm_b_second, arm_a_second))
            vec(b.phi, b.m_extended)[k] = 0.5 * (dot(d, d) - l * l)
            vec(b.phid, b.m_extended)[k] = dot(d, d_rate) - l * l_rate
            vec(b.phidd, b.m_extended)[k] = dot(d_rate, d_rate) + dot(d, d_second) - l * l_second - l_rate * l_rate
            r, by_u, by_w = vec(b.r, b.n_extended), onto(of_u, d), onto(of_w, d)
            for i in range(3):
                r[coord[e, i]] -= lam * d[i]
                r[coord[e, 7 + i]] += lam * d[i]
            for i in range(4):
                r[coord[e, 3 + i]] -= lam * by_u[i]
                r[coord[e, 10 + i]] += lam * by_w[i]
        else:
            values, slot = vec(b.values, b.n_values), imat(b.slot_s + 8 * 196 * e, 14, 14)
            slot_j, slot_jt = imat(b.slot_j, b.count, 14)[e], imat(b.slot_jt, b.count, 14)[e]
            of_u, arm_a = columns_at(b, coord[e], 3, par[e, 0], u)
            of_w, arm_b = columns_at(b, coord[e], 10, par[e, 1], w)
            d = plus(less(three(q, coord[e], 7), three(q, coord[e], 0)), less(arm_b, arm_a))
            factor = vec(b.coef, 2)[0] * lam
            add_bend(values, slot, 3, -factor, d, u)
            add_bend(values, slot, 10, factor, d, w)
            # d = sum of these columns times the coordinates' changes: d_i . d_j is the rest of the Hessian
            x, y, z, zero = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
            columns = (
                less(zero, x), less(zero, y), less(zero, z),
                less(zero, of_u[0]), less(zero, of_u[1]), less(zero, of_u[2]), less(zero, of_u[3]),
                x, y, z, of_w[0], of_w[1], of_w[2], of_w[3],
            )  # fmt: skip
            for i in range(14):
                for j in range(14):
                    values[slot[i, j]] += factor * dot(columns[i], columns[j])
                slope = dot(columns[i], d)
                values[slot_j[i]] += slope
                values[slot_jt[i]] += slope


@internal
def separation_load(row: Any, places: Any, numbers: Any, out: Any) -> None:
    a, b = point_of(row, places, 0, vector_of(numbers, 0)), point_of(row, places, FRAME, vector_of(numbers, 3))
    for k in range(3):
        out[k] -= row[places[2 * FRAME]] * (b[k] - a[k])


@dataclass(frozen=True)
class Separation(Primitive):
    """The points of both markers are `length` apart; 1 row."""

    length: Signal
    load: ClassVar[Any] = separation_load
    form: ClassVar[Form] = Form(
        distance3d_kernel,
        1,
        tuple((i, j) for i in range(SIZE) for j in range(SIZE)),
        tuple((0, j) for j in range(SIZE)),
    )

    def signals(self) -> Sequence[Signal]:
        return (self.length,)

    def parameters(self, a: Marker3D, b: Marker3D) -> Sequence[float]:
        return (*a.point, *b.point)

    def extra(self, numbering: Numbering) -> Sequence[int]:
        return (numbering.motion(self.length), account(numbering, self.length))
