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

from ..assembly.evaluate import constraint_norm, evaluate_residuals, evaluate_tangent
from ..assembly.levels import position_level, rate_level
from ..assembly.redundant_reactions import factor_equations, left_of_sharing, solve_equations
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at, solve
from ..rounding import ONLY_ROUNDING
from ..state.workspace_records import (
    NOT_FINITE,
    OK,
    OUTER_SLOW,
    REANALYZE,
    SINGULAR,
    control_at,
    convergence_at,
    counters_at,
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
def _factored(workspace: Any, lu_address: int, c_q: float, c_v: float) -> int:
    """Factor [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] of the current point."""
    evaluate_tangent(workspace, c_q, c_v)
    status = factor_equations(workspace, lu_address)
    if status == 2:
        return REANALYZE
    counters_at(workspace.counters).factorizations += 1
    return OK if status == 0 else SINGULAR


@internal
def refactor_absolute(workspace: Any, c_q: float, c_v: float) -> int:
    """New matrix at the current point."""
    rate = convergence_at(workspace.rate)
    rate.factor_age = -1.0
    status = _factored(workspace, workspace.kkt, c_q, c_v)
    if status != OK:
        return status
    rate.factor_age, rate.outer_rate = 0.0, 1.0
    rate.last_outer, rate.last_inner, rate.sensitivity = 0.0, 0.0, 0.0
    return OK


@internal
def solve_rows(workspace: Any, c_q: float, c_v: float, index: int) -> None:
    """rhs = (da, dlambda) from the residuals of the current point."""
    n = workspace.n
    rhs = vec(workspace.rhs, n + workspace.m_act)
    r, offset = vec(workspace.r, n), vec(workspace.offset, n)
    active = ivec(workspace.active, workspace.m_act)
    phi, phid, phidd = (
        vec(workspace.phi, workspace.m_ext),
        vec(workspace.phid, workspace.m_ext),
        vec(workspace.phidd, workspace.m_ext),
    )
    control = control_at(workspace.control)
    alpha, beta = control.stage_alpha, control.stage_beta
    for i in range(n):
        rhs[i] = offset[i] - r[i]
    for i in range(workspace.m_act):
        k = active[i]
        if index == 1:
            moved = 1.0 + 2.0 * alpha * c_v
            if i < workspace.m_held:
                moved += beta * beta * c_q
            rhs[n + i] = -(phidd[k] + 2.0 * alpha * phid[k] + beta * beta * phi[k]) / moved
        elif index == 2 or i >= workspace.m_held:
            rhs[n + i] = -phid[k] / c_v
        else:
            rhs[n + i] = -phi[k] / c_q
    left_of_sharing(workspace, False)
    solve(lu_at(workspace.kkt), workspace.rhs)


@internal
def _correct_coordinates(workspace: Any, c_q: float, c_v: float) -> float:
    """q += -h M^-1 Phi_q^T dmu, what brings Phi(q) to zero beside the acceleration increment just added; its norm.

    Called before the residuals are evaluated anew: that increment has moved Phi by -(c_q / c_v) phid.
    """
    n = workspace.n
    rhs = vec(workspace.rhs, n + workspace.m_act)
    active = ivec(workspace.active, workspace.m_act)
    phi, phid = vec(workspace.phi, workspace.m_ext), vec(workspace.phid, workspace.m_ext)
    for i in range(n):
        rhs[i] = 0.0
    for i in range(workspace.m_act):
        # along what velocity-level rows allow
        rhs[n + i] = -phi[active[i]] + c_q / c_v * phid[active[i]] if i < workspace.m_held else 0.0
    solve_equations(workspace, workspace.kkt_query)
    q = vec(workspace.q, n)
    for i in range(n):
        q[i] += rhs[i]
    return weighted_norm(rhs, vec(workspace.weight_q, n), n)


@internal
def _holds(workspace: Any, index: int) -> bool:
    """True if the constraints hold that this form solves for at position and velocity level."""
    if index == 1 or workspace.m_act == 0:
        return True
    control = control_at(workspace.control)
    bound = CONSTRAINT_SLACK * control.position_tolerance * position_level(workspace)
    if not constraint_norm(workspace, workspace.phi) <= bound:
        return False
    bound = CONSTRAINT_SLACK * control.velocity_tolerance * rate_level(workspace)
    if index == 2:
        return constraint_norm(workspace, workspace.phid) <= bound
    # positions say all of the others
    active, phid, row_scale = (
        ivec(workspace.active, workspace.m_act),
        vec(workspace.phid, workspace.m_ext),
        vec(workspace.row_scale, workspace.m_ext),
    )
    for i in range(workspace.m_held, workspace.m_act):
        if not abs(phid[active[i]]) <= bound * row_scale[active[i]]:
            return False
    return True


@inlined
def _only_rounding(workspace: Any, c_q: float) -> bool:
    """True if the increment in `rhs` moves q by rounding only: c_v da, which is larger by 2/h, need not vanish then."""
    rhs, scale = vec(workspace.rhs, workspace.n), vec(workspace.scale, workspace.n)
    largest = 0.0
    for i in range(workspace.n):
        largest = max(largest, abs(c_q * rhs[i]) / scale[i])
    return largest <= ONLY_ROUNDING * position_level(workspace)


@internal
def _iterate(workspace: Any, c_q: float, c_v: float, index: int) -> int:
    control, rate = control_at(workspace.control), convergence_at(workspace.rate)
    counters = counters_at(workspace.counters)
    tolerance = control.newton_tolerance
    previous = np.inf
    renewed = 0
    for k in range(int(control.max_outer)):
        solve_rows(workspace, c_q, c_v, index)
        counters.outer += 1
        norm = increment_norm(workspace, c_q, c_v)
        rounding = index == 3 and _only_rounding(workspace, c_q)
        add_increment(workspace, c_q, c_v)
        if index == 2 and workspace.m_act > 0:
            norm = max(norm, _correct_coordinates(workspace, c_q, c_v))
        if not np.isfinite(norm):
            return NOT_FINITE
        evaluate_residuals(workspace)
        if rounding and _holds(workspace, index):
            rate.last_outer = k + 1
            return OK
        if k > 0:
            status = judge_contraction(rate, norm / previous, norm > tolerance, renewed)
            if status == OUTER_SLOW:
                renewed += 1
                status = refactor_absolute(workspace, c_q, c_v)
            if status != OK:
                return status
        previous = norm
        known = min(max(rate.outer_rate, LEAST_RATE), 0.99)
        if norm * known / (1.0 - known) <= tolerance and _holds(workspace, index):
            rate.last_outer = k + 1
            if k == 0:
                rate.outer_rate = known * RATE_GROWTH
            return OK
    return OUTER_SLOW


@internal
def solve_absolute(workspace: Any, t: float, c_q: float, c_v: float, index: int) -> int:
    """Solve one stage from the predicted a, lambda in the workspace; on failure with old matrices once more with new.

    `index` says which constraints: 1 Baumgarte's combination, 2 positions and velocities, 3 positions.
    """
    rate = convergence_at(workspace.rate)
    begin_stage(workspace, t, c_q, c_v)
    if index == 2 and workspace.m_act > 0:
        # its direction is part of the formula: always that of the predicted point, however old the other matrix is
        status = _factored(workspace, workspace.kkt_query, 0.0, 0.0)
        if status != OK:
            return status
    if rate.factor_age < 0.0 or rate.last_outer > MOST_OUTER:
        status = refactor_absolute(workspace, c_q, c_v)
        if status != OK:
            return status
    fresh = rate.factor_age == 0.0
    rate.factor_age = _USED
    status = _iterate(workspace, c_q, c_v, index)
    if status != OK and not fresh:
        evaluate_prediction(workspace, c_q, c_v)
        status = refactor_absolute(workspace, c_q, c_v)
        if status != OK:
            return status
        status = _iterate(workspace, c_q, c_v, index)
    if rate.factor_age == 0.0:
        rate.factor_age = _USED
    if index == 2:
        _measure_correction(workspace, c_q)
    return status


@internal
def _measure_correction(workspace: Any, c_q: float) -> None:
    """How far h M^-1 Phi_q^T mu has moved the coordinates, in their typical magnitudes."""
    q, q_star, a, scale = (
        vec(workspace.q, workspace.n),
        vec(workspace.q_star, workspace.n),
        vec(workspace.a, workspace.n),
        vec(workspace.scale, workspace.n),
    )
    largest = 0.0
    for i in range(workspace.n):
        largest = max(largest, abs(q[i] - q_star[i] - c_q * a[i]) / scale[i])
    convergence_at(workspace.rate).correction = largest
