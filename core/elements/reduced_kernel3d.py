"""Spatial body in a floating frame with modal amplitudes w: r = R + A(p) c, c = x + Psi w.

Of the mass M of the mesh (one number for each pair of nodes) it takes sums over all nodes only (nodal form of Zwoelfer
and Gerstmayr, 2021, Acta Mech. 232: 4423), with a~ b = a x b:

    h = h0 + H w        h0 = sum M x, H_k = sum M Psi_k
    D_k = S_k + w_l N_lk          S_k = -sum x~ M Psi_k~, N_lk = -sum Psi_l~ M Psi_k~
    I = I0 + w_k (S_k^T + D_k)    inertia about the frame's origin
    beta_k = b_k + w_l Gamma_lk   b_k = sum x x M Psi_k, Gamma_lk = sum Psi_l x M Psi_k

The equations are Lagrange's of the kinetic energy m |R'|^2/2 + R'.A (u x h + h') + u.I u/2 + u.beta w' + w'.M w'/2,
u = 2 G p' the angular velocity in the frame. With alpha = A^T (R'' - gravity) and D = w'_k D_k:

    f     = u' x h + u x (u x h) + 2 u x h' + h''                     m (R'' - gravity) + A f
    tau   = h x alpha + I u' + u x I u + 2 D u + beta_k w''_k         2 G^T tau + 2 p lam
    of w  = H_k.alpha + beta_k.u' - u.D_k u + 2 u.(w'_l Gamma_lk) + (M w'' + C w' + K w)_k
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.rotation3d import (
    add_torque_bend,
    body_axes,
    body_rate,
    constant,
    cross,
    dot,
    four,
    less,
    of_body_torque,
    plus,
    three,
    times,
    turned,
    turning,
)

SCALARS = 16
"""m, h0 (3), I0 row by row (9), gravity (3): before the tables of the modes."""
OF_MODE = 15
"""H_k, b_k, S_k row by row."""
OF_PAIR = 12
"""N_lk row by row, Gamma_lk."""
FRAME = 7


@inlined
def _by(table: Any, i: int, first: int, x: Any) -> Any:
    """The 3 x 3 matrix that begins at column `first` of row i, times x."""
    return (
        table[i, first] * x[0] + table[i, first + 1] * x[1] + table[i, first + 2] * x[2],
        table[i, first + 3] * x[0] + table[i, first + 4] * x[1] + table[i, first + 5] * x[2],
        table[i, first + 6] * x[0] + table[i, first + 7] * x[1] + table[i, first + 8] * x[2],
    )


@inlined
def _back(table: Any, i: int, x: Any) -> Any:
    """The transposed matrix at the beginning of row i, times x."""
    return (
        table[i, 0] * x[0] + table[i, 3] * x[1] + table[i, 6] * x[2],
        table[i, 1] * x[0] + table[i, 4] * x[1] + table[i, 7] * x[2],
        table[i, 2] * x[0] + table[i, 5] * x[1] + table[i, 8] * x[2],
    )


@inlined
def _into_frame(p: Any, b: Any) -> Any:
    """A^T b, and the four columns of its derivative by p."""
    back = (p[0], -p[1], -p[2], -p[3])
    columns = turning(back, b)
    return turned(columns, back), (
        columns[0],
        times(-1.0, columns[1]),
        times(-1.0, columns[2]),
        times(-1.0, columns[3]),
    )


@inlined
def _row(table: Any, i: int, first: int) -> Any:
    """Three entries of a row, as a vector."""
    return table[i, first], table[i, first + 1], table[i, first + 2]


@internal
def reduced_sums(mode: Any, pair: Any, w: Any, dw: Any, whole: Any, d: Any, beta: Any, swirl: Any) -> None:
    """Adds the modes' parts to whole[0] = (h, h', I, D), and fills D_k (n, 9), beta_k and w'_l Gamma_lk (n, 3)."""
    n = len(w)
    for k in range(n):
        for i in range(9):
            d[k, i] = mode[k, 6 + i]
        for i in range(3):
            beta[k, i], swirl[k, i] = mode[k, 3 + i], 0.0
        for m in range(n):
            at = n * m + k
            for i in range(9):
                d[k, i] += w[m] * pair[at, i]
            for i in range(3):
                beta[k, i] += w[m] * pair[at, 9 + i]
                swirl[k, i] += dw[m] * pair[at, 9 + i]
        for i in range(3):
            whole[0, i] += w[k] * mode[k, i]
            whole[0, 3 + i] += dw[k] * mode[k, i]
            for j in range(3):
                whole[0, 6 + 3 * i + j] += w[k] * (mode[k, 6 + 3 * j + i] + d[k, 3 * i + j])
                whole[0, 15 + 3 * i + j] += dw[k] * d[k, 3 * i + j]


