"""Forces (or impulses) of several contacts in space with Coulomb friction: exact cones, not polygons.

With w = b + A P, each contact with a normal and two tangential directions: 0 <= w_N, P_N - base >= 0, their product
0; |P_T| <= mu P_N, and P_T = -mu P_N w_T/|w_T| where w_T is not zero. Where a direction of sliding is known, P_T is
against it whatever w_T is.

One contact is solved by itself: it separates, sticks, or slides with the angle at which w_T and -P_T are parallel, a
root of one scalar function (`one_cone`). Several: sweeps of that over all contacts, and Newton's method on the
projections of Alart and Curnier (1991), P_N = max(base, P_N - r w_N), P_T = projection of P_T - r w_T on the disk
mu P_N, which is semismooth and ends in few steps; where it does not get nearer, sweeps go on, in smaller steps, until
nothing changes (Jourdan, Alart, Jean 1998). What these do not find is followed from the forces without friction, while
that grows.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..linalg.small import call_least_norm, least_norm_size
from ..rounding import (
    FRICTION_ENOUGH,
    FRICTION_GOOD,
    FRICTION_MOTION,
    FRICTION_NEAR,
    FRICTION_RANK,
    FRICTION_ROUGH,
)

FAILED, FOUND = 0, 1
SWEEPS, MOST_SWEEPS = 20, 5000
NEWTON, HALVINGS = 60, 8
LEAST_PART = 0.125
GROWTH_SWEEPS, MOST_GROWTHS, FIRST_GROWTH, LEAST_GROWTH = 500, 100, 0.25, 1e-6
"""Where sweeps come to no end: friction grows in such parts of its coefficients."""
ANGLES = 48
"""Parts of a turn in which the angle of sliding is looked for."""
TOUCHES_ZERO, SLIDES_BACK = 1e-13, 1e-10
"""Of the terms: a value at an extremum that is zero; and of the motion: sliding that is none, where a contact is
between sticking and sliding."""


def friction_cones_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `solve_friction_cones` for n contacts."""
    m = 3 * n
    return m * m + 5 * m + least_norm_size(m, m, 1)


@internal
def _slide(a: Any, b: Any, mu: float, base: float, angle: float) -> Any:
    """(P_N, w_T x d, w_T . d) of one contact that slides along d at this angle; P_N < 0 where there is none."""
    c, s = math.cos(angle), math.sin(angle)
    grows = a[0] - mu * (a[1] * c + a[2] * s)
    if grows <= 0.0:
        return -1.0, 0.0, 0.0
    p = max(base, -b[0] / grows)
    x = b[1] + p * (a[1] - mu * (a[3] * c + a[4] * s))
    y = b[2] + p * (a[2] - mu * (a[4] * c + a[5] * s))
    return p, x * s - y * c, x * c + y * s


@internal
def _wave(a: Any, b: Any, mu: float, wave: Any) -> None:
    """Coefficients of 1, cos, sin, cos 2, sin 2 of the angle in (w_T x d)(a_NN - mu a_NT d), where P_N brings w_N to
    zero: the factor takes the poles away, and what is left has four roots at most."""
    of_s, of_c = b[1] * a[0] - b[0] * a[1], b[0] * a[2] - b[2] * a[0]
    of_cs = mu * (b[0] * (a[3] - a[5]) - b[1] * a[1] + b[2] * a[2])
    of_ss, of_cc = mu * (b[0] * a[4] - b[1] * a[2]), mu * (b[2] * a[1] - b[0] * a[4])
    wave[0], wave[1], wave[2] = 0.5 * (of_ss + of_cc), of_c, of_s
    wave[3], wave[4] = 0.5 * (of_cc - of_ss), 0.5 * of_cs


@internal
def _wave_at(wave: Any, angle: float) -> Any:
    """(value, derivative)."""
    c, s = math.cos(angle), math.sin(angle)
    c2, s2 = c * c - s * s, 2.0 * c * s
    value = wave[0] + wave[1] * c + wave[2] * s + wave[3] * c2 + wave[4] * s2
    return value, wave[2] * c - wave[1] * s + 2.0 * (wave[4] * c2 - wave[3] * s2)


