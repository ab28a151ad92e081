"""Forces (or impulses) of several planar contacts at once, with Coulomb friction, as a complementarity problem.

With w = b + A P for normal (N) and tangential (T) motion: 0 <= w_N, P_N >= 0, w_N P_N = 0, and for each contact with
friction P_T = -mu P_N sgn(w_T) where it slides, |P_T| <= mu P_N where w_T = 0 (Glocker 2001, Pfeiffer and Glocker
1996, chapter 8). The same problem holds for accelerations and forces, and for velocities and impulses.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .lcp import NoComplementarySolution, solve_lcp
from .many import AT_REST, shared, solve_many

Vector = NDArray[np.float64]

IMMOVABLE = 1e-12
"""A direction whose inverse effective mass is below this part of what it could be cannot move."""
RANK = 1e-10
"""Singular values of the tangential block below this part of the largest are zero."""
MANY = 8
"""Contacts; the forces of more are found as the limit of those that give way a little (`many`)."""


@dataclass(frozen=True)
class Delassus:
    """Inverse effective masses of n contacts, joints included: A = G M_b G^T, each block (n, n), 1/kg."""

    nn: Vector
    nt: Vector
    tt: Vector
    directions: Vector | None = None
    responses: Vector | None = None
    """G and G M_b, each (2 n, coordinates), where they are at hand: they tell directions apart that differ by so little
    that A has lost it."""

    def vectors(self, some: NDArray[np.intp]) -> tuple[Vector, Vector]:
        """Vectors of the directions `some` (normals first) and of what moves by them, whose products are A."""
        if self.directions is not None and self.responses is not None:
            return self.directions[some], self.responses[some]
        every = np.arange(len(self.nn))
        values, vectors = np.linalg.eigh(self.rows(every, every))
        root = (vectors * np.sqrt(np.maximum(values, 0.0)))[some]
        return root, root

    def among(self, part: NDArray[np.intp]) -> "Delassus":
        """The blocks of the contacts `part`."""
        here = np.ix_(part, part)
        return Delassus(self.nn[here], self.nt[here], self.tt[here])

    def rows(self, normal: NDArray[np.intp], tangential: NDArray[np.intp]) -> Vector:
        """The block of these normal and these tangential directions, in this order."""
        mixed = self.nt[np.ix_(normal, tangential)]
        return np.block([[self.nn[np.ix_(normal, normal)], mixed], [mixed.T, self.tt[np.ix_(tangential, tangential)]]])


@dataclass(frozen=True)
class ContactSolution:
    """Forces or impulses of n contacts, and the motion that follows, each (n,)."""

    normal: Vector
    tangential: Vector
    normal_motion: Vector
    tangential_motion: Vector
    sticks: bool
    """True if all friction was found below its limit at once, shared in proportion to what the contacts allow."""


def solve_contacts(
    a: Delassus, b_n: Vector, b_t: Vector, mu: Vector, direction: Vector, base: Vector | None = None
) -> ContactSolution:
    """Normal and tangential forces of n contacts.

    Parameters
    ----------
    a : inverse effective masses.
    b_n, b_t : motion without contact forces, (n,); normal is positive where the contact separates.
    mu : coefficients of friction, (n,); 0: none.
    direction : +1 or -1 where the contact slides and its friction is known, 0 where friction decides, (n,).
    base : normal forces that act in any case, (n,); the solution's are added to them.

    Raises
    ------
    NoComplementarySolution : if there is none.
    """
    n = len(b_n)
    if n == 1 and mu[0] == 0.0 and base is None:
        # most impacts are of one contact: no pivoting is needed
        alone = np.maximum(-b_n / a.nn[0], 0.0)
        motion = np.maximum(b_n, 0.0)
        return ContactSolution(alone, np.zeros(1), motion, b_t + a.nt[0] * alone, False)
    base = np.zeros(n) if base is None else base
    largest = max(float(np.max(np.diag(a.nn), initial=0.0)), float(np.max(np.diag(a.tt), initial=0.0)))
    mu = np.where((direction != 0.0) | (np.diag(a.tt) > IMMOVABLE * largest), mu, 0.0)
    ways = (_by_limit, _by_pivoting) if n > MANY else (_by_pivoting, _by_limit)
    for way in ways:
        found = way(a, b_n, b_t, mu, direction, base)
        if found is not None:
            return found
    raise NoComplementarySolution("neither pivoting nor Newton's method find forces of the contacts")


def _by_limit(
    a: Delassus, b_n: Vector, b_t: Vector, mu: Vector, direction: Vector, base: Vector
) -> ContactSolution | None:
    """The solution as the limit of those with contacts that give way; None if that path ends."""
    forces = solve_many(a.nn, a.nt, a.tt, b_n, b_t, mu, direction, base)
    if forces is None:
        return None
    normal, tangential = forces
    w_n, w_t = b_n + a.nn @ normal + a.nt @ tangential, b_t + a.nt.T @ normal + a.tt @ tangential
    size = max(float(np.max(np.abs(b_n))), float(np.max(np.abs(b_t))))
    held = (mu > 0.0) & (direction == 0.0) & (normal > 0.0)
    sticks = bool(np.any(held) and np.all(np.abs(w_t[held]) <= AT_REST * size))
    return ContactSolution(normal, tangential, w_n, w_t, sticks)


def _by_pivoting(
    a: Delassus, b_n: Vector, b_t: Vector, mu: Vector, direction: Vector, base: Vector
) -> ContactSolution | None:
    """The solution by Lemke's method: in few contacts quicker, and exact; None if it finds none."""
    free = np.flatnonzero((mu > 0.0) & (direction == 0.0))
    sliding = np.where(direction == 0.0, 0.0, -mu * direction)
    # columns of the normal forces, the friction of sliding contacts included
    nn, tn = a.nn + a.nt * sliding, a.nt.T + a.tt * sliding
    b_n, b_t = b_n + nn @ base, b_t + tn @ base
    forces = _all_stick(a, nn, tn, b_n, b_t, mu, free, base) if len(free) else None
    sticks = forces is not None
    try:
        if forces is not None:
            normal, tangential = forces
        elif len(free):
            normal, tangential = _with_limits(a, nn, tn, b_n, b_t, mu, free, base)
        else:
            normal, tangential = _scaled(nn, b_n, np.diag(a.nn)), np.zeros(len(b_n))
    except NoComplementarySolution:
        return None
    total = normal + base
    return ContactSolution(
        total,
        tangential + sliding * total,
        b_n + nn @ normal + a.nt[:, free] @ tangential[free],
        b_t + tn @ normal + a.tt[:, free] @ tangential[free],
        sticks,
    )


