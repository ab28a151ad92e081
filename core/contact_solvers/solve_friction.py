"""The contact problem with Coulomb friction, sparse or dense, solved to rounding, with its residual."""

import logging
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import ConvergenceError
from .friction_problem import FrictionProblem, Vector, lengths, scaled_problem
from .proximal_point import MOST_STEPS as PROXIMAL_STEPS
from .proximal_point import less_friction, proximal_point
from .semismooth_newton import MOST_STEPS as NEWTON_STEPS
from .semismooth_newton import newton
from .splitting import Splitting

logger = logging.getLogger(__name__)

GOAL, NEARER, FIRST_ITERATIONS = 1e-3, 0.03, 500
"""Residual to which the first-order method goes before Newton's method is tried, and factor from one attempt to the
next; iterations at most before the first attempt."""


@dataclass(frozen=True, eq=False)
class FrictionSolution:
    """Forces of a contact problem with Coulomb friction.

    Attributes
    ----------
    forces : (n p,), each contact's normal force and p - 1 tangential ones, N or N s.
    velocities : u = W r + q, (n p,), m/s or, of accelerations, m/s^2.
    modes : "open" (no force), "stick" or "slip" for each contact, (n,). A contact without friction that presses slips.
    residual : of the natural map, in parts of |q|, dimensionless.
    converged : whether the residual is at most the tolerance.
    first_order_iterations : of the alternating directions, dimensionless.
    newton_iterations : steps of the semismooth Newton method, dimensionless.
    """

    forces: Vector
    velocities: Vector
    modes: npt.NDArray[np.str_]
    residual: float
    converged: bool
    first_order_iterations: int
    newton_iterations: int


def solve_friction(
    W: Any,
    q: Any,
    mu: Any,
    *,
    tangents: int = 2,
    start: Any = None,
    tolerance: float = 1e-12,
    first_order_iterations: int = 5000,
    newton_iterations: int = 1000,
    seconds: float = math.inf,
    asymmetry: float = 0.01,
    must_converge: bool = False,
) -> FrictionSolution:
    """Forces r and velocities u = W r + q of contacts with Coulomb friction."""
    began = time.perf_counter()
    problem = scaled_problem(W, q, mu, tangents, asymmetry)

    def in_time() -> bool:
        return time.perf_counter() - began < seconds

    best = _start(problem, start)
    least = problem.residual(best)
    first, steps = 0, 0
    if least > tolerance:
        best, least, first, steps = _attempts(
            problem, best, least, tolerance, first_order_iterations, newton_iterations, in_time
        )
    return _solution(problem, best, least, tolerance, first, steps, must_converge)


def _attempts(
    problem: FrictionProblem,
    start: Vector,
    residual: float,
    tolerance: float,
    most_first: int,
    most_steps: int,
    in_time: Callable[[], bool],
) -> tuple[Vector, float, int, int]:
    """The best forces, their residual, the first-order iterations and the Newton steps."""
    best, least, steps = start, residual, 0
    splitting: Splitting | None = None

    def better(found: Vector, left: float, done: int = 0) -> bool:
        nonlocal best, least, steps
        if left < least:
            best, least = found, left
        steps += done
        return least <= tolerance or steps >= most_steps or not in_time()

    goal, most, once_more = GOAL, FIRST_ITERATIONS, True
    while True:
        near = start
        if least > goal or not once_more:
            splitting = splitting or Splitting(problem, start)
            left = splitting.run(goal, min(most, most_first - splitting.iterations), in_time)
            near = splitting.forces
            if better(near, left):
                break
        if better(*newton(problem, near, tolerance, min(NEWTON_STEPS, most_steps - steps), in_time)):
            break
        if better(*proximal_point(problem, near, tolerance, min(PROXIMAL_STEPS, most_steps - steps), in_time)):
            break
        if once_more and problem.mu.any():
            near, done = less_friction(problem, near, most_steps - steps, in_time)
            if better(near, problem.residual(near), done) or better(
                *proximal_point(problem, near, tolerance, min(PROXIMAL_STEPS, most_steps - steps), in_time)
            ):
                break
        if splitting is not None and splitting.iterations >= most_first:
            break
        once_more, goal, most = False, NEARER * goal, most_first
    return best, least, splitting.iterations if splitting else 0, steps


def _start(problem: FrictionProblem, start: Any) -> Vector:
    rows = len(problem.q)
    none = np.zeros(rows)
    if start is None:
        return none
    given = np.asarray(start, dtype=np.float64)
    if given.shape != (rows,) or not np.isfinite(given).all():
        raise ValueError(f"start has the shape {given.shape}; needed are finite forces ({rows},), as many as q has")
    given = problem.projected((problem.root * problem.blocks(given)).ravel())
    return given if problem.residual(given) < problem.residual(none) else none


def _solution(
    problem: FrictionProblem,
    forces: Vector,
    residual: float,
    tolerance: float,
    first: int,
    steps: int,
    must_converge: bool,
) -> FrictionSolution:
    # within the cones exactly, where that costs no accuracy
    inside = problem.projected(forces)
    left = problem.residual(inside)
    if left <= max(residual, tolerance):
        forces, residual = inside, left
    u = problem.root * problem.blocks(problem.velocities(forces))
    r = problem.blocks(forces) / problem.root
    modes = np.where(lengths(u[:, 1:]) > max(10.0 * residual, 1e-12) * problem.size, "slip", "stick")
    modes[problem.mu == 0.0] = "slip"
    modes[r[:, 0] <= 0.0] = "open"
    found = FrictionSolution(r.ravel(), u.ravel(), modes, residual, residual <= tolerance, first, steps)
    if not found.converged:
        message = (
            f"a contact problem of {len(r)} contacts is solved to a residual of {residual:.1e} of |q| only, not to "
            f"{tolerance:.1e}, after {first} first-order iterations and {steps} Newton steps; there may be no solution"
        )
        if must_converge:
            raise ConvergenceError(message, solution=found)
        logger.warning(message)
    return found
