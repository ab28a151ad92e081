"""How a free rigid body turns: Euler's equations, by their Taylor series.

With the momentum m = J w about the centre of mass, in the body's axes, and the Euler parameters p of the body

    m' = m x w    p' = p w / 2    w = J^-1 m

are quadratic: each term of a series follows from products of the earlier ones. w is made of elliptic functions of nu t,
whose poles are at least pi / (2 nu) from any real time, with nu^2 = (J3 - J2) (L^2 - 2 T J1) / (J1 J2 J3), or the same
with J1 and J3 exchanged (Whittaker, Analytical dynamics, 1937, section 69). As no moment is larger than the sum of the
other two, nu <= |w| at any time. So in a part of LARGEST_PART rad terms fall at least like 0.27^k.
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.views import mat
from ..model.rotation3d import cross, dot
from .quaternions import normalised, put_four

LARGEST_PART = 0.42
"""By which the body turns within one series, rad."""
TERMS = 34
"""Most terms of a series: 0.42^TERMS of the distance of the poles is below rounding by far."""
NEGLIGIBLE = 1e-18
"""Where two terms in a row are less, relative, the series ends."""
SERIES_SIZE = 10 * (TERMS + 1)
"""Numbers of the memory that a series needs: terms of m, w and p."""
SYMMETRIC_SIZE = 6
"""Numbers of a symmetric matrix: xx, yy, zz, xy, xz, yz."""


@inlined
def symmetric_times(x: Any, i: int, y: Any) -> Any:
    """The symmetric matrix from x[i] on (`SYMMETRIC_SIZE`), times y (3)."""
    return (
        x[i] * y[0] + x[i + 3] * y[1] + x[i + 4] * y[2],
        x[i + 3] * y[0] + x[i + 1] * y[1] + x[i + 5] * y[2],
        x[i + 4] * y[0] + x[i + 5] * y[1] + x[i + 2] * y[2],
    )


@internal
def set_inertia(x: Any, i: int, inertia: Any) -> None:
    """J = `inertia` (6, kg m^2) to x from i on, and J^-1 behind it."""
    for j in range(SYMMETRIC_SIZE):
        x[i + j] = inertia[j]
    a, b, c, d, e, f = inertia[0], inertia[1], inertia[2], inertia[3], inertia[4], inertia[5]
    aa, dd, ee = b * c - f * f, e * f - c * d, d * f - b * e
    size = 1.0 / (a * aa + d * dd + e * ee)
    i += SYMMETRIC_SIZE
    x[i], x[i + 1], x[i + 2] = size * aa, size * (a * c - e * e), size * (a * b - d * d)
    x[i + 3], x[i + 4], x[i + 5] = size * dd, size * ee, size * (d * e - a * f)


@internal
def free_acceleration(x: Any, i: int, w: Any) -> Any:
    """w' of a free body that turns at w, both in its axes, with J and J^-1 from x[i] on."""
    return symmetric_times(x, i + SYMMETRIC_SIZE, cross(symmetric_times(x, i, w), w))


@internal
def _add_series(memory: int, x: Any, i: int, p: Any, w: Any, time: float) -> Any:
    """(p, w) after `time`, by one series."""
    terms, m = mat(memory, TERMS + 1, 10), symmetric_times(x, i, w)
    first = terms[0]
    first[0], first[1], first[2] = m
    first[3], first[4], first[5] = w
    put_four(first, 6, p)
    size, before, last = np.sqrt(dot(w, w)), 1.0, 0
    while last < TERMS:
        a0, a1, a2, b0, b1, b2, b3 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for j in range(last + 1):
            y, z = terms[j], terms[last - j]
            w0, w1, w2 = z[3], z[4], z[5]
            a0 += y[1] * w2 - y[2] * w1
            a1 += y[2] * w0 - y[0] * w2
            a2 += y[0] * w1 - y[1] * w0
            b0 -= y[7] * w0 + y[8] * w1 + y[9] * w2
            b1 += y[6] * w0 + y[8] * w2 - y[9] * w1
            b2 += y[6] * w1 + y[9] * w0 - y[7] * w2
            b3 += y[6] * w2 + y[7] * w1 - y[8] * w0
        last += 1
        factor, term = time / last, terms[last]
        m = (factor * a0, factor * a1, factor * a2)
        w = symmetric_times(x, i + SYMMETRIC_SIZE, m)
        factor *= 0.5
        p = (factor * b0, factor * b1, factor * b2, factor * b3)
        term[0], term[1], term[2] = m
        term[3], term[4], term[5] = w
        put_four(term, 6, p)
        now = max(
            (abs(w[0]) + abs(w[1]) + abs(w[2])) / size,
            abs(p[0]) + abs(p[1]) + abs(p[2]) + abs(p[3]),
        )
        if max(now, before) < NEGLIGIBLE:
            break
        before = now
    # the smallest first
    for k in range(last - 1, -1, -1):
        term = terms[k]
        w = (w[0] + term[3], w[1] + term[4], w[2] + term[5])
        p = (p[0] + term[6], p[1] + term[7], p[2] + term[8], p[3] + term[9])
    return p, w


@internal
def turn_freely(memory: int, x: Any, i: int, p: Any, w: Any, time: float) -> Any:
    """(p, w) of a free body `time` (s) after it has had the unit quaternion p and the angular velocity w (rad/s, in its
    axes), with J and J^-1 from x[i] on; `memory`: address of room for SERIES_SIZE numbers."""
    parts = int(np.ceil(abs(time) * np.sqrt(dot(w, w)) / LARGEST_PART))
    for _ in range(parts):
        p, w = _add_series(memory, x, i, p, w, time / parts)
        p = normalised(p)
    return p, w
