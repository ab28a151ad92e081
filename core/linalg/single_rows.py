"""Rows of a small dense system that hold one unknown alone: solved first, so that the others are fewer."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import mat


@internal
def take_single_rows(address: int, m: int, x: Any, right: Any, kept: Any) -> int:
    """How many equations are left of those with the matrix at `address` (m, m) and the right-hand sides x (m,), once
    the rows with nothing beside their diagonal are solved. A row of zeros asks for nothing: its unknown is zero.

    x then holds the solutions of these; the others' matrix (k, k) is at `address`, their right-hand sides in `right`,
    and their numbers in `kept` (m,), a vector of numbers.
    """
    a, k = mat(address, m, m), 0
    for i in range(m):
        alone = True
        for j in range(m):
            alone = alone and (j == i or a[i, j] == 0.0)
        if alone:
            x[i] = x[i] / a[i, i] if a[i, i] != 0.0 else 0.0
        else:
            kept[k] = i
            k += 1
    for row in range(k):
        i, rest, other = int(kept[row]), 0.0, 0
        rest = x[i]
        for j in range(m):
            if other < k and int(kept[other]) == j:
                other += 1
            else:
                rest -= a[i, j] * x[j]
        right[row] = rest
    # in place: no entry goes behind where it was
    left = mat(address, k, k)
    for row in range(k):
        for column in range(k):
            left[row, column] = a[int(kept[row]), int(kept[column])]
    return k
