"""Ordering and pivots of a sparse matrix from SuperLU, chosen on its scaled values.

Measured on the matrices [M Phi^T; Phi 0] of chains, masses from 1e-3 to 1e3, and on spring grids with
constraints: COLAMD with pivots from the diagonal down to a tenth of the column's largest gives the lowest
fill that is safe. Minimum degree on A^T + A gives 5 % less for chains, but can give 20-fold fill where
the zero block forces pivots off the diagonal. Full partial pivoting costs 5-30 % more fill, and its
pivots go stale sooner: taken on geometry, they vanish when a body turns. Scaling (Curtis & Reid) keeps
most pivots on the diagonal for any mass.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import SingularMatrixError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DIAGONAL_PREFERENCE = 0.1
# From this size on the factors do not fit into the fast caches, and the order in which they are read counts.
LARGE = 4000
WIDEST_BAND = 50
MORE_FILL = 1.2
SWEEPS = 4
# Entries this much smaller than both their row's and their column's largest do not count in the scaling.
NEGLIGIBLE = 1e-6


def balancing_scales(n: int, rows: Ints, cols: Ints, values: Floats) -> tuple[Floats, Floats]:
    """Scales r (n,), c (n,) that bring the magnitudes r_i |a_ij| c_j near 1.

    Alternating least squares on the logarithms (Curtis & Reid 1972, J. Inst. Maths Applics 10, 118-124).
    """
    size = np.abs(values)
    row_top, col_top = np.zeros(n), np.zeros(n)
    np.maximum.at(row_top, rows, size)
    np.maximum.at(col_top, cols, size)
    counts = size > NEGLIGIBLE * np.minimum(row_top[rows], col_top[cols])
    rows, cols, logs = rows[counts], cols[counts], np.log(size[counts])
    row_count = np.maximum(np.bincount(rows, minlength=n), 1)
    col_count = np.maximum(np.bincount(cols, minlength=n), 1)
    row_log, col_log = np.zeros(n), np.zeros(n)
    for _ in range(SWEEPS):
        row_log = -np.bincount(rows, logs + col_log[cols], n) / row_count
        col_log = -np.bincount(cols, logs + row_log[rows], n) / col_count
    return np.exp(np.clip(row_log, -300, 300)), np.exp(np.clip(col_log, -300, 300))


def choose_pivots(n: int, rows: Ints, cols: Ints, values: Floats) -> tuple[Ints, Ints]:
    """Place of each row and of each column of the matrix in the pivot sequence: perm_r (n,), perm_c (n,).

    Raises
    ------
    SingularMatrixError : if SuperLU meets a column without a pivot.
    """
    # importing scipy.sparse takes as long as a short run: small systems never come here
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    row_scale, col_scale = balancing_scales(n, rows, cols, values)
    scaled = csc_array((values * row_scale[rows] * col_scale[cols], (rows, cols)), shape=(n, n))
    try:
        factors = splu(scaled, permc_spec="COLAMD", diag_pivot_thresh=DIAGONAL_PREFERENCE)
        if n >= LARGE:
            return _local_order(scaled, factors)
    except RuntimeError as error:
        raise SingularMatrixError(
            f"the {n} x {n} matrix is singular: {singular_place(n, rows, cols, values)}"
        ) from error
    return factors.perm_r.astype(np.int64), factors.perm_c.astype(np.int64)


def _local_order(scaled: Any, factors: Any) -> tuple[Ints, Ints]:
    """Permutations in which neighbours stay neighbours (reverse Cuthill-McKee) if their fill is nearly that of
    `factors`, else those of `factors`. A chain's factors are then read one after the other, not all over the memory."""
    from scipy.sparse.csgraph import reverse_cuthill_mckee
    from scipy.sparse.linalg import splu

    order = reverse_cuthill_mckee(scaled.tocsr(), symmetric_mode=True)
    found = factors
    try:
        # the bandwidth bounds the fill: wide bands are not even tried
        place = np.argsort(order)
        entries = scaled.tocoo()
        if np.max(np.abs(place[entries.row] - place[entries.col])) <= WIDEST_BAND:
            found = splu(scaled[order][:, order].tocsc(), permc_spec="NATURAL", diag_pivot_thresh=DIAGONAL_PREFERENCE)
    except RuntimeError:
        pass
    if found is factors or found.L.nnz + found.U.nnz > MORE_FILL * (factors.L.nnz + factors.U.nnz):
        return factors.perm_r.astype(np.int64), factors.perm_c.astype(np.int64)
    perm_r, perm_c = np.empty(len(order), np.int64), np.empty(len(order), np.int64)
    perm_r[order], perm_c[order] = found.perm_r, found.perm_c
    return perm_r, perm_c


def singular_place(n: int, rows: Ints, cols: Ints, values: Floats) -> str:
    """Words for the rows or columns that make the matrix singular, as far as they are found cheaply."""
    from .row_pivoting import pivot_rows

    used = values != 0.0
    for name, index in (("row", rows), ("column", cols)):
        empty = np.flatnonzero(np.bincount(index[used], minlength=n) == 0)
        if len(empty):
            return f"{name} {empty[0]} is zero"
    order = np.lexsort((cols, rows))
    indptr = np.concatenate(([0], np.cumsum(np.bincount(rows, minlength=n))))
    found = pivot_rows(n, n, indptr, cols[order], values[order], tol=1e-12)
    if len(found.redundant) == 0:
        return "a pivot is zero to rounding"
    row, others = found.redundant[0], found.depends_on[0]
    return f"row {row} is a combination of rows {', '.join(map(str, others))}"
