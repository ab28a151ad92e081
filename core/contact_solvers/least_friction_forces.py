"""Forces of rigid contacts as the limit of those of equally compliant ones, for sparse problems (docs/load-sharing.md).

W + eps C has one solution where friction is moderate: eps goes down from where contacts hardly feel each other, each
solution being the start of the next (Tikhonov 1963). C is 1 for each normal and tangent as given. The forces of the
last three compliances, of which each is half of the one before, are extrapolated to none.
"""

from collections.abc import Callable

import numpy as np

from .friction_problem import FrictionProblem, Vector
from .proximal_point import proximal_point
from .semismooth_newton import newton
from .splitting import Splitting

FIRST, LAST, LOWER, LARGEST = 10.0, 1e-5, 0.1, 0.8
"""Compliance at first and at last, in parts of the largest mobility; factor from one to the next, whose root is taken
where a solution is not found; and the factor above which the path ends."""
SOLVED, ENOUGH, ROUGHLY, ITERATIONS = 1e-12, 1e-11, 1e-3, 500
"""Residual to which each solution is taken, and with which it is; and what the first-order method goes to before the
first, in so many iterations at most."""
LIMIT_CHANGE = 1e-6
"""Change of the forces, in parts of them, by which the exact solution may differ from the limit."""


def least_forces(problem: FrictionProblem, most: int, in_time: Callable[[], bool]) -> tuple[Vector | None, int]:
    """The limit of compliant contacts, which solves the problem itself nearly, and the Newton steps; None: the path to
    it ends before."""
    mobility = problem.root.ravel() ** 2
    relative = mobility.max(initial=0.0) / mobility
    soft, factor = problem.compliant(FIRST * relative)
    splitting = Splitting(soft, np.zeros_like(problem.q))
    splitting.run(ROUGHLY, ITERATIONS, in_time)
    forces = factor * splitting.forces
    compliance, good, lower, steps = FIRST, 0.0, LOWER, 0
    last: list[Vector] = []
    while steps < most and in_time():
        soft, factor = problem.compliant(compliance * relative)
        found, left, done = newton(soft, forces / factor, SOLVED, most - steps, in_time)
        steps += done
        if left > ENOUGH:
            found, left, done = proximal_point(soft, forces / factor, SOLVED, most - steps, in_time)
            steps += done
        if left > ENOUGH:
            lower = np.sqrt(lower)
            if good == 0.0 or lower > LARGEST:
                break
            last, compliance = [], max(lower * good, 4.0 * LAST)
            continue
        forces, good = factor * found, compliance
        # the last three are for four times, twice and once the least compliance
        if compliance < 5.0 * LAST:
            last.append(forces)
        if len(last) == 3:
            return problem.projected((8.0 * last[2] - 6.0 * last[1] + last[0]) / 3.0), steps
        compliance = 0.5 * compliance if compliance < 5.0 * LAST else max(lower * compliance, 4.0 * LAST)
    return None, steps
