"""The stage solver.

Given t, q*, v*, c_q, c_v find (q, v, a, lambda) with
  q_i = q*_i + c_q a_i,  v_i = v*_i + c_v a_i                       (independent coordinates)
  Phi(q, t) = 0,  Phi_q v = -Phi_t,  Phi_q a = gamma,  M a + Phi_q^T lambda = Q(q, v, t).

Outer loop `newton`: the increment (da, dlambda) solves [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] (da, dlambda) =
-(r, Phi_q a - gamma), which to first order is the Newton step of the reduced system, since c_q da moves q along the
constraints. The matrices are kept while the iteration converges fast enough.
The other outer loops (`simple.py`, `jfnk.py`) and the stages of the comparison methods share what stands here.
"""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, inlined, internal
from ..compiled.views import ivec, vec
from ..linalg import factor, lu_at, solve
from ..system.evaluate import constraint_norm, evaluate_residuals, evaluate_tangent
from ..system.records import (
    CONTROL_SIZE,
    COUNTERS_SIZE,
    FACTOR_AGE,
    FACTOR_CQ,
    FACTOR_CV,
    FACTORIZATIONS,
    FAILED_NORM,
    FIRST_SENSITIVITY,
    INNER,
    LAST_INNER,
    LAST_OUTER,
    MAX_OUTER,
    NEWTON_TOLERANCE,
    NOT_FINITE,
    OK,
    OUTER,
    OUTER_DIVERGED,
    OUTER_RATE,
    OUTER_SLOW,
    POSITION_TOLERANCE,
    RATE_SIZE,
    REANALYZE,
    RTOL,
    SENSITIVITY,
    SINGULAR,
    STAGES,
    VELOCITY_TOLERANCE,
)
from .inner import correct_dependent, inner_loop, rounding_level

# Beyond these the matrices are renewed at the next stage: a factorisation costs about as much as two iterations.
MOST_OUTER = 3
MOST_INNER = 3
# A rate that was measured at an earlier stage is trusted less at each stage that does not measure it anew.
LEAST_RATE = 0.02
RATE_GROWTH = 1.5
# A contraction above this costs more iterations than a factorisation.
SLOW = 0.2


@compiled
def refactor(ws: Any, c_q: float, c_v: float) -> int:
    """New matrices at the current point: [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] and Phi_qd."""
    rate = vec(ws.rate, RATE_SIZE)
    evaluate_tangent(ws, c_q, c_v)
    rate[FACTOR_AGE] = -1.0
    for address in (ws.kkt, ws.lu_d):
        if address == ws.lu_d and ws.m_act == 0:
            continue
        status = factor(lu_at(address), ws.values)
        if status == 2:
            return REANALYZE
        if status != 0:
            return SINGULAR
    _measure_sensitivity(ws)
    ivec(ws.counters, COUNTERS_SIZE)[FACTORIZATIONS] += 1
    rate[FACTOR_AGE], rate[FACTOR_CQ], rate[FACTOR_CV] = 0.0, c_q, c_v
    rate[OUTER_RATE], rate[LAST_OUTER], rate[LAST_INNER] = 1.0, 0.0, 0.0
    return OK


@internal
def _measure_sensitivity(ws: Any) -> None:
    """How much the dependent coordinates move (scaled) for one move of all independent ones: |Phi_qd^-1 Phi_qi x|."""
    rate = vec(ws.rate, RATE_SIZE)
    if ws.m_act == 0 or ws.m_act == ws.n:
        return
    scale = vec(ws.scale, ws.n)
    values = vec(ws.values, ws.n_values)
    row, col, slot = ivec(ws.free_row, ws.n_free), ivec(ws.free_col, ws.n_free), ivec(ws.free_slot, ws.n_free)
    dependent = ivec(ws.dependent, ws.m_act)
    rhs = vec(ws.rhs, ws.m_act)
    for i in range(ws.m_act):
        rhs[i] = 0.0
    for e in range(ws.n_free):
        # weights between 1/2 and 3/2 in no simple ratio, so that the columns do not cancel
        golden = 0.6180339887498949 * col[e]
        rhs[row[e]] += values[slot[e]] * scale[col[e]] * (0.5 + golden - np.floor(golden))
    solve(lu_at(ws.lu_d), ws.rhs)
    largest = 0.0
    for i in range(ws.m_act):
        largest = max(largest, abs(rhs[i]) / scale[dependent[i]])
    rate[SENSITIVITY] = largest
    if rate[FIRST_SENSITIVITY] < 0.0:
        rate[FIRST_SENSITIVITY] = largest


