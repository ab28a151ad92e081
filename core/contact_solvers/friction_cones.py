"""Forces (or impulses) of several contacts in space with Coulomb friction: exact cones, not polygons.

With w = b + A P, each contact with a normal and two tangential directions: 0 <= w_N, P_N - base >= 0, their product
0; |P_T| <= mu P_N, and P_T = -mu P_N w_T/|w_T| where w_T is not zero. Where a direction of sliding is known, P_T is
against it whatever w_T is.

One contact is solved by itself: it separates, sticks, or slides with the angle at which w_T and -P_T are parallel, a
root of one scalar function (`single_contact.py`). Several: sweeps of that over all contacts, and Newton's method on the
projections of Alart and Curnier (1991), P_N = max(base, P_N - r w_N), P_T = projection of P_T - r w_T on the disk
mu P_N, which is semismooth and ends in few steps; where it does not get nearer, sweeps go on, in smaller steps, until
nothing changes (Jourdan, Alart, Jean 1998). What these do not find is followed from forces of contacts that give way
(`continuation.py`).
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..linalg.single_rows import take_single_rows
from ..linalg.small import call_least_norm, least_norm_size
from ..rounding import (
    FRICTION_ENOUGH,
    FRICTION_FOLLOWED,
    FRICTION_GOOD,
    FRICTION_MOTION,
    FRICTION_NEAR,
    FRICTION_RANK,
    FRICTION_ROUGH,
    FRICTION_SOLVED,
)
from .continuation import EARLIER, FINER, FIRST_COMPLIANCE, MOST_LENGTH, TIMES, follow_cones, giving_way_size
from .patch_friction import solve_ball
from .projections import motion_left, motion_of, residual_of_cones
from .single_contact import solve_single_contact

CONES_FAILED, CONES_SOLVED = 0, 1
SWEEPS, MOST_SWEEPS = 20, 5000
NEWTON, HALVINGS = 60, 8
FOLLOWED_AFTER = 60
"""Sweeps, after which the path is tried once before more of them."""
LEAST_PART = 0.125
BALL_TURNS, BALL_STICKS = 3, 1e-9
"""How often, and in what part of the inverse masses, friction with three tangents brakes what is to stick."""


def friction_cones_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `solve_friction_cones` for n contacts."""
    m = 3 * n
    return m + max(m * m + 6 * m + least_norm_size(m, m, 1), giving_way_size(n))


@internal
def solve_three_tangents(n: int, a: Any, b: Any, p: Any, i: int, limit: float, part: float) -> float:
    """Friction along the tangents of contact i and the first one of the next, in a ball of radius `limit`, which goes
    `part` of its way; how far it would go."""
    rows, own, motion, found = (n + i, 2 * n + i, n + i + 1), np.zeros((4, 4)), np.zeros(4), np.zeros(4)
    own[0, 0] = 1.0
    for k in range(3):
        motion[1 + k] = motion_of(a, b, p, rows[k])
        for l in range(3):
            own[1 + k, 1 + l] = a[rows[k], rows[l]]
            motion[1 + k] -= own[1 + k, 1 + l] * p[rows[l]]
    step = np.zeros(4)
    for _ in range(BALL_TURNS):
        # what it leaves of the motion is stopped too
        sticks = solve_ball(own, motion, 1.0, limit, BALL_STICKS, step)
        size = 0.0
        for k in range(1, 4):
            found[k] += step[k]
            size += found[k] * found[k]
        if not sticks or size > limit * limit:
            break
        for k in range(1, 4):
            for l in range(1, 4):
                motion[k] += own[k, l] * step[l]
    change = 0.0
    for k in range(3):
        more = found[1 + k] - p[rows[k]]
        change = max(change, abs(more))
        p[rows[k]] += part * more
    return change


@internal
def sweep_over_cones(n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, part: float) -> Any:
    """(found, largest change, largest force) of one sweep over all contacts, each of which goes `part` of its way."""
    change, largest = 0.0, 0.0
    for i in range(n):
        j, k = n + i, 2 * n + i
        own = (a[i, i], a[i, j], a[i, k], a[j, j], a[j, k], a[k, k])
        old = p[i], p[j], p[k]
        rest_n, rest_1, rest_2 = motion_of(a, b, p, i), motion_of(a, b, p, j), motion_of(a, b, p, k)
        rest_n -= own[0] * old[0] + own[1] * old[1] + own[2] * old[2]
        rest_1 -= own[1] * old[0] + own[3] * old[1] + own[4] * old[2]
        rest_2 -= own[2] * old[0] + own[4] * old[1] + own[5] * old[2]
        if known[i] != 0.0:
            grows = own[0] - mu[i] * (own[1] * way[0, i] + own[2] * way[1, i])
            if grows <= 0.0:
                return False, 0.0, 0.0
            p[i] = max(base[i], -rest_n / grows)
            p[j], p[k] = -mu[i] * p[i] * way[0, i], -mu[i] * p[i] * way[1, i]
        elif way[2, i] != 0.0:
            # (a given load: no tangent moves its normal)
            p[i] = max(base[i], -rest_n / own[0])
            if way[2, i] > 0.0:
                change = max(change, solve_three_tangents(n, a, b, p, i, mu[i] * p[i], part))
            largest = max(largest, p[i])
            continue
        else:
            found, p[i], p[j], p[k] = solve_single_contact(own, (rest_n, rest_1, rest_2), mu[i], base[i])
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
def newton_on_cones(
    least_norm: int, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, work: int
) -> float:
    """Semismooth Newton from p, which becomes the best point found: the residual there."""
    m = 3 * n
    jac, right_at = mat(work, m, m), work + 8 * m * m
    best, left = vec(work + 8 * (m * m + 2 * m), m), vec(work + 8 * (m * m + 3 * m), m)
    kept, step = vec(work + 8 * (m * m + 4 * m), m), vec(work + 8 * (m * m + 5 * m), m)
    space, least = work + 8 * (m * m + 6 * m), math.inf
    tried = 0
    for _ in range(NEWTON):
        worst = residual_of_cones(n, a, b, mu, base, known, way, p, left, jac)
        if worst < least:
            least, tried, size = worst, 0, 0.0
            for i in range(m):
                best[i], step[i], size = p[i], -left[i], max(size, abs(p[i]))
            if worst <= FRICTION_SOLVED * size:
                break
            rest = take_single_rows(work, m, step, vec(right_at, m), kept)
            if rest > 0:
                of, right, found = mat(work, rest, rest), mat(right_at, rest, 1), mat(right_at + 8 * m, rest, 1)
                call_least_norm(least_norm, of, right, found, FRICTION_RANK, space)
                for i in range(rest):
                    step[int(kept[i])] = found[i, 0]
        else:
            tried += 1
            if tried > HALVINGS:
                break
        for i in range(m):
            p[i] = best[i] + 0.5**tried * step[i]
    for i in range(m):
        p[i] = best[i]
    return least


