"""The contact problem with Coulomb friction, sparse or dense, solved to rounding, with its residual."""

import logging
import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import ConvergenceError
from .friction_problem import FrictionProblem, Vector, lengths, scaled_problem
from .semismooth_newton import MOST_STEPS, newton
from .splitting import Splitting

logger = logging.getLogger(__name__)

GOAL, NEARER = 1e-3, 0.03
"""Residual of the first-order method before Newton's method is first tried, and factor from one attempt to the next."""


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
    newton_iterations: int = 400,
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
    splitting: Splitting | None = None
    goal, steps = GOAL, 0
    while least > tolerance and steps < newton_iterations and in_time():
        if splitting is None and least > GOAL:
            splitting = Splitting(problem, best)
        if splitting is not None:
            left = splitting.run(goal, first_order_iterations - splitting.iterations, in_time)
            if left < least:
                least, best = left, splitting.forces
            found, left, done = newton(
                problem, splitting.forces, tolerance, min(MOST_STEPS, newton_iterations - steps), in_time
            )
        else:
            found, left, done = newton(problem, best, tolerance, min(MOST_STEPS, newton_iterations - steps), in_time)
            splitting = Splitting(problem, best) if left > tolerance else None
        steps += done
        if left < least:
            least, best = left, found
        if splitting is not None and splitting.iterations >= first_order_iterations:
            break
        goal *= NEARER
    return _solution(problem, best, least, tolerance, splitting.iterations if splitting else 0, steps, must_converge)


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
