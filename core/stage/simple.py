"""Outer loop `simple`: the fixed point of Shabana and Hussein (2009), with optional acceleration.

Each iteration solves the augmented system with the true M and Phi_q for (a, lambda) and puts a into the formula. It
contracts by about c_q omega^2 + c_v |D/M|, omega the highest frequency of the mechanism: no step beyond that of an
explicit method.
Aitken: relaxation by Irons and Tuck (1969). Anderson (1965): the combination of the last m iterates whose residual is
least; at most m + 1 further vectors.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals
from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..state.workspace_records import (
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_SLOW,
    control_at,
    convergence_at,
    counters_at,
)
from .inner import inner_loop
from .matrices import refactor
from .solver import add_increment, begin_stage, increment_norm, inner_slack, solve_increment

AITKEN = 1.0
MOST_DEPTH = 5
# rows of `basis`: the previous step and residual, differences of iterates and of residuals, an orthogonal basis
BASIS_ROWS = 2 + 3 * MOST_DEPTH
_HOPELESS = 1e3


@internal
def _relax(workspace: Any, k: int, before: float) -> float:
    """Aitken's factor from this residual (in `rhs`) and the previous one; rhs becomes the relaxed increment."""
    n = workspace.n
    increment = vec(workspace.rhs, n + workspace.m_act)
    previous = mat(workspace.basis, workspace.n_basis, workspace.n_ext)[0]
    weight = vec(workspace.weight_v, workspace.n_ext)
    factor = 1.0
    if k > 0:
        along, square = 0.0, 0.0
        for i in range(n):
            change = (increment[i] - previous[i]) / weight[i]
            along += previous[i] / weight[i] * change
            square += change * change
        if square > 0.0:
            factor = -before * along / square
    for i in range(n):
        previous[i] = increment[i]
        increment[i] *= factor
    return factor


@internal
def _mix(workspace: Any, k: int, depth: int) -> None:
    """Anderson's increment in `rhs`, from this residual and the differences of the last `depth` iterations.

    With f the residual, dF and dX the differences: f - (dX + dF) gamma, gamma the least-squares solution of
    dF gamma = f by modified Gram-Schmidt in the error weights; nearly dependent differences are left out.
    """
    n = workspace.n
    increment = vec(workspace.rhs, n + workspace.m_act)
    basis = mat(workspace.basis, workspace.n_basis, workspace.n_ext)
    weight = vec(workspace.weight_v, workspace.n_ext)
    last_step, last_residual = basis[0], basis[1]
    if k > 0:
        at = (k - 1) % depth
        for i in range(n):
            basis[2 + at, i] = last_step[i]
            basis[2 + MOST_DEPTH + at, i] = increment[i] - last_residual[i]
    for i in range(n):
        last_residual[i] = increment[i]
    count = min(k, depth)
    # rows 2 + 2 MOST_DEPTH ...: [dF_j in weights], orthogonalised, newest first; each keeps its own dX + dF
    for j in range(count):
        at = (k - 1 - j) % depth
        column = basis[2 + 2 * MOST_DEPTH + j]
        move = basis[2 + at]
        change = basis[2 + MOST_DEPTH + at]
        before = 0.0
        for i in range(n):
            column[i] = change[i] / weight[i]
            before += column[i] * column[i]
        after = before
        for _ in range(2):
            for o in range(j):
                other = basis[2 + 2 * MOST_DEPTH + o]
                along, square = 0.0, 0.0
                for i in range(n):
                    along += other[i] * column[i]
                    square += other[i] * other[i]
                if square > 0.0:
                    along /= square
                    from_move = basis[2 + (k - 1 - o) % depth]
                    from_change = basis[2 + MOST_DEPTH + (k - 1 - o) % depth]
                    for i in range(n):
                        column[i] -= along * other[i]
                        move[i] -= along * from_move[i]
                        change[i] -= along * from_change[i]
        after = 0.0
        for i in range(n):
            after += column[i] * column[i]
        if after <= 1e-12 * before:
            for i in range(n):
                column[i] = 0.0
            continue
        along = 0.0
        for i in range(n):
            along += column[i] * increment[i] / weight[i]
        along /= after
        for i in range(n):
            increment[i] -= along * (move[i] + change[i])
    for i in range(n):
        last_step[i] = increment[i]


@internal
def solve_simple_stage(workspace: Any, t: float, c_q: float, c_v: float) -> int:
    """Solve one stage by the fixed point, from the predicted a, lambda in the workspace."""
    control, counters, rate = (
        control_at(workspace.control), counters_at(workspace.counters), convergence_at(workspace.rate),
    )  # fmt: skip
    begin_stage(workspace, t, c_q, c_v)
    tolerance, slack, acceleration = control.newton_tolerance, inner_slack(control), control.acceleration
    start_inner = counters.inner
    previous, first, relaxation = np.inf, 0.0, 1.0
    status = OUTER_SLOW
    for k in range(int(control.max_outer)):
        # the first matrices come from the predicted point, which may miss the constraints a little
        if k == 0:
            status = refactor(workspace, 0.0, 0.0)
            if status != OK:
                return status
        status = inner_loop(workspace, workspace.lu_d, slack, np.inf)
        if status != OK:
            return status
        if k > 0:
            status = refactor(workspace, 0.0, 0.0)
            if status != OK:
                return status
        solve_increment(workspace, workspace.kkt)
        counters.outer += 1
        norm = increment_norm(workspace, c_q, c_v)
        if not np.isfinite(norm):
            return NOT_FINITE
        contraction = norm / previous
        if k == 0:
            first = norm
        elif norm > tolerance:
            plain = acceleration == 0.0
            if (plain and contraction > 0.9) or norm > _HOPELESS * first:
                rate.failed_norm = contraction
                return OUTER_DIVERGED
        if acceleration == AITKEN:
            relaxation = _relax(workspace, k, relaxation)
        elif acceleration > AITKEN:
            _mix(workspace, k, int(acceleration) - 1)
        add_increment(workspace, c_q, c_v)
        evaluate_residuals(workspace)
        if k > 0:
            rate.outer_rate = max(0.3 * rate.outer_rate, contraction)
            known = min(rate.outer_rate, 0.99)
        else:
            known = 0.5
        previous = norm
        if norm * known / (1.0 - known) <= tolerance:
            status = OK
            rate.last_outer = k + 1
            break
        rate.failed_norm = contraction
        status = OUTER_SLOW
    if status != OK:
        return status
    status = inner_loop(workspace, workspace.lu_d, 1.0, 1.0)
    rate.last_inner = counters.inner - start_inner
    rate.factor_age = -1.0
    return status
