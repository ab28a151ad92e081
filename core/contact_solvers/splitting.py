"""First-order method for contact problems with friction: alternating directions with multipliers (ADMM).

Glowinski and Marrocco (1975), Gabay and Mercier (1976); with over-relaxation, Eckstein and Bertsekas (1992). With the
forces on one side of the splitting and their projections on the cones on the other, an iteration is a solution with the
matrix W + rho, which stays, and a projection. The term mu |u_t| of de Saxce and Feng follows from the velocities of the
iteration before.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import splu

from .friction_problem import FrictionProblem, Vector, lengths

RELAXATION = 1.6
EVERY = 10
"""Iterations from one look at the residual to the next."""
BALANCE_AT, UNBALANCED, MOST_CHANGE = 50, 5.0, 10.0
"""Iterations to the first change of rho, twice as many to each later one; ratio of the two residuals above which it is
changed; and factor at most."""


class Splitting:
    """An ADMM on the scaled problem, which can be run on from where it is.

    Attributes
    ----------
    forces : in the cones, scaled.
    iterations : done so far, dimensionless.
    """

    def __init__(self, problem: FrictionProblem, start: Vector) -> None:
        self.problem, self.rho, self.iterations, self._next = problem, 1.0, 0, BALANCE_AT
        self._solve = _factorised(problem, self.rho)
        self.set(start)

    def set(self, forces: Vector) -> None:
        """Go on from other forces."""
        self.forces = self.problem.projected(forces)
        self._dual = -self.problem.augmented(self.problem.velocities(self.forces)) / self.rho

    def run(self, goal: float, most: int, in_time: Callable[[], bool]) -> float:
        """Iterate until the residual is at most the goal: the residual reached after at most `most` iterations."""
        problem, mu = self.problem, self.problem.mu
        left, done, shift = problem.residual(self.forces), 0, np.zeros_like(problem.q)
        while left > goal and done < most and in_time():
            for _ in range(EVERY):
                before = self.forces
                problem.blocks(shift)[:, 0] = mu * self.rho * lengths(problem.blocks(self._dual)[:, 1:])
                free = self._solve(self.rho * (before - self._dual) - problem.q - shift)
                mixed = RELAXATION * free + (1.0 - RELAXATION) * before
                self.forces = problem.projected(mixed + self._dual)
                self._dual = self._dual + mixed - self.forces
            done += EVERY
            self.iterations += EVERY
            left = problem.residual(self.forces)
            if not math.isfinite(left):
                break
            if self.iterations >= self._next:
                self._next *= 2
                self._balance(float(np.linalg.norm(free - self.forces)), float(np.linalg.norm(self.forces - before)))
        return left

    def _balance(self, primal: float, change: float) -> None:
        """Change rho where one of the two residuals is much larger than the other."""
        dual = self.rho * change
        if dual == 0.0 or primal == 0.0 or 1.0 / UNBALANCED < primal / dual < UNBALANCED:
            return
        factor = min(max(math.sqrt(primal / dual), 1.0 / MOST_CHANGE), MOST_CHANGE)
        self.rho *= factor
        self._dual = self._dual / factor
        self._solve = _factorised(self.problem, self.rho)


def _factorised(problem: FrictionProblem, rho: float) -> Callable[[Vector], Vector]:
    """Solutions with the matrix W + rho."""
    matrix, rows = problem.matrix, len(problem.q)
    if sparse.issparse(matrix):
        solve: Callable[[Vector], Vector] = splu((matrix + rho * sparse.eye_array(rows)).tocsc()).solve
        return solve
    factors = linalg.lu_factor(matrix + rho * np.eye(rows), check_finite=False)
    return lambda right: linalg.lu_solve(factors, right, check_finite=False)