@internal
def _wave_root(wave: Any, low: float, high: float, f_low: float) -> float:
    """The root between two angles with values of different sign."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        if (_wave_at(wave, middle)[0] > 0.0) == (f_low > 0.0):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@internal
def _roots_of_wave(wave: Any, first: float, angles: Any, count: int) -> int:
    """All roots are added to the first `count` in `angles`; their number. Where the values at both ends of a part have
    one sign, its extremum between them tells whether there are two, or one that only touches zero."""
    step, size = 2.0 * math.pi / ANGLES, 0.0
    for k in range(5):
        size += abs(wave[k])
    left = first - 0.5 * step
    f_left, slope_left = _wave_at(wave, left)
    for k in range(ANGLES):
        right = first + (k + 0.5) * step
        f_right, slope_right = _wave_at(wave, right)
        if (f_left > 0.0) != (f_right > 0.0):
            angles[count] = _wave_root(wave, left, right, f_left)
            count += 1
        elif (slope_left > 0.0) != (slope_right > 0.0) and (slope_left > 0.0) == (f_left < 0.0):
            low, high = left, right
            for _ in range(60):
                middle = 0.5 * (low + high)
                if (_wave_at(wave, middle)[1] > 0.0) == (slope_left > 0.0):
                    low = middle
                else:
                    high = middle
            middle = 0.5 * (low + high)
            f_middle = _wave_at(wave, middle)[0]
            if (f_middle > 0.0) != (f_left > 0.0):
                angles[count] = _wave_root(wave, left, middle, f_left)
                angles[count + 1] = _wave_root(wave, middle, right, f_middle)
                count += 2
            elif abs(f_middle) <= TOUCHES_ZERO * size:
                angles[count] = middle
                count += 1
        left, f_left, slope_left = right, f_right, slope_right
    return count


@internal
def _angles_with_base(a: Any, b: Any, mu: float, base: float, first: float, angles: Any) -> int:
    """Angles of sliding, to `angles`, where the normal force may be its least one; their number."""
    step, count = 2.0 * math.pi / ANGLES, 0
    left, f_left, ok_left = first - 0.5 * step, 0.0, False
    for k in range(ANGLES + 1):
        right = first + (k - 0.5) * step
        p, f, _ = _slide(a, b, mu, base, right)
        ok = p >= 0.0
        if k > 0 and ok and ok_left and (f > 0.0) != (f_left > 0.0):
            low, high, f_low = left, right, f_left
            for _ in range(60):
                middle = 0.5 * (low + high)
                _, f_middle, _ = _slide(a, b, mu, base, middle)
                if (f_middle > 0.0) == (f_low > 0.0):
                    low = middle
                else:
                    high = middle
            angles[count] = 0.5 * (low + high)
            count += 1
        left, f_left, ok_left = right, f, ok
    return count


@internal
def one_cone(a: Any, b: Any, mu: float, base: float) -> Any:
    """(found, P_N, P_1, P_2) of one contact whose friction is not known; a: inverse mass N N, N 1, N 2, 1 1, 1 2, 2 2,
    1/kg; b: motion without it."""
    if mu == 0.0 or not a[3] + a[5] > 0.0:
        p = max(base, -b[0] / a[0])
        return True, p, 0.0, 0.0
    if base == 0.0 and b[0] >= 0.0:
        return True, 0.0, 0.0, 0.0
    # it sticks: the tangents take what is left of the normal
    det = a[3] * a[5] - a[4] * a[4]
    if det > 1e-14 * a[3] * a[5]:
        n1, n2 = (a[5] * a[1] - a[4] * a[2]) / det, (a[3] * a[2] - a[4] * a[1]) / det
        m1, m2 = (a[5] * b[1] - a[4] * b[2]) / det, (a[3] * b[2] - a[4] * b[1]) / det
    else:
        # one tangent, or none, can move
        n1 = n2 = m1 = m2 = 0.0
        if a[3] >= a[5]:
            n1, m1 = a[1] / a[3], b[1] / a[3]
        else:
            n2, m2 = a[2] / a[5], b[2] / a[5]
    grows = a[0] - a[1] * n1 - a[2] * n2
    p = max(base, -(b[0] - a[1] * m1 - a[2] * m2) / grows) if grows > 1e-12 * a[0] else base
    p1, p2 = -m1 - n1 * p, -m2 - n2 * p
    if p >= base and p1 * p1 + p2 * p2 <= mu * mu * p * p:
        return True, p, p1, p2
    # it slides; most contacts, and all spheres, as they would without friction
    first = math.atan2(b[2], b[1])
    p, f, along = _slide(a, b, mu, base, first)
    if p >= 0.0 and along >= 0.0 and abs(f) <= 1e-16 * abs(along):
        return True, p, -mu * p * math.cos(first), -mu * p * math.sin(first)
    angles, wave = np.empty(2 * ANGLES), np.empty(5)
    count = _angles_with_base(a, b, mu, base, first, angles) if base > 0.0 else 0
    _wave(a, b, mu, wave)
    count = _roots_of_wave(wave, first, angles, count)
    best_angle, best, size = first, math.inf, abs(b[0]) + abs(b[1]) + abs(b[2])
    for k in range(count):
        p, f, along = _slide(a, b, mu, base, angles[k])
        if p < 0.0 or along < -SLIDES_BACK * size or abs(f) > SLIDES_BACK * (size + abs(along)):
            continue
        # of several the one that is nearest to the motion before
        away = angles[k] - first
        away = abs(away - 2.0 * math.pi * np.rint(away / (2.0 * math.pi))) + (0.0 if along >= 0.0 else 4.0)
        if away < best:
            best_angle, best = angles[k], away
    if best == math.inf:
        return False, 0.0, 0.0, 0.0
    p, _, _ = _slide(a, b, mu, base, best_angle)
    return True, p, -mu * p * math.cos(best_angle), -mu * p * math.sin(best_angle)


@internal
def _motion(a: Any, b: Any, p: Any, i: int) -> float:
    total = b[i]
    for j in range(len(b)):
        total += a[i, j] * p[j]
    return total


@internal
def _sweep(n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, part: float) -> Any:
    """(found, largest change, largest force) of one sweep over all contacts, each of which goes `part` of its way."""
    change, largest = 0.0, 0.0
    for i in range(n):
        j, k = n + i, 2 * n + i
        own = (a[i, i], a[i, j], a[i, k], a[j, j], a[j, k], a[k, k])
        old = p[i], p[j], p[k]
        rest_n, rest_1, rest_2 = _motion(a, b, p, i), _motion(a, b, p, j), _motion(a, b, p, k)
        rest_n -= own[0] * old[0] + own[1] * old[1] + own[2] * old[2]
        rest_1 -= own[1] * old[0] + own[3] * old[1] + own[4] * old[2]
        rest_2 -= own[2] * old[0] + own[4] * old[1] + own[5] * old[2]
        if known[i] != 0.0:
            grows = own[0] - mu[i] * (own[1] * way[0, i] + own[2] * way[1, i])
            if grows <= 0.0:
                return False, 0.0, 0.0
            p[i] = max(base[i], -rest_n / grows)
            p[j], p[k] = -mu[i] * p[i] * way[0, i], -mu[i] * p[i] * way[1, i]
        else:
            found, p[i], p[j], p[k] = one_cone(own, (rest_n, rest_1, rest_2), mu[i], base[i])
            if not found:
                return False, 0.0, 0.0
        change = max(change, abs(p[i] - old[0]), abs(p[j] - old[1]), abs(p[k] - old[2]))
        if part < 1.0:
            p[i], p[j], p[k] = (
                old[0] + part * (p[i] - old[0]),
                old[1] + part * (p[j] - old[1]),
                old[2] + part * (p[k] - old[2]),
            )
        largest = max(largest, p[i])
    return True, change, largest


@internal
def _residual(n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, r: Any, jac: Any) -> float:
    """P less its projection, and its derivative by P; the largest of it."""
    m, worst = 3 * n, 0.0
    for i in range(m):
        for j in range(m):
            jac[i, j] = 1.0 if i == j else 0.0
    for i in range(n):
        j, k = n + i, 2 * n + i
        step = 1.0 / a[i, i]
        trial = p[i] - step * _motion(a, b, p, i)
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
            x, y = p[j] - step * _motion(a, b, p, j), p[k] - step * _motion(a, b, p, k)
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
def _motion_left(n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any) -> float:
    """What is left of the motion that the conditions want otherwise, in parts of the largest motion without forces."""
    worst, largest = 0.0, 0.0
    for i in range(n):
        j, k = n + i, 2 * n + i
        largest = max(largest, abs(b[i]), abs(b[j]), abs(b[k]))
        trial = max(base[i], p[i] - _motion(a, b, p, i) / a[i, i])
        worst = max(worst, a[i, i] * abs(p[i] - trial))
        size, limit = a[j, j] + a[k, k], mu[i] * max(p[i], 0.0)
        if size == 0.0:
            continue
        if known[i] != 0.0:
            x, y = -limit * way[0, i], -limit * way[1, i]
        else:
            x, y = p[j] - _motion(a, b, p, j) / size, p[k] - _motion(a, b, p, k) / size
            length = math.sqrt(x * x + y * y)
            part = limit / length if length > limit else 1.0
            x, y = part * x, part * y
        worst = max(worst, size * abs(p[j] - x), size * abs(p[k] - y))
    return worst / largest if largest > 0.0 else 0.0


@internal
def _newton(
    least_norm: int, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, work: int
) -> float:
    """Semismooth Newton from p, which becomes the best point found: the residual there."""
    m = 3 * n
    jac, r, found = mat(work, m, m), mat(work + 8 * m * m, m, 1), mat(work + 8 * (m * m + m), m, 1)
    best, left = vec(work + 8 * (m * m + 2 * m), m), vec(work + 8 * (m * m + 3 * m), m)
    space, least = work + 8 * (m * m + 5 * m), math.inf
    tried = 0
    for _ in range(NEWTON):
        worst = _residual(n, a, b, mu, base, known, way, p, left, jac)
        if worst < least:
            least, tried = worst, 0
            for i in range(m):
                best[i], r[i, 0] = p[i], -left[i]
            if worst == 0.0:
                break
            call_least_norm(least_norm, jac, r, found, FRICTION_RANK, space)
        else:
            tried += 1
            if tried > HALVINGS:
                break
        for i in range(m):
            p[i] = best[i] + 0.5**tried * found[i, 0]
    for i in range(m):
        p[i] = best[i]
    return least


@internal
def _grow(least_norm: int, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, work: int) -> bool:
    """True if p, the forces, are found by Newton's method while friction grows from nothing to its coefficients."""
    less, before, grown, step = np.empty(n), np.empty(3 * n), 0.0, FIRST_GROWTH
    for i in range(n):
        less[i] = 0.0
        p[i], p[n + i], p[2 * n + i] = base[i], 0.0, 0.0
    for _ in range(GROWTH_SWEEPS):
        found, change, largest = _sweep(n, a, b, less, base, known, way, p, 1.0)
        if not found:
            return False
        if change <= FRICTION_ENOUGH * largest:
            break
    for _ in range(MOST_GROWTHS):
        for i in range(3 * n):
            before[i] = p[i]
        reached = min(grown + step, 1.0)
        for i in range(n):
            less[i] = reached * mu[i]
        _newton(least_norm, n, a, b, less, base, known, way, p, work)
        for i in range(n):
            p[i] = max(p[i], base[i])
        if _motion_left(n, a, b, less, base, known, way, p) <= FRICTION_GOOD:
            grown, step = reached, 2.0 * step
            if grown == 1.0:
                return True
            continue
        step *= 0.5
        if step < LEAST_GROWTH:
            break
        for i in range(3 * n):
            p[i] = before[i]
    return False


