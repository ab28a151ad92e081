"""Planar body in a floating frame of reference with modal amplitudes p: r = R + A(theta) u, u = u0 + S p + g(p, p)/2.

g(p, p) = g_kl p_k p_l is the second-order displacement of a beam that keeps its length as it bends (foreshortening);
without it the equations are those of the linear displacement field. With the invariants

    h = h0 + H p + G(p, p)/2      first moment, H = int S dm, G = int g dm
    I = J0 + 2 a.p + p.N p        inertia about the frame's origin, N = int S^T S dm + int u0.g dm
    beta = b + Gamma^T p          b_k = int u0 x S_k dm, Gamma_kl = int S_k x S_l dm + int u0 x g_kl dm
    M                             int S^T S dm and rotary inertia

the kinetic energy is T = m |R'|^2/2 + R'.A (theta' J h + h') + theta'^2 I/2 + theta' beta.p' + p'.M p'/2 (Shabana,
"Dynamics of Multibody Systems", ch. 5; the terms of g as in Wallrapp and Schwertassek, 1991). The kernel is that of
Lagrange's equations of this T, so momenta and energy of T are kept exactly, whatever T leaves out. With
alpha = A^T (R'' - gravity), f = theta'' J h + 2 theta' J h' - theta'^2 h + h'', e_k = H_k + G_kl p_l:

    m (R'' - gravity) + A f
    alpha.J h + theta'' I + theta' I' + beta.p'' + p'.Gamma p'
    alpha.e_k + theta'' beta_k + theta' (Gamma_jk - Gamma_kj) p'_j - theta'^2 (a + N p)_k + (M p'' + C p' + K p)_k
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec

VECTORS = 4
"""a, b, H_x, H_y: rows of the first table of the parameters, after the six scalars."""
MATRICES = 7
"""N, Gamma, M, K, C, G_x, G_y."""
SCALARS = 6
"""m, h0_x, h0_y, J0, gravity x and y."""


@internal
def _products(matrix: Any, x: Any, out: Any) -> None:
    """out = matrix x."""
    for i in range(len(x)):
        total = 0.0
        for j in range(len(x)):
            total += matrix[i, j] * x[j]
        out[i] = total


@internal
def floating_body2d_kernel(job: int, t: float, b: Any) -> None:
    n = b.ncoord - 3
    coord = imat(b.coord, b.count, b.ncoord)
    q, v, acc = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    p, dp, ddp = np.empty(n), np.empty(n), np.empty(n)
    ex, ey, dex, dey, ddex, ddey = np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    centrifugal, beta, swirl, inner = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    for e in range(b.count):
        base = b.par + 8 * b.npar * e
        scalar = vec(base, SCALARS)
        vectors = mat(base + 8 * SCALARS, VECTORS, n)
        start = base + 8 * (SCALARS + VECTORS * n)
        size = 8 * n * n
        big_n, gamma, mass, stiffness, damping, gx, gy = (
            mat(start, n, n), mat(start + size, n, n), mat(start + 2 * size, n, n), mat(start + 3 * size, n, n),
            mat(start + 4 * size, n, n), mat(start + 5 * size, n, n), mat(start + 6 * size, n, n),
        )  # fmt: skip
        for k in range(n):
            p[k], dp[k], ddp[k] = q[coord[e, 3 + k]], v[coord[e, 3 + k]], acc[coord[e, 3 + k]]
        if job == POWER:
            lost = 0.0
            for i in range(n):
                for j in range(n):
                    lost += damping[i, j] * dp[i] * dp[j]
            acc[imat(b.extra, b.count, 1)[e, 0]] += lost
            continue
        x, y, z = coord[e, 0], coord[e, 1], coord[e, 2]
        m, w = scalar[0], v[z]
        c, s = math.cos(q[z]), math.sin(q[z])
        # e_k and its rates' part that comes from G; h, h', I, I', beta
        _products(gx, p, ex)
        _products(gy, p, ey)
        _products(gx, dp, dex)
        _products(gy, dp, dey)
        _products(big_n, p, centrifugal)
        hx, hy, dhx, dhy, inertia, dinertia = scalar[1], scalar[2], 0.0, 0.0, scalar[3], 0.0
        for k in range(n):
            hx += (vectors[2, k] + 0.5 * ex[k]) * p[k]
            hy += (vectors[3, k] + 0.5 * ey[k]) * p[k]
            ex[k] += vectors[2, k]
            ey[k] += vectors[3, k]
            dhx += ex[k] * dp[k]
            dhy += ey[k] * dp[k]
            centrifugal[k] += vectors[0, k]  # a + N p: half of dI/dp
            inertia += (vectors[0, k] + centrifugal[k]) * p[k]
            dinertia += 2.0 * centrifugal[k] * dp[k]
            beta[k] = vectors[1, k]
            swirl[k] = 0.0
            for j in range(n):
                beta[k] += gamma[j, k] * p[j]
                swirl[k] += (gamma[j, k] - gamma[k, j]) * dp[j]
        if job == ENERGY:
            energy = vec(b.energy, 3)
            fx, fy = dhx - w * hy, dhy + w * hx
            kinetic = m * (v[x] * v[x] + v[y] * v[y]) + w * w * inertia
            kinetic += 2.0 * (v[x] * (c * fx - s * fy) + v[y] * (s * fx + c * fy))
            strain = 0.0
            for i in range(n):
                kinetic += 2.0 * w * beta[i] * dp[i]
                for j in range(n):
                    kinetic += mass[i, j] * dp[i] * dp[j]
                    strain += stiffness[i, j] * p[i] * p[j]
            energy[0] += 0.5 * kinetic
            energy[1] -= scalar[4] * (m * q[x] + c * hx - s * hy) + scalar[5] * (m * q[y] + s * hx + c * hy)
            energy[2] += 0.5 * strain
            continue
        bx, by, dw = acc[x] - scalar[4], acc[y] - scalar[5], acc[z]
        alpha_x, alpha_y = c * bx + s * by, c * by - s * bx
        ddhx, ddhy = 0.0, 0.0
        for k in range(n):
            ddhx += ex[k] * ddp[k] + dex[k] * dp[k]
            ddhy += ey[k] * ddp[k] + dey[k] * dp[k]
        fx = ddhx - dw * hy - 2.0 * w * dhy - w * w * hx
        fy = ddhy + dw * hx + 2.0 * w * dhx - w * w * hy
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            r[x] += m * bx + c * fx - s * fy
            r[y] += m * by + s * fx + c * fy
            turning = alpha_y * hx - alpha_x * hy + dw * inertia + w * dinertia
            for k in range(n):
                turning += beta[k] * ddp[k]
                total = alpha_x * ex[k] + alpha_y * ey[k] + dw * beta[k] + w * swirl[k] - w * w * centrifugal[k]
                for j in range(n):
                    turning += gamma[k, j] * dp[k] * dp[j]
                    total += mass[k, j] * ddp[j] + damping[k, j] * dp[j] + stiffness[k, j] * p[j]
                r[coord[e, 3 + k]] += total
            r[z] += turning
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            c_q, c_v = coef[0], coef[1]
            slot = imat(b.slot_s + 8 * e * b.ncoord * b.ncoord, b.ncoord, b.ncoord)
            ahx, ahy = -c * hy - s * hx, -s * hy + c * hx  # A J h
            values[slot[0, 0]] += m
            values[slot[1, 1]] += m
            sx, sy = -2.0 * c_v * (dhy + w * hx) - c_q * fy, 2.0 * c_v * (dhx - w * hy) + c_q * fx
            values[slot[0, 2]] += ahx + c * sx - s * sy
            values[slot[1, 2]] += ahy + s * sx + c * sy
            values[slot[2, 0]] += ahx
            values[slot[2, 1]] += ahy
            values[slot[2, 2]] += inertia + c_v * dinertia - c_q * (alpha_x * hx + alpha_y * hy)
            _products(gx, ddp, ddex)
            _products(gy, ddp, ddey)
            _products(big_n, dp, inner)
            for k in range(n):
                i = 3 + k
                sx = ex[k] + 2.0 * c_v * (dex[k] - w * ey[k])
                sy = ey[k] + 2.0 * c_v * (dey[k] + w * ex[k])
                sx += c_q * (ddex[k] - dw * ey[k] - 2.0 * w * dey[k] - w * w * ex[k])
                sy += c_q * (ddey[k] + dw * ex[k] + 2.0 * w * dex[k] - w * w * ey[k])
                values[slot[0, i]] += c * sx - s * sy
                values[slot[1, i]] += s * sx + c * sy
                values[slot[i, 0]] += c * ex[k] - s * ey[k]
                values[slot[i, 1]] += s * ex[k] + c * ey[k]
                by_p = alpha_y * ex[k] - alpha_x * ey[k] + 2.0 * (dw * centrifugal[k] + w * inner[k])
                by_rate = 2.0 * w * centrifugal[k]
                for j in range(n):
                    by_p += gamma[k, j] * ddp[j]
                    by_rate += (gamma[k, j] + gamma[j, k]) * dp[j]
                values[slot[2, i]] += beta[k] + c_v * by_rate + c_q * by_p
                by_rate = swirl[k] - 2.0 * w * centrifugal[k]
                values[slot[i, 2]] += beta[k] + c_v * by_rate + c_q * (alpha_y * ex[k] - alpha_x * ey[k])
                for j in range(n):
                    by_p = alpha_x * gx[k, j] + alpha_y * gy[k, j] + dw * gamma[j, k] - w * w * big_n[k, j]
                    by_rate = damping[k, j] + w * (gamma[j, k] - gamma[k, j])
                    values[slot[i, 3 + j]] += mass[k, j] + c_v * by_rate + c_q * (by_p + stiffness[k, j])
