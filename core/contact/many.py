"""Forces of many contacts at once, which may repeat each other: a stack of blocks, a body on many feet.

Where contacts repeat each other the forces are not unique, the equations of what each contact does are singular, and
rounding decides what pivoting finds. So a part eps of each contact's own inverse mass is added to it: each gives way a
little, and the forces are unique and continuous in what they follow from. With large eps Newton's method on the
conditions as equations without derivatives at a few places (Alart and Curnier 1991) ends within few iterations; eps is
then lowered step by step to nothing (Tikhonov 1963), each solution being the start of the next. What is found are the
forces that are least.
"""

from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from .sweeps import sweep

Vector = NDArray[np.float64]
Flags = NDArray[np.bool_]

FIRST, LAST = 0.1, 1e-8
"""Part of its own inverse mass by which each contact gives way, at first and at last."""
LOWER, LOWER_AT_LEAST = 0.03, 0.5
"""Factor from one part to the next; where Newton's method fails, its root is tried, but nothing above the second."""
ITERATIONS, SWEEPS = 60, 8
"""Of Newton's method; and sweeps where it goes in a circle, each time twice as many."""
CONVERGED = 1e-12
"""Of the largest motion: what is left of the conditions is rounding."""
NEAR = 1e-7
"""Of the largest motion: the same where a step along the path has failed if more is left."""
GOOD = 1e-7
"""Of the largest motion: with more left at the end, there is no solution. Where contacts repeat each other nearly, a
motion of this size would take forces beyond all measure to undo."""
STANDS = 1e-9
"""Of the largest motion: forces that stand on no more contacts than it takes may leave this."""
AT_REST = 1e-9
"""Of the largest motion: contacts that move less than this stay together."""
RANK = 1e-13
"""Singular values below this part of the largest are zero."""
PSEUDO = 1e-10
"""The same of the block of friction that sticks."""
NONE = 1e-12
"""Of the largest force: below it there is none."""
SAME = 1e-11
"""The same of normals that repeat one another."""


def shared(along: Vector, limit: Vector, wanted: Vector) -> Vector:
    """Friction that makes the motion `wanted` along the tangents (block `along` of the inverse masses): each contact
    takes as much of its limit as the others that it shares with, sum of friction^2/limit being least."""
    root = np.sqrt(limit)
    return np.asarray(root * np.linalg.lstsq(along * root, wanted, rcond=PSEUDO)[0])


def solve_many(
    nn: Vector, nt: Vector, tt: Vector, b_n: Vector, b_t: Vector, mu: Vector, direction: Vector, base: Vector
) -> tuple[Vector, Vector] | None:
    """Normal and tangential forces (n,) of n contacts, or None where none were found; arguments as in
    `complementarity.solve_contacts`, `base` (n,) being the least normal forces."""
    problem = _Problem(nn, nt, tt, b_n, b_t, mu, direction, base)
    if problem.size == 0.0:
        return base.copy(), -direction * mu * base
    forces = problem.follow()
    if forces is None:
        return None
    best, least = forces, problem.left(*forces)
    for _ in range(3):
        candidate = problem.direct(*best)
        left = problem.left(*candidate)
        if left >= least:
            break
        best, least = candidate, left
    if not least <= GOOD * problem.size:
        return None
    basic = problem.basic(*best)
    return basic if basic is not None and problem.left(*basic) <= max(least, STANDS * problem.size) else best