def _scaled(m: Vector, q: Vector, inverse_mass: Vector) -> Vector:
    """`solve_lcp` with rows and columns brought to unit size."""
    d = 1.0 / np.sqrt(np.where(inverse_mass > 0.0, inverse_mass, 1.0))
    return d * solve_lcp(d[:, None] * m * d, d * q)


def _all_stick(
    a: Delassus, nn: Vector, tn: Vector, b_n: Vector, b_t: Vector, mu: Vector, free: NDArray[np.intp], base: Vector
) -> tuple[Vector, Vector] | None:
    """The solution in which no contact of `free` slides, each with the same part of what its friction allows as the
    others that it shares with; None if there is none."""
    along = a.tt[np.ix_(free, free)]
    inverse = np.linalg.pinv(along, rcond=RANK, hermitian=True)
    across = a.nt[:, free] @ inverse
    m, q = nn - across @ tn[free], b_n - across @ b_t[free]
    # where sticking leaves no motion along the normals, what is left is rounding
    root = np.sqrt(np.diag(a.nn))
    m = np.where(np.abs(m) <= RANK * np.outer(root, root), 0.0, m)
    q = np.where(np.abs(q) <= RANK * (np.abs(b_n) + np.abs(across) @ np.abs(b_t[free])), 0.0, q)
    try:
        normal = _scaled(m, q, np.diag(a.nn))
    except NoComplementarySolution:
        return None
    wanted = b_t[free] + tn[free] @ normal
    tangential = np.zeros(len(b_n))
    limit = mu[free] * (normal + base)[free]
    tangential[free] = shared(along, limit, -wanted)
    left = wanted + along @ tangential[free]
    if np.max(np.abs(left)) > 1e-9 * np.max(np.abs(wanted), initial=1e-300):
        return None
    force = np.abs(tangential[free])
    if np.all(force <= limit * (1.0 + 1e-12) + 1e-14 * np.max(force)):
        return normal, tangential
    return None


