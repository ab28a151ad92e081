"""The conditions of several contacts: how far forces are from meeting them, what each contact does with them, and the
forces that belong to what contacts do.

The functions take the record of the problem (`planar_contacts.py`) and the coefficients of friction that count, mu
(n,); `eps` is the part of its own inverse mass by which each contact gives way (`regularization.py`).
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..linalg.small import add, call_least_norm, dot, least_norm_size, solve_square
from ..rounding import CONDITIONS_RANK

NONE, SOLVED, BELOW_LIMITS = range(3)
"""What solvers return: there are no forces; there are; there are, and all friction was found below its limit at once,
shared in proportion to what the contacts allow."""
PRESSES, STICKING, RIGHT, LEFT = 1, 2, 4, 8
"""What a contact does: bits of its state. The last two tell to which side the friction of one that does not stick
goes."""


def solving_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `left`, `does` and `solve_for` for n contacts."""
    return 4 * n * n + 8 * n + least_norm_size(2 * n, 2 * n, 1)


@internal
def largest_motion(cn: Any) -> float:
    """Of any contact, without contact forces."""
    size = 0.0
    for i in range(cn.n):
        size = max(size, abs(vec(cn.b_n, cn.n)[i]), abs(vec(cn.b_t, cn.n)[i]))
    return size


@internal
def tangential_mass(cn: Any, i: int) -> float:
    """Inverse mass of contact i along its tangent; 1 where it has none."""
    c = mat(cn.tt, cn.n, cn.n)[i, i]
    return c if c > 0.0 else 1.0


@internal
def move(cn: Any, normal: Any, friction: Any, eps: float, w_n: Any, w_t: Any) -> None:
    """Motion along the normals and along the tangents, each (n,)."""
    n = cn.n
    nn, nt, tt = mat(cn.nn, n, n), mat(cn.nt, n, n), mat(cn.tt, n, n)
    for i in range(n):
        w_n[i] = vec(cn.b_n, n)[i] + dot(nn[i], normal) + dot(nt[i], friction) + eps * nn[i, i] * normal[i]
        w_t[i] = vec(cn.b_t, n)[i] + dot(tt[i], friction) + eps * tangential_mass(cn, i) * friction[i]
    for j in range(n):
        add(w_t, normal[j], nt[j])


@internal
def left(cn: Any, mu: Any, normal: Any, friction: Any, eps: float, work: int) -> float:
    """Largest residual of the conditions, as a motion; infinite for forces that are no numbers."""
    n, largest = cn.n, 0.0
    nn, direction, base = mat(cn.nn, n, n), vec(cn.direction, n), vec(cn.base, n)
    w_n, w_t = vec(work, n), vec(work + 8 * n, n)
    move(cn, normal, friction, eps, w_n, w_t)
    for i in range(n):
        along, across = abs(min((normal[i] - base[i]) * nn[i, i], w_n[i])), 0.0
        if mu[i] > 0.0:
            c, limit = tangential_mass(cn, i), mu[i] * normal[i]
            wanted = -direction[i] * limit
            if direction[i] == 0.0:
                wanted = min(max(friction[i] - w_t[i] / c, -limit), limit)
            across = abs((friction[i] - wanted) * c)
        if not (np.isfinite(normal[i]) and np.isfinite(along + across)):
            return np.inf
        largest = max(largest, along, across)
    return largest


@internal
def does(cn: Any, mu: Any, normal: Any, friction: Any, eps: float, state: Any, ratio: Any, work: int) -> None:
    """State of each contact, (n,) int64, and what part of its normal force the friction of those that do not stick is,
    (n,)."""
    n = cn.n
    nn, direction, base = mat(cn.nn, n, n), vec(cn.direction, n), vec(cn.base, n)
    w_n, w_t = vec(work, n), vec(work + 8 * n, n)
    move(cn, normal, friction, eps, w_n, w_t)
    for i in range(n):
        state[i] = PRESSES if (normal[i] - base[i]) * nn[i, i] > w_n[i] else 0
        ratio[i] = -direction[i] * mu[i]
        if mu[i] > 0.0 and direction[i] == 0.0:
            proposed = friction[i] - w_t[i] / tangential_mass(cn, i)
            ratio[i] = mu[i] * np.sign(proposed)
            if abs(proposed) < mu[i] * max(normal[i], base[i]):
                ratio[i] = 0.0
                state[i] |= STICKING
        if ratio[i] != 0.0:
            state[i] |= RIGHT if ratio[i] > 0.0 else LEFT


@internal
def _equations(
    cn: Any, some: Any, stuck: Any, ratio: Any, w_n: Any, w_t: Any, eps: float, matrix: Any, wanted: Any
) -> None:
    """Of the normal forces of `some`, with the friction that goes with them, and of the friction of `stuck`."""
    n, first = cn.n, len(some)
    nn, nt, tt = mat(cn.nn, n, n), mat(cn.nt, n, n), mat(cn.tt, n, n)
    for k in range(first):
        i = some[k]
        wanted[k, 0] = -w_n[i]
        for j in range(first):
            matrix[k, j] = nn[i, some[j]] + nt[i, some[j]] * ratio[some[j]]
        for j in range(len(stuck)):
            matrix[k, first + j] = nt[i, stuck[j]]
        matrix[k, k] += eps * nn[i, i]
    for k in range(len(stuck)):
        i, row = stuck[k], first + k
        wanted[row, 0] = -w_t[i]
        for j in range(first):
            matrix[row, j] = nt[some[j], i] + tt[i, some[j]] * ratio[some[j]]
        for j in range(len(stuck)):
            matrix[row, first + j] = tt[i, stuck[j]]
        matrix[row, row] += eps * tangential_mass(cn, i)


@internal
def solve_for(cn: Any, state: Any, ratio: Any, normal: Any, friction: Any, eps: float, work: int) -> None:
    """Forces with which contacts that press and that stick do not move; the friction of the others is `ratio` times
    their normal force. Where they are not unique, those nearest to the given ones, which they replace."""
    n, count, held = cn.n, 0, 0
    w_n, w_t, presses, sticks = vec(work, n), vec(work + 8 * n, n), ivec(work + 16 * n, n), ivec(work + 24 * n, n)
    work += 32 * n
    move(cn, normal, friction, eps, w_n, w_t)
    for i in range(n):
        if state[i] & PRESSES:
            presses[count] = i
            count += 1
        if state[i] & STICKING:
            sticks[held] = i
            held += 1
    some, stuck, size = presses[:count], sticks[:held], count + held
    matrix, wanted = mat(work, size, size), mat(work + 8 * size * size, size, 1)
    change = mat(work + 8 * size * (size + 1), size, 1)
    _equations(cn, some, stuck, ratio, w_n, w_t, eps, matrix, wanted)
    # where contacts give way the matrix is regular, but for friction that makes contacts jam
    if eps > 0.0 and solve_square(matrix, vec(work + 8 * size * size, size)) != 0:
        change = wanted
    else:
        _equations(cn, some, stuck, ratio, w_n, w_t, eps, matrix, wanted)
        call_least_norm(cn.least_norm, matrix, wanted, change, CONDITIONS_RANK, work + 8 * size * (size + 2))
    for k in range(count):
        normal[some[k]] += change[k, 0]
    for k in range(held):
        friction[stuck[k]] += change[count + k, 0]
    for i in range(n):
        if not state[i] & STICKING:
            friction[i] = ratio[i] * normal[i]
