"""Of all forces that contacts may have, those of least norm: the limit of equally compliant contacts.

Where contacts repeat each other, w = b + A P is solved by many P. Contacts that are compliant by the same small part
eps have w = b + (A + eps C) P, whose solution is unique; with eps -> 0 its part along a null vector n of A,
n^T C P = -n^T b/eps = 0, is right at any eps, since b is a motion that bodies can have. So eps is brought down from
where the problem is well conditioned (Tikhonov 1963), and what is left, a power series in eps, is extrapolated to zero
(Richardson 1911).
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..linalg.single_rows import take_single_rows
from ..linalg.small import solve_square
from ..rounding import FRICTION_EXACT, FRICTION_GOOD, FRICTION_NEAR
from .friction_cones import newton_on_cones
from .projections import motion_left, residual_of_cones

FIRST, LOWER, LAST = 10.0, 0.01, 1e-5
"""Compliance in parts of the largest inverse mass: at first, where contacts hardly feel each other and Newton's method
finds the forces from none at all, in whatever order they are listed; factor from one to the next; and at last."""
LARGEST_STEPS = 0.9
"""Of that factor, whose root is taken where Newton's method does not follow: beyond, there is no way."""
NEARER, NEAREST = 0.1, 1e-10
"""Factor from the last one to the next where what a contact does changes on the way, and the least of all."""
SETTLED = 1e-9
"""Of the largest force: forces of two compliances that differ by less are those of the limit, and less is no force."""
ITERATIONS = 40


