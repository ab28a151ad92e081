"""The methods for contact problems with friction in their order, from quick to slow."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from .friction_problem import FrictionProblem, Places, Vector
from .least_friction_forces import LIMIT_CHANGE, least_forces
from .proximal_point import less_friction, proximal_point
from .semismooth_newton import newton
from .splitting import Splitting

GOAL, NEARER, FIRST_ITERATIONS = 1e-3, 0.03, 500
"""Residual to which the first-order method goes before the others are tried, factor from one such attempt to the next,
and iterations at most before the first."""


class Search:
    """The methods in their order, and the best forces found."""

    def __init__(
        self,
        problem: FrictionProblem,
        start: Vector,
        tolerance: float,
        most_first: int,
        most_steps: int,
        in_time: Callable[[], bool],
    ) -> None:
        self.problem, self.tolerance, self.in_time = problem, tolerance, in_time
        self.best = self.near = start
        self.least = problem.residual(start)
        self.first, self.steps, self._most_first, self._most_steps = 0, 0, most_first, most_steps
        self.limit = False

    def follow_compliance(self) -> None:
        """The limit of compliant contacts, if the exact solution next to it is one."""
        forces, steps = least_forces(self.problem, self._most_steps, self.in_time)
        self.steps += steps
        if forces is not None:
            self._take(forces, self.problem.residual(forces), 0)
            self._newton(newton, forces)
            moved = float(np.linalg.norm(self.best - forces))
            self.limit = self.least <= self.tolerance and moved <= LIMIT_CHANGE * float(np.linalg.norm(forces))

    def run(self) -> None:
        """All contacts at once by what is quick, then each island that is not solved by itself."""
        if self._done():
            return
        splitting = self._quick()
        if self._done():
            return
        islands = self.problem.islands()
        if len(islands) == 1:
            self._slow(splitting)
            return
        for island in islands:
            part, rows = self.problem.part(island)
            own = Search(
                part,
                self.best[rows],
                self.tolerance / math.sqrt(len(islands)),
                self._most_first,
                self._most_steps,
                self.in_time,
            )
            own.run()
            self.first, self.steps = self.first + own.first, self.steps + own.steps
            self.best = _with(self.best, rows, own.best)
        self.least = self.problem.residual(self.best)

    def _quick(self) -> Splitting | None:
        """Whole Newton steps, from the first-order method where the start is not near."""
        splitting = None
        if self.least > GOAL:
            splitting = Splitting(self.problem, self.near)
            self._split(splitting, GOAL, FIRST_ITERATIONS)
        self._newton(newton, self.near)
        return splitting

    def _slow(self, splitting: Splitting | None) -> None:
        """Proximal points; those of less friction first; then again from nearer."""
        self._newton(proximal_point, self.near)
        if self.problem.mu.any() and not self._done():
            forces, steps = less_friction(self.problem, self.near, self._most_steps - self.steps, self.in_time)
            self._take(forces, self.problem.residual(forces), steps)
            self._newton(proximal_point, forces)
        splitting, goal = splitting or Splitting(self.problem, self.best), GOAL
        while not self._done() and splitting.iterations < self._most_first:
            goal *= NEARER
            self._split(splitting, goal, self._most_first)
            self._newton(newton, self.near)
            self._newton(proximal_point, self.near)

    def _split(self, splitting: Splitting, goal: float, most: int) -> None:
        left = splitting.run(goal, min(most, self._most_first - splitting.iterations), self.in_time)
        self.first, self.near = splitting.iterations, splitting.forces
        self._take(self.near, left, 0)

    def _newton(self, method: Any, start: Vector) -> None:
        if not self._done():
            self._take(*method(self.problem, start, self.tolerance, self._most_steps - self.steps, self.in_time))

    def _take(self, forces: Vector, residual: float, steps: int) -> None:
        self.steps += steps
        if residual < self.least:
            self.best, self.least = forces, residual

    def _done(self) -> bool:
        return self.least <= self.tolerance or self.steps >= self._most_steps or not self.in_time()


def _with(forces: Vector, rows: Places, part: Vector) -> Vector:
    found = forces.copy()
    found[rows] = part
    return found
