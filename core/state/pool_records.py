"""Records of contact pools: shapes of which any two may touch, and slots that contacts of near pairs take."""

from typing import Any

import numpy as np

from ..compiled import types
from ..compiled.jit import records_view

POOL_SHAPE = np.dtype(
    [
        ("coord", np.int64, (7,)),   # coordinates of its body: place and Euler parameters
        ("half_space", np.int64),    # 1: a half-space fixed to the ground, 0: a sphere
        ("group", np.int64),         # which POOL_GROUP it belongs to
        ("body", np.int64),          # a number for each body
        ("rest", np.float64),        # what is added to the body's first Euler parameter
        ("point", np.float64, (3,)),  # centre, or a point of the plane, on its body, m
        ("axes", np.float64, (9,)),  # of the marker, one after another
        ("radius", np.float64),      # m
    ]
)  # fmt: skip
"""A shape of a pool."""
POOL_GROUP = np.dtype(
    [
        ("first_slot", np.int64), ("slots", np.int64),    # its slots
        ("first_shape", np.int64), ("shapes", np.int64),  # its shapes: spheres, then half-spaces
    ]
)  # fmt: skip
"""A group whose contacts are pooled."""
shapes_at: Any = records_view(types.from_dtype(POOL_SHAPE))
"""shapes_at(address, n): n records of POOL_SHAPE."""
groups_at: Any = records_view(types.from_dtype(POOL_GROUP))
"""groups_at(address, n): n records of POOL_GROUP."""
NO_PAIR = 0
"""Of a slot that no pair has yet; others have `pair_number`."""


def pair_number(first: int, second: int, shapes: int) -> int:
    """Number of a pair of shapes, of which the first has the lower number."""
    return 1 + first * shapes + second


def shapes_of_pair(number: int, shapes: int) -> tuple[int, int]:
    """The shapes of the pair with this number, `pair_number`."""
    return divmod(number - 1, shapes)
