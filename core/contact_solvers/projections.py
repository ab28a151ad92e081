"""The conditions of friction cones as equations: forces are their own projections (Alart and Curnier 1991).

P_N = max(base, P_N - w_N/a_NN); P_T = projection of P_T - w_T/a_TT on the disk mu P_N, or, where a direction of sliding
is known, -mu P_N along it.
"""

import math
from typing import Any

from ..compiled.jit import internal


@internal
def motion_of(a: Any, b: Any, p: Any, i: int) -> float:
    """Motion i with the forces p."""
    total = b[i]
    for j in range(len(b)):
        total += a[i, j] * p[j]
    return total


@internal
def residual_of_cones(
    n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, r: Any, jac: Any
) -> float:
    """P less its projection, and its derivative by P; the largest of it."""
    m, worst = 3 * n, 0.0
    for i in range(m):
        for j in range(m):
            jac[i, j] = 1.0 if i == j else 0.0
    for i in range(n):
        j, k = n + i, 2 * n + i
        step = 1.0 / a[i, i]
        trial = p[i] - step * motion_of(a, b, p, i)
        if trial > base[i]:
            r[i] = p[i] - trial
            for l in range(m):
                jac[i, l] = step * a[i, l]
        else:
            r[i] = p[i] - base[i]
        if known[i] != 0.0:
            r[j], r[k] = p[j] + mu[i] * p[i] * way[0, i], p[k] + mu[i] * p[i] * way[1, i]
            jac[j, i], jac[k, i] = mu[i] * way[0, i], mu[i] * way[1, i]
        else:
            size = a[j, j] + a[k, k]
            step = 1.0 / size if size > 0.0 else 0.0
            x, y = p[j] - step * motion_of(a, b, p, j), p[k] - step * motion_of(a, b, p, k)
            length, limit = math.sqrt(x * x + y * y), mu[i] * max(p[i], 0.0)
            if step == 0.0 or limit == 0.0:
                r[j], r[k] = p[j], p[k]
            elif length <= limit:
                r[j], r[k] = p[j] - x, p[k] - y
                for l in range(m):
                    jac[j, l], jac[k, l] = step * a[j, l], step * a[k, l]
            else:
                c, s = x / length, y / length
                r[j], r[k] = p[j] - limit * c, p[k] - limit * s
                part = limit / length
                for l in range(m):
                    d_x = (1.0 if l == j else 0.0) - step * a[j, l]
                    d_y = (1.0 if l == k else 0.0) - step * a[k, l]
                    turn = part * (c * d_y - s * d_x)
                    jac[j, l] += s * turn
                    jac[k, l] -= c * turn
                jac[j, i] -= mu[i] * c
                jac[k, i] -= mu[i] * s
        worst = max(worst, abs(r[i]), abs(r[j]), abs(r[k]))
    return worst


@internal
def motion_left(n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any) -> float:
    """What is left of the motion that the conditions want otherwise, in parts of the largest motion without forces."""
    worst, largest = 0.0, 0.0
    for i in range(n):
        j, k = n + i, 2 * n + i
        largest = max(largest, abs(b[i]), abs(b[j]), abs(b[k]))
        trial = max(base[i], p[i] - motion_of(a, b, p, i) / a[i, i])
        worst = max(worst, a[i, i] * abs(p[i] - trial))
        size, limit = a[j, j] + a[k, k], mu[i] * max(p[i], 0.0)
        if size == 0.0:
            continue
        if known[i] != 0.0:
            x, y = -limit * way[0, i], -limit * way[1, i]
        else:
            x, y = p[j] - motion_of(a, b, p, j) / size, p[k] - motion_of(a, b, p, k) / size
            length = math.sqrt(x * x + y * y)
            part = limit / length if length > limit else 1.0
            x, y = part * x, part * y
        worst = max(worst, size * abs(p[j] - x), size * abs(p[k] - y))
    return worst / largest if largest > 0.0 else 0.0
