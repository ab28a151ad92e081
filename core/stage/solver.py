"""The stage solver.

Given t, q*, v*, c_q, c_v find (q, v, a, lambda) with
  q_i = q*_i + c_q a_i,  v_i = v*_i + c_v a_i                       (independent coordinates)
  Phi(q, t) = 0,  Phi_q v = -Phi_t,  Phi_q a = gamma,  M a + Phi_q^T lambda = Q(q, v, t).

Outer loop `newton`: the increment (da, dlambda) solves [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] (da, dlambda) =
-(r, Phi_q a - gamma), which to first order is the Newton step of the reduced system, since c_q da moves q along the
constraints. The matrices are kept while the iteration converges fast enough, but not for many stages.
The other outer loops (`simple.py`, `jfnk.py`) and the stages of the comparison methods share what stands here.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_constraints, evaluate_residuals
from ..assembly.redundant_reactions import left_of_sharing
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at, solve
from ..state.workspace_records import (
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_SLOW,
    control_at,
    convergence_at,
    counters_at,
)
from .corotating import add_in_frame
from .inner import inner_loop
from .matrices import refactor

# Beyond these the matrices are renewed at the next stage: a factorisation costs about as much as two iterations.
MOST_OUTER = 3
MOST_INNER = 3
# The same where constraints are cheap beside the residuals.
MOST_CHEAP_INNER = 12
# A rate that was measured at an earlier stage is trusted less at each stage that does not measure it anew.
LEAST_RATE = 0.02
RATE_GROWTH = 1.5
# A contraction does not show what old matrices do in single directions: increments that they make too small shrink
# slowly there, behind others that shrink fast. So they are renewed after so many stages.
OLDEST = 30.0
# A contraction above this costs more iterations than a factorisation.
SLOW = 0.2


@internal
def solve_increment(workspace: Any, lu_address: int) -> None:
    """rhs = -matrix^-1 (r, phidd), and what is left of compatibility."""
    rhs = vec(workspace.rhs, workspace.n + workspace.m_act)
    r = vec(workspace.r, workspace.n)
    phidd = vec(workspace.phidd, workspace.m_ext)
    active = ivec(workspace.active, workspace.m_act)
    for i in range(workspace.n):
        rhs[i] = -r[i]
    for i in range(workspace.m_act):
        rhs[workspace.n + i] = -phidd[active[i]]
    left_of_sharing(workspace, False)
    solve(lu_at(lu_address), workspace.rhs)


@internal
def weighted_norm(x: Any, weight: Any, n: int) -> float:
    """Root mean square of x_i / weight_i."""
    total = 0.0
    for i in range(n):
        y = x[i] / weight[i]
        total += y * y
    return np.sqrt(total / max(n, 1))


@internal
def evaluate_prediction(workspace: Any, c_q: float, c_v: float) -> None:
    """Residuals at q = q* + c_q a, v = v* + c_v a of all coordinates; for the dependent ones this is a prediction."""
    q, v, a = vec(workspace.q, workspace.n_ext), vec(workspace.v, workspace.n_ext), vec(workspace.a, workspace.n_ext)
    q_star, v_star = vec(workspace.q_star, workspace.n_ext), vec(workspace.v_star, workspace.n_ext)
    for i in range(workspace.n):
        q[i] = q_star[i] + c_q * a[i]
        v[i] = v_star[i] + c_v * a[i]
    add_in_frame(workspace, a)
    evaluate_residuals(workspace)


@internal
def begin_stage(workspace: Any, t: float, c_q: float, c_v: float) -> None:
    """The time of a stage, and the residuals at the point that its formula makes of the predicted accelerations."""
    vec(workspace.t, 1)[0] = t
    counters_at(workspace.counters).stages += 1
    evaluate_prediction(workspace, c_q, c_v)


@internal
def prepare_attempt(workspace: Any, c_q: float, c_v: float, attempt: int, most_outer: int) -> int:
    """Matrices for attempt 0 or 1 at a stage: first the old ones, unless they have become slow (more than `most_outer`
    iterations at the last stage) or too old; then new ones at the predicted point. FACTOR_AGE is 1 if they are new."""
    rate = convergence_at(workspace.rate)
    if attempt > 0:
        evaluate_prediction(workspace, c_q, c_v)
    most_inner = MOST_INNER if workspace.part_first == 0 else MOST_CHEAP_INNER
    slow = rate.last_outer > most_outer or rate.last_inner > most_inner
    # in turning frames coordinates are predicted so well that their increments tell nothing of the matrices, which turn
    # with the bodies: old ones would leave multipliers wrong, unseen
    if attempt > 0 or slow or workspace.n_spins > 0 or not 0.0 <= rate.factor_age < OLDEST:
        status = refactor(workspace, c_q, c_v)
        if status != OK:
            return status
    rate.factor_age += 1.0
    return OK


@internal
def increment_norm(workspace: Any, c_q: float, c_v: float) -> float:
    """Size of the acceleration increment in `rhs`, as the change of q and v that it makes, in error weights."""
    increment = vec(workspace.rhs, workspace.n + workspace.m_act)
    of_q = weighted_norm(increment, vec(workspace.weight_q, workspace.n_ext), workspace.n)
    of_v = weighted_norm(increment, vec(workspace.weight_v, workspace.n_ext), workspace.n)
    return max(c_q * of_q, c_v * of_v)


@internal
def add_increment(workspace: Any, c_q: float, c_v: float) -> None:
    """Add the increments of accelerations and multipliers in `rhs`; q and v follow."""
    n, m_act = workspace.n, workspace.m_act
    q, v, a = vec(workspace.q, workspace.n_ext), vec(workspace.v, workspace.n_ext), vec(workspace.a, workspace.n_ext)
    lam, rows = vec(workspace.lam, workspace.m_ext), m_act + workspace.n_implied
    active = ivec(workspace.active, rows)
    increment = vec(workspace.rhs, n + rows)
    for i in range(n):
        q[i] += c_q * increment[i]
        v[i] += c_v * increment[i]
        a[i] += increment[i]
    add_in_frame(workspace, increment)
    for i in range(rows):
        lam[active[i]] += increment[n + i]


@inlined
def inner_slack(control: Any) -> float:
    """By how much the inner loop may be looser while the outer one moves: before that has converged, the constraints
    need to hold only a hundred times better than it does, or as well as the formula asks for."""
    enough = 0.01 * control.newton_tolerance * control.rtol / control.position_tolerance
    return max(1.0, min(control.most_slack, enough))


@inlined
def judge_contraction(rate: Any, contraction: float, wanting: bool, renewed: int) -> int:
    """OK, OUTER_DIVERGED, or OUTER_SLOW: the matrix of the predicted point is not good enough, that of the present one
    is. `wanting`: the tolerance is not met; `renewed`: how often the matrix has been renewed in this iteration."""
    rate.outer_rate = max(0.3 * rate.outer_rate, contraction)
    if contraction > 0.9 and wanting and (renewed > 0 or contraction > 2.0):
        rate.failed_norm = contraction
        return OUTER_DIVERGED
    return OUTER_SLOW if contraction > SLOW and wanting and renewed < 2 else OK


@internal
def solve_stage(workspace: Any, t: float, c_q: float, c_v: float) -> int:
    """Solve one stage from the predicted a, lambda in the workspace. Returns OK or what went wrong.

    On failure with old matrices it tries once more with new ones.
    """
    begin_stage(workspace, t, c_q, c_v)
    status = OK
    for attempt in range(2):
        status = prepare_attempt(workspace, c_q, c_v, attempt, MOST_OUTER)
        if status != OK:
            return status
        fresh = convergence_at(workspace.rate).factor_age == 1.0
        status = _iterate(workspace, c_q, c_v)
        if status == OK or fresh:
            break
    return status


@internal
def _iterate(workspace: Any, c_q: float, c_v: float) -> int:
    """The outer loop."""
    control = control_at(workspace.control)
    counters = counters_at(workspace.counters)
    rate = convergence_at(workspace.rate)
    tolerance = control.newton_tolerance
    start_inner = counters.inner
    previous = np.inf
    renewed = 0
    slack = inner_slack(control)
    status = OUTER_SLOW
    for k in range(int(control.max_outer)):
        status = inner_loop(workspace, workspace.lu_d, slack, np.inf, k > 0)
        if status != OK:
            return status
        solve_increment(workspace, workspace.kkt)
        counters.outer += 1
        norm = increment_norm(workspace, c_q, c_v)
        if not np.isfinite(norm):
            return NOT_FINITE
        add_increment(workspace, c_q, c_v)
        evaluate_constraints(workspace)
        if control.is_linear > 0.0 and c_v == rate.factor_cv and renewed == 0 and k == 0:
            # the matrices are those of the equations: a second increment would be rounding
            rate.last_outer, status = 1.0, OK
            break
        if k > 0:
            status = judge_contraction(rate, norm / previous, norm > tolerance, renewed)
            if status == OUTER_SLOW:
                renewed += 1
                status = refactor(workspace, c_q, c_v)
            if status != OK:
                return status
        previous = norm
        known = min(max(rate.outer_rate, LEAST_RATE), 0.99)
        if norm * known / (1.0 - known) <= tolerance:
            status = OK
            rate.last_outer = k + 1
            if k == 0:
                rate.outer_rate = known * RATE_GROWTH
            break
        status = OUTER_SLOW
    if status != OK:
        return status
    status = inner_loop(workspace, workspace.lu_d, 1.0, 1.0, True)
    rate.last_inner = counters.inner - start_inner
    return status
