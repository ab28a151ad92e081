"""Linear bushing in space between two markers: six forces from six deflections, along the axes of marker a.

z = (s, f): s_k = a_k . (x_b - x_a), and f = 2 e with (e0, e) the Euler parameters of marker b seen from marker a, of
both signs that with e0 > 0 at the start. f is the rotation vector while it is small; about one axis it is
2 sin(angle/2). Forces are -(dz/dq)^T (K z + C z'): those of an energy z.K z/2 and of damping that never feeds energy,
for deflections of any size and any number of turns, since e goes on smoothly through half a turn. f is bilinear in both
bodies' Euler parameters.
"""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.attitude import Vector4
from ..model.attitude import product as seen
from ..model.rotation3d import body_axes, four
from ..rounding import SYMMETRY
from .base import BodyElement, Numbering, Row
from .measure3d import columns_of, coordinates_of, place_of, product
from .measured_force3d import FULL, Pair3D
from .turning_bodies import refuse_points

Vector6 = tuple[float, float, float, float, float, float]
Matrix6 = tuple[Vector6, Vector6, Vector6, Vector6, Vector6, Vector6]
NONE: Vector6 = (0.0,) * 6
SIGN = 106


@internal
def seen_from(p: Any, m: Any) -> Any:
    """The Euler parameters of a marker: those of its body, p, and then its own, m."""
    return (
        p[0] * m[0] - p[1] * m[1] - p[2] * m[2] - p[3] * m[3],
        p[0] * m[1] + p[1] * m[0] + p[2] * m[3] - p[3] * m[2],
        p[0] * m[2] + p[2] * m[0] + p[3] * m[1] - p[1] * m[3],
        p[0] * m[3] + p[3] * m[0] + p[1] * m[2] - p[2] * m[1],
    )


@internal
def _unit(j: int) -> Any:
    return 1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0, 1.0 if j == 3 else 0.0


@internal
def tilt_of(q: Any, coord: Any, par: Any, k: int, gradient: Any, hessian: Any) -> float:
    """f_k, with its derivatives. Parameters behind those of the markers: the Euler parameters of both (8); last of all
    twice the sign of e0 at the start."""
    p, s = four(q, coord, 3, par[0]), four(q, coord, 10, par[1])
    m, w = (par[26], par[27], par[28], par[29]), (par[30], par[31], par[32], par[33])
    a, b = seen_from(p, m), seen_from(s, w)
    sign = par[SIGN]
    gradient[:] = 0.0
    hessian[:, :] = 0.0
    # f = 2 G(a) b = -2 G(b) a, and the columns of a by p are those of unit parameters
    of_b, of_a = body_axes(a), body_axes(b)
    value = 0.0
    for i in range(4):
        value += sign * of_b[i][k] * b[i]
    for j in range(4):
        e = _unit(j)
        by_p, by_s = seen_from(e, m), seen_from(e, w)
        turned = body_axes(by_p)
        for i in range(4):
            gradient[3 + j] -= sign * of_a[i][k] * by_p[i]
            gradient[10 + j] += sign * of_b[i][k] * by_s[i]
        for l in range(4):
            other = seen_from(_unit(l), w)
            mixed = 0.0
            for i in range(4):
                mixed += sign * turned[i][k] * other[i]
            hessian[3 + j, 10 + l] = hessian[10 + l, 3 + j] = mixed
    return value