@internal
def reduced_body3d_kernel(job: int, t: float, b: Any) -> None:
    n = b.ncoord - FRAME
    coord = imat(b.coord, b.count, b.ncoord)
    q, v, acc = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    w, dw, ddw, whole = np.empty(n), np.empty(n), np.empty(n), np.empty((1, 24))
    d, beta, swirl = np.empty((n, 9)), np.empty((n, 3)), np.empty((n, 3))
    for e in range(b.count):
        base = b.par + 8 * b.npar * e
        scalar, mode = vec(base, SCALARS), mat(base + 8 * SCALARS, n, OF_MODE)
        pair = mat(base + 8 * (SCALARS + OF_MODE * n), n * n, OF_PAIR)
        start = base + 8 * (SCALARS + OF_MODE * n + OF_PAIR * n * n)
        mass, stiffness, damping = mat(start, n, n), mat(start + 8 * n * n, n, n), mat(start + 16 * n * n, n, n)
        for k in range(n):
            at = coord[e, FRAME + k]
            w[k], dw[k], ddw[k] = q[at], v[at], acc[at]
        if job == POWER:
            lost = 0.0
            for i in range(n):
                for j in range(n):
                    lost += damping[i, j] * dw[i] * dw[j]
            acc[imat(b.extra, b.count, 1)[e, 0]] += lost
            continue
        for i in range(3):
            whole[0, i], whole[0, 3 + i] = scalar[1 + i], 0.0
        for i in range(9):
            whole[0, 6 + i], whole[0, 15 + i] = scalar[4 + i], 0.0
        reduced_sums(mode, pair, w, dw, whole, d, beta, swirl)
        m, h, dh = scalar[0], _row(whole, 0, 0), _row(whole, 0, 3)
        p, dp = four(q, coord[e], 3, 0.0), four(v, coord[e], 3, 0.0)
        u = times(2.0, body_rate(p, dp))
        momentum = _by(whole, 0, 6, u)
        gravity = constant(scalar, 13)
        if job == ENERGY:
            energy, velocity = vec(b.energy, 3), three(v, coord[e], 0)
            moved, place = plus(cross(u, h), dh), turned(turning(p, h), p)
            kinetic = m * dot(velocity, velocity) + dot(u, momentum)
            kinetic += 2.0 * dot(velocity, turned(turning(p, moved), p))
            strain = 0.0
            for i in range(n):
                kinetic += 2.0 * dw[i] * dot(u, _row(beta, i, 0))
                for j in range(n):
                    kinetic += mass[i, j] * dw[i] * dw[j]
                    strain += stiffness[i, j] * w[i] * w[j]
            energy[0] += 0.5 * kinetic
            energy[1] -= m * dot(gravity, three(q, coord[e], 0)) + dot(gravity, place)
            energy[2] += 0.5 * strain
            continue
        ddp = four(acc, coord[e], 3, 0.0)
        du = times(2.0, body_rate(p, ddp))
        pulled = less(three(acc, coord[e], 0), gravity)
        alpha, alpha_by = _into_frame(p, pulled)
        swing = cross(u, h)
        f = plus(plus(cross(du, h), cross(u, swing)), times(2.0, cross(u, dh)))
        tau = plus(
            plus(cross(h, alpha), _by(whole, 0, 6, du)), plus(cross(u, momentum), times(2.0, _by(whole, 0, 15, u)))
        )
        for k in range(n):
            f = plus(f, times(ddw[k], _row(mode, k, 0)))
            tau = plus(tau, times(ddw[k], _row(beta, k, 0)))
        lam = vec(b.lam, b.m_extended)[imat(b.row, b.count, 1)[e, 0]]
        columns = turning(p, f)
        if job == RESIDUAL:
            r, k = vec(b.r, b.n_extended), imat(b.row, b.count, 1)[e, 0]
            force, torque = turned(columns, p), of_body_torque(p, tau)
            for i in range(3):
                r[coord[e, i]] += m * pulled[i] + force[i]
            norm, rate, second = -1.0, 0.0, 0.0
            for i in range(4):
                r[coord[e, 3 + i]] += 2.0 * torque[i] + 2.0 * p[i] * lam
                norm += p[i] * p[i]
                rate += 2.0 * p[i] * dp[i]
                second += 2.0 * (p[i] * ddp[i] + dp[i] * dp[i])
            vec(b.phi, b.m_extended)[k] = norm
            vec(b.phid, b.m_extended)[k] = rate
            vec(b.phidd, b.m_extended)[k] = second
            for i in range(n):
                total = dot(alpha, _row(mode, i, 0)) + dot(du, _row(beta, i, 0)) - dot(u, _by(d, i, 0, u))
                total += 2.0 * dot(u, _row(swirl, i, 0))
                for j in range(n):
                    total += mass[i, j] * ddw[j] + damping[i, j] * dw[j] + stiffness[i, j] * w[j]
                r[coord[e, FRAME + i]] += total
        elif job == TANGENT:
            values, c_q, c_v = vec(b.values, b.n_values), vec(b.coef, 2)[0], vec(b.coef, 2)[1]
            slot = imat(b.slot_s + 8 * b.ncoord * b.ncoord * e, b.ncoord, b.ncoord)
            slot_j, slot_jt = imat(b.slot_j, b.count, b.ncoord)[e], imat(b.slot_jt, b.count, b.ncoord)[e]
            axes, by_rate, by_second = body_axes(p), body_axes(dp), body_axes(ddp)
            for j in range(3):
                unit = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
                a, _ = _into_frame(p, unit)
                torque = of_body_torque(p, cross(h, a))
                values[slot[j, j]] += m
                for i in range(4):
                    values[slot[3 + i, j]] += 2.0 * torque[i]
                for i in range(n):
                    values[slot[FRAME + i, j]] += dot(a, _row(mode, i, 0))
            for j in range(4):
                of_du = plus(times(2.0, axes[j]), times(-2.0 * c_q, by_second[j]))
                of_u = plus(times(2.0 * c_v, axes[j]), times(-2.0 * c_q, by_rate[j]))
                of_alpha, of_swing = times(c_q, alpha_by[j]), cross(of_u, h)
                of_f = plus(
                    plus(cross(of_du, h), cross(of_u, swing)), plus(cross(u, of_swing), times(2.0, cross(of_u, dh)))
                )
                of_tau = plus(plus(cross(h, of_alpha), _by(whole, 0, 6, of_du)), times(2.0, _by(whole, 0, 15, of_u)))
                of_tau = plus(of_tau, plus(cross(of_u, momentum), cross(u, _by(whole, 0, 6, of_u))))
                force, torque = turned(turning(p, of_f), p), of_body_torque(p, of_tau)
                for i in range(3):
                    values[slot[i, 3 + j]] += force[i] + c_q * columns[j][i]
                for i in range(4):
                    values[slot[3 + i, 3 + j]] += 2.0 * torque[i]
                values[slot[3 + j, 3 + j]] += 2.0 * c_q * lam
                for i in range(n):
                    total = dot(of_alpha, _row(mode, i, 0)) + dot(of_du, _row(beta, i, 0))
                    total -= dot(of_u, plus(_by(d, i, 0, u), _back(d, i, u)))
                    values[slot[FRAME + i, 3 + j]] += total + 2.0 * dot(of_u, _row(swirl, i, 0))
                values[slot_j[3 + j]] += 2.0 * p[j]
                values[slot_jt[3 + j]] += 2.0 * p[j]
            add_torque_bend(values, slot, times(2.0 * c_q, tau), 1.0)
            for j in range(n):
                of_h = _row(mode, j, 0)
                sheared = plus(_by(d, j, 0, u), _back(d, j, u))
                turning_up = plus(_by(d, j, 0, du), _back(d, j, du))
                of_f = plus(cross(du, of_h), cross(u, cross(u, of_h)))
                of_f = plus(of_h, plus(times(2.0 * c_v, cross(u, of_h)), times(c_q, of_f)))
                of_tau = plus(plus(cross(of_h, alpha), turning_up), cross(u, sheared))
                for k in range(n):
                    at = n * j + k
                    of_tau = plus(of_tau, times(2.0 * dw[k], _by(pair, at, 0, u)))
                    of_tau = plus(of_tau, times(ddw[k], _row(pair, at, 9)))
                    by_place = dot(du, _row(pair, at, 9)) - dot(u, _by(pair, at, 0, u)) + stiffness[k, j]
                    by_speed = 2.0 * dot(u, _row(pair, at, 9)) + damping[k, j]
                    values[slot[FRAME + k, FRAME + j]] += mass[k, j] + c_v * by_speed + c_q * by_place
                of_tau = plus(_row(beta, j, 0), plus(times(2.0 * c_v, _by(d, j, 0, u)), times(c_q, of_tau)))
                force, torque = turned(turning(p, of_f), p), of_body_torque(p, of_tau)
                for i in range(3):
                    values[slot[i, FRAME + j]] += force[i]
                for i in range(4):
                    values[slot[3 + i, FRAME + j]] += 2.0 * torque[i]