class _Problem:
    """The conditions, and how far forces are from meeting them."""

    def __init__(
        self, nn: Vector, nt: Vector, tt: Vector, b_n: Vector, b_t: Vector, mu: Vector, direction: Vector, base: Vector
    ) -> None:
        # of one type, for which `sweep` is compiled before the run
        arrays = (np.ascontiguousarray(x, dtype=np.float64) for x in (nn, nt, tt, b_n, b_t, mu, direction, base))
        self.nn, self.nt, self.tt, self.b_n, self.b_t, self.mu, self.direction, self.base = arrays
        self.count = len(self.b_n)
        self.a, self.c = np.diag(self.nn), np.where(np.diag(self.tt) > 0.0, np.diag(self.tt), 1.0)
        self.free = (self.mu > 0.0) & (self.direction == 0.0)
        self.size = max(float(np.max(np.abs(self.b_n))), float(np.max(np.abs(self.b_t))))

    def motion(self, normal: Vector, friction: Vector, eps: float = 0.0) -> tuple[Vector, Vector]:
        """Along the normals and along the tangents, with the part `eps` by which contacts give way."""
        return (
            self.b_n + self.nn @ normal + self.nt @ friction + eps * self.a * normal,
            self.b_t + self.nt.T @ normal + self.tt @ friction + eps * self.c * friction,
        )

    def left(self, normal: Vector, friction: Vector, eps: float = 0.0) -> float:
        """Largest residual of the conditions, as a motion."""
        w_n, w_t = self.motion(normal, friction, eps)
        along = np.minimum((normal - self.base) * self.a, w_n)
        limit = self.mu * normal
        wanted = np.where(self.free, np.clip(friction - w_t / self.c, -limit, limit), -self.direction * limit)
        across = np.where(self.mu > 0.0, (friction - wanted) * self.c, 0.0)
        return float(max(np.max(np.abs(along)), np.max(np.abs(across))))

    # ---- along the path ---------------------------------------------------------------------------------------------

    def follow(self) -> tuple[Vector, Vector] | None:
        """Forces where contacts give way by next to nothing; None if the path comes to an end."""
        forces = self.base.copy(), -self.direction * self.mu * self.base
        eps, factor = FIRST, LOWER
        forces, left = self.newton(*forces, eps)
        if left > NEAR * self.size:
            return None
        while eps > LAST:
            lower = max(factor * eps, LAST)
            found, left = self.newton(*forces, lower)
            if left <= NEAR * self.size:
                forces, eps = found, lower
            elif factor > LOWER_AT_LEAST:
                return None
            else:
                factor = np.sqrt(factor)
        return forces

    def newton(self, normal: Vector, friction: Vector, eps: float) -> tuple[tuple[Vector, Vector], float]:
        """The best forces of Newton's method for the part `eps`, from the given ones, and what they leave."""
        best, least = (normal, friction), self.left(normal, friction, eps)
        seen: set[bytes] = set()
        count = SWEEPS
        for _ in range(ITERATIONS):
            if least <= CONVERGED * self.size:
                break
            presses, sticks, ratio = self.does(normal, friction, eps)
            key = presses.tobytes() + sticks.tobytes() + ratio.tobytes()
            if key in seen:
                # it goes in a circle: sweeps lead out of it
                seen.clear()
                swept = self.swept(*best, eps, count)
                if swept is None:
                    break
                normal, friction = swept
                count *= 2
            else:
                seen.add(key)
                normal = np.where(presses, 0.0, self.base)
                normal, friction = self.solved(presses, sticks, ratio, normal, ratio * normal, eps)
            left = self.left(normal, friction, eps)
            if left < least:
                best, least = (normal, friction), left
        return best, least

    def does(self, normal: Vector, friction: Vector, eps: float = 0.0) -> tuple[Flags, Flags, Vector]:
        """Which contacts press, which of them stick, and what part of their normal force the friction of others is."""
        w_n, w_t = self.motion(normal, friction, eps)
        presses = (normal - self.base) * self.a > w_n
        limit, proposed = self.mu * np.maximum(normal, self.base), friction - w_t / self.c
        sticks = self.free & (np.abs(proposed) < limit)
        sides = np.where(self.free, np.sign(proposed), -self.direction)
        return presses, sticks, np.where(sticks, 0.0, sides * self.mu)

    def solved(
        self, presses: Flags, sticks: Flags, ratio: Vector, normal: Vector, friction: Vector, eps: float = 0.0
    ) -> tuple[Vector, Vector]:
        """Forces with which contacts that press and that stick do not move; the friction of the others is `ratio` times
        their normal force. Where they are not unique, those nearest to the given ones."""
        w_n, w_t = self.motion(normal, friction, eps)
        some, stuck = np.flatnonzero(presses), np.flatnonzero(sticks)
        # unknowns: the normal forces with the friction that goes with them, and friction that sticks
        of_normal = np.vstack([self.nn[some] + self.nt[some] * ratio, self.nt.T[stuck] + self.tt[stuck] * ratio])
        matrix = np.hstack([of_normal[:, some], np.vstack([self.nt[some], self.tt[stuck]])[:, stuck]])
        wanted = -np.concatenate([w_n[some], w_t[stuck]])
        if eps > 0.0:
            matrix[np.diag_indices(len(matrix))] += eps * np.concatenate([self.a[some], self.c[stuck]])
        change = _solve(matrix, wanted, eps > 0.0)
        normal, moved = normal.copy(), friction.copy()
        normal[some] += change[: len(some)]
        moved[stuck] += change[len(some) :]
        return normal, np.where(sticks, moved, ratio * normal)

    def swept(self, normal: Vector, friction: Vector, eps: float, count: int) -> tuple[Vector, Vector] | None:
        """The forces after `count` sweeps; None if a contact has no solution of its own."""
        nn, tt = self.nn.copy(), self.tt.copy()
        nn[np.diag_indices(self.count)] += eps * self.a
        tt[np.diag_indices(self.count)] += eps * np.diag(self.tt)
        normal, friction = np.maximum(normal, self.base), friction.copy()
        rest = self.nt, tt, self.b_n, self.b_t, self.mu, self.direction, self.base
        return (normal, friction) if sweep(nn, *rest, normal, friction, count) else None

    # ---- at its end -------------------------------------------------------------------------------------------------

    def direct(self, normal: Vector, friction: Vector) -> tuple[Vector, Vector]:
        """Forces that solve the equations of what each contact does now, nearest to the given ones."""
        presses, sticks, ratio = self.does(normal, friction)
        normal = np.where(presses, normal, self.base)
        normal, friction = self.solved(presses, sticks, ratio, normal, np.where(sticks, friction, ratio * normal))
        normal = np.maximum(normal, self.base)
        return normal, np.where(sticks, friction, ratio * normal)

    def basic(self, normal: Vector, friction: Vector) -> tuple[Vector, Vector] | None:
        """Of the forces that make the same motion those that stand on no more contacts than it takes, with the least
        share of what friction allows; None if there are none."""
        w_n, w_t = self.motion(normal, friction)
        presses = np.abs(w_n) <= AT_REST * self.size
        free = self.free & presses
        sticks = free & (np.abs(w_t) <= AT_REST * self.size)
        ratio = np.where(free, -np.sign(w_t), -self.direction) * np.where(sticks, 0.0, self.mu)
        some, stuck = np.flatnonzero(presses & (normal > self.base)), np.flatnonzero(sticks)
        along = self.tt[np.ix_(stuck, stuck)]
        across = self.nt[:, stuck] @ np.linalg.pinv(along, rcond=PSEUDO, hermitian=True)
        # with the friction that follows: of sliding contacts their part, of sticking ones what holds them
        matrix = self.nn + self.nt * ratio - across @ (self.nt.T[stuck] + self.tt[stuck] * ratio)
        normal = np.where(presses, np.maximum(normal, self.base), self.base)
        normal[some] = self.base[some] + _on_few(matrix[np.ix_(presses, some)], normal[some] - self.base[some])
        # the same contacts, free of the rounding that finding them has left
        loaded = normal > self.base
        start = ratio * normal
        normal, _ = self.solved(loaded, sticks & loaded, np.where(sticks, 0.0, ratio), normal, start)
        if np.any(normal < self.base - NONE * np.max(normal)):
            return None
        normal = np.maximum(normal, self.base)
        friction = ratio * normal
        _, w_t = self.motion(normal, friction)
        friction[stuck] = shared(along, self.mu[stuck] * normal[stuck], -w_t[stuck])
        return normal, friction


