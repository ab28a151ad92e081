"""Forces (or impulses) of several contacts at once as one compiled function: no allocation, no exception, no Python.

Compiled code calls it by its address (`address_of(solve_cones, CONES_SIGNATURE)`, `call_cones`) with a record of sizes
and addresses; `Cones` builds one with memory for up to so many contacts. What the problem is: `complementarity.py`.
"""

from typing import Any

import numpy as np

from ..compiled import types
from ..compiled.jit import address_of, caller, compiled
from ..compiled.records import ArrayRecord
from ..compiled.views import mat, vec
from ..linalg.small import LEAST_NORM_SIGNATURE, least_norm
from ..rounding import IMMOVABLE
from .conditions import BELOW_LIMITS, NONE, SOLVED
from .lcp import FIND_SIGNATURE, find_complementary
from .pivoting import by_pivoting, pivoting_size
from .regularization import by_limit, many_size

__all__ = [
    "BELOW_LIMITS",
    "CONES",
    "CONES_SIGNATURE",
    "CONES_TYPE",
    "IMMOVABLE",
    "MANY",
    "NONE",
    "PLANAR_VECTORS",
    "SOLVED",
    "Cones",
    "call_cones",
    "solve_cones",
    "work_size",
]

MANY = 8
"""Contacts; the forces of more are found as the limit of those that give way a little (`regularization.py`)."""

PLANAR_VECTORS = (
    "b_n", "b_t",                          # motion without contact forces; b_n > 0: the contact separates
    "mu",                                  # coefficients of friction; 0: none
    "direction",                           # +-1 where it slides and friction is known, 0: friction decides
    "base",                                # normal forces that act in any case
    "normal", "tangential",                # found: forces, base included
    "normal_motion", "tangential_motion",  # found: motion with them
)  # fmt: skip
"""(n,) each."""

CALLED = ("by_pivoting", "by_limit", "find_complementary", "least_norm")

CONES = np.dtype(
    [
        (name, np.int64)
        for name in (
            *CALLED,                                # addresses of these functions
            "n",                                    # contacts
            "nn", "nt", "tt",                       # (n, n) inverse effective masses, 1/kg
            *PLANAR_VECTORS,
            "work",                                 # (work_size(n),) scratch
        )
    ]
)  # fmt: skip
CONES_TYPE = types.from_dtype(CONES)
WAY_SIGNATURE = types.int64(CONES_TYPE, types.Array(types.float64, 1, "C"), types.int64)
call_way = caller(WAY_SIGNATURE)
"""call_way(address, cn, mu, work): one of the two ways to solutions."""
CONES_SIGNATURE = types.int64(CONES_TYPE)
call_cones = caller(CONES_SIGNATURE)
"""call_cones(address of `solve_cones`, cn): NONE, SOLVED or BELOW_LIMITS."""


def work_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `solve_cones` for n contacts."""
    return n + max(pivoting_size(n), many_size(n))


def addresses() -> dict[str, int]:
    """The functions whose addresses the record holds."""
    return {
        "by_pivoting": address_of(by_pivoting, WAY_SIGNATURE),
        "by_limit": address_of(by_limit, WAY_SIGNATURE),
        "find_complementary": address_of(find_complementary, FIND_SIGNATURE),
        "least_norm": address_of(least_norm, LEAST_NORM_SIGNATURE),
    }


class Cones(ArrayRecord):
    """The record of a problem of at most `most` contacts, with memory for it: `arrays` by their names in CONES.

    A problem of n contacts takes the first n (or n n, row by row) numbers of each array; `set_size("n", n)`, or
    compiled code by `cn.n = n`, tells n.
    """

    def __init__(self, most: int) -> None:
        sizes = {"n": most, **addresses()}
        shapes: dict[str, tuple[int, ...]] = dict.fromkeys(("nn", "nt", "tt"), (most, most))
        shapes |= dict.fromkeys(PLANAR_VECTORS, (most,)) | {"work": (work_size(most),)}
        super().__init__(CONES, {name: np.zeros(shape) for name, shape in shapes.items()}, sizes)


@compiled
def solve_cones(cn: Any) -> int:
    """Forces of the contacts of the record `cn`, and the motion with them: NONE, SOLVED or BELOW_LIMITS.

    The arrays of what is given stay as they are; with NONE, those of what is found mean nothing.
    """
    n = cn.n
    if n == 0:
        return SOLVED
    nn, tt = mat(cn.nn, n, n), mat(cn.tt, n, n)
    given, direction, mu = vec(cn.mu, n), vec(cn.direction, n), vec(cn.work, n)
    if n == 1 and given[0] == 0.0 and vec(cn.base, n)[0] == 0.0:
        # most impacts are of one contact: no pivoting is needed
        b_n, alone = vec(cn.b_n, n)[0], max(-vec(cn.b_n, n)[0] / nn[0, 0], 0.0)
        vec(cn.normal, n)[0], vec(cn.tangential, n)[0] = alone, 0.0
        vec(cn.normal_motion, n)[0] = max(b_n, 0.0)
        vec(cn.tangential_motion, n)[0] = vec(cn.b_t, n)[0] + mat(cn.nt, n, n)[0, 0] * alone
        return SOLVED
    largest = 0.0
    for i in range(n):
        largest = max(largest, nn[i, i], tt[i, i])
    for i in range(n):
        mu[i] = given[i] if direction[i] != 0.0 or tt[i, i] > IMMOVABLE * largest else 0.0
    work = cn.work + 8 * n
    for way in range(2):
        limit = (way == 0) == (n > MANY)
        status = call_way(cn.by_limit if limit else cn.by_pivoting, cn, mu, work)
        if status != NONE:
            return int(status)
    return NONE
