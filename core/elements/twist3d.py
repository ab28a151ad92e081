"""Primitive "twist": Phi = s (a_1 . b_1) - c (a_2 . b_2), directions of both bodies, s = sin f(t), c = cos f(t), or 1.

Without f it says that a joint does not twist (constant velocity: a_x . b_y = a_y . b_x). With f, b_1 = b_2 it holds the
angle of that direction in the plane of a_1 and a_2 at f: Phi = sin(f - angle), whole turns and all.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.frame3d import FRAME, in_space, vector_of
from ..model.markers import Marker3D
from ..model.motion import evaluate_motion
from ..model.rotation3d import constant, cross, dot, turns
from ..model.signals import INPUT_SIZE, Constant, Signal
from .base import Form, Numbering
from .dot1_3d import BY_ROTATION, ROTATIONS, add_product_force, add_product_tangent
from .primitive3d import AXIS, Axis, Primitive, account


@internal
def twist3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    par, coord, row = mat(b.par, b.count, 15), imat(b.coord, b.count, 14), imat(b.row, b.count, 1)
    extra = imat(b.extra, b.count, 2)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    for e in range(b.count):
        k = row[e, 0]
        lam = vec(b.lam, b.m_extended)[k]
        s, s_rate, s_second = 1.0, 0.0, 0.0
        c, c_rate, c_second = 1.0, 0.0, 0.0
        f_rate = 0.0
        if par[e, 14] != 0.0:
            f, f_rate, f_second = evaluate_motion(pool, inputs, extra[e, 0], t)
            s, c = np.sin(f), np.cos(f)
            s_rate, c_rate = c * f_rate, -s * f_rate
            s_second, c_second = c * f_second - s * f_rate * f_rate, -s * f_second - c * f_rate * f_rate
        phi, phid, phidd, power = 0.0, 0.0, 0.0, 0.0
        for term in range(2):
            u, w = constant(par[e], 2 + 3 * term), constant(par[e], 8 + 3 * term)
            g, g_rate, g_second = (s, s_rate, s_second) if term == 0 else (-c, -c_rate, -c_second)
            if job != TANGENT:
                of_a, x, x_rate, x_second = turns(b, coord[e], 3, par[e, 0], u)
                of_b, y, y_rate, y_second = turns(b, coord[e], 10, par[e, 1], w)
                z, z_rate = dot(x, y), dot(x_rate, y) + dot(x, y_rate)
                z_second = dot(x_second, y) + 2.0 * dot(x_rate, y_rate) + dot(x, y_second)
                phi += g * z
                phid += g * z_rate + g_rate * z
                phidd += g * z_second + 2.0 * g_rate * z_rate + g_second * z
                power += lam * g_rate * z
                if job == RESIDUAL:
                    add_product_force(b, coord[e], of_a, of_b, x, y, lam * g)
            else:
                add_product_tangent(b, e, par[e], u, w, lam, g)
        if job == RESIDUAL:
            vec(b.phi, b.m_extended)[k] = phi
            vec(b.phid, b.m_extended)[k] = phid
            vec(b.phidd, b.m_extended)[k] = phidd
        elif job == POWER:
            vec(b.a, b.n_extended)[extra[e, 1]] += power


@internal
def twist_load(row: Any, places: Any, numbers: Any, out: Any) -> None:
    a1, a2 = in_space(row, places, 0, vector_of(numbers, 0)), in_space(row, places, 0, vector_of(numbers, 3))
    b1, b2 = in_space(row, places, FRAME, vector_of(numbers, 6)), in_space(row, places, FRAME, vector_of(numbers, 9))
    s = c = 1.0
    if numbers[12] != 0.0:
        # where the angle is f, the axes themselves say its sine and cosine
        s, c = dot(a2, b2), dot(a1, b1)
    first, second = cross(a1, b1), cross(a2, b2)
    for k in range(3):
        out[3 + k] += row[places[2 * FRAME]] * (s * first[k] - c * second[k])


@dataclass(frozen=True)
class Twist(Primitive):
    """sin f (a_1 . b_1) = cos f (a_2 . b_2) of axes of markers a and b; without f, a_1 . b_1 = a_2 . b_2; 1 row."""

    first: tuple[Axis, Axis]
    """Axes a_1, b_1."""
    second: tuple[Axis, Axis]
    angle: Signal | None = None
    """f, rad."""
    holds_axes: ClassVar[bool] = True
    load: ClassVar[Any] = twist_load
    form: ClassVar[Form] = Form(twist3d_kernel, 1, ROTATIONS, BY_ROTATION)

    def signals(self) -> Sequence[Signal]:
        return () if self.angle is None else (self.angle,)

    def parameters(self, a: Marker3D, b: Marker3D) -> Sequence[float]:
        of_a, of_b = a.axes(), b.axes()
        a1, a2 = (of_a[:, AXIS[axes[0]]] for axes in (self.first, self.second))
        b1, b2 = (of_b[:, AXIS[axes[1]]] for axes in (self.first, self.second))
        return (*a1, *a2, *b1, *b2, float(self.angle is not None))

    def extra(self, numbering: Numbering) -> Sequence[int]:
        angle = self.angle or Constant(value=0.0)
        return (numbering.motion(angle), account(numbering, angle))
