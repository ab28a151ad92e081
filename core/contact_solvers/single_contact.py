"""Force (or impulse) of one contact in space with Coulomb friction: it separates, sticks, or slides with the angle at
which its sliding and its friction are parallel, a root of one scalar function."""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal

ANGLES = 48
"""Parts of a turn in which the angle of sliding is looked for."""
TOUCHES_ZERO, SLIDES_BACK = 1e-13, 1e-10
"""Of the terms: a value at an extremum that is zero; and of the motion: sliding that is none, where a contact is
between sticking and sliding."""


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
def solve_single_contact(a: Any, b: Any, mu: float, base: float) -> Any:
    """(found, P_N, P_1, P_2) of one contact whose friction is not known; a: inverse mass N N, N 1, N 2, 1 1, 1 2, 2 2,
    1/kg; b: motion without it."""
    if mu == 0.0 or not a[3] + a[5] > 0.0:
        p = max(base, -b[0] / a[0])
        return True, p, 0.0, 0.0
    if base == 0.0 and b[0] >= 0.0:
        return True, 0.0, 0.0, 0.0
    # it sticks: the tangents take what is left of the normal
    det, prescribed = a[3] * a[5] - a[4] * a[4], False
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
        # what goes on along the other one no friction stops
        across = b[2] - a[4] * m1 if a[3] >= a[5] else b[1] - a[4] * m2
        prescribed = abs(across) > SLIDES_BACK * (abs(b[0]) + abs(b[1]) + abs(b[2]))
    grows = a[0] - a[1] * n1 - a[2] * n2
    p = max(base, -(b[0] - a[1] * m1 - a[2] * m2) / grows) if grows > 1e-12 * a[0] else base
    p1, p2 = -m1 - n1 * p, -m2 - n2 * p
    if p >= base and p1 * p1 + p2 * p2 <= mu * mu * p * p and not prescribed:
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
