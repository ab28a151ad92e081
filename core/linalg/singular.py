"""What makes a matrix singular, in words."""

import numpy as np
from numpy.typing import NDArray

from .row_pivoting import pivot_rows

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def singular_place(n: int, rows: Ints, cols: Ints, values: Floats) -> str:
    """Words for the rows or columns that make the matrix singular, as far as they are found cheaply."""
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
