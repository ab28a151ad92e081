"""Kernel of the planar ANCF cable: axial strain eps = |r'| - 1, material curvature kappa = (r' x r'')/|r'|^2.

r += M a - m g + int (EA (eps - eps0) + c_a eps') d eps/dq ds + int (EI (kappa - kappa0) + c_b kappa') d kappa/dq ds
(Gerstmayr and Irschik 2008, J. Sound Vib. 318, 461: on the correct representation of bending and axial deformation in
the absolute nodal coordinate formulation). With a = r', b = r'', c = a x b, Q = a . a, and c_a = (b_y, -b_x),
c_b = (-a_y, a_x) the derivatives of c:
  kappa_a = c_a/Q - 2 c a/Q^2,  kappa_b = c_b/Q,  kappa_bb = 0,  kappa_ab = J^T/Q - 2 a c_b^T/Q^2,
  kappa_aa = -2 (c_a a^T + a c_a^T + c I)/Q^2 + 8 c a a^T/Q^3.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from .cable_shape import FIRST, MOST_POINTS, SECOND, SHARE

NODAL = 8
"""Coordinates of an element: x, y, slope_x, slope_y of its two nodes."""
# columns of the parameters; then eps0 and kappa0 at the Gauss points
LENGTH, MASS, AXIAL, BENDING, AXIAL_DAMPING, BENDING_DAMPING, GRAVITY_X, GRAVITY_Y, AXIAL_POINTS, BENDING_POINTS = (
    range(10)
)
STRAIN = 10
CURVATURE = STRAIN + MOST_POINTS
COLUMNS = CURVATURE + MOST_POINTS

# consistent mass of r0, s0, r1, s1 over m L; the slopes count with L
MASS_MATRIX = np.array(
    [[156.0, 22.0, 54.0, -13.0], [22.0, 4.0, 13.0, -3.0], [54.0, 13.0, 156.0, -22.0], [-13.0, -3.0, -22.0, 4.0]]
) / 420.0  # fmt: skip
WEIGHT = np.array([0.5, 1.0 / 12.0, 0.5, -1.0 / 12.0])
"""Integrals of the shape functions over L; those of the slopes count with L."""


@inlined
def _gather(x: Any, coord: Any, length: float, u: Any) -> None:
    """u (3, 2): d = (r1 - r0)/L, s0, s1 of one element from the vector x."""
    for c in range(2):
        u[0, c] = (x[coord[4 + c]] - x[coord[c]]) / length
        u[1, c] = x[coord[2 + c]]
        u[2, c] = x[coord[6 + c]]


@inlined
def _at(table: Any, n: int, k: int, u: Any) -> Any:
    """The vector with the weights table[n, k] of d, s0, s1."""
    h0, h1, h2 = table[n, k, 0], table[n, k, 1], table[n, k, 2]
    return h0 * u[0, 0] + h1 * u[1, 0] + h2 * u[2, 0], h0 * u[0, 1] + h1 * u[1, 1] + h2 * u[2, 1]


@internal
def _add_axial(par: Any, u: Any, du: Any, c_q: float, c_v: float, g: Any) -> None:
    """Derivatives of the axial forces on d, s0, s1 into g (3, 3, 2, 2)."""
    n = int(par[AXIAL_POINTS])
    stiffness, damping, length = par[AXIAL], par[AXIAL_DAMPING], par[LENGTH]
    for k in range(n):
        ax, ay = _at(FIRST, n, k, u)
        vx, vy = _at(FIRST, n, k, du)
        size = math.sqrt(ax * ax + ay * ay)
        tx, ty = ax / size, ay / size
        w = SHARE[n, k] * length
        rate = tx * vx + ty * vy
        force = w * (stiffness * (size - 1.0 - par[STRAIN + k]) + damping * rate)
        # rows of t_q: (I - t t^T)/|r'|; times the velocity
        turn = (tx * vy - ty * vx) / size
        across = c_q * force / size
        along = w * (c_q * stiffness + c_v * damping)
        shear = w * c_q * damping * turn
        xx = across * ty * ty + along * tx * tx - shear * tx * ty
        xy = -across * tx * ty + along * tx * ty + shear * tx * tx
        yx = -across * tx * ty + along * tx * ty - shear * ty * ty
        yy = across * tx * tx + along * ty * ty + shear * tx * ty
        for i in range(3):
            for j in range(3):
                h = FIRST[n, k, i] * FIRST[n, k, j]
                g[i, j, 0, 0] += h * xx
                g[i, j, 0, 1] += h * xy
                g[i, j, 1, 0] += h * yx
                g[i, j, 1, 1] += h * yy


@internal
def _add_bending(par: Any, u: Any, du: Any, c_q: float, c_v: float, g: Any) -> None:
    """Derivatives of the bending forces on d, s0, s1 into g (3, 3, 2, 2)."""
    n = int(par[BENDING_POINTS])
    stiffness, damping, length = par[BENDING], par[BENDING_DAMPING], par[LENGTH]
    for k in range(n):
        ax, ay = _at(FIRST, n, k, u)
        bx, by = _at(SECOND, n, k, u)
        dax, day = _at(FIRST, n, k, du)
        dbx, dby = _at(SECOND, n, k, du)
        bx, by, dbx, dby = bx / length, by / length, dbx / length, dby / length
        s = 1.0 / (ax * ax + ay * ay)
        cross = ax * by - ay * bx
        w = SHARE[n, k] * length
        z = 2.0 * cross * s * s
        kax, kay, kbx, kby = by * s - z * ax, -bx * s - z * ay, -ay * s, ax * s
        rate = kax * dax + kay * day + kbx * dbx + kby * dby
        moment = w * (stiffness * (cross * s - par[CURVATURE + k]) + damping * rate)
        y = 2.0 * s * s
        cube = 8.0 * cross * s * s * s
        aaxx = -y * (2.0 * by * ax + cross) + cube * ax * ax
        aaxy = -y * (by * ay - bx * ax) + cube * ax * ay
        aayy = -y * (-2.0 * bx * ay + cross) + cube * ay * ay
        # kappa_ab: rows a, columns b
        abxx, abxy = y * ax * ay, s - y * ax * ax
        abyx, abyy = -s + y * ay * ay, -y * ax * ay
        # Hessian times velocity
        hax = aaxx * dax + aaxy * day + abxx * dbx + abxy * dby
        hay = aaxy * dax + aayy * day + abyx * dbx + abyy * dby
        hbx = abxx * dax + abyx * day
        hby = abxy * dax + abyy * day
        p, m, o = w * (c_q * stiffness + c_v * damping), c_q * moment, w * c_q * damping
        qax, qay, qbx, qby = p * kax + o * hax, p * kay + o * hay, p * kbx + o * hbx, p * kby + o * hby
        for i in range(3):
            hi, hi2 = FIRST[n, k, i], SECOND[n, k, i] / length
            kx, ky = hi * kax + hi2 * kbx, hi * kay + hi2 * kby
            # row i of the Hessian, against a and b
            rxax, rxay = m * (hi * aaxx + hi2 * abxx), m * (hi * aaxy + hi2 * abyx)
            ryax, ryay = m * (hi * aaxy + hi2 * abxy), m * (hi * aayy + hi2 * abyy)
            rxbx, rxby, rybx, ryby = m * hi * abxx, m * hi * abxy, m * hi * abyx, m * hi * abyy
            for j in range(3):
                hj, hj2 = FIRST[n, k, j], SECOND[n, k, j] / length
                qx, qy = hj * qax + hj2 * qbx, hj * qay + hj2 * qby
                g[i, j, 0, 0] += kx * qx + hj * rxax + hj2 * rxbx
                g[i, j, 0, 1] += kx * qy + hj * rxay + hj2 * rxby
                g[i, j, 1, 0] += ky * qx + hj * ryax + hj2 * rybx
                g[i, j, 1, 1] += ky * qy + hj * ryay + hj2 * ryby


@internal
def _residual(b: Any) -> None:
    """Scalars instead of small arrays, and no rates without damping: this is what most of the time goes into."""
    par, coords = mat(b.par, b.count, COLUMNS), imat(b.coord, b.count, NODAL)
    q, v, a, r = (
        vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended), vec(b.r, b.n_extended)
    )  # fmt: skip
    for e in range(b.count):
        c, length = coords[e], par[e, LENGTH]
        x0, y0, x1, y1, x2, y2, x3, y3 = c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]
        s = 1.0 / length
        # d, s0, s1 and their rates
        ux0, uy0 = (q[x2] - q[x0]) * s, (q[y2] - q[y0]) * s
        ux1, uy1, ux2, uy2 = q[x1], q[y1], q[x3], q[y3]
        damped = par[e, AXIAL_DAMPING] != 0.0 or par[e, BENDING_DAMPING] != 0.0
        vx0, vy0, vx1, vy1, vx2, vy2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        if damped:
            vx0, vy0 = (v[x2] - v[x0]) * s, (v[y2] - v[y0]) * s
            vx1, vy1, vx2, vy2 = v[x1], v[y1], v[x3], v[y3]
        fx0, fy0, fx1, fy1, fx2, fy2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        n = int(par[e, AXIAL_POINTS])
        for k in range(n):
            h0, h1, h2 = FIRST[n, k, 0], FIRST[n, k, 1], FIRST[n, k, 2]
            ax, ay = h0 * ux0 + h1 * ux1 + h2 * ux2, h0 * uy0 + h1 * uy1 + h2 * uy2
            size = math.sqrt(ax * ax + ay * ay)
            force = par[e, AXIAL] * (size - 1.0 - par[e, STRAIN + k])
            if damped:
                dax, day = h0 * vx0 + h1 * vx1 + h2 * vx2, h0 * vy0 + h1 * vy1 + h2 * vy2
                force += par[e, AXIAL_DAMPING] * (ax * dax + ay * day) / size
            force *= SHARE[n, k] * length / size
            px, py = force * ax, force * ay
            fx0, fy0, fx1, fy1 = fx0 + h0 * px, fy0 + h0 * py, fx1 + h1 * px, fy1 + h1 * py
            fx2, fy2 = fx2 + h2 * px, fy2 + h2 * py
        n = int(par[e, BENDING_POINTS])
        for k in range(n):
            h0, h1, h2 = FIRST[n, k, 0], FIRST[n, k, 1], FIRST[n, k, 2]
            g0, g1, g2 = SECOND[n, k, 0] * s, SECOND[n, k, 1] * s, SECOND[n, k, 2] * s
            ax, ay = h0 * ux0 + h1 * ux1 + h2 * ux2, h0 * uy0 + h1 * uy1 + h2 * uy2
            bx, by = g0 * ux0 + g1 * ux1 + g2 * ux2, g0 * uy0 + g1 * uy1 + g2 * uy2
            w = 1.0 / (ax * ax + ay * ay)
            bend = (ax * by - ay * bx) * w
            kax, kay, kbx, kby = w * (by - 2.0 * bend * ax), -w * (bx + 2.0 * bend * ay), -w * ay, w * ax
            moment = par[e, BENDING] * (bend - par[e, CURVATURE + k])
            if damped:
                dax, day = h0 * vx0 + h1 * vx1 + h2 * vx2, h0 * vy0 + h1 * vy1 + h2 * vy2
                dbx, dby = g0 * vx0 + g1 * vx1 + g2 * vx2, g0 * vy0 + g1 * vy1 + g2 * vy2
                moment += par[e, BENDING_DAMPING] * (kax * dax + kay * day + kbx * dbx + kby * dby)
            moment *= SHARE[n, k] * length
            kax, kay, kbx, kby = moment * kax, moment * kay, moment * kbx, moment * kby
            fx0, fy0 = fx0 + h0 * kax + g0 * kbx, fy0 + h0 * kay + g0 * kby
            fx1, fy1 = fx1 + h1 * kax + g1 * kbx, fy1 + h1 * kay + g1 * kby
            fx2, fy2 = fx2 + h2 * kax + g2 * kbx, fy2 + h2 * kay + g2 * kby
        mass = par[e, MASS] * length
        for axis in range(2):
            i0, i1, i2, i3 = c[axis], c[2 + axis], c[4 + axis], c[6 + axis]
            a0, a1, a2, a3 = a[i0], length * a[i1], a[i2], length * a[i3]
            f0, f1, f2 = (fx0, fx1, fx2) if axis == 0 else (fy0, fy1, fy2)
            g, m = mass * par[e, GRAVITY_X + axis], mass / 420.0
            r[i0] += m * (156.0 * a0 + 22.0 * a1 + 54.0 * a2 - 13.0 * a3) - 0.5 * g - f0 * s
            r[i1] += length * (m * (22.0 * a0 + 4.0 * a1 + 13.0 * a2 - 3.0 * a3) - g / 12.0) + f1
            r[i2] += m * (54.0 * a0 + 13.0 * a1 + 156.0 * a2 - 22.0 * a3) - 0.5 * g + f0 * s
            r[i3] += length * (m * (4.0 * a3 - 13.0 * a0 - 3.0 * a1 - 22.0 * a2) + g / 12.0) + f2


@internal
def _tangent(b: Any, u: Any, du: Any, g: Any) -> None:
    par, coords = mat(b.par, b.count, COLUMNS), imat(b.coord, b.count, NODAL)
    q, v, values = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.values, b.n_values)
    slots = imat(b.slot_s, b.count, NODAL * NODAL)
    c_q, c_v = vec(b.coef, 2)[0], vec(b.coef, 2)[1]
    for e in range(b.count):
        coord, length, slot = coords[e], par[e, LENGTH], slots[e]
        mass = par[e, MASS] * length
        if c_q != 0.0 or c_v != 0.0:
            _gather(q, coord, length, u)
            _gather(v, coord, length, du)
            g[:] = 0.0
            _add_axial(par[e], u, du, c_q, c_v, g)
            _add_bending(par[e], u, du, c_q, c_v, g)
        for i in range(4):
            li = 1.0 if i % 2 == 0 else length
            # node vector i moves d (by -1/L or 1/L), s0 or s1
            p, wi = (0, (-1.0 if i == 0 else 1.0) / length) if i % 2 == 0 else ((i + 1) // 2, 1.0)
            for j in range(4):
                lj = 1.0 if j % 2 == 0 else length
                o, wj = (0, (-1.0 if j == 0 else 1.0) / length) if j % 2 == 0 else ((j + 1) // 2, 1.0)
                inertia = mass * li * lj * MASS_MATRIX[i, j]
                w, at = wi * wj, 2 * i * NODAL + 2 * j
                values[slot[at]] += inertia + w * g[p, o, 0, 0]
                values[slot[at + 1]] += w * g[p, o, 0, 1]
                values[slot[at + NODAL]] += w * g[p, o, 1, 0]
                values[slot[at + NODAL + 1]] += inertia + w * g[p, o, 1, 1]


@internal
def _energies(b: Any, u: Any) -> None:
    """Kinetic, potential and strain energy."""
    par, coords = mat(b.par, b.count, COLUMNS), imat(b.coord, b.count, NODAL)
    q, v, energy = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.energy, 3)
    for e in range(b.count):
        coord, length = coords[e], par[e, LENGTH]
        _gather(q, coord, length, u)
        mass = par[e, MASS] * length
        for i in range(4):
            li = mass if i % 2 == 0 else mass * length
            for c in range(2):
                energy[1] -= li * WEIGHT[i] * par[e, GRAVITY_X + c] * q[coord[2 * i + c]]
                for j in range(4):
                    lj = 1.0 if j % 2 == 0 else length
                    energy[0] += 0.5 * li * lj * MASS_MATRIX[i, j] * v[coord[2 * i + c]] * v[coord[2 * j + c]]
        n = int(par[e, AXIAL_POINTS])
        for k in range(n):
            ax, ay = _at(FIRST, n, k, u)
            strain = math.sqrt(ax * ax + ay * ay) - 1.0 - par[e, STRAIN + k]
            energy[2] += 0.5 * SHARE[n, k] * length * par[e, AXIAL] * strain * strain
        n = int(par[e, BENDING_POINTS])
        for k in range(n):
            ax, ay = _at(FIRST, n, k, u)
            bx, by = _at(SECOND, n, k, u)
            bend = (ax * by - ay * bx) / (length * (ax * ax + ay * ay)) - par[e, CURVATURE + k]
            energy[2] += 0.5 * SHARE[n, k] * length * par[e, BENDING] * bend * bend


@internal
def _dissipated(b: Any, u: Any, du: Any) -> None:
    """Power of the damping."""
    par, coords = mat(b.par, b.count, COLUMNS), imat(b.coord, b.count, NODAL)
    q, v, account = vec(b.q, b.n_extended), vec(b.v, b.n_extended), imat(b.extra, b.count, 1)
    total = 0.0
    for e in range(b.count):
        coord, length = coords[e], par[e, LENGTH]
        if par[e, AXIAL_DAMPING] == 0.0 and par[e, BENDING_DAMPING] == 0.0:
            continue
        _gather(q, coord, length, u)
        _gather(v, coord, length, du)
        n = int(par[e, AXIAL_POINTS])
        for k in range(n):
            ax, ay = _at(FIRST, n, k, u)
            vx, vy = _at(FIRST, n, k, du)
            rate = (ax * vx + ay * vy) / math.sqrt(ax * ax + ay * ay)
            total += SHARE[n, k] * length * par[e, AXIAL_DAMPING] * rate * rate
        n = int(par[e, BENDING_POINTS])
        for k in range(n):
            ax, ay = _at(FIRST, n, k, u)
            bx, by = _at(SECOND, n, k, u)
            vx, vy = _at(FIRST, n, k, du)
            wx, wy = _at(SECOND, n, k, du)
            square = ax * ax + ay * ay
            growth = 2.0 * (ax * by - ay * bx) * (ax * vx + ay * vy) / square
            rate = (vx * by - vy * bx + ax * wy - ay * wx - growth) / (length * square)
            total += SHARE[n, k] * length * par[e, BENDING_DAMPING] * rate * rate
    if b.count > 0:
        vec(b.a, b.n_extended)[account[0, 0]] += total


@internal
def cable2d_kernel(job: int, t: float, b: Any) -> None:
    u, du, g = np.empty((3, 2)), np.empty((3, 2)), np.zeros((3, 3, 2, 2))
    if job == RESIDUAL:
        _residual(b)
    elif job == TANGENT:
        _tangent(b, u, du, g)
    elif job == ENERGY:
        _energies(b, u)
    elif job == POWER:
        _dissipated(b, u, du)
