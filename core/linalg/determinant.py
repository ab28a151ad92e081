"""On which side of a singular matrix a factorised one is."""

from typing import Any

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, uvec, vec
from .record import DENSE


@compiled
def determinant_sign(lu: Any) -> float:
    """+1 or -1, the sign of the determinant of the matrix factorised last; 1 for n = 0."""
    n = lu.n
    if n == 0:
        return 1.0
    if lu.kind == DENSE:
        inverse, sign = vec(lu.values + 8 * n * n, n), 1.0
        for j in range(n):
            sign = sign if inverse[j] > 0.0 else -sign
        return sign * _parity(lu, ivec(lu.pivots, n))
    inverse, sign = vec(lu.values + 8 * (lu.nl + lu.nu), n), 1.0
    for j in range(n):
        sign = sign if inverse[j] > 0.0 else -sign
    return sign * _parity(lu, uvec(lu.row_at, n)) * _parity(lu, uvec(lu.col_at, n))


@internal
def _parity(lu: Any, at: Any) -> float:
    """+1 for an even permutation, -1 for an odd one."""
    seen, sign = vec(lu.work, lu.n), 1.0
    for j in range(lu.n):
        seen[j] = 0.0
    for j in range(lu.n):
        k, length = j, 0
        while seen[k] == 0.0:
            seen[k] = 1.0
            k = int(at[k])
            length += 1
        if length > 0 and length % 2 == 0:
            sign = -sign
    return sign
