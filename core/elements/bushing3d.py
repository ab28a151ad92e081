"""Linear bushing in space between two markers: six forces from six deflections, along the axes of marker a.

z = (s, f): s_k = a_k . (x_b - x_a), and f = 2 e with (e0, e) the Euler parameters of marker b seen from marker a, of
both signs that with e0 > 0 at the start. f is the rotation vector while it is small; about one axis it is
2 sin(angle/2). Elastic forces are -(dz/dq)^T K z, those of an energy z.K z/2, for deflections of any size and any
number of turns, since e goes on smoothly through half a turn. f is bilinear in both bodies' Euler parameters.

Damping goes with the rates u = (s', w), w the angular velocity of b seen from a: forces -(du/dv)^T C u, which never
feed energy and do not depend on the angle. (f' = e0 w + w x e is less than w, and none about the axis at half a turn.)
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
from ..model.rotation3d import four
from ..rounding import SYMMETRY
from .base import BodyElement, Numbering, Row, full_pattern
from .geometry2d import along
from .measure3d import Pair3D, columns_of, coordinates_of, place_of
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
def _back(p: Any) -> Any:
    """The Euler parameters of the rotation back."""
    return p[0], -p[1], -p[2], -p[3]


@internal
def _spin(k: int, x: Any, y: Any) -> float:
    """Component k of 2 (y0 x - x0 y + y x x), vectors of Euler parameters: of the angular velocity along the axes of a
    where y are those of b seen from a and x their rates."""
    i, j = 1 + (k + 1) % 3, 1 + (k + 2) % 3
    return 2.0 * (y[0] * x[1 + k] - x[0] * y[1 + k] + y[i] * x[j] - y[j] * x[i])


@internal
def _turn(q: Any, coord: Any, par: Any, seen: Any, by: Any, mixed: Any) -> None:
    """The Euler parameters of marker b seen from marker a, to seen (4,), their derivatives by those of the bodies, to
    by (8, 4), and mixed ones by one of a's and one of b's, to mixed (4, 4, 4). Parameters behind those of the markers:
    the Euler parameters of both (8); last of all twice the sign of e0 at the start."""
    p, s = four(q, coord, 3, par[0]), four(q, coord, 10, par[1])
    m, w = (par[26], par[27], par[28], par[29]), (par[30], par[31], par[32], par[33])
    back, other = _back(seen_from(p, m)), seen_from(s, w)
    seen[0], seen[1], seen[2], seen[3] = seen_from(back, other)
    for j in range(4):
        by_p = _back(seen_from(_unit(j), m))
        by[j, 0], by[j, 1], by[j, 2], by[j, 3] = seen_from(by_p, other)
        by[4 + j, 0], by[4 + j, 1], by[4 + j, 2], by[4 + j, 3] = seen_from(back, seen_from(_unit(j), w))
        for l in range(4):
            both = seen_from(by_p, seen_from(_unit(l), w))
            for i in range(4):
                mixed[j, l, i] = both[i]


@internal
def _place_in(i: int) -> int:
    """Local coordinate of the i-th Euler parameter of both bodies."""
    return 3 + i if i < 4 else 6 + i


@internal
def _tilt(k: int, sign: float, seen: Any, by: Any, mixed: Any, gradient: Any, hessian: Any) -> float:
    """f_k, with its derivatives."""
    gradient[:] = 0.0
    hessian[:, :] = 0.0
    for i in range(8):
        gradient[_place_in(i)] = sign * by[i, 1 + k]
    for j in range(4):
        for l in range(4):
            hessian[3 + j, 10 + l] = hessian[10 + l, 3 + j] = sign * mixed[j, l, 1 + k]
    return sign * seen[1 + k]


@internal
def _spin_rows(k: int, seen: Any, by: Any, mixed: Any, row: Any, change: Any) -> None:
    """What component k of the angular velocity is of the velocities, to row (14,), and its derivatives by the
    coordinates, to the columns of change (14, 14)."""
    row[:] = 0.0
    change[:, :] = 0.0
    for i in range(8):
        row[_place_in(i)] = _spin(k, by[i], seen)
        for j in range(8):
            value = _spin(k, by[i], by[j])
            if i < 4 <= j:
                value += _spin(k, mixed[i, j - 4], seen)
            elif j < 4 <= i:
                value += _spin(k, mixed[j, i - 4], seen)
            change[_place_in(i), _place_in(j)] = value


@internal
def bushing3d_kernel(job: int, t: float, b: Any) -> None:
    par, coord, extra = mat(b.par, b.count, SIGN + 1), imat(b.coord, b.count, 14), imat(b.extra, b.count, 1)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    z, rate, pull, drag = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    # rates are rows (6, 14) of the velocities; along places these are the gradients
    gradient, hessian, rows, changes = (
        np.empty((6, 14)), np.empty((6, 14, 14)), np.empty((6, 14)), np.empty((6, 14, 14))
    )  # fmt: skip
    seen, by, mixed = np.empty(4), np.empty((8, 4)), np.empty((4, 4, 4))
    for e in range(b.count):
        _turn(q, coord[e], par[e], seen, by, mixed)
        for k in range(6):
            if k < 3:
                z[k] = place_of(q, coord[e], par[e], k, gradient[k], hessian[k])
                rows[k], changes[k] = gradient[k], hessian[k]
            else:
                z[k] = _tilt(k - 3, par[e, SIGN], seen, by, mixed, gradient[k], hessian[k])
                _spin_rows(k - 3, seen, by, mixed, rows[k], changes[k])
            rate[k] = along(rows[k], v, coord[e])
        energy, lost = 0.0, 0.0
        for k in range(6):
            pull[k], drag[k] = 0.0, 0.0
            for l in range(6):
                pull[k] += par[e, 34 + 6 * k + l] * z[l]
                drag[k] += par[e, 70 + 6 * k + l] * rate[l]
            energy += 0.5 * z[k] * pull[k]
            lost += rate[k] * drag[k]
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for k in range(6):
                for i in range(14):
                    r[coord[e, i]] += pull[k] * gradient[k, i] + drag[k] * rows[k, i]
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * 196 * e, 14, 14)
            for j in range(14):
                for l in range(6):
                    by_rate = coef[1] * rows[l, j]
                    for i in range(14):
                        by_rate += coef[0] * changes[l, i, j] * v[coord[e, i]]
                    by_z = coef[0] * gradient[l, j]
                    for i in range(14):
                        change = coef[0] * (pull[l] * hessian[l, i, j] + drag[l] * changes[l, i, j])
                        for k in range(6):
                            change += gradient[k, i] * par[e, 34 + 6 * k + l] * by_z
                            change += rows[k, i] * par[e, 70 + 6 * k + l] * by_rate
                        values[slot[i, j]] += change
        elif job == ENERGY:
            vec(b.energy, 3)[2] += energy
        elif job == POWER:
            vec(b.a, b.n_extended)[extra[e, 0]] += lost


class Bushing3D(Pair3D):
    """Elastic bushing: pulls marker `b` to marker `a` and its axes to those of `a`, with six stiffnesses and dampings.

    In the order x, y, z (N/m, N s/m), about x, about y, about z (N m/rad, N m s/rad), along the axes of marker a; or as
    matrices of six rows, which couple them. Its angles are 2 sin(angle/2): about one axis a stiffness k gives the
    torque k sin(angle), largest at a quarter of a turn and zero at half of one. A coupling of turns with displacements
    changes its sign after a whole turn. Its damping is that of the rates of displacement and of the angular velocity,
    at any angle.
    """

    type: Literal["Bushing3D"] = "Bushing3D"
    symbol: ClassVar[str] = "bushing"
    kernel: ClassVar[Any] = bushing3d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = full_pattern(14)

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