@internal
def solve_friction_cones(
    least_norm: int, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, work: int
) -> int:
    """Forces p (3 n,) of n contacts: normals, first and second tangents; FOUND or FAILED.

    Parameters
    ----------
    least_norm : address of `linalg.small.least_norm`.
    a, b : inverse masses (3 n, 3 n) and motion without forces (3 n,), in the same order.
    mu, base : coefficients and least normal forces (n,).
    known, way : where not 0, the contact slides along the direction `way` (2, n).
    work : address of `friction_cones_size` numbers.
    """
    for i in range(3 * n):
        p[i] = 0.0
    for i in range(n):
        p[i] = base[i]
    sweeps, wait, part, before, change, largest = 0, SWEEPS, 1.0, math.inf, 0.0, 0.0
    while sweeps < MOST_SWEEPS:
        for _ in range(wait):
            found, change, largest = _sweep(n, a, b, mu, base, known, way, p, part)
            sweeps += 1
            if not found:
                return FAILED
            if n == 1 or change <= FRICTION_ENOUGH * largest:
                return FOUND
        kept = vec(work + 8 * (9 * n * n + 12 * n), 3 * n)
        for i in range(3 * n):
            kept[i] = p[i]
        largest = 0.0
        left = _newton(least_norm, n, a, b, mu, base, known, way, p, work)
        for i in range(n):
            largest = max(largest, p[i])
        # directions that nearly repeat each other leave what they differ by
        for i in range(n):
            # less than the least by rounding would pull in the next problem
            p[i] = max(p[i], base[i])
        near = left <= FRICTION_NEAR * largest or (left <= FRICTION_GOOD * largest and left > 0.5 * before)
        if near and _motion_left(n, a, b, mu, base, known, way, p) <= FRICTION_MOTION:
            return FOUND
        before = left
        for i in range(3 * n):
            p[i] = kept[i]
        # sweeps that go round in circles come to rest with smaller steps
        wait, part = 2 * wait, max(0.5 * part, LEAST_PART)
    kept = vec(work + 8 * (9 * n * n + 12 * n), 3 * n)
    for i in range(3 * n):
        kept[i] = p[i]
    if _grow(least_norm, n, a, b, mu, base, known, way, p, work):
        return FOUND
    for i in range(3 * n):
        p[i] = kept[i]
    rough = change <= FRICTION_ROUGH * largest
    return FOUND if rough and _motion_left(n, a, b, mu, base, known, way, p) <= FRICTION_ROUGH else FAILED
