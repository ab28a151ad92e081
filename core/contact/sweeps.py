"""Forces of many contacts at once by sweeps over them, one contact after another.

Where contacts repeat each other, or nearly so (a stack of blocks), pivoting comes to its end by rounding. Sweeps
(nonlinear Gauss-Seidel, Jean and Moreau 1992; Jean 1999) go on from every estimate, and what they say of each contact
- open, stuck, sliding this way or that - soon stays the same. Then the equations of just that are solved directly.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import compiled, internal

Vector = NDArray[np.float64]
Flags = NDArray[np.bool_]

ROUNDS, FIRST_SWEEPS = 12, 20
"""How often the direct solution is tried, and how many sweeps come before the first trial; each time twice as many."""
SOLVED = 1e-12
"""Of the largest motion: what is left of the conditions is rounding."""
GOOD = 1e-7
"""Of the largest motion: with more left at the end, there is no solution. Where contacts repeat each other nearly, a
motion of this size would take forces beyond all measure to undo."""
AT_REST = 1e-9
"""Of the largest motion: contacts that move less than this stay together."""
RANK = 1e-13
"""Singular values below this part of the largest are zero."""
PSEUDO = 1e-10
"""The same of the block of friction that sticks."""


@internal
def one_contact(a: float, b: float, c: float, w_n: float, w_t: float, mu: float, direction: float, least: float) -> Any:
    """(N, T) of one contact whose motion without forces of its own is (w_n, w_t); N >= least. NaN if there are none."""
    if mu == 0.0:
        return max(least, -w_n / a), 0.0
    if direction != 0.0:
        pressing = a - mu * direction * b
        if pressing <= 0.0 and w_n + pressing * least < 0.0:
            return np.nan, np.nan
        normal = max(least, -w_n / pressing) if pressing > 0.0 else least
        return normal, -mu * direction * normal
    # no more than what it has in any case
    friction = -(w_t + b * least) / c if c > 0.0 else 0.0
    friction = min(max(friction, -mu * least), mu * least)
    if w_n + a * least + b * friction >= 0.0:
        return least, friction
    determinant = a * c - b * b
    if determinant > 1e-14 * a * c:
        normal, friction = (b * w_t - c * w_n) / determinant, (b * w_n - a * w_t) / determinant
        if normal >= least and abs(friction) <= mu * normal:
            return normal, friction
    elif c == 0.0:
        return -w_n / a, 0.0
    # the way in which the friction of a stuck contact gives way
    side = 1.0 if w_t - b / a * w_n > 0.0 else -1.0
    for _ in range(2):
        pressing = a - mu * side * b
        if pressing > 0.0:
            normal = max(-w_n / pressing, least)
            if side * (w_t + (b - mu * side * c) * normal) >= -1e-14 * (abs(w_t) + (abs(b) + mu * c) * normal):
                return normal, -mu * side * normal
        side = -side
    return np.nan, np.nan


@compiled
def sweep(
    nn: Any,
    nt: Any,
    tt: Any,
    b_n: Any,
    b_t: Any,
    mu: Any,
    direction: Any,
    base: Any,
    normal: Any,
    friction: Any,
    count: int,
) -> bool:
    """`count` sweeps over the contacts, from (`normal`, `friction`), which are overwritten. False if a contact has no
    solution of its own."""
    n = len(b_n)
    for _ in range(count):
        for i in range(n):
            w_n, w_t = b_n[i], b_t[i]
            for j in range(n):
                if j != i:
                    w_n += nn[i, j] * normal[j] + nt[i, j] * friction[j]
                    w_t += nt[j, i] * normal[j] + tt[i, j] * friction[j]
            alone = one_contact(nn[i, i], nt[i, i], tt[i, i], w_n, w_t, mu[i], direction[i], base[i])
            if not np.isfinite(alone[0]):
                return False
            normal[i], friction[i] = alone
    return True  # fmt: skip


class _Problem:
    """The conditions, and how far forces are from meeting them."""

    def __init__(
        self, nn: Vector, nt: Vector, tt: Vector, b_n: Vector, b_t: Vector, mu: Vector, direction: Vector, base: Vector
    ) -> None:
        self.nn, self.nt, self.tt, self.b_n, self.b_t = nn, nt, tt, b_n, b_t
        self.mu, self.direction, self.base = mu, direction, base
        self.a, self.c = np.diag(nn), np.where(np.diag(tt) > 0.0, np.diag(tt), 1.0)

    def motion(self, normal: Vector, friction: Vector) -> tuple[Vector, Vector]:
        """Along the normals and along the tangents."""
        return (
            self.b_n + self.nn @ normal + self.nt @ friction,
            self.b_t + self.nt.T @ normal + self.tt @ friction,
        )

    def left(self, normal: Vector, friction: Vector) -> float:
        """Largest residual of the conditions, as a motion."""
        w_n, w_t = self.motion(normal, friction)
        along = np.minimum((normal - self.base) * self.a, w_n)
        limit = self.mu * normal
        wanted = np.where(
            self.direction == 0.0, np.clip(friction - w_t / self.c, -limit, limit), -self.direction * limit
        )
        across = np.where(self.mu > 0.0, (friction - wanted) * self.c, 0.0)
        return float(max(np.max(np.abs(along)), np.max(np.abs(across))))

    def basic(self, normal: Vector, friction: Vector, size: float) -> tuple[Vector, Vector] | None:
        """Of the forces that make the same motion those that stand on no more contacts than it takes, with the least
        share of what friction allows; None if these are beyond its limits."""
        # importing scipy costs more than most runs: only who needs it pays
        from scipy.optimize import nnls

        w_n, w_t = self.motion(normal, friction)
        presses = np.abs(w_n) <= AT_REST * size
        free = (self.mu > 0.0) & (self.direction == 0.0) & presses
        sticks = free & (np.abs(w_t) <= AT_REST * size)
        ratio = np.where(free, -np.sign(w_t), -self.direction) * np.where(sticks, 0.0, self.mu)
        some, stuck = np.flatnonzero(presses), np.flatnonzero(sticks)
        friction = ratio * self.base
        w_n, w_t = self.motion(self.base, friction)
        inverse = np.linalg.pinv(self.tt[np.ix_(stuck, stuck)], rcond=PSEUDO, hermitian=True)
        across = self.nt[np.ix_(some, stuck)] @ inverse
        coupled = (self.nt.T[stuck] + self.tt[stuck] * ratio)[:, some]
        matrix = (self.nn[some] + self.nt[some] * ratio)[:, some] - across @ coupled
        try:
            more, _ = nnls(matrix, across @ w_t[stuck] - w_n[some])
        except RuntimeError:
            return None
        normal = self.base.copy()
        normal[some] += more
        friction = ratio * normal
        # each takes as much of what its normal force allows as the others that it shares with
        limit = self.mu[stuck] * normal[stuck]
        wanted = -(w_t[stuck] + coupled @ more)
        part = np.linalg.lstsq(self.tt[np.ix_(stuck, stuck)] * limit, wanted, rcond=PSEUDO)[0]
        friction[stuck] = limit * part
        return normal, friction

    def direct(self, normal: Vector, friction: Vector) -> tuple[Vector, Vector]:
        """Forces that solve the equations of what each contact does now, nearest to the given ones."""
        w_n, w_t = self.motion(normal, friction)
        presses = (normal - self.base) * self.a > w_n
        limit, proposed = self.mu * normal, friction - w_t / self.c
        free = (self.mu > 0.0) & (self.direction == 0.0)
        sticks = free & (np.abs(proposed) < limit)
        ratio = np.where(free, np.sign(proposed), -self.direction) * np.where(sticks, 0.0, self.mu)
        normal = np.where(presses, normal, self.base)
        return self._solved(presses, sticks, ratio, normal, np.where(sticks, friction, ratio * normal))

    def _solved(
        self, presses: Flags, sticks: Flags, ratio: Vector, normal: Vector, friction: Vector
    ) -> tuple[Vector, Vector]:
        """Forces, nearest to the given ones, with which contacts that press and that stick do not move; the friction of
        the others is `ratio` times their normal force."""
        w_n, w_t = self.motion(normal, friction)
        some, stuck = np.flatnonzero(presses), np.flatnonzero(sticks)
        # unknowns: the normal forces with the friction that goes with them, and friction that sticks
        of_normal = np.vstack([self.nn[some] + self.nt[some] * ratio, self.nt.T[stuck] + self.tt[stuck] * ratio])
        of_friction = np.vstack([self.nt[some], self.tt[stuck]])
        matrix = np.hstack([of_normal[:, some], of_friction[:, stuck]])
        change = np.linalg.lstsq(matrix, -np.concatenate([w_n[some], w_t[stuck]]), rcond=RANK)[0]
        normal = normal.copy()
        normal[some] = np.maximum(normal[some] + change[: len(some)], self.base[some])
        moved = friction.copy()
        moved[stuck] += change[len(some) :]
        return normal, np.where(sticks, moved, ratio * normal)


def solve_by_sweeps(
    nn: Vector, nt: Vector, tt: Vector, b_n: Vector, b_t: Vector, mu: Vector, direction: Vector, base: Vector
) -> tuple[Vector, Vector] | None:
    """Normal and tangential forces (n,) of n contacts, or None where none were found; arguments as in
    `complementarity.solve_contacts`, `base` (n,) being the least normal forces."""
    # of one type, for which `sweep` is compiled before the run
    nn, nt, tt, b_n, b_t, mu, direction, base = (
        np.ascontiguousarray(x, dtype=np.float64) for x in (nn, nt, tt, b_n, b_t, mu, direction, base)
    )
    problem = _Problem(nn, nt, tt, b_n, b_t, mu, direction, base)
    size = max(float(np.max(np.abs(b_n))), float(np.max(np.abs(b_t))))
    normal, friction = base.copy(), -direction * mu * base
    best, least = (normal, friction), np.inf
    count = FIRST_SWEEPS
    for _ in range(ROUNDS):
        if not sweep(nn, nt, tt, b_n, b_t, mu, direction, base, normal, friction, count):
            return None
        count *= 2
        for candidate in ((normal.copy(), friction.copy()), problem.direct(normal, friction)):
            left = problem.left(*candidate)
            if left < least:
                best, least = candidate, left
        if least <= SOLVED * size:
            break
    if not least <= GOOD * size:
        return None
    basic = problem.basic(*best, size)
    return basic if basic is not None and problem.left(*basic) <= max(least, 10.0 * SOLVED * size) else best