@compiled
def solve_increment(ws: Any, lu_address: int) -> None:
    """rhs = -matrix^-1 (r, phidd)."""
    rhs = vec(ws.rhs, ws.n + ws.m_act)
    r = vec(ws.r, ws.n)
    phidd = vec(ws.phidd, ws.m_ext)
    active = ivec(ws.active, ws.m_act)
    for i in range(ws.n):
        rhs[i] = -r[i]
    for i in range(ws.m_act):
        rhs[ws.n + i] = -phidd[active[i]]
    solve(lu_at(lu_address), ws.rhs)


@internal
def weighted_norm(x: Any, weight: Any, n: int) -> float:
    """Root mean square of x_i / weight_i."""
    total = 0.0
    for i in range(n):
        y = x[i] / weight[i]
        total += y * y
    return np.sqrt(total / max(n, 1))


@compiled
def set_from_accelerations(ws: Any, c_q: float, c_v: float) -> None:
    """q = q* + c_q a, v = v* + c_v a for all coordinates; for the dependent ones this is a prediction."""
    q, v, a = vec(ws.q, ws.n_ext), vec(ws.v, ws.n_ext), vec(ws.a, ws.n_ext)
    q_star, v_star = vec(ws.q_star, ws.n_ext), vec(ws.v_star, ws.n_ext)
    for i in range(ws.n):
        q[i] = q_star[i] + c_q * a[i]
        v[i] = v_star[i] + c_v * a[i]


@internal
def increment_norm(ws: Any, c_q: float, c_v: float) -> float:
    """Size of the acceleration increment in `rhs`, as the change of q and v that it makes, in error weights."""
    increment = vec(ws.rhs, ws.n + ws.m_act)
    of_q = weighted_norm(increment, vec(ws.weight_q, ws.n_ext), ws.n)
    of_v = weighted_norm(increment, vec(ws.weight_v, ws.n_ext), ws.n)
    return max(c_q * of_q, c_v * of_v)


@internal
def add_increment(ws: Any, c_q: float, c_v: float) -> None:
    """Add the increments of accelerations and multipliers in `rhs`; q and v follow."""
    n, m_act = ws.n, ws.m_act
    q, v, a = vec(ws.q, ws.n_ext), vec(ws.v, ws.n_ext), vec(ws.a, ws.n_ext)
    lam = vec(ws.lam, ws.m_ext)
    active = ivec(ws.active, m_act)
    increment = vec(ws.rhs, n + m_act)
    for i in range(n):
        q[i] += c_q * increment[i]
        v[i] += c_v * increment[i]
        a[i] += increment[i]
    for i in range(m_act):
        lam[active[i]] += increment[n + i]


@inlined
def inner_slack(control: Any) -> float:
    """By how much the inner loop may be looser while the outer one moves: before that has converged, the constraints
    need to hold only a hundred times better than it does."""
    return max(1.0, min(1e4, 0.01 * control[NEWTON_TOLERANCE] * control[RTOL] / control[POSITION_TOLERANCE]))


@internal
def solve_stage(ws: Any, t: float, c_q: float, c_v: float) -> int:
    """Solve one stage from the predicted a, lambda in the workspace. Returns OK or what went wrong.

    On failure with old matrices it tries once more with new ones.
    """
    rate = vec(ws.rate, RATE_SIZE)
    vec(ws.t, 1)[0] = t
    ivec(ws.counters, COUNTERS_SIZE)[STAGES] += 1
    set_from_accelerations(ws, c_q, c_v)
    evaluate_residuals(ws)
    if rate[FACTOR_AGE] < 0.0 or rate[LAST_OUTER] > MOST_OUTER or rate[LAST_INNER] > MOST_INNER:
        status = refactor(ws, c_q, c_v)
        if status != OK:
            return status
    fresh = rate[FACTOR_AGE] == 0.0
    rate[FACTOR_AGE] += 1.0
    status = _iterate(ws, c_q, c_v)
    if status == OK or fresh:
        return status
    set_from_accelerations(ws, c_q, c_v)
    evaluate_residuals(ws)
    status = refactor(ws, c_q, c_v)
    if status != OK:
        return status
    rate[FACTOR_AGE] += 1.0
    return _iterate(ws, c_q, c_v)


