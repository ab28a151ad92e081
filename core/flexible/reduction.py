"""Reduction of a linear structure to physical coordinates that are kept and modes of the rest.

Craig and Bampton, "Coupling of substructures for dynamic analyses", AIAA J. 6 (1968) 1313: with kept coordinates b and
others i,  u = T (u_b, z),  T = [I 0; Psi Phi],  Psi = -K_ii^-1 K_ib (constraint modes: statics for moved b),
Phi: the lowest modes of K_ii phi = omega^2 M_ii phi (b held), of unit modal mass. T^T M T and T^T K T follow; rigid
motion and statics under loads at b are exact whatever the number of modes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ModelError

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Reduction:
    """A reduced structure; its coordinates are the kept ones in the given order, then the modal amplitudes.

    Attributes
    ----------
    mass, stiffness : of the reduced coordinates (r, r).
    basis : T (n, r): coordinates of the structure u = T (u_b, z).
    frequencies : of the modes, with the kept coordinates held, rad/s.
    """

    mass: Matrix
    stiffness: Matrix
    basis: Matrix
    frequencies: NDArray[np.float64]


def craig_bampton(mass: ArrayLike, stiffness: ArrayLike, kept: Sequence[int], modes: int) -> Reduction:
    """Keep the coordinates `kept`, and `modes` modes of all others.

    Parameters
    ----------
    mass, stiffness : symmetric, (n, n).
    kept : at least as many as hold the structure, so that K_ii is positive definite.

    Raises
    ------
    ModelError : for coordinates that do not exist or are given twice, more modes than there are, or a K_ii that is
        singular because what is kept does not hold the structure.
    """
    from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh  # importing scipy costs more than most runs

    m, k = np.asarray(mass, dtype=float), np.asarray(stiffness, dtype=float)
    n = len(m)
    if m.shape != (n, n) or k.shape != (n, n):
        raise ModelError(f"mass and stiffness must be square and of one size; they are {m.shape} and {k.shape}")
    b = np.asarray(kept, dtype=np.int64)
    if len(b) == 0 or len(set(b.tolist())) < len(b) or b.min() < 0 or b.max() >= n:
        raise ModelError(f"kept = {list(kept)} must name different coordinates in 0..{n - 1}, at least one")
    i = np.setdiff1d(np.arange(n), b)
    if not 0 <= modes <= len(i):
        raise ModelError(f"modes = {modes} must be at least 0 and at most {len(i)}, the number of coordinates not kept")
    basis = np.zeros((n, len(b) + modes))
    basis[b, np.arange(len(b))] = 1.0
    frequencies = np.zeros(0)
    if len(i):
        try:
            basis[i, : len(b)] = -cho_solve(cho_factor(k[np.ix_(i, i)]), k[np.ix_(i, b)])
        except LinAlgError:
            raise ModelError(
                f"kept = {list(kept)} does not hold the structure: others can move without strain. Keep more"
            ) from None
        if modes:
            squares, shapes = eigh(k[np.ix_(i, i)], m[np.ix_(i, i)], subset_by_index=(0, modes - 1))
            basis[i, len(b) :] = shapes
            frequencies = np.sqrt(squares)
    reduced_m, reduced_k = basis.T @ m @ basis, basis.T @ k @ basis
    return Reduction(0.5 * (reduced_m + reduced_m.T), 0.5 * (reduced_k + reduced_k.T), basis, frequencies)