def _with_limits(
    a: Delassus, nn: Vector, tn: Vector, b_n: Vector, b_t: Vector, mu: Vector, free: NDArray[np.intp], base: Vector
) -> tuple[Vector, Vector]:
    """The problem with friction limits: unknown P_N, the two signs of P_T, and the speed of sliding.

    In this form (Stewart and Trinkle 1996) the matrix is copositive and Lemke's method ends with a solution for every
    impact from b = G v^-.
    """
    n, f = len(b_n), len(free)
    across, along = a.nt[:, free], a.tt[np.ix_(free, free)]
    pick = np.zeros((f, n))
    pick[np.arange(f), free] = mu[free]
    one, none = np.eye(f), np.zeros((f, f))
    m = np.block(
        [
            [nn, across, -across, np.zeros((n, f))],
            [tn[free], along, -along, one],
            [-tn[free], -along, along, one],
            [pick, -one, -one, none],
        ]
    )
    q = np.concatenate([b_n, b_t[free], -b_t[free], mu[free] * base[free]])
    root = np.sqrt(np.concatenate([np.diag(a.nn), np.diag(a.tt)[free]]))
    force = 1.0 / np.where(root > 0.0, root, 1.0)
    columns = np.concatenate([force, force[n:], 1.0 / force[n:]])
    z = columns * solve_lcp(columns[:, None] * m * columns, columns * q)
    tangential = np.zeros(n)
    tangential[free] = z[n : n + f] - z[n + f : n + 2 * f]
    return z[:n], tangential


def independent(
    a: Delassus, normal: NDArray[np.intp], tangential: NDArray[np.intp], rank: float = RANK
) -> tuple[list[int], list[int]]:
    """Those of the directions that do not repeat earlier ones, normals first: positions in the given lists. `rank`: the
    part of a direction's inverse mass that must be left of it."""
    some = np.concatenate([normal, len(a.nn) + tangential]).astype(np.intp)
    left, moves = (x.copy() for x in a.vectors(some))
    size = np.einsum("ij,ij->i", left, moves)
    kept: list[int] = []
    # orthogonal to one another, in the product that the inverse masses make, and of unit size
    base, base_moves = np.zeros_like(left), np.zeros_like(left)
    for i in range(len(some)):
        x, moved, k = left[i], moves[i], len(kept)
        for _ in range(2):
            part = base_moves[:k] @ x
            x, moved = x - part @ base[:k], moved - part @ base_moves[:k]
        rest = float(x @ moved)
        if rest > rank * size[i]:
            root = np.sqrt(rest)
            base[k], base_moves[k] = x / root, moved / root
            kept.append(i)
    count = len(normal)
    return [i for i in kept if i < count], [i - count for i in kept if i >= count]


def farthest(matrix: Vector, among: NDArray[np.intp]) -> NDArray[np.intp]:
    """Those of the directions `among` (a block of A) that do not repeat others, each time the one that is least held by
    those before it."""
    rest, kept = matrix[np.ix_(among, among)].copy(), []
    scale = np.diag(rest).copy()
    for _ in range(len(among)):
        k = int(np.argmax(np.diag(rest)))
        if not rest[k, k] > RANK * scale[k]:
            break
        kept.append(k)
        rest -= np.outer(rest[:, k], rest[k]) / rest[k, k]
    return np.sort(among[kept])
