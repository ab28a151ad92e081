"""Energy of a spring whose force is a table."""

from typing import Any

from ..compiled.jit import internal


@internal
def energy_of_table(pool: Any, offset: int, x: float) -> float:
    """Integral of the spline at `offset` of the pool from its first knot to x: the four coefficients of each interval
    follow the knots."""
    n, total = int(pool[offset + 1]), 0.0
    knots = pool[offset + 2 : offset + 2 + n]
    for i in range(n - 1):
        last = i == n - 2
        s = (x if last or x < knots[i + 1] else knots[i + 1]) - knots[i]
        c = offset + 2 + n + 4 * i
        total += s * (pool[c + 3] + s * (pool[c + 2] / 2.0 + s * (pool[c + 1] / 3.0 + s * pool[c] / 4.0)))
        if last or x < knots[i + 1]:
            break
    return total
