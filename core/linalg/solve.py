"""`factor` and `solve`: what compiled loops call, for every kind of factorisation."""

from functools import cache
from typing import Any

import numpy as np

from ..compiled.jit import address_of, caller, compiled, internal
from ..compiled.views import vec
from .dense import dense_factor, dense_solve, dense_solve_transposed
from .record import DENSE, FACTOR_SIGNATURE, OK, REANALYSE, SOLVE_SIGNATURE
from .sparse import columns_factor, program_factor, sparse_solve, sparse_solve_transposed

_call_factor = caller(FACTOR_SIGNATURE)
_call_solve = caller(SOLVE_SIGNATURE)


@compiled
def factor(lu: Any, values_address: int) -> int:
    """Factor the matrix whose entries are in the float64 source array at `values_address`.

    Returns
    -------
    0 (OK).
    1 (NO_PIVOT) : a value is not finite, or a pivot is zero to rounding: below PIVOT_NOISE times a partial
        result of its own sum. This test does not depend on the scaling of rows and columns, so that it holds
        for mixed units.
    2 (REANALYSE) : an entry of L exceeds GROWTH times the largest of its column at analysis, or was never
        analysed (sparse only; one comparison for each entry of L). Up to log10(GROWTH) digits could be lost.

    On 1 and 2 do not solve: call `Factorization.analyze`, which takes pivots that fit the values and raises
    SingularMatrixError if there are none. Right after it `factor` of the same values returns 0.
    """
    if lu.n == 0:
        return OK
    return _call_factor(lu.factor_function, lu, values_address)


@compiled
def solve(lu: Any, b_address: int) -> None:
    """Solve A x = b in place on the (n,) float64 vector at `b_address`, after a `factor` that returned 0."""
    if lu.n > 0:
        _call_solve(lu.solve_function, lu, b_address)


@internal
def solve_transposed(lu: Any, b_address: int) -> None:
    """Solve A^T x = b in place on the (n,) float64 vector at `b_address`, after a `factor` that returned 0."""
    if lu.n == 0:
        return
    if lu.kind == DENSE:
        dense_solve_transposed(lu, b_address)
    else:
        sparse_solve_transposed(lu, b_address)


@internal
def _not_analysed(lu: Any, values_address: int) -> int:
    return REANALYSE


@internal
def _no_solution(lu: Any, b_address: int) -> None:
    vec(b_address, 1)[0] = np.nan


@cache
def functions_of(kind: str) -> tuple[int, int]:
    """Addresses of factor and solve of a kind: "unready" (not analysed yet), "dense", "program" or "columns".

    They are called by address, so that only the kinds that are used are compiled, and none of them again inside each
    of their callers.
    """
    factor_function, solve_function = {
        "unready": (_not_analysed, _no_solution),
        "dense": (dense_factor, dense_solve),
        "program": (program_factor, sparse_solve),
        "columns": (columns_factor, sparse_solve),
    }[kind]
    return address_of(factor_function, FACTOR_SIGNATURE), address_of(solve_function, SOLVE_SIGNATURE)