# Residual of the constraints (of positions, relative) up to which one correction is as good as the inner loop.
NEAR = 1e-3
# Iterations in which that is tried; a stage that needs more has the constraints met first.
MOST_AT_ONCE = 3


@internal
def _correction_size(ws: Any, weight_address: int) -> float:
    """Size of the last correction of dependent coordinates or velocities, in error weights."""
    rhs, dependent = vec(ws.rhs, ws.m_act), ivec(ws.dependent, ws.m_act)
    weight = vec(weight_address, ws.n_ext)
    total = 0.0
    for i in range(ws.m_act):
        y = rhs[i] / weight[dependent[i]]
        total += y * y
    return np.sqrt(total / max(ws.m_act, 1))


@internal
def _iterate(ws: Any, c_q: float, c_v: float) -> int:
    """The outer loop."""
    control = vec(ws.control, CONTROL_SIZE)
    counters = ivec(ws.counters, COUNTERS_SIZE)
    rate = vec(ws.rate, RATE_SIZE)
    tolerance = control[NEWTON_TOLERANCE]
    most_inner = 0
    previous = np.inf
    renewed = 0
    slack = inner_slack(control)
    # where the accelerations shall be finer than the constraints, these have to come first
    near = NEAR if tolerance * control[RTOL] > control[POSITION_TOLERANCE] else 0.0
    status = OUTER_SLOW
    for k in range(int(control[MAX_OUTER])):
        of_q, of_v = 0.0, 0.0
        position, size = constraint_norm(ws, ws.phi), rounding_level(ws, ws.q)
        if k < MOST_AT_ONCE and position <= near * size:
            # The residual stays that of the uncorrected point: what it misses, the next iteration makes good.
            if position > slack * control[POSITION_TOLERANCE] * size:
                correct_dependent(ws, ws.lu_d, ws.phi, ws.q)
                of_q = _correction_size(ws, ws.weight_q)
            if constraint_norm(ws, ws.phid) > slack * control[VELOCITY_TOLERANCE] * rounding_level(ws, ws.v):
                correct_dependent(ws, ws.lu_d, ws.phid, ws.v)
                of_v = _correction_size(ws, ws.weight_v)
        else:
            start_inner = counters[INNER]
            status = inner_loop(ws, ws.lu_d, slack, np.inf)
            most_inner = max(most_inner, counters[INNER] - start_inner)
            if status != OK:
                return status
        solve_increment(ws, ws.kkt)
        counters[OUTER] += 1
        norm = increment_norm(ws, c_q, c_v)
        if not np.isfinite(norm):
            return NOT_FINITE
        add_increment(ws, c_q, c_v)
        evaluate_residuals(ws)
        if k > 0:
            contraction = norm / previous
            rate[OUTER_RATE] = max(0.3 * rate[OUTER_RATE], contraction)
            if contraction > 0.9 and norm > tolerance and (renewed > 0 or contraction > 2.0):
                rate[FAILED_NORM] = contraction
                return OUTER_DIVERGED
            if contraction > SLOW and norm > tolerance and renewed < 2:
                # the matrix of the predicted point is not good enough: that of the present one is
                renewed += 1
                status = refactor(ws, c_q, c_v)
                if status != OK:
                    return status
        # what has been corrected acts on the accelerations through the next residual, as the increment does
        previous = max(norm, of_q, of_v)
        known = min(max(rate[OUTER_RATE], LEAST_RATE), 0.99)
        if previous * known / (1.0 - known) <= tolerance and of_q <= tolerance:
            status = OK
            rate[LAST_OUTER] = k + 1
            if k == 0:
                rate[OUTER_RATE] = known * RATE_GROWTH
            break
        status = OUTER_SLOW
    if status != OK:
        return status
    start_inner = counters[INNER]
    status = inner_loop(ws, ws.lu_d, 1.0, 1.0)
    rate[LAST_INNER] = max(most_inner, counters[INNER] - start_inner)
    return status