@internal
def bushing3d_kernel(job: int, t: float, b: Any) -> None:
    par, coord, extra = mat(b.par, b.count, SIGN + 1), imat(b.coord, b.count, 14), imat(b.extra, b.count, 1)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    z, rate, force = np.empty(6), np.empty(6), np.empty(6)
    gradient, hessian = np.empty((6, 14)), np.empty((6, 14, 14))
    for e in range(b.count):
        for k in range(6):
            if k < 3:
                z[k] = place_of(q, coord[e], par[e], k, gradient[k], hessian[k])
            else:
                z[k] = tilt_of(q, coord[e], par[e], k - 3, gradient[k], hessian[k])
            rate[k] = product(gradient[k], v, coord[e])
        energy, lost = 0.0, 0.0
        for k in range(6):
            force[k] = 0.0
            for l in range(6):
                elastic, damping = par[e, 34 + 6 * k + l] * z[l], par[e, 70 + 6 * k + l] * rate[l]
                force[k] += elastic + damping
                energy += 0.5 * z[k] * elastic
                lost += rate[k] * damping
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for k in range(6):
                for i in range(14):
                    r[coord[e, i]] += force[k] * gradient[k, i]
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * 196 * e, 14, 14)
            for j in range(14):
                for l in range(6):
                    change = 0.0
                    for i in range(14):
                        change += hessian[l, i, j] * v[coord[e, i]]
                    for k in range(6):
                        elastic, damping = par[e, 34 + 6 * k + l], par[e, 70 + 6 * k + l]
                        by_z = (coef[0] * elastic + coef[1] * damping) * gradient[l, j] + coef[0] * damping * change
                        for i in range(14):
                            values[slot[i, j]] += gradient[k, i] * by_z
                    for i in range(14):
                        values[slot[i, j]] += coef[0] * force[l] * hessian[l, i, j]
        elif job == ENERGY:
            vec(b.energy, 3)[2] += energy
        elif job == POWER:
            vec(b.a, b.n_extended)[extra[e, 0]] += lost


class Bushing3D(Pair3D):
    """Elastic bushing: pulls marker `b` to marker `a` and its axes to those of `a`, with six stiffnesses and dampings.

    In the order x, y, z (N/m, N s/m), about x, about y, about z (N m/rad, N m s/rad), along the axes of marker a; or as
    matrices of six rows, which couple them. Its angles are 2 sin(angle/2): about one axis a stiffness k gives the
    torque k sin(angle), largest at a quarter of a turn and zero at half of one. A coupling of turns with displacements
    changes its sign after a whole turn.
    """

    type: Literal["Bushing3D"] = "Bushing3D"
    kernel: ClassVar[Any] = bushing3d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL

    stiffness: Vector6 | Matrix6
    """Six numbers (three in N/m, three in N m/rad), or a matrix of six rows."""
    damping: Vector6 | Matrix6 = NONE
    """Six numbers (three in N s/m, three in N m s/rad), or a matrix of six rows."""

    @model_validator(mode="after")
    def _check(self) -> "Bushing3D":
        for what, given in (("stiffness", self.stiffness), ("damping", self.damping)):
            matrix = _matrix(given)
            largest = float(np.max(np.abs(matrix)))
            if np.max(np.abs(matrix - matrix.T)) > SYMMETRY * largest:
                raise ValueError(
                    f"the {what} of bushing '{self.name}' is not symmetric: forces from an energy, and damping, have "
                    "symmetric matrices; give K[i][j] = K[j][i]"
                )
            least = float(np.linalg.eigvalsh(matrix)[0])
            if least < -SYMMETRY * largest:
                raise ValueError(
                    f"the {what} of bushing '{self.name}' has the negative eigenvalue {least:.6g}: it would give "
                    "energy away; all must be zero or more"
                )
        return self

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        refuse_points(self.name, self.markers(), bodies, "use springs between points, or a RigidBody3D")

    def row(self, numbering: Numbering) -> Row:
        of_a, of_b = (seen(numbering.start(m)[3:7], m.attitude.parameters()) for m in (self.a, self.b))
        sign = 2.0 if float(np.dot(of_a, of_b)) >= 0.0 else -2.0
        own: tuple[Vector4, Vector4] = (self.a.attitude.parameters(), self.b.attitude.parameters())
        parameters = (
            *columns_of(self.a, self.b, numbering), *own[0], *own[1], *_matrix(self.stiffness).ravel().tolist(),
            *_matrix(self.damping).ravel().tolist(), sign,
        )  # fmt: skip
        return Row(parameters, coordinates_of(self.a, self.b, numbering), (numbering.work("dampers"),))


def _matrix(given: Vector6 | Matrix6) -> np.ndarray:
    array = np.array(given, dtype=np.float64)
    return np.diag(array) if array.ndim == 1 else array
