"""Linear algebra with 80-bit numbers, which LAPACK has not."""

import numpy as np
from scipy.linalg import qr

REAL = np.longdouble
RANK = 1e-10
"""Rows that differ by less than this part repeat each other."""


def independent_rows(rows) -> list[int]:
    """Numbers of rows that are independent and span all."""
    if len(rows) == 0:
        return []
    _, r, order = qr(rows.T.astype(float), mode="economic", pivoting=True)
    diagonal = np.abs(np.diag(r))
    return [int(k) for k in order[: int(np.sum(diagonal > RANK * diagonal[0]))]]


def solve(matrix, right) -> np.ndarray:
    """Solution of a linear system by elimination with pivots, of any floating type.
    Raises LinAlgError for a singular matrix."""
    n = len(matrix)
    work = np.concatenate((matrix, right.reshape(n, -1)), axis=1)
    for k in range(n):
        p = k + int(np.argmax(np.abs(work[k:, k])))
        if work[p, k] == 0.0:
            raise np.linalg.LinAlgError(f"column {k} has no pivot")
        if p != k:
            work[[k, p]] = work[[p, k]]
        work[k + 1 :, k:] -= np.outer(work[k + 1 :, k] / work[k, k], work[k, k:])
    found = np.zeros((n, work.shape[1] - n), work.dtype)
    for k in range(n - 1, -1, -1):
        found[k] = (work[k, n:] - work[k, k + 1 : n] @ found[k + 1 :]) / work[k, k]
    return found.reshape(right.shape)
