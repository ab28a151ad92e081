"""Forces of several contacts by pivoting: in few contacts quicker than their limit (`regularization.py`), and exact.

First the solution in which no contact slides, then the whole problem with the limits of friction. The functions take
the record of the problem (`planar_contacts.py`) and the coefficients of friction that count, mu (n,).
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..linalg.small import dot
from ..rounding import BEYOND_LIMIT, NO_FRICTION, STICKING_MOVES, STICKING_RANK
from .conditions import BELOW_LIMITS, NONE, SOLVED
from .lcp import call_find, lcp_size
from .sticking_friction import hold_tangents, share, sticking_size


def pivoting_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `by_pivoting` for n contacts."""
    stuck = 2 * n * n + 6 * n + max(sticking_size(n), lcp_size(n))
    limits = 16 * n * n + 12 * n + lcp_size(4 * n)
    return 2 * n * n + 5 * n + max(stuck, limits)


@internal
def by_pivoting(cn: Any, mu: Any, work: int) -> int:
    """The solution by Lemke's method: NONE, SOLVED or BELOW_LIMITS."""
    n = cn.n
    nn, tn, sliding = mat(work, n, n), mat(work + 8 * n * n, n, n), vec(work + 16 * n * n, n)
    work += 8 * (2 * n * n + n)
    b_n, b_t, normal, free = vec(work, n), vec(work + 8 * n, n), vec(work + 16 * n, n), ivec(work + 24 * n, n)
    work += 32 * n
    a_nn, a_nt, a_tt = mat(cn.nn, n, n), mat(cn.nt, n, n), mat(cn.tt, n, n)
    direction, base = vec(cn.direction, n), vec(cn.base, n)
    tangential, w_n, w_t = vec(cn.tangential, n), vec(cn.normal_motion, n), vec(cn.tangential_motion, n)
    count = 0
    for i in range(n):
        sliding[i] = 0.0 if direction[i] == 0.0 else -mu[i] * direction[i]
        tangential[i] = 0.0
        if mu[i] > 0.0 and direction[i] == 0.0:
            free[count] = i
            count += 1
    for i in range(n):
        # columns of the normal forces, the friction of sliding contacts included
        for j in range(n):
            nn[i, j], tn[i, j] = a_nn[i, j] + a_nt[i, j] * sliding[j], a_nt[j, i] + a_tt[i, j] * sliding[j]
        b_n[i], b_t[i] = vec(cn.b_n, n)[i] + dot(nn[i], base), vec(cn.b_t, n)[i] + dot(tn[i], base)
    status = SOLVED
    if count > 0 and _all_stick(cn, nn, tn, b_n, b_t, mu, free[:count], normal, work):
        status = BELOW_LIMITS
    elif count > 0:
        if not _with_limits(cn, nn, tn, b_n, b_t, mu, free[:count], normal, work):
            return NONE
    else:
        matrix, q = mat(work, n, n), vec(work + 8 * n * n, n)
        for i in range(n):
            q[i] = b_n[i]
            for j in range(n):
                matrix[i, j] = nn[i, j]
        if not _scaled(cn, matrix, q, normal, work + 8 * (n * n + n)):
            return NONE
    for i in range(n):
        w_n[i], w_t[i] = b_n[i] + dot(nn[i], normal), b_t[i] + dot(tn[i], normal)
        for k in range(count):
            w_n[i] += a_nt[i, free[k]] * tangential[free[k]]
            w_t[i] += a_tt[i, free[k]] * tangential[free[k]]
    total = vec(cn.normal, n)
    for i in range(n):
        total[i] = normal[i] + base[i]
        tangential[i] += sliding[i] * total[i]
    return status


@internal
def _scaled(cn: Any, m: Any, q: Any, z: Any, work: int) -> bool:
    """`find_complementary` with rows and columns, which are overwritten, brought to unit size."""
    n = len(q)
    nn, unit = mat(cn.nn, n, n), vec(work, n)
    for i in range(n):
        unit[i] = 1.0 / np.sqrt(nn[i, i]) if nn[i, i] > 0.0 else 1.0
    for i in range(n):
        q[i] *= unit[i]
        for j in range(n):
            m[i, j] = unit[i] * m[i, j] * unit[j]
    found = call_find(cn.find_complementary, cn.least_norm, m, q, z, work + 8 * n)
    for i in range(n):
        z[i] *= unit[i]
    return bool(found)


