"""Forces (or impulses) of several planar contacts at once, with Coulomb friction, as a complementarity problem.

With w = b + A P for normal (N) and tangential (T) motion: 0 <= w_N, P_N >= 0, w_N P_N = 0, and for each contact with
friction P_T = -mu P_N sgn(w_T) where it slides, |P_T| <= mu P_N where w_T = 0 (Glocker 2001, Pfeiffer and Glocker
1996, chapter 8). The same problem holds for accelerations and forces, and for velocities and impulses.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..rounding import DIRECTION_RANK
from .directions import farthest_directions, farthest_size, independent_directions, independent_size
from .lcp import NoComplementarySolution
from .planar_contacts import BELOW_LIMITS, MANY, NONE, PLANAR_VECTORS, Cones, solve_cones

__all__ = [
    "MANY",
    "ContactSolution",
    "Delassus",
    "farthest",
    "independent",
    "solve_contacts",
]

Vector = NDArray[np.float64]


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

    def vectors(self) -> tuple[Vector, Vector]:
        """Vectors of the directions (normals first) and of what moves by them, whose products are A."""
        if self.directions is not None and self.responses is not None:
            return self.directions, self.responses
        every = np.arange(len(self.nn))
        values, vectors = np.linalg.eigh(self.rows(every, every))
        root = vectors * np.sqrt(np.maximum(values, 0.0))
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
    cones = Cones(n)
    given = {"nn": a.nn, "nt": a.nt, "tt": a.tt, "b_n": b_n, "b_t": b_t, "mu": mu, "direction": direction}
    for name, values in given.items():
        cones.arrays[name][...] = values
    if base is not None:
        cones.arrays["base"][:] = base
    status = solve_cones(cones.record)
    if status == NONE:
        raise NoComplementarySolution("neither pivoting nor Newton's method find forces of the contacts")
    normal, tangential, normal_motion, tangential_motion = (cones.arrays[name] for name in PLANAR_VECTORS[-4:])
    return ContactSolution(normal, tangential, normal_motion, tangential_motion, status == BELOW_LIMITS)


def independent(
    a: Delassus, normal: NDArray[np.intp], tangential: NDArray[np.intp], rank: float = DIRECTION_RANK
) -> tuple[list[int], list[int]]:
    """Those of the directions that do not repeat earlier ones, normals first: positions in the given lists. `rank`: the
    part of a direction's inverse mass that must be left of it."""
    some, count = np.concatenate([normal, len(a.nn) + tangential]).astype(np.int64), len(normal)
    directions, responses = (np.ascontiguousarray(x, dtype=np.float64) for x in a.vectors())
    kept, work = np.empty(len(some), np.int64), np.empty(independent_size(len(some), directions.shape[1]))
    found = independent_directions(directions, responses, some, count, len(some), rank, kept, work)
    positions = sorted(kept[:found].tolist())
    return [i for i in positions if i < count], [i - count for i in positions if i >= count]


def farthest(matrix: Vector, among: NDArray[np.intp]) -> NDArray[np.intp]:
    """Those of the directions `among` (a block of A, ascending) that do not repeat others, each time the one that is
    least held by those before it."""
    some, kept = np.ascontiguousarray(among, dtype=np.int64), np.empty(len(among), np.int64)
    matrix = np.ascontiguousarray(matrix, dtype=np.float64)
    return kept[: farthest_directions(matrix, some, kept, np.empty(farthest_size(len(some))))]