def _on_few(matrix: Vector, forces: Vector) -> Vector:
    """Positive `forces` that make the same motion with no more contacts than it takes: as long as columns of the
    matrix depend on one another, the forces are moved along that until one of them is zero."""
    if len(forces) == 0:
        return forces
    _, values, rows = np.linalg.svd(matrix)
    same = rows[int(np.sum(values > SAME * values[0])) :]
    forces, left = forces.copy(), np.arange(len(forces))
    for _ in range(len(same)):
        # the one that ends first on the way along a direction; of all directions, that with the largest part there
        reach = forces[left] / np.maximum(np.abs(same), 1e-300)
        ends = np.argmin(reach, axis=1)
        k = int(np.argmax(np.abs(same[np.arange(len(same)), ends]) / np.max(np.abs(same), axis=1)))
        i = int(ends[k])
        step = forces[left[i]] / same[k, i]
        forces[left] = np.maximum(forces[left] - step * same[k], 0.0)
        forces[left[i]] = 0.0
        rest = np.delete(same - np.outer(same[:, i] / same[k, i], same[k]), k, axis=0)
        same, left = np.delete(rest, i, axis=1), np.delete(left, i)
    return forces


def _solve(matrix: Vector, wanted: Vector, regular: bool) -> Vector:
    """The least solution; a `regular` matrix may still be singular where friction makes contacts jam."""
    if regular:
        with suppress(np.linalg.LinAlgError):
            return np.asarray(np.linalg.solve(matrix, wanted), dtype=np.float64)
    return np.asarray(np.linalg.lstsq(matrix, wanted, rcond=RANK)[0], dtype=np.float64)
