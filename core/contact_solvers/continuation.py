"""Forces of contacts that give way, followed until they give way no more, along a path that may turn back.

A part eps of each contact's own inverse mass is added to it. With a large part, contacts hardly feel each other and
the forces are found at once; with none they are those asked for (Tikhonov 1963). Where friction lets contacts wedge
each other the forces are no function of eps: as eps falls one contact reaches its limit, and beyond that there are no
forces nearby. They go on, but with eps growing again, until others reach their limits. So not eps is the parameter but
the length along the path (Riks 1979; Allgower and Georg 1990, chapters 2 and 6). Where the path has a kink, its
direction is the one in which the determinant of the equations and the direction keeps its sign, which is also how
pivoting for linear complementarity goes on (Lemke 1965; Eaves 1976).
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..linalg.small import solve_square
from ..rounding import FRICTION_FOLLOWED
from .projections import residual_of_cones

FIRST_COMPLIANCE, LAST_COMPLIANCE = 0.1, 1e-8
"""Part of its own inverse mass by which each contact gives way, at first and at last."""
FIRST_LENGTH, MOST_LENGTH, LEAST_LENGTH = 0.02, 0.2, 1e-10
"""Of a step along the path, in which forces count in parts of the largest one up to there."""
TIMES, EARLIER, FINER = 3, 10.0, 0.25
"""A long step may end on another path, which leads back: then once more from a larger part, in shorter steps."""
LONGER, SHORTER = 1.7, 0.4
"""Factors of the next step after one that has met the path, and after one that has not."""
SPAN = 10.0
"""A unit of length is so much of the logarithm of eps."""
STEPS, CORRECTIONS = 600, 12
FARTHEST = 3.0
"""A path that comes back to e^3 of the first part leads nowhere."""
BESIDE = 1e-6
"""Difference of the logarithm of eps for derivatives by it."""


def giving_way_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `follow_cones` for n contacts."""
    m = 3 * n
    return 2 * m * m + (m + 1) ** 2 + 9 * (m + 1)


@internal
def _soften(m: int, a: Any, eps: float, soft: Any) -> None:
    for i in range(m):
        for j in range(m):
            soft[i, j] = a[i, j]
        soft[i, i] += eps * a[i, i]


@internal
def _equations(
    n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, log: float, work: int
) -> float:
    """What p (3 n,) leaves at this logarithm of eps, to `left`, its derivatives (m, m + 1) by the forces and by
    log/SPAN, to the top of the bordered matrix; the largest that is left."""
    m = 3 * n
    soft, jac, bordered = _matrices(m, work)
    left, other = vec(work + 8 * (2 * m * m + (m + 1) ** 2), m), vec(work + 8 * (2 * m * m + (m + 1) ** 2 + m), m)
    _soften(m, a, math.exp(log + BESIDE), soft)
    residual_of_cones(n, soft, b, mu, base, known, way, p, left, jac)
    _soften(m, a, math.exp(log - BESIDE), soft)
    residual_of_cones(n, soft, b, mu, base, known, way, p, other, jac)
    for i in range(m):
        bordered[i, m] = SPAN * (left[i] - other[i]) / (2.0 * BESIDE)
    _soften(m, a, math.exp(log), soft)
    worst = residual_of_cones(n, soft, b, mu, base, known, way, p, left, jac)
    for i in range(m):
        for j in range(m):
            bordered[i, j] = jac[i, j]
    return float(worst)


@internal
def _matrices(m: int, work: int) -> Any:
    return mat(work, m, m), mat(work + 8 * m * m, m, m), mat(work + 16 * m * m, m + 1, m + 1)


@internal
def _turn(m: int, size: float, bordered: Any, border: Any, right: Any, way_on: Any, orientation: int) -> int:
    """Direction (m + 1,) in which the path goes on, to `way_on`, from the derivatives in `bordered`, which are
    overwritten, and the direction before, whose products are in `border`. `orientation`: sign of the determinant that
    stays, 0 if that is yet to be found: eps falls at first. Returns it; 0 if there is no direction."""
    for j in range(m + 1):
        bordered[m, j], right[j] = border[j], 0.0
    right[m] = 1.0
    sign = solve_square(bordered, right)
    if sign == 0:
        return 0
    length = right[m] * right[m]
    for j in range(m):
        length += (right[j] / size) ** 2
    if orientation == 0:
        orientation = -sign if right[m] > 0.0 else sign
    factor = orientation * sign / math.sqrt(length)
    for j in range(m + 1):
        way_on[j] = factor * right[j]
        border[j] = way_on[j] if j == m else way_on[j] / (size * size)
    return orientation


@internal
def follow_cones(
    n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, first: float, longest: float, work: int
) -> bool:
    """Forces p (3 n,), as of `solve_friction_cones`, of contacts that give way by LAST_COMPLIANCE, from those that give
    way by `first`, which p is. False if the path to them is not found.

    longest : of its steps.
    """
    m = 3 * n
    _, _, bordered = _matrices(m, work)
    at = work + 8 * (2 * m * m + (m + 1) ** 2)
    left, right = vec(at, m), vec(at + 16 * m, m + 1)
    way_on, border, here = (
        vec(at + 8 * (3 * m + 1), m + 1),
        vec(at + 8 * (4 * m + 2), m + 1),
        vec(at + 8 * (5 * m + 3), m),
    )
    log, length, size = math.log(first), min(FIRST_LENGTH, longest), 0.0
    for i in range(m):
        size, border[i] = max(size, abs(p[i])), 0.0
    border[m] = 1.0
    if not size > 0.0:
        return False
    _equations(n, a, b, mu, base, known, way, p, log, work)
    orientation = _turn(m, size, bordered, border, right, way_on, 0)
    if orientation == 0:
        return False
    for _ in range(STEPS):
        there, met = log + length * way_on[m] * SPAN, False
        for i in range(m):
            here[i] = p[i]
            p[i] += length * way_on[i]
        for _ in range(CORRECTIONS):
            worst, off = _equations(n, a, b, mu, base, known, way, p, there, work), -length
            for i in range(m):
                off += border[i] * (p[i] - here[i])
            off += border[m] * (there - log) / SPAN
            if worst <= FRICTION_FOLLOWED * size and abs(off) <= FRICTION_FOLLOWED:
                met = True
                break
            for j in range(m + 1):
                bordered[m, j] = border[j]
                right[j] = -off if j == m else -left[j]
            if solve_square(bordered, right) == 0:
                break
            for i in range(m):
                p[i] += right[i]
            there += SPAN * right[m]
            if not abs(there) < 60.0:
                break
        if not met:
            for i in range(m):
                p[i] = here[i]
            length *= SHORTER
            if length < LEAST_LENGTH:
                return False
            continue
        log = there
        if log <= math.log(LAST_COMPLIANCE):
            return True
        for i in range(m):
            size = max(size, abs(p[i]))
        if log > math.log(first) + FARTHEST or _turn(m, size, bordered, border, right, way_on, orientation) == 0:
            return False
        length = min(LONGER * length, longest)
    return False