def least_forces_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `take_least_forces` for n contacts, beside that of `newton_on_cones`."""
    m = 3 * n
    return 2 * m * m + 8 * m


@internal
def _follow(
    n: int, soft: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, jac_at: int, left: Any, best: Any
) -> bool:
    """Newton's method on compliant contacts from p, which becomes the best point; True if that solves the problem. It
    goes on down to rounding: forces that repeat each other count in the residual by their compliance only."""
    m, least, size = 3 * n, math.inf, 0.0
    jac, right, kept = mat(jac_at, m, m), vec(jac_at + 8 * m * m, m), vec(jac_at + 8 * (m * m + m), m)
    for _ in range(ITERATIONS):
        worst = residual_of_cones(n, soft, b, mu, base, known, way, p, left, jac)
        if worst < least:
            least, size = worst, 0.0
            for i in range(3 * n):
                best[i] = p[i]
                size = max(size, abs(p[i]))
        elif least <= FRICTION_NEAR * size:
            break
        rest = take_single_rows(jac_at, m, left, right, kept)
        if solve_square(mat(jac_at, rest, rest), vec(jac_at + 8 * m * m, rest)) == 0:
            break
        for i in range(rest):
            left[int(kept[i])] = right[i]
        for i in range(3 * n):
            p[i] -= left[i]
    for i in range(3 * n):
        p[i] = best[i]
    return least <= FRICTION_NEAR * size


@internal
def _soften(m: int, a: Any, part: float, largest: float, soft: Any) -> None:
    for i in range(m):
        for j in range(m):
            soft[i, j] = a[i, j]
        soft[i, i] += part * largest


@internal
def _near_the_limit(
    least_norm: int, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, last: Any, work: int
) -> bool:
    """Forces p from those of the least compliance before, `last`: followed with less and less, until what is left of
    the way, gone by the least increments, solves the problem and no longer changes; False, with p as it was, where that
    is never so. Friction at its limit makes what is left a series in the compliance too, and rounding makes it grow
    again: of two in a row those that differ least are extrapolated."""
    m, largest, part, size = 3 * n, 0.0, NEARER * LAST, 0.0
    soft, jac_at = mat(work, m, m), work + 8 * m * m
    at = jac_at + 8 * (m * m + 2 * m)
    left, best, own, before = vec(at, m), vec(at + 8 * m, m), vec(at + 16 * m, m), vec(at + 24 * m, m)
    times, differed = 0, math.inf
    for i in range(m):
        largest = max(largest, a[i, i])
    while part >= 0.5 * NEAREST:
        _soften(m, a, part, largest, soft)
        if not _follow(n, soft, b, mu, base, known, way, last, jac_at, left, best):
            break
        part *= NEARER
        for i in range(m):
            own[i] = last[i]
        if not _solve_rigid(least_norm, n, a, b, mu, base, known, way, own, at + 48 * m):
            continue
        differs = 0.0
        for i in range(m):
            differs, size = max(differs, abs(own[i] - before[i])), max(size, abs(own[i]))
        if times > 0 and differs >= differed:
            break
        for i in range(m):
            if times > 0:
                p[i] = own[i] + NEARER / (1.0 - NEARER) * (own[i] - before[i])
            else:
                p[i] = own[i]
            before[i] = own[i]
        if times > 0:
            differed = differs
        times += 1
        if differed <= SETTLED * size:
            break
    if times == 0:
        return False
    for i in range(m):
        own[i] = p[i]
    if _solve_rigid(least_norm, n, a, b, mu, base, known, way, own, at + 48 * m):
        for i in range(m):
            p[i] = own[i]
    else:
        for i in range(m):
            p[i] = before[i]
    return True


@internal
def _solve_rigid(
    least_norm: int, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, work: int
) -> bool:
    """Forces p of contacts that are not compliant, by the least increments; True if they solve the problem."""
    newton_on_cones(least_norm, n, a, b, mu, base, known, way, p, work)
    for i in range(n):
        p[i] = max(p[i], base[i])
    return bool(motion_left(n, a, b, mu, base, known, way, p) <= FRICTION_GOOD)


@internal
def take_least_forces(
    least_norm: int, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, work: int
) -> bool:
    """Forces of least norm in place of the forces p (3 n,), as of `solve_friction_cones`; False, with p as it was,
    where the way to them is not found."""
    m, largest = 3 * n, 0.0
    soft, jac_at = mat(work, m, m), work + 8 * m * m
    at = jac_at + 8 * (m * m + 2 * m)
    left, best, own = vec(at, m), vec(at + 8 * m, m), vec(at + 16 * m, m)
    once, twice, last = vec(at + 24 * m, m), vec(at + 32 * m, m), vec(at + 40 * m, m)
    for i in range(m):
        largest, own[i] = max(largest, a[i, i]), base[i] if i < n else 0.0
    part, good, lower = FIRST, FIRST, LOWER
    while True:
        for i in range(m):
            twice[i], once[i] = once[i], own[i]
        _soften(m, a, part, largest, soft)
        if not _follow(n, soft, b, mu, base, known, way, own, jac_at, left, best):
            # from the one before in a smaller step
            for i in range(m):
                own[i], once[i] = once[i], twice[i]
            if good < 5.0 * LAST:
                break
            lower = math.sqrt(lower)
            if part == FIRST or lower > LARGEST_STEPS:
                return False
            part = max(lower * good, 4.0 * LAST)
            continue
        if part < 1.5 * LAST:
            break
        # the last three are for four times, twice and once the least compliance
        good = part
        part = 0.5 * part if part < 5.0 * LAST else max(lower * part, 4.0 * LAST)
    size = 0.0
    for i in range(m):
        last[i] = own[i]
        own[i] = (8.0 * own[i] - 6.0 * once[i] + twice[i]) / 3.0
    for i in range(n):
        own[i] = max(own[i], base[i])
        size = max(size, own[i])
    if not residual_of_cones(n, a, b, mu, base, known, way, own, left, mat(jac_at, m, m)) <= FRICTION_EXACT * size:
        # what a contact does changes nearer to the limit
        if not _near_the_limit(least_norm, n, a, b, mu, base, known, way, p, last, work):
            return False
    else:
        for i in range(m):
            p[i] = own[i]
    _drop_noise(n, a, b, mu, base, known, way, p, own)
    return True


@internal
def _drop_noise(n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, own: Any) -> None:
    """Forces p without those that the limit does not tell from none, if they solve the problem. `own` (3 n,): room."""
    size, any_dropped = 0.0, False
    for i in range(n):
        size = max(size, p[i] - base[i])
    for i in range(3 * n):
        own[i] = p[i]
    for i in range(n):
        if 0.0 < p[i] - base[i] <= SETTLED * size and (known[i] != 0.0 or base[i] == 0.0):
            any_dropped, own[i] = True, base[i]
            own[n + i], own[2 * n + i] = -mu[i] * base[i] * way[0, i], -mu[i] * base[i] * way[1, i]
    if any_dropped and motion_left(n, a, b, mu, base, known, way, own) <= FRICTION_GOOD:
        for i in range(3 * n):
            p[i] = own[i]
