"""Forces of compliant contacts with Coulomb friction, by semismooth Newton steps in 80-bit numbers.

w = b + (A + eps C) P, C the relative compliances, 0 <= w_n, 0 <= P_n, w_n P_n = 0; at rest |P_t| <= mu P_n with
w_t = 0 within the cone and w_t against P_t at its limit (Alart and Curnier 1991); of contacts that slide
P_t = -mu P_n d. The compliance eps decreases along a path on which each solution begins from the last one. It is a part
of the largest inverse mass.
"""

from dataclasses import dataclass, replace

import numpy as np
from dense_contacts import ContactProblem
from extended_numbers import REAL, solve

FIRST, LAST = 10.0, 1e-10
FASTEST, SLOWEST = 0.1, 0.98
"""Least and largest factor from one compliance to the next."""
MOST_STEPS = 40
EXACT, ROUGHLY = 1e-16, 1e-13
"""Of the largest force: what is left of the laws, and what of it rounding may leave."""
STICKS = 1e-7
"""Of the largest free acceleration: what moves less than this, at rest, is held."""

PRESSES = 1e-9
"""Of the largest normal force: less is none."""


class NotFoundError(Exception):
    """The path of solutions does not go on."""


@dataclass
class Forces:
    """Of the contacts of a problem."""

    values: np.ndarray
    """(contacts, 3), N."""
    accelerations: np.ndarray
    """(contacts, 3), m/s^2: b + A P, without the compliance."""
    begins: np.ndarray
    """Which contacts begin to slide."""
    changes: int
    """How often contacts have begun to slide with their kinetic friction, which others then did not hold."""


def _local(problem: ContactProblem, eps: REAL, p, mu) -> tuple[np.ndarray, np.ndarray]:
    """Residual of the laws of all contacts and its generalized Jacobian."""
    n = len(problem.names)
    stiff = problem.matrix + eps * np.diag(np.repeat(problem.compliance, 3))
    w = problem.free + stiff @ p
    residual, jacobian = np.zeros(3 * n, REAL), np.zeros((3 * n, 3 * n), REAL)
    unit = np.eye(3 * n, dtype=REAL)
    for i in range(n):
        k, rows = 3 * i, slice(3 * i + 1, 3 * i + 3)
        scale = 1.0 / stiff[k, k]
        aim = p[k] - scale * w[k]
        if aim <= 0.0:
            residual[k : k + 3], jacobian[k : k + 3] = p[k : k + 3], unit[k : k + 3]
            continue
        residual[k], jacobian[k] = scale * w[k], scale * stiff[k]
        way = problem.ways[i]
        if way.any():
            residual[rows] = p[rows] + mu[i] * p[k] * way
            jacobian[rows] = unit[rows] + mu[i] * np.outer(way, unit[k])
            continue
        scale = 1.0 / max(stiff[k + 1, k + 1], stiff[k + 2, k + 2])
        held = p[rows] - scale * w[rows]
        size, limit = np.sqrt(held @ held), mu[i] * aim
        if size <= limit:
            residual[rows], jacobian[rows] = scale * w[rows], scale * stiff[rows]
            continue
        e = held / size
        of_held = unit[rows] - scale * stiff[rows]
        of_aim = unit[k] - stiff[k] / stiff[k, k]
        turn = (limit / size) * (np.eye(2, dtype=REAL) - np.outer(e, e))
        residual[rows] = p[rows] - limit * e
        jacobian[rows] = unit[rows] - turn @ of_held - mu[i] * np.outer(e, of_aim)
    return residual, jacobian


def _newton(problem: ContactProblem, eps: REAL, start, mu, size: float) -> np.ndarray | None:
    """Forces for one compliance, or None: by full steps, which may pass points that are worse, or by shortened ones."""
    for halvings in (0, 12):
        found = _steps(problem, eps, start, mu, size, halvings)
        if found is not None:
            return found
    return None


def _steps(problem: ContactProblem, eps: REAL, start, mu, size: float, halvings: int) -> np.ndarray | None:
    p = start.copy()
    residual, jacobian = _local(problem, eps, p, mu)
    for _ in range(MOST_STEPS):
        error = np.sqrt(residual @ residual)
        if error <= EXACT * size:
            return p
        try:
            step = solve(jacobian, residual)
        except np.linalg.LinAlgError:
            return None
        part = REAL(1.0)
        for k in range(halvings + 1):
            tried = p - part * step
            new, matrix = _local(problem, eps, tried, mu)
            if halvings == 0 or np.sqrt(new @ new) <= (1.0 - 0.1 * part) * error:
                break
            if k == halvings:
                # rounding is all that is left
                return p if error <= ROUGHLY * size else None
            part *= 0.5
        p, residual, jacobian = tried, new, matrix
    return p if np.sqrt(residual @ residual) <= ROUGHLY * size else None


def follow(problem: ContactProblem, mu, last: float = LAST) -> np.ndarray:
    """Forces (3 contacts,) at the compliance `last` times the largest inverse mass. Raises NotFoundError."""
    n = len(problem.names)
    largest = np.max(np.diag(problem.matrix))
    size = float(np.max(np.abs(problem.free)) / largest) if n else 0.0
    p, eps, factor = np.zeros(3 * n, REAL), REAL(FIRST), FASTEST
    if n == 0 or size == 0.0:
        return p
    found = _newton(problem, eps * largest, p, mu, size)
    if found is None:
        raise NotFoundError("no forces of soft contacts")
    p = found
    while eps > last:
        following = max(REAL(last), eps * factor)
        found = _newton(problem, following * largest, p, mu, size)
        if found is None:
            factor = np.sqrt(factor)
            if factor > SLOWEST:
                raise NotFoundError(f"no forces below a compliance of {float(eps):.1e}")
            continue
        p, eps, factor = found, following, max(factor**1.5, FASTEST)
    return p


def rigid_forces(problem: ContactProblem, last: float = LAST) -> Forces:
    """Forces of the contacts of a problem at the compliance `last`; contacts that static friction does not hold slide
    against it with their kinetic friction. Raises NotFoundError."""
    n = len(problem.names)
    now, begins = problem, np.zeros(n, bool)
    scale = float(np.max(np.abs(problem.free))) if n else 0.0
    for changes in range(n + 1):
        slides = np.array([way.any() for way in now.ways], bool)
        mu = np.where(slides, problem.kinetic, problem.static)
        p = follow(now, mu, last)
        w = (problem.free + problem.matrix @ p).reshape(n, 3)
        forces = p.reshape(n, 3)
        presses = forces[:, 0] > PRESSES * np.max(forces[:, 0], initial=0.0)
        fast = np.linalg.norm(w[:, 1:].astype(float), axis=1) > STICKS * scale
        moves = ~slides & presses & (mu > 0.0) & fast
        begins |= moves
        if not (moves & (problem.static != problem.kinetic)).any():
            return Forces(forces, w, begins, changes)
        ways = now.ways.copy()
        for i in np.flatnonzero(moves):
            size = np.sqrt(forces[i, 1:] @ forces[i, 1:])
            ways[i] = -forces[i, 1:] / size
        now = replace(now, ways=ways)
    raise NotFoundError("contacts begin to slide again and again")
