"""Order of the columns of a sparse matrix, by its pattern; and what makes a matrix singular.

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

from .choice import DIAGONAL_PREFERENCE

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# From this size on the factors do not fit into the fast caches, and the order in which they are read counts.
LARGE = 4000
WIDEST_BAND = 50
MORE_FILL = 1.2


def order_columns(n: int, rows: Ints, cols: Ints) -> Ints:
    """Place of each column of a pattern in the pivot sequence, (n,).

    COLAMD orders by the pattern alone; the values given to SuperLU only let it come to its end.
    """
    # importing scipy.sparse takes as long as a short run: small systems never come here
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    values = 1.0 + np.modf(0.6180339887498949 * np.arange(1, len(rows) + 1))[0]
    matrix = csc_array((values, (rows, cols)), shape=(n, n))
    try:
        factors = splu(matrix, permc_spec="COLAMD", diag_pivot_thresh=DIAGONAL_PREFERENCE)
    except RuntimeError:
        return np.arange(n)  # structurally singular: whatever the order
    if n >= LARGE:
        return _local_order(matrix, factors)
    return np.asarray(factors.perm_c, dtype=np.int64)


def _local_order(matrix: Any, factors: Any) -> Ints:
    """An order in which neighbours stay neighbours (reverse Cuthill-McKee) if its fill is nearly that of `factors`,
    else theirs. A chain's factors are then read one after the other, not all over the memory."""
    from scipy.sparse.csgraph import reverse_cuthill_mckee
    from scipy.sparse.linalg import splu

    order = reverse_cuthill_mckee(matrix.tocsr(), symmetric_mode=True)
    found = factors
    try:
        # the bandwidth bounds the fill: wide bands are not even tried
        place = np.argsort(order)
        entries = matrix.tocoo()
        if np.max(np.abs(place[entries.row] - place[entries.col])) <= WIDEST_BAND:
            found = splu(matrix[order][:, order].tocsc(), permc_spec="NATURAL", diag_pivot_thresh=DIAGONAL_PREFERENCE)
    except RuntimeError:
        pass
    if found is factors or found.L.nnz + found.U.nnz > MORE_FILL * (factors.L.nnz + factors.U.nnz):
        return np.asarray(factors.perm_c, dtype=np.int64)
    return np.asarray(place, dtype=np.int64)


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
