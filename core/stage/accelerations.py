"""Accelerations and multipliers of a point whose coordinates and velocities are known."""

from typing import Any

import numpy as np

from ..compiled.jit import compiled_unlocked, internal
from ..compiled.views import ivec, vec
from ..linalg import factor, lu_at
from ..system.evaluate import evaluate_residuals, evaluate_tangent
from ..system.records import OK, OUTER_SLOW, REANALYZE
from .solver import solve_increment


@internal
def _largest(x: Any, n: int) -> float:
    """Largest magnitude of the first n entries; infinity if one is not a number."""
    largest = 0.0
    for i in range(n):
        if np.isnan(x[i]):
            return np.inf
        largest = max(largest, abs(x[i]))
    return largest


@compiled_unlocked
def solve_accelerations(ws: Any) -> int:
    """(a, lambda) of the current (q, v) from the augmented system [M, Phi_q^T; Phi_q, 0], with matrices of its own."""
    n = ws.n
    a, lam = vec(ws.a, ws.n_ext), vec(ws.lam, ws.m_ext)
    active = ivec(ws.active, ws.m_act)
    increment = vec(ws.rhs, n + ws.m_act)
    evaluate_tangent(ws, 0.0, 0.0)
    if factor(lu_at(ws.kkt_query), ws.values) != 0:
        return REANALYZE
    previous, norm, size = np.inf, np.inf, 0.0
    for _ in range(10):
        evaluate_residuals(ws)
        solve_increment(ws, ws.kkt_query)
        for i in range(n):
            a[i] += increment[i]
        for i in range(ws.m_act):
            lam[active[i]] += increment[n + i]
        norm, size = _largest(increment, n), _largest(a, n)
        if norm <= 1e-14 * (1.0 + size) or norm >= previous:
            break
        previous = norm
    evaluate_residuals(ws)
    return OK if norm <= 1e-8 * (1.0 + size) < np.inf else OUTER_SLOW
