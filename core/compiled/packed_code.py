"""The overload behind `packed.py`: straight code where the compiler knows the size, a loop where it does not."""

from typing import Any

from numba import types
from numba.extending import overload

OF_SIX = 21
"""Entries of the upper triangle of a 6 x 6 matrix."""


def curvature(packed: Any, x: Any, index: Any) -> float:
    """x . H x for the entries `index` of x; H symmetric, its upper triangle row by row in `packed` (empty: zero)."""
    raise NotImplementedError("compiled code alone calls it")


def _of_six(packed: Any, x: Any, index: Any) -> float:
    # six sums that do not wait for each other
    x0, x1, x2, x3, x4, x5 = x[index[0]], x[index[1]], x[index[2]], x[index[3]], x[index[4]], x[index[5]]
    row0 = (packed[1] * x1 + packed[2] * x2) + (packed[3] * x3 + packed[4] * x4) + packed[5] * x5
    row1 = (packed[7] * x2 + packed[8] * x3) + (packed[9] * x4 + packed[10] * x5)
    row2 = (packed[12] * x3 + packed[13] * x4) + packed[14] * x5
    row3, row4 = packed[16] * x4 + packed[17] * x5, packed[19] * x5
    part0 = x0 * (packed[0] * x0 + 2.0 * row0) + x1 * (packed[6] * x1 + 2.0 * row1)
    part1 = x2 * (packed[11] * x2 + 2.0 * row2) + x3 * (packed[15] * x3 + 2.0 * row3)
    return (part0 + part1) + (x4 * (packed[18] * x4 + 2.0 * row4) + packed[20] * x5 * x5)


def _of_any(packed: Any, x: Any, index: Any) -> float:
    total, size, i, j = 0.0, len(packed), 0, 0
    n = 0
    while n * (n + 1) < 2 * size:
        n += 1
    for k in range(size):
        w = 1.0 if i == j else 2.0
        total += w * packed[k] * x[index[i]] * x[index[j]]
        j += 1
        if j == n:
            i += 1
            j = i
    return total


@overload(curvature, jit_options={"error_model": "numpy"})
def _curvature(packed: Any, x: Any, index: Any) -> Any:
    known = isinstance(packed, types.BaseTuple) and len(packed) == OF_SIX
    return _of_six if known else _of_any