@internal
def _give_way(
    least_norm: int, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, work: int
) -> bool:
    """True if p, the forces, are found as those of contacts that give way less and less."""
    m, first, longest = 3 * n, FIRST_COMPLIANCE, MOST_LENGTH
    soft = mat(work, m, m)
    for _ in range(TIMES):
        for i in range(m):
            p[i] = base[i] if i < n else 0.0
            for j in range(m):
                soft[i, j] = a[i, j]
            soft[i, i] += first * a[i, i]
        for _ in range(MOST_SWEEPS):
            found, change, largest = sweep_over_cones(n, soft, b, mu, base, known, way, p, 1.0)
            if not found:
                return False
            if change <= FRICTION_FOLLOWED * largest:
                break
        if follow_cones(n, a, b, mu, base, known, way, p, first, longest, work):
            newton_on_cones(least_norm, n, a, b, mu, base, known, way, p, work)
            for i in range(n):
                p[i] = max(p[i], base[i])
            if motion_left(n, a, b, mu, base, known, way, p) <= FRICTION_GOOD:
                return True
        first, longest = EARLIER * first, FINER * longest
    return False


@internal
def solve_friction_cones(
    least_norm: int, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any, work: int, most: int
) -> int:
    """Forces p (3 n,) of n contacts: normals, first and second tangents; CONES_SOLVED or CONES_FAILED.

    Parameters
    ----------
    least_norm : address of `linalg.small.least_norm`.
    a, b : inverse masses (3 n, 3 n) and motion without forces (3 n,), in the same order; where normal forces come with
        torques, a is not symmetric.
    mu, base : coefficients and least normal forces (n,).
    known, way : where not 0, the contact slides along the direction `way` (3, n), whose third row says how far on the
        contact stands that has the third tangent of the same friction, or the first two: 1 or -1; 0: none.
    work : address of `friction_cones_size` numbers.
    most : sweeps, MOST_SWEEPS unless there is another way to the forces.
    """
    for i in range(3 * n):
        p[i] = 0.0
    for i in range(n):
        p[i] = base[i]
    # one whose normal force comes with a torque is solved by sweeps too, which have a symmetric matrix for it
    alone = n == 1 and a[0, 1] == a[1, 0] and a[0, 2] == a[2, 0]
    kept, work = vec(work, 3 * n), work + 24 * n
    sweeps, wait, part, before, change, largest, followed = 0, SWEEPS, 1.0, math.inf, 0.0, 0.0, False
    while sweeps < most:
        for _ in range(wait):
            found, change, largest = sweep_over_cones(n, a, b, mu, base, known, way, p, part)
            sweeps += 1
            if not found:
                return CONES_FAILED
            if alone or change <= FRICTION_ENOUGH * largest:
                return CONES_SOLVED
        for i in range(3 * n):
            kept[i] = p[i]
        largest = 0.0
        left = newton_on_cones(least_norm, n, a, b, mu, base, known, way, p, work)
        for i in range(n):
            largest = max(largest, p[i])
        # directions that nearly repeat each other leave what they differ by
        for i in range(n):
            # less than the least by rounding would pull in the next problem
            p[i] = max(p[i], base[i])
        near = left <= FRICTION_NEAR * largest or (left <= FRICTION_GOOD * largest and left > 0.5 * before)
        if near and motion_left(n, a, b, mu, base, known, way, p) <= FRICTION_MOTION:
            return CONES_SOLVED
        before = left
        if not followed and sweeps >= FOLLOWED_AFTER:
            followed = True
            if _give_way(least_norm, n, a, b, mu, base, known, way, p, work):
                return CONES_SOLVED
        for i in range(3 * n):
            p[i] = kept[i]
        # sweeps that go round in circles come to rest with smaller steps
        wait, part = 2 * wait, max(0.5 * part, LEAST_PART)
    rough = change <= FRICTION_ROUGH * largest
    return CONES_SOLVED if rough and motion_left(n, a, b, mu, base, known, way, p) <= FRICTION_ROUGH else CONES_FAILED
