"""Kernel of the ANCF cable in space: axial strain eps = |r'| - 1, material curvature kappa = |r' x r''|/|r'|^2.

It has no torsion. r += M a - m g + int (EA (eps - eps0) + c_a eps') d eps/dq ds + int EI kappa d kappa/dq ds (Gerstmayr
and Shabana 2006, Nonlinear Dyn. 45, 109). With a = r', b = r'', Q = a . a, B = b . b, D = a . b, N = Q B - D^2,
m = B a - D b and n = Q b - D a the bending energy is EI N/(2 Q^2), smooth where the cable is straight, and its
derivatives over EI are
  _a = m/Q^2 - 2 N a/Q^3    _b = n/Q^2    _bb = (Q I - a a^T)/Q^2    _ab = (2 a b^T - D I - b a^T)/Q^2 - 4 a n^T/Q^3
  _aa = (B I - b b^T)/Q^2 - 4 (m a^T + a m^T)/Q^3 - 2 N I/Q^3 + 12 N a a^T/Q^4.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.rotation3d import dot, plus, times
from .cable_kernel import MASS_MATRIX, WEIGHT
from .cable_shape import FIRST, SECOND, SHARE

NODAL_IN_SPACE = 12
"""Coordinates of an element: x, y, z, slope_x, slope_y, slope_z of its two nodes."""
LENGTH, MASS, AXIAL, BENDING, AXIAL_DAMPING, STRAIN, GRAVITY, AXIAL_POINTS, BENDING_POINTS, COLUMNS = (
    0, 1, 2, 3, 4, 5, 6, 9, 10, 11,
)  # fmt: skip
"""Columns of the parameters; gravity has three."""


@inlined
def _gather(x: Any, coord: Any, length: float) -> Any:
    """d = (r1 - r0)/L, s0, s1 of one element from the vector x."""
    return (
        (
            (x[coord[6]] - x[coord[0]]) / length,
            (x[coord[7]] - x[coord[1]]) / length,
            (x[coord[8]] - x[coord[2]]) / length,
        ),
        (x[coord[3]], x[coord[4]], x[coord[5]]),
        (x[coord[9]], x[coord[10]], x[coord[11]]),
    )


@inlined
def _at(weights: Any, u: Any) -> Any:
    """The vector with these weights of d, s0, s1."""
    return plus(plus(times(weights[0], u[0]), times(weights[1], u[1])), times(weights[2], u[2]))


@inlined
def _load(r: Any, coord: Any, weights: Any, length: float, f: Any) -> None:
    """Add the generalised forces of f, whose work is f . (weights of d, s0, s1)."""
    for i in range(3):
        end = weights[0] * f[i] / length
        r[coord[i]] -= end
        r[coord[6 + i]] += end
        r[coord[3 + i]] += weights[1] * f[i]
        r[coord[9 + i]] += weights[2] * f[i]


@inlined
def _bending(a: Any, b: Any) -> Any:
    """Q, B, D and N."""
    square, bend, along = dot(a, a), dot(b, b), dot(a, b)
    return square, bend, along, square * bend - along * along


@internal
def _residual(b: Any) -> None:
    par, coords = mat(b.par, b.count, COLUMNS), imat(b.coord, b.count, NODAL_IN_SPACE)
    q, v, a, r = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended), vec(b.r, b.n_extended)
    for e in range(b.count):
        coord, length = coords[e], par[e, LENGTH]
        u, du = _gather(q, coord, length), _gather(v, coord, length)
        n = int(par[e, AXIAL_POINTS])
        for k in range(n):
            x = _at(FIRST[n, k], u)
            size = math.sqrt(dot(x, x))
            force = par[e, AXIAL] * (size - 1.0 - par[e, STRAIN])
            if par[e, AXIAL_DAMPING] != 0.0:
                force += par[e, AXIAL_DAMPING] * dot(x, _at(FIRST[n, k], du)) / size
            _load(r, coord, FIRST[n, k], length, times(SHARE[n, k] * length * force / size, x))
        n = int(par[e, BENDING_POINTS])
        for k in range(n):
            x, y = _at(FIRST[n, k], u), times(1.0 / length, _at(SECOND[n, k], u))
            square, bend, along, cross_square = _bending(x, y)
            w = SHARE[n, k] * length * par[e, BENDING] / (square * square)
            of_x = plus(times(w * (bend - 2.0 * cross_square / square), x), times(-w * along, y))
            of_y = plus(times(w * square / length, y), times(-w * along / length, x))
            _load(r, coord, FIRST[n, k], length, of_x)
            _load(r, coord, SECOND[n, k], length, of_y)
        mass = par[e, MASS] * length
        for i in range(4):
            li = 1.0 if i % 2 == 0 else length
            for c in range(3):
                force = -WEIGHT[i] * par[e, GRAVITY + c]
                for j in range(4):
                    force += (1.0 if j % 2 == 0 else length) * MASS_MATRIX[i, j] * a[coord[3 * j + c]]
                r[coord[3 * i + c]] += mass * li * force


@internal
def _add_axial(par: Any, u: Any, du: Any, c_q: float, c_v: float, g: Any) -> None:
    """Derivatives of the axial forces on d, s0, s1 into g (3, 3, 3, 3)."""
    n = int(par[AXIAL_POINTS])
    for k in range(n):
        x, rate = _at(FIRST[n, k], u), _at(FIRST[n, k], du)
        size = math.sqrt(dot(x, x))
        t = times(1.0 / size, x)
        growth = dot(t, rate)
        w = SHARE[n, k] * par[LENGTH]
        across = c_q * (par[AXIAL] * (size - 1.0 - par[STRAIN]) + par[AXIAL_DAMPING] * growth) / size
        along = c_q * par[AXIAL] + c_v * par[AXIAL_DAMPING] - across
        turn = times(c_q * par[AXIAL_DAMPING] / size, plus(rate, times(-growth, t)))
        for p in range(3):
            for s in range(3):
                h = w * FIRST[n, k, p] * FIRST[n, k, s]
                for i in range(3):
                    g[p, s, i, i] += h * across
                    for j in range(3):
                        g[p, s, i, j] += h * t[i] * (along * t[j] + turn[j])


@internal
def _add_bending(par: Any, u: Any, c_q: float, g: Any) -> None:
    """The same of the bending moments."""
    n = int(par[BENDING_POINTS])
    length = par[LENGTH]
    for k in range(n):
        x, y = _at(FIRST[n, k], u), times(1.0 / length, _at(SECOND[n, k], u))
        square, bend, along, cross_square = _bending(x, y)
        m, z = plus(times(bend, x), times(-along, y)), plus(times(square, y), times(-along, x))
        w = c_q * SHARE[n, k] * length * par[BENDING] / (square * square)
        for i in range(3):
            for j in range(3):
                same = 1.0 if i == j else 0.0
                xx = bend * same - y[i] * y[j] - 4.0 * (m[i] * x[j] + x[i] * m[j]) / square
                xx += cross_square * (12.0 * x[i] * x[j] / square - 2.0 * same) / square
                xy = 2.0 * x[i] * y[j] - along * same - y[i] * x[j] - 4.0 * x[i] * z[j] / square
                yx = 2.0 * x[j] * y[i] - along * same - y[j] * x[i] - 4.0 * x[j] * z[i] / square
                yy = square * same - x[i] * x[j]
                for p in range(3):
                    hp, gp = FIRST[n, k, p], SECOND[n, k, p] / length
                    for s in range(3):
                        hs, gs = FIRST[n, k, s], SECOND[n, k, s] / length
                        g[p, s, i, j] += w * (hp * hs * xx + hp * gs * xy + gp * hs * yx + gp * gs * yy)


@internal
def _tangent(b: Any, g: Any) -> None:
    par, coords = mat(b.par, b.count, COLUMNS), imat(b.coord, b.count, NODAL_IN_SPACE)
    q, v, values = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.values, b.n_values)
    slots = imat(b.slot_s, b.count, NODAL_IN_SPACE * NODAL_IN_SPACE)
    c_q, c_v = vec(b.coef, 2)[0], vec(b.coef, 2)[1]
    for e in range(b.count):
        coord, length, slot = coords[e], par[e, LENGTH], slots[e]
        g[:] = 0.0
        if c_q != 0.0 or c_v != 0.0:
            u = _gather(q, coord, length)
            _add_axial(par[e], u, _gather(v, coord, length), c_q, c_v, g)
            _add_bending(par[e], u, c_q, g)
        mass = par[e, MASS] * length
        for i in range(4):
            li = 1.0 if i % 2 == 0 else length
            # node vector i moves d (by -1/L or 1/L), s0 or s1
            p, wi = (0, (-1.0 if i == 0 else 1.0) / length) if i % 2 == 0 else ((i + 1) // 2, 1.0)
            for j in range(4):
                lj = 1.0 if j % 2 == 0 else length
                s, wj = (0, (-1.0 if j == 0 else 1.0) / length) if j % 2 == 0 else ((j + 1) // 2, 1.0)
                for c in range(3):
                    row = (3 * i + c) * NODAL_IN_SPACE + 3 * j
                    values[slot[row + c]] += mass * li * lj * MASS_MATRIX[i, j]
                    for d in range(3):
                        values[slot[row + d]] += wi * wj * g[p, s, c, d]


@internal
def _energies(b: Any) -> None:
    """Kinetic, potential and strain energy."""
    par, coords = mat(b.par, b.count, COLUMNS), imat(b.coord, b.count, NODAL_IN_SPACE)
    q, v, energy = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.energy, 3)
    for e in range(b.count):
        coord, length = coords[e], par[e, LENGTH]
        u, mass = _gather(q, coord, length), par[e, MASS] * length
        for i in range(4):
            li = mass if i % 2 == 0 else mass * length
            for c in range(3):
                energy[1] -= li * WEIGHT[i] * par[e, GRAVITY + c] * q[coord[3 * i + c]]
                for j in range(4):
                    lj = 1.0 if j % 2 == 0 else length
                    energy[0] += 0.5 * li * lj * MASS_MATRIX[i, j] * v[coord[3 * i + c]] * v[coord[3 * j + c]]
        n = int(par[e, AXIAL_POINTS])
        for k in range(n):
            x = _at(FIRST[n, k], u)
            strain = math.sqrt(dot(x, x)) - 1.0 - par[e, STRAIN]
            energy[2] += 0.5 * SHARE[n, k] * length * par[e, AXIAL] * strain * strain
        n = int(par[e, BENDING_POINTS])
        for k in range(n):
            square, _, _, cross_square = _bending(_at(FIRST[n, k], u), times(1.0 / length, _at(SECOND[n, k], u)))
            energy[2] += 0.5 * SHARE[n, k] * length * par[e, BENDING] * cross_square / (square * square)


@internal
def _dissipated(b: Any) -> None:
    """Power of the damping."""
    par, coords = mat(b.par, b.count, COLUMNS), imat(b.coord, b.count, NODAL_IN_SPACE)
    q, v, account = vec(b.q, b.n_extended), vec(b.v, b.n_extended), imat(b.extra, b.count, 1)
    for e in range(b.count):
        if par[e, AXIAL_DAMPING] == 0.0:
            continue
        u, du = _gather(q, coords[e], par[e, LENGTH]), _gather(v, coords[e], par[e, LENGTH])
        n = int(par[e, AXIAL_POINTS])
        for k in range(n):
            x = _at(FIRST[n, k], u)
            rate = dot(x, _at(FIRST[n, k], du)) / math.sqrt(dot(x, x))
            power = SHARE[n, k] * par[e, LENGTH] * par[e, AXIAL_DAMPING] * rate * rate
            vec(b.a, b.n_extended)[account[e, 0]] += power


@internal
def cable3d_kernel(job: int, t: float, b: Any) -> None:
    if job == RESIDUAL:
        _residual(b)
    elif job == TANGENT:
        _tangent(b, np.zeros((3, 3, 3, 3)))
    elif job == ENERGY:
        _energies(b)
    elif job == POWER:
        _dissipated(b)
