"""Semismooth Newton method for contact problems with friction, with proximal regularisation.

The equations are those of Alart and Curnier (1991), with x = r - u of the scaled problem:

    r_n = max(0, x_n),    r_t = projection of x_t on the disk of radius mu max(0, x_n).

Contacts that open leave the linear system at once: their forces are 0. Those that stick have the rows u = 0, those that
slip u_n = 0 and r_t = mu r_n d with d = x_t/|x_t|, which turns with the forces. Where contacts repeat each other the
system is singular. So eps is added to W: each step is one of Newton's method on the proximal subproblem (Rockafellar
1976) with its centre at the last forces, whose solution is that of the problem itself, and eps goes to nothing with the
residual. Steps are whole. Of several that do not get nearer the best forces are kept, and eps grows from there
(watchdog, Chamberlain et al. 1982).
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import splu

from .friction_problem import FrictionProblem, Vector, lengths

MOST_STEPS, PATIENCE = 40, 4
"""Steps of one attempt; steps without an improvement before the best forces are taken up again."""
FIRST, NEAR, LEAST, MOST = 1e-3, 1e-7, 1e-10, 1.0
"""Proximal regularisation at first, from a start that is near (more would not keep how contacts share loads), at least,
and above which an attempt ends; in parts of the contacts' own mobilities."""
QUICK, DROP_QUICK, DROP, GROW = 0.3, 0.03, 0.3, 30.0
"""Part of the residual below which eps drops quickly; factors of eps after quick, other and no improvement."""
TINY = np.finfo(np.float64).tiny


class Equations(NamedTuple):
    """What is left of the equations of Alart and Curnier, x (n, p), |x_t| (n,), which contacts press and slip, u."""

    left: Vector
    x: Vector
    length: Vector
    presses: Any
    slips: Any
    u: Vector


def newton(
    problem: FrictionProblem, start: Vector, tolerance: float, most: int, in_time: Callable[[], bool]
) -> tuple[Vector, float, int]:
    """Forces from a start: the best ones by the residual of the natural map, that residual, and the steps done."""
    best, forces, steps = start, start, 0
    least = natural = problem.residual(start)
    at = equations(problem, start)
    value = lowest = float(np.linalg.norm(at.left))
    eps, waited, taken = max(min(FIRST, least), NEAR), 0, start
    while natural > tolerance and steps < min(most, MOST_STEPS) and in_time():
        change = newton_step(problem, forces, at, eps)
        steps += 1
        if change is None:
            value = np.inf
        else:
            forces = forces + change
            at = equations(problem, forces)
            value = float(np.linalg.norm(at.left))
        if value < lowest:
            eps = max(eps * (DROP_QUICK if value < QUICK * lowest else DROP), LEAST)
            lowest, taken, waited = value, forces, 0
            natural = problem.residual(forces, at.u)
            if natural < least:
                least, best = natural, forces
        else:
            waited += 1
            if waited < PATIENCE and np.isfinite(value):
                continue
            forces, waited, eps = taken, 0, eps * GROW
            at = equations(problem, forces)
            if eps > MOST:
                break
    return best, least, steps


def equations(problem: FrictionProblem, r: Vector) -> Equations:
    u = problem.velocities(r)
    x = problem.blocks(r - u)
    pressing = np.maximum(x[:, 0], 0.0)
    limit, length = problem.mu * pressing, lengths(x[:, 1:])
    slips = (length > limit) | (problem.mu == 0.0)
    left = problem.blocks(r).copy()
    left[:, 0] -= pressing
    left[:, 1:] -= np.where(slips, limit / np.maximum(length, TINY), 1.0)[:, None] * x[:, 1:]
    return Equations(left.ravel(), x, length, x[:, 0] > 0.0, slips, u)


def newton_step(problem: FrictionProblem, r: Vector, at: Equations, eps: float) -> Vector | None:
    """Change of the forces; None where its equations are singular."""
    rows = 1 + problem.tangents
    change = np.where(np.repeat(at.presses, rows), 0.0, -r)
    (some,) = at.presses.nonzero()
    if len(some) == 0:
        return change
    # rows `of_u` (W + eps) + `of_r` of the forces' change, each with a block for each contact
    slips, x = at.slips[some], at.x[some]
    moved = problem.matrix @ change
    wanted = -problem.blocks(at.u + moved)[some]
    of_u, of_r = np.zeros((len(some), rows, rows)), np.zeros((len(some), rows, rows))
    of_u[:] = np.eye(rows)
    if problem.tangents and slips.any():
        force, mu = problem.blocks(r)[some][slips], problem.mu[some][slips]
        length = np.maximum(at.length[some][slips], TINY)
        way, limit = x[slips, 1:] / length[:, None], mu * np.maximum(force[:, 0], 0.0)
        eye = np.eye(problem.tangents)
        turns = np.minimum(limit / length, 1.0)[:, None, None] * (eye - way[:, :, None] * way[:, None, :])
        part = np.zeros((len(mu), rows, rows))
        part[:, 0, 0], part[:, 1:, 1:] = 1.0, turns
        of_u[slips] = part
        part = np.zeros_like(part)
        part[:, 1:, 0], part[:, 1:, 1:] = -mu[:, None] * way, eye - turns
        of_r[slips] = part
        carried = np.einsum("ijk,ik->ij", turns, problem.blocks(moved)[some][slips, 1:])
        wanted[slips, 1:] = limit[:, None] * way - force[:, 1:] - carried
    places = (rows * some[:, None] + np.arange(rows)).ravel()
    found = _solved(problem.matrix, places, of_u, eps * of_u + of_r, wanted.ravel())
    if found is None:
        return None
    change[places] = found
    return change


def _solved(matrix: Any, places: Any, of_u: Vector, of_r: Vector, wanted: Vector) -> Vector | None:
    """Solution of (of_u W + of_r) y = wanted, W at the places, the others block diagonal; None where it is singular."""
    count, rows, _ = of_u.shape
    size = count * rows
    if sparse.issparse(matrix):
        some = matrix[places][:, places]
        system = _diagonal(of_u) @ some + _diagonal(of_r)
        try:
            found = splu(system.tocsc()).solve(wanted)
        except RuntimeError as singular:
            if "singular" not in str(singular):
                raise
            return None
    else:
        system = (of_u @ matrix[np.ix_(places, places)].reshape(count, rows, size)).reshape(size, size)
        index = np.arange(size).reshape(count, rows)
        system[index[:, :, None], index[:, None, :]] += of_r
        _, _, found, info = linalg.lapack.dgesv(system, wanted, overwrite_a=1)
        if info:
            return None
    return found if np.isfinite(found).all() else None


def _diagonal(blocks: Vector) -> Any:
    """A sparse matrix of blocks (n, p, p) on its diagonal."""
    count, rows, _ = blocks.shape
    each = np.arange(count + 1)
    return sparse.bsr_array((blocks, each[:-1], each), shape=(count * rows, count * rows)).tocsr()
