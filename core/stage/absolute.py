"""Newton's iteration for stages in which all coordinates are integrated, as the comparison methods do it.

Given t, q*, v*, c_q, c_v find (a, lambda) with q = q* + c_q a, v = v* + c_v a for every coordinate and
  M a + Phi_q^T lambda - Q = offset                     (offset: what a force filter carries over, else zero)
and the constraints at one level or two (`index1.py`, `index2.py`, `index3.py`). No coordinate is dependent.

The increment (da, dlambda) solves the matrix of TLISMNI's stages, [M + c_v D + c_q K, Phi_q^T; Phi_q, 0], with the
constraint rows divided by what da does to them: the scaling by c_q and c_v that keeps the index-3 and index-2 matrices
well conditioned for small steps (Negrut et al. 2007; Bottasso et al. 2007). The matrix is kept while it converges.
"""

from typing import Any

import numpy as np

from ..assembly.compatibility import factor_equations, left_of_sharing, solve_equations
from ..assembly.evaluate import constraint_norm, evaluate_residuals, evaluate_tangent
from ..assembly.levels import position_level, rate_level
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at, solve
from ..rounding import ONLY_ROUNDING
from ..state.workspace_records import (
    CONTROL_SIZE,
    CORRECTION,
    COUNTERS_SIZE,
    FACTOR_AGE,
    FACTORIZATIONS,
    LAST_INNER,
    LAST_OUTER,
    MAX_OUTER,
    NEWTON_TOLERANCE,
    NOT_FINITE,
    OK,
    OUTER,
    OUTER_RATE,
    OUTER_SLOW,
    POSITION_TOLERANCE,
    RATE_SIZE,
    REANALYZE,
    SENSITIVITY,
    SINGULAR,
    STAGE_ALPHA,
    STAGE_BETA,
    VELOCITY_TOLERANCE,
)
from .solver import (
    LEAST_RATE,
    MOST_OUTER,
    RATE_GROWTH,
    add_increment,
    begin_stage,
    evaluate_prediction,
    increment_norm,
    judge_contraction,
    weighted_norm,
)

CONSTRAINT_SLACK = 1000.0
"""The constraints that Newton solves hold to this many times the tolerances of TLISMNI's inner loop: to 1e-10."""
_USED = 1.0  # age of a factorisation that has been used; there is no partition whose strain would call for a new one


@internal
def _factored(ws: Any, lu_address: int, c_q: float, c_v: float) -> int:
    """Factor [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] of the current point."""
    evaluate_tangent(ws, c_q, c_v)
    status = factor_equations(ws, lu_address)
    if status == 2:
        return REANALYZE
    ivec(ws.counters, COUNTERS_SIZE)[FACTORIZATIONS] += 1
    return OK if status == 0 else SINGULAR


@internal
def refactor_absolute(ws: Any, c_q: float, c_v: float) -> int:
    """New matrix at the current point."""
    rate = vec(ws.rate, RATE_SIZE)
    rate[FACTOR_AGE] = -1.0
    status = _factored(ws, ws.kkt, c_q, c_v)
    if status != OK:
        return status
    rate[FACTOR_AGE], rate[OUTER_RATE] = 0.0, 1.0
    rate[LAST_OUTER], rate[LAST_INNER], rate[SENSITIVITY] = 0.0, 0.0, 0.0
    return OK


@internal
def solve_rows(ws: Any, c_q: float, c_v: float, index: int) -> None:
    """rhs = (da, dlambda) from the residuals of the current point."""
    n = ws.n
    rhs = vec(ws.rhs, n + ws.m_act)
    r, offset = vec(ws.r, n), vec(ws.offset, n)
    active = ivec(ws.active, ws.m_act)
    phi, phid, phidd = vec(ws.phi, ws.m_ext), vec(ws.phid, ws.m_ext), vec(ws.phidd, ws.m_ext)
    control = vec(ws.control, CONTROL_SIZE)
    alpha, beta = control[STAGE_ALPHA], control[STAGE_BETA]
    for i in range(n):
        rhs[i] = offset[i] - r[i]
    for i in range(ws.m_act):
        k = active[i]
        if index == 1:
            moved = 1.0 + 2.0 * alpha * c_v
            if i < ws.m_held:
                moved += beta * beta * c_q
            rhs[n + i] = -(phidd[k] + 2.0 * alpha * phid[k] + beta * beta * phi[k]) / moved
        elif index == 2 or i >= ws.m_held:
            rhs[n + i] = -phid[k] / c_v
        else:
            rhs[n + i] = -phi[k] / c_q
    left_of_sharing(ws, False)
    solve(lu_at(ws.kkt), ws.rhs)


@internal
def _correct_coordinates(ws: Any, c_q: float, c_v: float) -> float:
    """q += -h M^-1 Phi_q^T dmu, what brings Phi(q) to zero beside the acceleration increment just added; its norm.

    Called before the residuals are evaluated anew: that increment has moved Phi by -(c_q / c_v) phid.
    """
    n = ws.n
    rhs = vec(ws.rhs, n + ws.m_act)
    active = ivec(ws.active, ws.m_act)
    phi, phid = vec(ws.phi, ws.m_ext), vec(ws.phid, ws.m_ext)
    for i in range(n):
        rhs[i] = 0.0
    for i in range(ws.m_act):
        # along what velocity-level rows allow
        rhs[n + i] = -phi[active[i]] + c_q / c_v * phid[active[i]] if i < ws.m_held else 0.0
    solve_equations(ws, ws.kkt_query)
    q = vec(ws.q, n)
    for i in range(n):
        q[i] += rhs[i]
    return weighted_norm(rhs, vec(ws.weight_q, n), n)


