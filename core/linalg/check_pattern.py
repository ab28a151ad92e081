"""Are these the entries of a square matrix?"""

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]

# Indices are unsigned 32-bit.
LARGEST_INDEX = 2**32 - 1


def check_pattern(n: int, rows: Ints, cols: Ints, slots: Ints, source_size: int) -> None:
    """Raise ValueError for vectors of different lengths, indices out of range, or an entry given twice."""
    if n < 0:
        raise ValueError(f"n = {n} must not be negative")
    lengths = [a.shape for a in (rows, cols, slots)]
    if len(set(lengths)) != 1 or len(lengths[0]) != 1:
        raise ValueError(f"rows, cols and slots must be vectors of one length, not of shapes {lengths}")
    limits = (
        ("rows", rows, n),
        ("cols", cols, n),
        ("slots", slots, source_size),
    )
    for name, array, limit in limits:
        if len(array) and (array.min() < 0 or array.max() >= limit):
            raise ValueError(f"{name} must be in 0..{limit - 1}, they range from {array.min()} to {array.max()}")
    if source_size > LARGEST_INDEX:
        raise ValueError(f"a source array of {source_size} is more than 32-bit indices can reach")
    place, count = np.unique(rows * n + cols, return_counts=True)
    if np.any(count > 1):
        twice = int(place[np.argmax(count > 1)])
        raise ValueError(f"entry ({twice // n}, {twice % n}) is given more than once")
