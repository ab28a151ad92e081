"""Impulses of many contacts by sweeps over their rows, one after another, as changes of the motion.

Nonlinear Gauss-Seidel with projections (Jourdan, Alart and Jean 1998; Jean 1999): each row takes the impulse that
brings its rate to zero, the normal one not below zero, the tangential ones and the torques against rolling within
circles of the present normal one, that against spinning within its limit, or with the tangential ones within a ball,
where friction on a patch is one. No matrix of all contacts is formed: each row knows its gradient, and the motion that
a unit impulse along it causes.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, mat
from .contact_blocks import WIDE, sweep_contacts


@internal
def list_columns(rows: int, n: int, directions: Any, responses: Any, columns: int) -> None:
    """Which entries of each row are not zero, to `columns` (2, rows, n + 1): first how many."""
    of_directions, of_responses = imat(columns, rows, n + 1), imat(columns + 8 * rows * (n + 1), rows, n + 1)
    for r in range(rows):
        some, others = 0, 0
        for j in range(n):
            if directions[r, j] != 0.0:
                some += 1
                of_directions[r, some] = j
            if responses[r, j] != 0.0:
                others += 1
                of_responses[r, others] = j
        of_directions[r, 0], of_responses[r, 0] = some, others


@internal
def along(r: int, n: int, rows: int, columns: int, directions: Any, x: Any) -> float:
    """Product of the gradient of row r with x (n,), by the entries of the gradient that `list_columns` has found."""
    return _along(r, directions, imat(columns, rows, n + 1), x)


@internal
def _along(r: int, directions: Any, where: Any, x: Any) -> float:
    product = 0.0
    for e in range(1, where[r, 0] + 1):
        product += directions[r, where[r, e]] * x[where[r, e]]
    return float(product)


@internal
def _move(r: int, impulse: float, responses: Any, where: Any, x: Any) -> None:
    for e in range(1, where[r, 0] + 1):
        x[where[r, e]] += impulse * responses[r, where[r, e]]


@internal
def sweep_rows(
    count: int, tangents: int, turns: bool, rows: int, n: int, wholes: Any, reals: Any, masses: Any, off: Any,
    arms: Any, p: Any, x: Any, work: Any, tolerance: float, most: int,
) -> int:  # fmt: skip
    """Impulses p (rows,) of `count` contacts, and the change x (n,) of the motion that they cause; both go on from what
    they are. Until no rate changes by more than `tolerance` in a sweep, but at most so many: how many there were.

    Rows are normals, first and second tangents, two across the normal and one along it against turning, as many of them
    as `tangents` and `turns` say. off, masses, arms (rows,): rates without the impulses, the rows' inverse masses, 0
    where a row takes none, and how far they may go, in parts of the normal impulse; an arm of -r against spinning: that
    of a patch of friction radius r, with the tangents. wholes, reals: the blocks of `contact_blocks.pack_contacts`.
    work (2 rows + 2 n,).

    What a sweep changes is taken for the negative gradient of a function, and the way on is that of nonlinear
    conjugate gradients (Silcowitz-Hansen, Niebe and Erleben 2010, with Fletcher's and Reeves's factor); where changes
    do not become smaller it begins anew. The last sweep goes nowhere else: its impulses lie within their limits.
    """
    stages, before, local = 4 if turns else 2, 0.0, np.zeros(2 * WIDE)
    for e in range(rows + n):
        work[e], work[rows + n + e] = p[e] if e < rows else x[e - rows], 0.0
    for turn in range(most):
        change = sweep_contacts(count, tangents, stages, rows, wholes, reals, masses, off, arms, p, x, local)
        if change <= tolerance:
            return turn + 1
        size = 0.0
        for r in range(rows):
            size += masses[r] * (p[r] - work[r]) ** 2
        further = size / before if 0.0 < size <= before and turn < most - 2 else 0.0
        for e in range(rows + n):
            here, way = p[e] if e < rows else x[e - rows], further * work[rows + n + e]
            work[rows + n + e] = way + here - work[e] if further > 0.0 or turn == 0 else 0.0
            work[e] = here + way
            if e < rows:
                p[e] += way
            else:
                x[e - rows] += way
        before = size
    return most


@internal
def _motion(count: int, p: Any, responses: Any, where: Any, n: int, x: Any) -> None:
    """x = the motion that the normal impulses p cause."""
    for j in range(n):
        x[j] = 0.0
    for i in range(count):
        if p[i] != 0.0:
            _move(i, p[i], responses, where, x)


@internal
def press_apart(
    count: int, rows: int, n: int, directions_at: int, responses_at: int, columns: int, masses: Any, gaps: Any, p: Any,
    x: Any, work: Any, tolerance: float, most: int,
) -> bool:  # fmt: skip
    """Least motion x (n,) along the normals that leaves none of the `gaps` (rows,) below -`tolerance`; p (rows,): how
    much each normal has pressed. True if it was found in so many turns.

    Sweeps find which normals press, conjugate gradients how much these do: a quadratic problem with bounds (as MPRGP
    of Dostal and Schoeberl 2005 turns from one to the other). work : (3 rows + n,).
    """
    directions, responses = mat(directions_at, rows, n), mat(responses_at, rows, n)
    to_read, to_move = imat(columns, rows, n + 1), imat(columns + 8 * rows * (n + 1), rows, n + 1)
    rest, way, product, motion = work[:rows], work[rows : 2 * rows], work[2 * rows : 3 * rows], work[3 * rows :]
    for j in range(n):
        x[j] = 0.0
    for i in range(count):
        p[i] = 0.0
    for _ in range(most):
        for _ in range(5):
            for i in range(count):
                if masses[i] > 0.0:
                    step = max(-(gaps[i] + _along(i, directions, to_read, x)) / masses[i], -p[i])
                    if step != 0.0:
                        p[i] += step
                        _move(i, step, responses, to_move, x)
        worst, size = 0.0, 0.0
        for i in range(count):
            left = gaps[i] + _along(i, directions, to_read, x)
            worst = max(worst, -left, left if p[i] > 0.0 else 0.0)
            rest[i] = -left if p[i] > 0.0 else 0.0
            way[i] = rest[i]
            size += rest[i] * rest[i]
        if worst <= tolerance:
            return True
        for _ in range(2 * count):
            if not size > 0.0:
                break
            _motion(count, way, responses, to_move, n, motion)
            of_way = 0.0
            for i in range(count):
                product[i] = _along(i, directions, to_read, motion) if p[i] > 0.0 else 0.0
                of_way += product[i] * way[i]
            if not of_way > 0.0:
                break
            length, before, out = size / of_way, size, False
            for i in range(count):
                if way[i] < 0.0 and p[i] + length * way[i] < 0.0:
                    length, out = min(length, p[i] / -way[i]), True
            size = 0.0
            for i in range(count):
                p[i] = max(p[i] + length * way[i], 0.0) if way[i] != 0.0 else p[i]
                rest[i] -= length * product[i]
                size += rest[i] * rest[i] if p[i] > 0.0 else 0.0
            for j in range(n):
                x[j] += length * motion[j]
            if out or np.sqrt(size) <= 0.1 * tolerance:
                break
            for i in range(count):
                way[i] = rest[i] + size / before * way[i] if p[i] > 0.0 else 0.0
    return False