@internal
def _holds(ws: Any, index: int) -> bool:
    """True if the constraints hold that this form solves for at position and velocity level."""
    if index == 1 or ws.m_act == 0:
        return True
    control = vec(ws.control, CONTROL_SIZE)
    bound = CONSTRAINT_SLACK * control[POSITION_TOLERANCE] * position_level(ws)
    if not constraint_norm(ws, ws.phi) <= bound:
        return False
    bound = CONSTRAINT_SLACK * control[VELOCITY_TOLERANCE] * rate_level(ws)
    if index == 2:
        return constraint_norm(ws, ws.phid) <= bound
    # positions say all of the others
    active, phid, row_scale = ivec(ws.active, ws.m_act), vec(ws.phid, ws.m_ext), vec(ws.row_scale, ws.m_ext)
    for i in range(ws.m_held, ws.m_act):
        if not abs(phid[active[i]]) <= bound * row_scale[active[i]]:
            return False
    return True


@inlined
def _only_rounding(ws: Any, c_q: float) -> bool:
    """True if the increment in `rhs` moves q by rounding only: c_v da, which is larger by 2/h, need not vanish then."""
    rhs, scale = vec(ws.rhs, ws.n), vec(ws.scale, ws.n)
    largest = 0.0
    for i in range(ws.n):
        largest = max(largest, abs(c_q * rhs[i]) / scale[i])
    return largest <= ONLY_ROUNDING * position_level(ws)


@internal
def _iterate(ws: Any, c_q: float, c_v: float, index: int) -> int:
    control, rate = vec(ws.control, CONTROL_SIZE), vec(ws.rate, RATE_SIZE)
    counters = ivec(ws.counters, COUNTERS_SIZE)
    tolerance = control[NEWTON_TOLERANCE]
    previous = np.inf
    renewed = 0
    for k in range(int(control[MAX_OUTER])):
        solve_rows(ws, c_q, c_v, index)
        counters[OUTER] += 1
        norm = increment_norm(ws, c_q, c_v)
        rounding = index == 3 and _only_rounding(ws, c_q)
        add_increment(ws, c_q, c_v)
        if index == 2 and ws.m_act > 0:
            norm = max(norm, _correct_coordinates(ws, c_q, c_v))
        if not np.isfinite(norm):
            return NOT_FINITE
        evaluate_residuals(ws)
        if rounding and _holds(ws, index):
            rate[LAST_OUTER] = k + 1
            return OK
        if k > 0:
            status = judge_contraction(rate, norm / previous, norm > tolerance, renewed)
            if status == OUTER_SLOW:
                renewed += 1
                status = refactor_absolute(ws, c_q, c_v)
            if status != OK:
                return status
        previous = norm
        known = min(max(rate[OUTER_RATE], LEAST_RATE), 0.99)
        if norm * known / (1.0 - known) <= tolerance and _holds(ws, index):
            rate[LAST_OUTER] = k + 1
            if k == 0:
                rate[OUTER_RATE] = known * RATE_GROWTH
            return OK
    return OUTER_SLOW


@internal
def solve_absolute(ws: Any, t: float, c_q: float, c_v: float, index: int) -> int:
    """Solve one stage from the predicted a, lambda in the workspace; on failure with old matrices once more with new.

    `index` says which constraints: 1 Baumgarte's combination, 2 positions and velocities, 3 positions.
    """
    rate = vec(ws.rate, RATE_SIZE)
    begin_stage(ws, t, c_q, c_v)
    if index == 2 and ws.m_act > 0:
        # its direction is part of the formula: always that of the predicted point, however old the other matrix is
        status = _factored(ws, ws.kkt_query, 0.0, 0.0)
        if status != OK:
            return status
    if rate[FACTOR_AGE] < 0.0 or rate[LAST_OUTER] > MOST_OUTER:
        status = refactor_absolute(ws, c_q, c_v)
        if status != OK:
            return status
    fresh = rate[FACTOR_AGE] == 0.0
    rate[FACTOR_AGE] = _USED
    status = _iterate(ws, c_q, c_v, index)
    if status != OK and not fresh:
        evaluate_prediction(ws, c_q, c_v)
        status = refactor_absolute(ws, c_q, c_v)
        if status != OK:
            return status
        status = _iterate(ws, c_q, c_v, index)
    if rate[FACTOR_AGE] == 0.0:
        rate[FACTOR_AGE] = _USED
    if index == 2:
        _measure_correction(ws, c_q)
    return status


@internal
def _measure_correction(ws: Any, c_q: float) -> None:
    """How far h M^-1 Phi_q^T mu has moved the coordinates, in their typical magnitudes."""
    q, q_star, a, scale = vec(ws.q, ws.n), vec(ws.q_star, ws.n), vec(ws.a, ws.n), vec(ws.scale, ws.n)
    largest = 0.0
    for i in range(ws.n):
        largest = max(largest, abs(q[i] - q_star[i] - c_q * a[i]) / scale[i])
    vec(ws.rate, RATE_SIZE)[CORRECTION] = largest
