"""Impulses of many contacts by sweeps over their rows, one after another, as changes of the motion.

Nonlinear Gauss-Seidel with projections (Jourdan, Alart and Jean 1998; Jean 1999): each row takes the impulse that
brings its rate to zero, the normal one not below zero, the tangential ones and the torques against rolling within
circles of the present normal one, that against spinning within its limit, or with the tangential ones within a ball,
where friction on a patch is one. No matrix of all contacts is formed: each contact knows its gradients, and the motions
that unit impulses along them cause.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from .contact_blocks import WIDE, move_normal, normal_rate, sweep_contacts


@internal
def sweep_rows(
    count: int, tangents: int, turns: bool, rows: int, n: int, wholes: Any, reals: Any, masses: Any, off: Any,
    arms: Any, p: Any, x: Any, work: Any, tolerance: float, most: int,
) -> Any:  # fmt: skip
    """Impulses p (rows,) of `count` contacts, and the change x (n,) of the motion that they cause; both go on from what
    they are. Until no rate changes by more than `tolerance` (m/s) in a sweep, but at most so many: how many there were,
    and by how much a rate changed in the last.

    Rows are normals, first and second tangents, two across the normal and one along it against turning, as many of them
    as `tangents` and `turns` say. off, masses, arms (rows,): rates without the impulses, the rows' inverse masses, 0
    where a row takes none, and how far they may go, in parts of the normal impulse; an arm of -r against spinning: that
    of a patch of friction radius r, with the tangents. wholes, reals: the blocks of `contact_blocks.pack_block`.
    work (2 rows + 2 n,).

    Sweeps are extrapolated with Nesterov's factors, which begin anew where the way would turn back (O'Donoghue and
    Candes 2015; for contacts Mazhar et al. 2015). The last sweep goes nowhere else: its impulses lie within their
    limits.
    """
    stages, weight, local, end = 4 if turns else 2, 1.0, np.zeros(2 * WIDE), rows + n
    for e in range(end):
        work[e] = work[end + e] = p[e] if e < rows else x[e - rows]
    for turn in range(most):
        change = sweep_contacts(count, tangents, stages, rows, wholes, reals, masses, off, arms, p, x, local)
        if change <= tolerance or turn == most - 1:
            return turn + 1, change
        back = 0.0
        for r in range(rows):
            back += masses[r] * (work[end + r] - p[r]) * (p[r] - work[r])
        after = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * weight * weight))
        further, weight = (0.0, 1.0) if back > 0.0 else ((weight - 1.0) / after, after)
        for e in range(end):
            here = p[e] if e < rows else x[e - rows]
            begins = here + further * (here - work[e])
            work[e], work[end + e] = here, begins
            if e < rows:
                p[e] = begins
            else:
                x[e - rows] = begins
    return 0, np.inf


@internal
def _motion(count: int, p: Any, wholes: Any, reals: Any, n: int, x: Any) -> None:
    """x = the motion that the normal impulses p cause."""
    for j in range(n):
        x[j] = 0.0
    for i in range(count):
        if p[i] != 0.0:
            move_normal(i, count, wholes, reals, p[i], x)


@internal
def press_apart(
    count: int, rows: int, n: int, wholes: Any, reals: Any, masses: Any, gaps: Any, p: Any, x: Any, work: Any,
    tolerance: float, most: int,
) -> bool:  # fmt: skip
    """Least motion x (n,) along the normals that leaves none of the `gaps` (rows,) below -`tolerance`; p (rows,): how
    much each normal has pressed. True if it was found in so many turns.

    Sweeps find which normals press, conjugate gradients how much these do: a quadratic problem with bounds (as MPRGP
    of Dostal and Schoeberl 2005 turns from one to the other). work : (3 rows + n,).
    """
    rest, way, product, motion = work[:rows], work[rows : 2 * rows], work[2 * rows : 3 * rows], work[3 * rows :]
    for j in range(n):
        x[j] = 0.0
    for i in range(count):
        p[i] = 0.0
    for _ in range(most):
        for _ in range(5):
            for i in range(count):
                if masses[i] > 0.0:
                    step = max(-(gaps[i] + normal_rate(i, count, wholes, reals, x)) / masses[i], -p[i])
                    if step != 0.0:
                        p[i] += step
                        move_normal(i, count, wholes, reals, step, x)
        worst, size = 0.0, 0.0
        for i in range(count):
            left = gaps[i] + normal_rate(i, count, wholes, reals, x)
            worst = max(worst, -left, left if p[i] > 0.0 else 0.0)
            rest[i] = -left if p[i] > 0.0 else 0.0
            way[i] = rest[i]
            size += rest[i] * rest[i]
        if worst <= tolerance:
            return True
        for _ in range(2 * count):
            if not size > 0.0:
                break
            _motion(count, way, wholes, reals, n, motion)
            of_way = 0.0
            for i in range(count):
                product[i] = normal_rate(i, count, wholes, reals, motion) if p[i] > 0.0 else 0.0
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
