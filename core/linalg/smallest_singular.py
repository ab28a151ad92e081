"""The smallest singular values of a wide sparse matrix, with their directions, from one sparse factorisation.

Block Lanczos iteration with the inverse of J J^T (Golub and Van Loan 2013, Matrix Computations, 4th ed., 10.3.6). The
inverse is applied through the augmented matrix [I, J^T; J, -shift I], which stays sparse where J J^T does not: where
one body takes part in many constraints. The singular values are those of J^T on the space so found, so that their
error is a rounding of J, not the square root of one as in eigenvalues of J J^T.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SHIFT = 1e-16
"""Of the largest singular value's square: without it the matrix has no factors where J loses rank. Singular vectors are
the same with it."""
GUARD = 4
"""Vectors of a block beyond those asked for: they keep those apart from what lies near."""
LARGEST_BASIS = 8
"""Blocks of a basis; then it begins anew with the best quarter of it."""
STANDS = 1e-8
"""Relative change of the singular values from one block to the next with which they are taken."""
MOST_BLOCKS = 1000
"""Blocks beyond which a look is given up. A gap of a millionth between the values takes some tens."""


def smallest_singular(matrix: Any, count: int) -> tuple[Floats, Floats] | None:
    """The `count` smallest singular values of `matrix`, (m, n) and sparse with m <= n, in descending order as those of
    `numpy.linalg.svd`, and the directions (count, n) that belong to them; None if they do not stand still within
    MOST_BLOCKS blocks.

    Raises
    ------
    ValueError : for m > n, and for more values than `most_values(m)`.
    """
    # importing scipy costs more than most runs: only who needs it pays
    from scipy.sparse import block_array, eye_array
    from scipy.sparse.linalg import norm, splu

    m, n = matrix.shape
    if m > n or not 0 < count <= most_values(m):
        raise ValueError(f"{count} singular values of a {m} x {n} matrix: at most {most_values(m)}, m <= n needed")
    shift = SHIFT * max(float(norm(matrix, 1) * norm(matrix, np.inf)), 1e-300)
    factors = splu(block_array([[eye_array(n), matrix.T], [matrix, -shift * eye_array(m)]], format="csc"))
    block = count + GUARD
    # the same numbers each time, of no pattern that a mechanism could have
    newest = np.random.default_rng(m).standard_normal((m, block))
    basis, known = np.empty((m, 0)), np.full(count, np.inf)
    for _ in range(MOST_BLOCKS):
        newest = _beside(basis, _inverse(factors, newest, n))
        basis = np.hstack([basis, newest])
        directions, values, combinations = np.linalg.svd(matrix.T @ basis, full_matrices=False)
        found = values[-count:]
        if np.all(np.abs(found - known) <= STANDS * found + 1e-15 * values[0]):
            return found, directions[:, -count:].T
        known = found
        if basis.shape[1] + block > min(LARGEST_BASIS * block, m):
            basis = np.linalg.qr(basis @ combinations[-2 * block :].T)[0]
            newest = basis[:, -block:]
    return None


def most_values(m: int) -> int:
    """How many singular values of a matrix with m rows can be asked for: three blocks must fit."""
    return m // 3 - GUARD


def _inverse(factors: Any, vectors: Floats, n: int) -> Floats:
    """(J J^T + shift)^-1 times each column, its largest entry 1."""
    rhs = np.zeros((n + len(vectors), vectors.shape[1]))
    rhs[n:] = -vectors
    found = factors.solve(rhs)[n:]
    found /= np.max(np.abs(found), axis=0)
    return np.asarray(found)


def _beside(basis: Floats, vectors: Floats) -> Floats:
    """An orthonormal basis of what the vectors add to that of `basis`."""
    for _ in range(2):
        vectors = np.linalg.qr(vectors - basis @ (basis.T @ vectors))[0]
    return vectors
