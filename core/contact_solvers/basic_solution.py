"""Of the forces that make the same motion, those that stand on no more contacts than it takes."""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, mat, vec
from ..linalg.small import add, null_space
from ..rounding import NO_FORCE, NORMALS_RANK, TOGETHER
from .conditions import PRESSING, STUCK, move, solve_for, solving_size
from .sticking_friction import hold_tangents, share, sticking_size


def basic_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `basic` for n contacts."""
    return 7 * n + max(4 * n * n + sticking_size(n), solving_size(n))


@internal
def basic(cn: Any, mu: Any, size: float, normal: Any, friction: Any, work: int) -> bool:
    """The given forces become those, with the least share of what friction allows; False if there are none. `size`: of
    the largest motion."""
    n, held, count = cn.n, 0, 0
    base, direction = vec(cn.base, n), vec(cn.direction, n)
    state, ratio, w_n, w_t = ivec(work, n), vec(work + 8 * n, n), vec(work + 16 * n, n), vec(work + 24 * n, n)
    sticks, loaded, forces = ivec(work + 32 * n, n), ivec(work + 40 * n, n), vec(work + 48 * n, n)
    work += 56 * n
    move(cn, normal, friction, 0.0, w_n, w_t)
    for i in range(n):
        state[i] = PRESSING if abs(w_n[i]) <= TOGETHER * size else 0
        free = mu[i] > 0.0 and direction[i] == 0.0 and state[i] & PRESSING != 0
        ratio[i] = -mu[i] * (np.sign(w_t[i]) if free else direction[i])
        if free and abs(w_t[i]) <= TOGETHER * size:
            ratio[i] = 0.0
            state[i] |= STUCK
            sticks[held] = i
            held += 1
        normal[i] = max(normal[i], base[i]) if state[i] & PRESSING else base[i]
        if normal[i] > base[i]:
            loaded[count] = i
            forces[count] = normal[i] - base[i]
            count += 1
    stuck, some = sticks[:held], loaded[:count]
    if count > 0:
        _reduced(cn, state, ratio, stuck, some, forces[:count], work)
    # the same contacts, free of the rounding that finding them has left
    for k in range(count):
        normal[some[k]] = base[some[k]] + forces[k]
    for i in range(n):
        if not normal[i] > base[i]:
            state[i] = 0
        friction[i] = ratio[i] * normal[i]
    solve_for(cn, state, ratio, normal, friction, 0.0, work)
    largest = 0.0
    for i in range(n):
        largest = max(largest, normal[i])
    for i in range(n):
        if not normal[i] >= base[i] - NO_FORCE * largest:
            return False
        normal[i] = max(normal[i], base[i])
        friction[i] = ratio[i] * normal[i]
    move(cn, normal, friction, 0.0, w_n, w_t)
    # (the motion of the normals is needed no more)
    limit, wanted, found = w_n[:held], mat(work, held, 1), mat(work + 8 * held, held, 1)
    for k in range(held):
        limit[k], wanted[k, 0] = mu[stuck[k]] * normal[stuck[k]], -w_t[stuck[k]]
    share(cn, stuck, limit, wanted, found, work + 16 * held)
    for k in range(held):
        friction[stuck[k]] = found[k, 0]
    return True


@inlined
def _reduced(cn: Any, state: Any, ratio: Any, stuck: Any, some: Any, forces: Any, work: int) -> None:
    """`forces` (beyond the base) of the contacts `some` on no more of them than it takes for the motion of all that
    stay together."""
    n, count, rows = cn.n, len(some), 0
    for i in range(n):
        rows += 1 if state[i] & PRESSING else 0
    block = mat(work, rows, count)
    work += 8 * n * n
    matrix, tn, across = mat(work, n, n), mat(work + 8 * n * n, n, n), mat(work + 16 * n * n, len(stuck), n)
    nn, nt, tt = mat(cn.nn, n, n), mat(cn.nt, n, n), mat(cn.tt, n, n)
    # with the friction that follows: of sliding contacts their part, of sticking ones what holds them
    for i in range(n):
        for j in range(n):
            matrix[i, j], tn[i, j] = nn[i, j] + nt[i, j] * ratio[j], nt[j, i] + tt[i, j] * ratio[j]
    hold_tangents(cn, stuck, tn, matrix, across, work + 24 * n * n)
    row = 0
    for i in range(n):
        if state[i] & PRESSING:
            for j in range(count):
                block[row, j] = matrix[i, some[j]]
            row += 1
    same = mat(work, count, count)
    left = null_space(block, same, NORMALS_RANK, work + 8 * count * count)
    _on_few(same, left, forces, ivec(work + 8 * count * count, count))


@internal
def _on_few(same: Any, count: int, forces: Any, numbers: Any) -> None:
    """Positive `forces` that make the same motion with no more contacts than it takes: as long as there are directions
    without motion, the first `count` rows of `same`, the forces are moved along one until one of them is zero.
    `numbers`: scratch, one for each force."""
    left = len(forces)
    for i in range(left):
        numbers[i] = i
    while count > 0:
        # the one that ends first on the way along a direction; of all directions, that with the largest part there
        most, row, end = -1.0, 0, 0
        for k in range(count):
            first, reach, largest = 0, np.inf, 0.0
            for i in range(left):
                size = abs(same[k, i])
                largest = max(largest, size)
                if forces[numbers[i]] / max(size, 1e-300) < reach:
                    first, reach = i, forces[numbers[i]] / max(size, 1e-300)
            if abs(same[k, first]) > most * largest:
                most, row, end = abs(same[k, first]) / max(largest, 1e-300), k, first
        step = forces[numbers[end]] / same[row, end]
        for i in range(left):
            forces[numbers[i]] = max(forces[numbers[i]] - step * same[row, i], 0.0)
        forces[numbers[end]] = 0.0
        # the others without that force
        count, left = count - 1, left - 1
        for k in range(count + 1):
            if k != row:
                add(same[k], -same[k, end] / same[row, end], same[row])
        for i in range(left + 1):
            same[row, i] = same[count, i]
        for k in range(count):
            for i in range(end, left):
                same[k, i] = same[k, i + 1]
        for i in range(end, left):
            numbers[i] = numbers[i + 1]
