"""How the contact of two axes makes way for contacts of their ends where they lie side by side: of capsules, of edges.

Nearly parallel the nearest points of two axes run from end to end as the capsules turn a little; parallel, these touch
along a line, whose ends are ends of capsules. So below a small angle, of the sine `tilt`, the gap of the axes grows by
BACK (R_a + R_b) (1 - u)^3, u the squared sine over the squared tilt, and contacts of the ends carry.
"""

import math
from typing import Any

from ..compiled.jit import inlined, internal
from ..elements.measure3d import AXES_A, AXES_B, add_bent
from ..model.rotation3d import constant, dot, four, less, onto, times, turned, turning

BACK = 2e-3
"""Of the sum of the radii."""
STEEPEST = 6.0 * math.sqrt(0.2) * 0.8**2
"""Of BACK (R_a + R_b)/tilt: the largest change by an angle, where u = 1/5."""


@inlined
def back_by(c: float, tilt: float, radii: float) -> float:
    """By how much the gap is larger, m, where c is the cosine of the angle."""
    rest = 1.0 - (1.0 - c * c) / (tilt * tilt)
    return BACK * radii * rest**3 if rest > 0.0 else 0.0


@internal
def draw_back(q: Any, coord: Any, held: Any, tilt: float, radii: float, gradient: Any, hessian: Any) -> float:
    """By how much the gap is larger, m; its derivatives are added to gradient (14,) and hessian (14, 14)."""
    p, s = four(q, coord, 3, held[0]), four(q, coord, 10, held[1])
    axis_a, axis_b = constant(held, AXES_A + 6), constant(held, AXES_B + 6)
    of_a, of_b = turning(p, axis_a), turning(s, axis_b)
    a, b = turned(of_a, p), turned(of_b, s)
    # the square of the sine; longer axes, where the norm of Euler parameters is not 1, do not turn
    aa, bb, c, square, deep = dot(a, a), dot(b, b), dot(a, b), tilt * tilt, BACK * radii
    rest = 1.0 - (aa * bb - c * c) / square
    if rest <= 0.0:
        return 0.0
    first, second = -3.0 * deep * rest * rest / square, 6.0 * deep * rest / (square * square)
    from_b, from_a = less(times(bb, a), times(c, b)), less(times(aa, b), times(c, a))
    by_p, by_s = onto(of_a, from_b), onto(of_b, from_a)
    c_p, c_s, aa_p, bb_s = onto(of_a, b), onto(of_b, a), onto(of_a, a), onto(of_b, b)
    for i in range(4):
        gradient[3 + i] += 2.0 * first * by_p[i]
        gradient[10 + i] += 2.0 * first * by_s[i]
        for j in range(4):
            of_p = bb * dot(of_a[i], of_a[j]) - c_p[i] * c_p[j]
            of_s = aa * dot(of_b[i], of_b[j]) - c_s[i] * c_s[j]
            hessian[3 + i, 3 + j] += 2.0 * first * of_p + 4.0 * second * by_p[i] * by_p[j]
            hessian[10 + i, 10 + j] += 2.0 * first * of_s + 4.0 * second * by_s[i] * by_s[j]
            mixed = 2.0 * aa_p[i] * bb_s[j] - c_p[i] * c_s[j] - c * dot(of_a[i], of_b[j])
            mixed = 2.0 * first * mixed + 4.0 * second * by_p[i] * by_s[j]
            hessian[3 + i, 10 + j] += mixed
            hessian[10 + j, 3 + i] += mixed
    add_bent(hessian, 3, 2.0 * first, from_b, axis_a)
    add_bent(hessian, 10, 2.0 * first, from_a, axis_b)
    return deep * rest**3
