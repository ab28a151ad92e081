"""`factor` and `solve`: what compiled loops call, for every kind of factorisation."""

from typing import Any

from ..compiled.jit import compiled
from .dense import dense_factor, dense_solve
from .record import COLUMNS, DENSE, OK, PROGRAM, REANALYSE
from .sparse import columns_factor, program_factor, sparse_solve


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
    if lu.kind == DENSE:
        return dense_factor(lu, values_address)
    if lu.kind == PROGRAM:
        return program_factor(lu, values_address)
    if lu.kind == COLUMNS:
        return columns_factor(lu, values_address)
    return REANALYSE


@compiled
def solve(lu: Any, b_address: int) -> None:
    """Solve A x = b in place on the (n,) float64 vector at `b_address`, after a `factor` that returned 0."""
    if lu.kind == DENSE:
        dense_solve(lu, b_address)
    elif lu.kind == PROGRAM or lu.kind == COLUMNS:
        sparse_solve(lu, b_address)