@internal
def _all_stick(cn: Any, nn: Any, tn: Any, b_n: Any, b_t: Any, mu: Any, free: Any, normal: Any, work: int) -> bool:
    """The solution in which no contact of `free` slides, each with the same part of what its friction allows as the
    others that it shares with: normal forces beyond their base, and the tangential ones. False if there is none."""
    n, count = len(b_n), len(free)
    m, across, q = mat(work, n, n), mat(work + 8 * n * n, count, n), vec(work + 16 * n * n, n)
    work += 8 * (2 * n * n + n)
    a_nn, a_tt, base = mat(cn.nn, n, n), mat(cn.tt, n, n), vec(cn.base, n)
    tangential = vec(cn.tangential, n)
    for i in range(n):
        for j in range(n):
            m[i, j] = nn[i, j]
    hold_tangents(cn, free, tn, m, across, work)
    for i in range(n):
        # where sticking leaves no motion along the normals, what is left is rounding
        for j in range(n):
            if abs(m[i, j]) <= STICKING_RANK * (np.sqrt(a_nn[i, i]) * np.sqrt(a_nn[j, j])):
                m[i, j] = 0.0
        q[i], size = b_n[i], abs(b_n[i])
        for k in range(count):
            q[i] -= across[k, i] * b_t[free[k]]
            size += abs(across[k, i]) * abs(b_t[free[k]])
        if abs(q[i]) <= STICKING_RANK * size:
            q[i] = 0.0
    if not _scaled(cn, m, q, normal, work):
        return False
    limit, wanted = vec(work, count), vec(work + 8 * count, count)
    rest, friction = mat(work + 16 * count, count, 1), mat(work + 24 * count, count, 1)
    work += 32 * count
    most = 0.0
    for k in range(count):
        i = free[k]
        limit[k] = mu[i] * (normal[i] + base[i])
        wanted[k] = b_t[i] + dot(tn[i], normal)
        rest[k, 0] = -wanted[k]
        most = max(most, abs(wanted[k]))
    share(cn, free, limit, rest, friction, work)
    largest = 0.0
    for k in range(count):
        left = wanted[k]
        for j in range(count):
            left += a_tt[free[k], free[j]] * friction[j, 0]
        # (comparisons that are false for NaN)
        if not abs(left) <= STICKING_MOVES * max(most, 1e-300):
            return False
        largest = max(largest, abs(friction[k, 0]))
    for k in range(count):
        if not abs(friction[k, 0]) <= limit[k] * (1.0 + BEYOND_LIMIT) + NO_FRICTION * largest:
            return False
    for k in range(count):
        tangential[free[k]] = friction[k, 0]
    return True


@internal
def _with_limits(cn: Any, nn: Any, tn: Any, b_n: Any, b_t: Any, mu: Any, free: Any, normal: Any, work: int) -> bool:
    """The problem with friction limits: unknown P_N, the two signs of P_T, and the speed of sliding. False if there is
    no solution.

    In this form (Stewart and Trinkle 1996) the matrix is copositive and Lemke's method ends with a solution for every
    impact from b = G v^-.
    """
    n, f = len(b_n), len(free)
    size = n + 3 * f
    m, q, z = mat(work, size, size), vec(work + 8 * size * size, size), vec(work + 8 * size * (size + 1), size)
    columns = vec(work + 8 * size * (size + 2), size)
    work += 8 * size * (size + 3)
    a_nn, a_nt, a_tt = mat(cn.nn, n, n), mat(cn.nt, n, n), mat(cn.tt, n, n)
    base, tangential = vec(cn.base, n), vec(cn.tangential, n)
    for i in range(size):
        for j in range(size):
            m[i, j] = 0.0
    for i in range(n):
        q[i], columns[i] = b_n[i], 1.0 / np.sqrt(a_nn[i, i]) if a_nn[i, i] > 0.0 else 1.0
        for j in range(n):
            m[i, j] = nn[i, j]
    for k in range(f):
        i, plus, minus, speed = free[k], n + k, n + f + k, n + 2 * f + k
        for j in range(n):
            m[j, plus], m[j, minus] = a_nt[j, i], -a_nt[j, i]
            m[plus, j], m[minus, j] = tn[i, j], -tn[i, j]
        for j in range(f):
            x = a_tt[i, free[j]]
            m[plus, n + j], m[plus, n + f + j], m[minus, n + j], m[minus, n + f + j] = x, -x, -x, x
        m[plus, speed], m[minus, speed] = 1.0, 1.0
        m[speed, i], m[speed, plus], m[speed, minus] = mu[i], -1.0, -1.0
        q[plus], q[minus], q[speed] = b_t[i], -b_t[i], mu[i] * base[i]
        force = 1.0 / np.sqrt(a_tt[i, i]) if a_tt[i, i] > 0.0 else 1.0
        columns[plus], columns[minus], columns[speed] = force, force, 1.0 / force
    for i in range(size):
        q[i] *= columns[i]
        for j in range(size):
            m[i, j] = columns[i] * m[i, j] * columns[j]
    if not call_find(cn.find_complementary, cn.least_norm, m, q, z, work):
        return False
    for i in range(n):
        normal[i] = columns[i] * z[i]
    for k in range(f):
        tangential[free[k]] = columns[n + k] * z[n + k] - columns[n + f + k] * z[n + f + k]
    return True
