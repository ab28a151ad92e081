"""The conditions of friction cones as equations: forces are their own projections (Alart and Curnier 1991).

P_N = max(base, P_N - w_N/a_NN); P_T = projection of P_T - w_T/a_TT on the disk mu P_N, or, where a direction of sliding
is known, -mu P_N along it. Of friction with three tangents two contacts have a part each, and P_T of both together
lies in the ball mu P_N; `way` (3, n) says with its third row how far on the other one stands, 0: there is none.
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
def size_of_ball(n: int, a: Any, i: int, other: int) -> float:
    """Sum of the inverse masses of the tangents of contact i and of the one that stands `other` further on."""
    j, k = n + i, 2 * n + i
    total = 0.0
    for row in (j, k, j + other, k + other):
        total += a[row, row]
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
            other = int(way[2, i])
            size = a[j, j] + a[k, k]
            if other != 0:
                size = size_of_ball(n, a, i, other)
            step = 1.0 / size if size > 0.0 else 0.0
            x, y = p[j] - step * motion_of(a, b, p, j), p[k] - step * motion_of(a, b, p, k)
            length, limit, x_2, y_2 = math.sqrt(x * x + y * y), mu[i] * max(p[i], 0.0), 0.0, 0.0
            if other != 0:
                x_2 = p[j + other] - step * motion_of(a, b, p, j + other)
                y_2 = p[k + other] - step * motion_of(a, b, p, k + other)
                length = math.sqrt(x * x + y * y + x_2 * x_2 + y_2 * y_2)
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
                    if other != 0:
                        forward = c * d_x + s * d_y
                        forward += x_2 / length * ((1.0 if l == j + other else 0.0) - step * a[j + other, l])
                        forward += y_2 / length * ((1.0 if l == k + other else 0.0) - step * a[k + other, l])
                        jac[j, l] -= part * (d_x - c * forward)
                        jac[k, l] -= part * (d_y - s * forward)
                        continue
                    turn = part * (c * d_y - s * d_x)
                    jac[j, l] += s * turn
                    jac[k, l] -= c * turn
                jac[j, i] -= mu[i] * c
                jac[k, i] -= mu[i] * s
        worst = max(worst, abs(r[i]), abs(r[j]), abs(r[k]))
    return worst


@internal
def motion_left(n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any) -> float:
    """What is left of the motion that the conditions want otherwise, in parts of the largest motion without forces, or
    with the least normal ones: when restitution is added to contacts at rest, these are all that drives them."""
    worst, largest = 0.0, 0.0
    for i in range(3 * n):
        with_least = b[i]
        for l in range(n):
            with_least += a[i, l] * base[l]
        largest = max(largest, abs(b[i]), abs(with_least))
    for i in range(n):
        j, k = n + i, 2 * n + i
        trial = max(base[i], p[i] - motion_of(a, b, p, i) / a[i, i])
        worst = max(worst, a[i, i] * abs(p[i] - trial))
        size, limit, other = a[j, j] + a[k, k], mu[i] * max(p[i], 0.0), int(way[2, i])
        if other != 0:
            size = size_of_ball(n, a, i, other)
        if size == 0.0:
            continue
        if known[i] != 0.0:
            x, y = -limit * way[0, i], -limit * way[1, i]
        else:
            x, y = p[j] - motion_of(a, b, p, j) / size, p[k] - motion_of(a, b, p, k) / size
            length = math.sqrt(x * x + y * y)
            if other != 0:
                x_2 = p[j + other] - motion_of(a, b, p, j + other) / size
                y_2 = p[k + other] - motion_of(a, b, p, k + other) / size
                length = math.sqrt(x * x + y * y + x_2 * x_2 + y_2 * y_2)
            part = limit / length if length > limit else 1.0
            x, y = part * x, part * y
        worst = max(worst, size * abs(p[j] - x), size * abs(p[k] - y))
    return worst / largest if largest > 0.0 else 0.0
