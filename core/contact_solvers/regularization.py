"""Forces of many contacts at once, which may repeat each other: a stack of blocks, a body on many feet.

Where contacts repeat each other the forces are not unique, the equations of what each contact does are singular, and
rounding decides what pivoting finds. So a part eps of each contact's own inverse mass is added to it: each gives way a
little, and the forces are unique and continuous in what they follow from. With large eps Newton's method on the
conditions as equations without derivatives at a few places (Alart and Curnier 1991) ends within few iterations; eps is
then lowered step by step to nothing (Tikhonov 1963), each solution being the start of the next. What is found are the
forces that are least.

The functions take the record of the problem (`planar_contacts.py`) and the coefficients of friction that count, mu
(n,).
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.views import imat, ivec, vec
from ..rounding import CONES_CONVERGED, CONES_GOOD, CONES_NEAR, TOGETHER
from .conditions import (
    BELOW_LIMITS,
    NONE,
    PRESSES,
    SOLVED,
    STICKING,
    does,
    largest_motion,
    left,
    move,
    solve_for,
    solving_size,
)
from .sweeps import sweep

FIRST, LAST = 0.1, 1e-8
"""Part of its own inverse mass by which each contact gives way, at first and at last."""
LOWER, LOWER_AT_LEAST = 0.03, 0.5
"""Factor from one part to the next; where Newton's method fails, its root is tried, but nothing above the second."""
ITERATIONS, SWEEPS, MOST_SWEEPS = 60, 8, 1024
"""Of Newton's method; and sweeps where it goes in a circle, each time twice as many, but not more at once."""
DIRECT = 3
"""Solutions at most of the equations without eps, at the end."""


def many_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `solve_many` for n contacts."""
    return (6 + ITERATIONS) * n + solving_size(n)


@internal
def by_limit(cn: Any, mu: Any, work: int) -> int:
    """The solution as the limit of those with contacts that give way: SOLVED or BELOW_LIMITS; NONE if the path to it
    ends."""
    n, size, some = cn.n, largest_motion(cn), False
    if not _solve(cn, mu, size, work):
        return NONE
    normal, direction, w_t = vec(cn.normal, n), vec(cn.direction, n), vec(cn.tangential_motion, n)
    move(cn, normal, vec(cn.tangential, n), 0.0, vec(cn.normal_motion, n), w_t)
    for i in range(n):
        if mu[i] > 0.0 and direction[i] == 0.0 and normal[i] > 0.0:
            some = True
            if not abs(w_t[i]) <= TOGETHER * size:
                return SOLVED
    return BELOW_LIMITS if some else SOLVED


@inlined
def _solve(cn: Any, mu: Any, size: float, work: int) -> bool:
    """Normal and tangential forces, the base in them; False where none were found."""
    n = cn.n
    normal, friction = vec(cn.normal, n), vec(cn.tangential, n)
    other, other_friction = vec(work, n), vec(work + 8 * n, n)
    work += 16 * n
    base, direction = vec(cn.base, n), vec(cn.direction, n)
    for i in range(n):
        normal[i], friction[i] = base[i], -direction[i] * mu[i] * base[i]
    if size == 0.0:
        return True
    if not _follow(cn, mu, size, other, other_friction, work):
        return False
    least = left(cn, mu, normal, friction, 0.0, work)
    for _ in range(DIRECT):
        _copy(normal, friction, other, other_friction)
        _direct(cn, mu, other, other_friction, work)
        now = left(cn, mu, other, other_friction, 0.0, work)
        if not now < least:
            break
        _copy(other, other_friction, normal, friction)
        least = now
    return bool(least <= CONES_GOOD * size)


@internal
def _copy(normal: Any, friction: Any, to_normal: Any, to_friction: Any) -> None:
    for i in range(len(normal)):
        to_normal[i], to_friction[i] = normal[i], friction[i]


@inlined
def _follow(cn: Any, mu: Any, size: float, other: Any, other_friction: Any, work: int) -> bool:
    """Forces where contacts give way by next to nothing, from those in the record; False if the path comes to an end.
    `other`, `other_friction`: scratch."""
    normal, friction = vec(cn.normal, cn.n), vec(cn.tangential, cn.n)
    eps, lower, factor = 0.0, FIRST, LOWER
    while eps == 0.0 or eps > LAST:
        _copy(normal, friction, other, other_friction)
        if _newton(cn, mu, size, other, other_friction, lower, work) <= CONES_NEAR * size:
            _copy(other, other_friction, normal, friction)
            eps = lower
        elif eps > 0.0 and factor <= LOWER_AT_LEAST:
            factor = np.sqrt(factor)
        else:
            return False
        lower = max(factor * eps, LAST)
    return True


@internal
def _newton(cn: Any, mu: Any, size: float, best: Any, best_friction: Any, eps: float, work: int) -> float:
    """The best forces of Newton's method for the part `eps`, from the given ones, and what they leave."""
    n, base = cn.n, vec(cn.base, cn.n)
    normal, friction, seen = vec(work, n), vec(work + 8 * n, n), imat(work + 16 * n, ITERATIONS, n)
    work += 8 * (2 + ITERATIONS) * n
    state, ratio = ivec(work, n), vec(work + 8 * n, n)
    _copy(best, best_friction, normal, friction)
    least = left(cn, mu, best, best_friction, eps, work)
    met, count = 0, SWEEPS
    for _ in range(ITERATIONS):
        if least <= CONES_CONVERGED * size:
            break
        does(cn, mu, normal, friction, eps, state, ratio, work + 16 * n)
        if _is_among(seen, met, state):
            # it goes in a circle: sweeps lead out of it
            met = 0
            for i in range(n):
                normal[i], friction[i] = max(best[i], base[i]), best_friction[i]
            if not sweep(cn, mu, normal, friction, eps, count):
                break
            count = min(2 * count, MOST_SWEEPS)
        else:
            for i in range(n):
                seen[met, i] = state[i]
                normal[i] = 0.0 if state[i] & PRESSES else base[i]
                friction[i] = ratio[i] * normal[i]
            met += 1
            solve_for(cn, state, ratio, normal, friction, eps, work + 16 * n)
        now = left(cn, mu, normal, friction, eps, work + 16 * n)
        if now < least:
            _copy(normal, friction, best, best_friction)
            least = now
    return least


@internal
def _is_among(seen: Any, count: int, state: Any) -> bool:
    for k in range(count):
        same = True
        for i in range(len(state)):
            if seen[k, i] != state[i]:
                same = False
                break
        if same:
            return True
    return False


@internal
def _direct(cn: Any, mu: Any, normal: Any, friction: Any, work: int) -> None:
    """Forces that solve the equations of what each contact does now, nearest to the given ones, which they replace."""
    n, base = cn.n, vec(cn.base, cn.n)
    state, ratio = ivec(work, n), vec(work + 8 * n, n)
    does(cn, mu, normal, friction, 0.0, state, ratio, work + 16 * n)
    for i in range(n):
        if not state[i] & PRESSES:
            normal[i] = base[i]
        if not state[i] & STICKING:
            friction[i] = ratio[i] * normal[i]
    solve_for(cn, state, ratio, normal, friction, 0.0, work + 16 * n)
    for i in range(n):
        normal[i] = max(normal[i], base[i])
        if not state[i] & STICKING:
            friction[i] = ratio[i] * normal[i]
