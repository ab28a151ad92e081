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
from .friction_search import Search

logger = logging.getLogger(__name__)

SLIDES, SURELY = 1e-12, 10.0
"""Sliding speed, in parts of |q|, above which a contact slips; factor of the residual, where that is more."""


@dataclass(frozen=True, eq=False)
class FrictionSolution:
    """Forces of a contact problem with Coulomb friction.

    Attributes
    ----------
    forces : r, (n p,), normal and p - 1 tangential forces of each contact, N (or impulses, N s).
    velocities : u = W r + q, (n p,), m/s (or accelerations, m/s^2).
    modes : "open" (without force), "stick" or "slip" for each contact, (n,). One that presses without friction slips.
    residual : of the natural map, in parts of |q|, dimensionless.
    converged : whether the residual is at most the tolerance.
    first_order_iterations : of the alternating directions, dimensionless.
    newton_iterations : steps of Newton's method, each with a factorisation, dimensionless.
    least : whether the forces are the limit of those of equally compliant contacts, which was asked for.
    """

    forces: Vector
    velocities: Vector
    modes: npt.NDArray[np.str_]
    residual: float
    converged: bool
    first_order_iterations: int
    newton_iterations: int
    least: bool


def solve_friction(
    W: Any,
    q: Any,
    mu: Any,
    *,
    tangents: int = 2,
    start: Any = None,
    least: bool = False,
    tolerance: float = 1e-12,
    first_order_iterations: int = 5000,
    newton_iterations: int = 1000,
    seconds: float = math.inf,
    asymmetry: float = 0.01,
    must_converge: bool = False,
) -> FrictionSolution:
    """Forces r and velocities u = W r + q of n contacts with Coulomb friction.

    Each contact is open (r = 0, u_n >= 0), sticks (u = 0, |r_t| <= mu r_n) or slips (u_n = 0, r_t = -mu r_n u_t/|u_t|).
    In the form of de Saxce and Feng (1998): K* contains u + mu |u_t| e_n, perpendicular to r in the friction cone K.
    The velocities may be accelerations, or those after an impact; the forces then are impulses.

    Where contacts repeat each other W is singular, and the problem leaves open how they share a load: one solution is
    given, with `least` that of equally compliant contacts. Contacts that slip in different directions are braked by
    what each carries, so that their velocities differ with it too. If friction is large a problem may also have several
    solutions with other modes, or none.

    Parameters
    ----------
    W : Delassus matrix J M^-1 J^T, (n p, n p), symmetric and positive semidefinite, an array or a sparse matrix; in
        blocks of p = 1 + tangents rows a contact, in the order normal, tangents. 1/kg.
    q : velocities without contact forces, (n p,), m/s.
    mu : coefficients of friction, (n,) or one for all, dimensionless.
    tangents : of each contact: 2 in space, 1 in the plane, 0 without friction (mu is then of no account).
    start : forces to start from, (n p,), of a problem nearby; N s.
    least : take the forces of rigid contacts as the limit of those of equally compliant ones, where the path to it is
        found (docs/load-sharing.md). It takes longer, and `start` is not used.
    tolerance : of the residual, dimensionless.
    first_order_iterations, newton_iterations : at most so many, for each island of contacts that act on each other.
    seconds : of wall time; no new iteration begins later, s.
    asymmetry : largest difference of W from its transpose that is accepted, in parts of the contacts' own mobilities.
        W is used as it is; dimensionless.
    must_converge : raise a `ConvergenceError` where the tolerance is not reached, which has the best forces found as
        `solution`. Else a warning is logged, and they are returned with their residual.

    Returns
    -------
    FrictionSolution
        Its residual is |D r - P_K(D r - (u + mu |u_t| e_n))|/|q|, the natural map of the problem (Acary, Bremond, Huber
        2018), with Euclidean norms, P_K the projection on the friction cones, and D the contacts' own mobilities: of
        each the mean of the diagonal of its block of W. It does not depend on units, nor on the choice of tangents.

    Raises
    ------
    ValueError : the shapes do not fit; elements are not finite; mu or a diagonal element of W is negative; W is not
        symmetric.
    ConvergenceError : the tolerance is not reached, and `must_converge`.
    """
    began = time.perf_counter()
    if not tolerance > 0.0:
        raise ValueError(f"tolerance = {tolerance!r}; needed is a positive number, as 1e-12, which is near rounding")
    problem = scaled_problem(W, q, mu, tangents, asymmetry)
    search = Search(
        problem,
        _start(problem, start),
        tolerance,
        first_order_iterations,
        newton_iterations,
        lambda: time.perf_counter() - began < seconds,
    )
    if least:
        search.follow_compliance()
    search.run()
    found = _solution(problem, search)
    if not found.converged:
        message = (
            f"a contact problem of {len(problem.mu)} contacts is solved to a residual of {found.residual:.1e} of |q| "
            f"only, not to {tolerance:.1e}, after {found.first_order_iterations} first-order iterations and "
            f"{found.newton_iterations} Newton steps; there may be no solution"
        )
        if must_converge:
            raise ConvergenceError(message, solution=found)
        logger.warning(message)
    return found


def _start(problem: FrictionProblem, start: Any) -> Vector:
    """Scaled forces to start from: none, where those that are given are not nearer."""
    rows = len(problem.q)
    none = np.zeros(rows)
    if start is None:
        return none
    given = np.asarray(start, dtype=np.float64)
    if given.shape != (rows,) or not np.isfinite(given).all():
        raise ValueError(f"start has the shape {given.shape}; needed are finite forces ({rows},), as many as q has")
    given = problem.projected((problem.root * problem.blocks(given)).ravel())
    return given if problem.residual(given) < problem.residual(none) else none


def _solution(problem: FrictionProblem, search: Search) -> FrictionSolution:
    forces, residual = search.best, search.least
    # within the cones exactly, where that costs no accuracy
    inside = problem.projected(forces)
    left = problem.residual(inside)
    if left <= max(residual, search.tolerance):
        forces, residual = inside, left
    u = problem.root * problem.blocks(problem.velocities(forces))
    r = problem.blocks(forces) / problem.root
    modes = np.where(lengths(u[:, 1:]) > max(SURELY * residual, SLIDES) * problem.size, "slip", "stick")
    modes[problem.mu == 0.0] = "slip"
    modes[r[:, 0] <= 0.0] = "open"
    return FrictionSolution(
        r.ravel(), u.ravel(), modes, residual, residual <= search.tolerance, search.first, search.steps, search.limit
    )
