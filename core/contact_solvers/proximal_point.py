"""Proximal point method for contact problems with friction, each subproblem by the semismooth Newton method.

Rockafellar (1976): the forces are those of contacts that give way by eps about the forces before, W + eps and
q - eps r_k, which are solved to a part of what is left, and eps goes down as long as Newton's method takes few steps.
Where friction is large the term mu |u_t| makes the problem non-monotone: Newton's method then ends with few contacts
whose modes go in circles. So eps is raised there, and where that does not help either, the coefficients of friction
are: from problems with a part of them, which are nearer to a convex one, to the whole.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from .friction_problem import FrictionProblem, Vector
from .semismooth_newton import Equations, equations, newton_step

MOST_STEPS = 150
"""Newton steps of one attempt."""
MOST_INNER, PATIENCE, FEW, SOME = 12, 6, 3, 6
"""Newton steps of a subproblem; those without an improvement before it is given up; and those that count as few."""
FIRST, LEAST, MOST, GROW = 0.03, 1e-10, 1e4, 4.0
"""eps at first, at least, and at most, in parts of the contacts' own mobilities; factor where a subproblem fails."""
DROP_FEW, DROP_SOME, DROP = 0.1, 0.3, 0.6
"""Factors of eps after few, some and more steps."""
PART, ROUGHEST, FINEST = 0.01, 1e-4, 1e-14
"""Of what is left, to which a subproblem is solved; and of |q|, to which it is solved at least, and at most."""
FRICTION_PARTS, PART_TOLERANCE, PART_STEPS, PART_FIRST = (0.3, 0.6, 0.8, 0.9), 1e-9, 60, 0.01
"""Parts of the coefficients of friction on the way to them; what each is solved to, in how many steps, and its eps."""


def proximal_point(
    problem: FrictionProblem,
    start: Vector,
    tolerance: float,
    most: int,
    in_time: Callable[[], bool],
    first: float = FIRST,
) -> tuple[Vector, float, int]:
    """Forces from a start: the best ones by the residual of the natural map, that residual, and the Newton steps."""
    centre = best = start
    least, steps, eps = problem.residual(start), 0, first
    size = float(np.linalg.norm(problem.q))
    while least > tolerance and steps < min(most, MOST_STEPS) and in_time():
        goal = size * max(min(ROUGHEST, PART * least), FINEST)
        soft, factor = problem.compliant(np.full(len(problem.mu), eps))
        soft = replace(soft, q=soft.q - eps * factor * centre)
        found, solved, done = _subproblem(soft, centre / factor, goal)
        steps += done
        if not solved:
            eps *= GROW
            if eps > MOST:
                break
            continue
        centre = factor * found
        left = problem.residual(centre)
        if left < least:
            least, best = left, centre
        eps = max(eps * (DROP_FEW if done <= FEW else DROP_SOME if done <= SOME else DROP), LEAST)
    return best, least, steps


def less_friction(
    problem: FrictionProblem, start: Vector, most: int, in_time: Callable[[], bool]
) -> tuple[Vector, int]:
    """A start for the whole friction, from the forces of less: the forces, and the Newton steps."""
    forces, steps = start, 0
    for part in FRICTION_PARTS:
        with_part = replace(problem, mu=part * problem.mu)
        budget = min(PART_STEPS, most - steps)
        forces, _, done = proximal_point(
            with_part, with_part.projected(forces), PART_TOLERANCE, budget, in_time, PART_FIRST
        )
        steps += done
    return forces, steps


def _subproblem(problem: FrictionProblem, start: Vector, goal: float) -> tuple[Vector, bool, int]:
    """Forces of a subproblem, whether what is left of their equations is at most the goal, and the steps."""
    forces, best, steps, waited = start, start, 0, 0
    at: Equations = equations(problem, start)
    lowest = float(np.linalg.norm(at.left))
    while lowest > goal and steps < MOST_INNER and waited < PATIENCE:
        change = newton_step(problem, forces, at, 0.0)
        steps += 1
        if change is None:
            break
        forces = forces + change
        at = equations(problem, forces)
        value = float(np.linalg.norm(at.left))
        if not np.isfinite(value):
            break
        if value < lowest:
            lowest, best, waited = value, forces, 0
        else:
            waited += 1
    return best, lowest <= goal, steps
