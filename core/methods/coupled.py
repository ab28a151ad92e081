"""Coupled stages of a fully implicit Runge-Kutta method, by sweeps with one matrix for all of them.

Unknowns are the accelerations a_i of all stages (independent coordinates; the inner loop gives the dependent ones):
  V_i = v_n + h sum_j A_ij a_j,  Q_i = q_n + c_i h v_n + h^2 sum_j (A A)_ij a_j,  M a_i + Phi_q^T lambda_i = Q(Q_i, V_i)
A sweep goes through the stages in turn: the point of stage i is shifted by the corrections that stages j < i have
found (v by h S_ij da_j, q by h^2 (S S)_ij da_j; S of `tableaus.py`), the inner loop brings it onto the constraints,
and the matrix M + h gamma D + (h gamma)^2 K, bordered by Phi_q, gives (da_i, dlambda_i). Then all points move as the
tableau says. The fixed point is the solution, whatever the matrices are. In turning frames the first sweep has those of
each stage nevertheless: the moves of coordinates, which are predicted to rounding there, do not show how far the
multipliers are from the fixed point. After it multipliers err as little as accelerations do.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..stage.corotating import to_formula
from ..stage.inner import inner_loop
from ..stage.matrices import refactor
from ..stage.solver import LEAST_RATE, MOST_INNER, RATE_GROWTH, solve_increment
from ..state.workspace_records import (
    COUPLED_STAGES,
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_SLOW,
    REANALYZE,
    control_at,
    convergence_at,
    counters_at,
)
from .guess import FROM_REST, best_guess, guess_stages
from .multistep import weight_rows
from .stages import (
    A_SQUARED,
    EMBEDDED,
    GAMMA,
    INNER_EACH,
    LAST_STEP,
    LAST_SWEEPS,
    MEMORY,
    SHIFT,
    SHIFT2,
    SWEEP_RATE,
    A,
    load_stage,
    stage_count,
    stage_rows,
)

# Sweeps allowed, times the most iterations of a single stage: with the exact tangent too a sweep leaves up to 0.4.
SWEEPS = 3
# Beyond this the matrices are renewed at the next step: a factorisation costs less than a sweep.
MOST_SWEEPS = 3
# A relative change of the step by this much calls for new matrices if the sweeps contract no faster than STIFF_RATE.
STEP_CHANGE, STIFF_RATE = 0.2, 0.1
# Contractions that the tableau alone does not cause: once the first sweeps are over, and ever.
SLOW_SWEEP, EXPLODING = 0.5, 5.0


@internal
def _refactor(workspace: Any, method: Any, t: float, h: float, simple: bool) -> int:
    """New matrices at the stage in the middle."""
    table = weight_rows(method)
    load_stage(workspace, method, stage_count(method) // 2, t, h)
    c_v = 0.0 if simple else h * table[EMBEDDED, GAMMA]
    table[MEMORY, SWEEP_RATE] = 1.0
    return refactor(workspace, c_v * c_v, c_v)


@internal
def _sweep(workspace: Any, method: Any, t: float, h: float, slack: float, simple: bool, own: bool) -> int:
    """One pass over the stages: corrections of their accelerations and multipliers; `own`: with matrices of each."""
    n, multipliers = workspace.n_ext, workspace.m_act + workspace.n_implied
    table, rows = weight_rows(method), stage_rows(workspace)
    c_v, status = h * table[EMBEDDED, GAMMA], OK
    q, v, active = vec(workspace.q, n), vec(workspace.v, n), ivec(workspace.active, multipliers)
    increment = vec(workspace.rhs, workspace.n + multipliers)
    counters = counters_at(workspace.counters)
    for i in range(stage_count(method)):
        row = rows[i]
        for j in range(i):
            shift_q = h * h * table[SHIFT2, COUPLED_STAGES * i + j]
            shift_v = h * table[SHIFT, COUPLED_STAGES * i + j]
            for l in range(workspace.n):
                row[l] += shift_q * rows[j, 3 * n + l]
                row[n + l] += shift_v * rows[j, 3 * n + l]
        load_stage(workspace, method, i, t, h)
        if own:
            status = refactor(workspace, c_v * c_v, c_v)
        if status == OK:
            evaluate_residuals(workspace)
            status = inner_loop(workspace, workspace.lu_d, slack, np.inf)
        if status == OK and simple:
            status = refactor(workspace, 0.0, 0.0)
        if status != OK:
            return status
        solve_increment(workspace, workspace.kkt)
        counters.outer += 1
        to_formula(workspace, row, increment)
        for l in range(workspace.n):
            # with what the inner loop has corrected: the next sweep need not find it again
            row[l] = q[l]
            row[n + l] = v[l]
            row[2 * n + l] += increment[l]
            row[3 * n + l] = increment[l]
        for l in range(multipliers):
            row[4 * n + active[l]] += increment[workspace.n + l]
    return OK


@internal
def _move(workspace: Any, method: Any, h: float) -> float:
    """Move the stages' points by the corrections of their accelerations. Returns the largest weighted norm of a move.

    Independent coordinates are then those of the tableau; for the dependent ones it is a prediction.
    """
    n = workspace.n_ext
    stages = stage_count(method)
    table, rows = weight_rows(method), stage_rows(workspace)
    weight_q, weight_v = vec(workspace.weight_q, n), vec(workspace.weight_v, n)
    largest = 0.0
    for i in range(stages):
        row, of_q, of_v = rows[i], 0.0, 0.0
        for l in range(workspace.n):
            move_q, move_v, moved_q, moved_v = 0.0, 0.0, 0.0, 0.0
            for j in range(stages):
                correction, e = rows[j, 3 * n + l], COUPLED_STAGES * i + j
                move_q += table[A_SQUARED, e] * correction
                move_v += table[A, e] * correction
                moved_q += table[SHIFT2, e] * correction
                moved_v += table[SHIFT, e] * correction
            row[l] += h * h * (move_q - moved_q)
            row[n + l] += h * (move_v - moved_v)
            of_q += (h * h * move_q / weight_q[l]) ** 2
            of_v += (h * move_v / weight_v[l]) ** 2
        if not of_q + of_v < np.inf:  # NaN, which `max` could lose
            return np.inf
        largest = max(largest, of_q, of_v)
    return np.sqrt(largest / max(workspace.n, 1))


@internal
def _iterate(workspace: Any, method: Any, t: float, h: float, simple: bool) -> int:
    """Sweeps until the stages have converged."""
    control, memory = control_at(workspace.control), weight_rows(method)[MEMORY]
    counters = counters_at(workspace.counters)
    stages = stage_count(method)
    tolerance = control.newton_tolerance
    # before the sweeps have converged, the constraints need to hold only a hundred times better than they do
    slack = max(1.0, min(1e4, 0.01 * tolerance * control.rtol / control.position_tolerance))
    start_inner = counters.inner
    previous, before = np.inf, np.inf
    renewed = 0
    for k in range(int(control.max_outer) * (1 if simple else SWEEPS)):
        own = k == 0 and workspace.n_spins > 0 and not simple
        status = _sweep(workspace, method, t, h, slack, simple, own)
        if status != OK:
            return status
        norm = _move(workspace, method, h)
        if not np.isfinite(norm):
            return NOT_FINITE
        renew = False
        if k > 0:
            # S is far from normal: over two sweeps the contraction is seen better than over one
            contraction = max(norm / previous, np.sqrt(norm / before))
            memory[SWEEP_RATE] = max(0.3 * memory[SWEEP_RATE], contraction)
            if norm > tolerance:
                stalled = norm > 0.8 * before
                if (simple and contraction > 0.9) or (stalled and renewed > 0):
                    memory[SWEEP_RATE] = 1.0
                    convergence_at(workspace.rate).failed_norm = contraction
                    return OUTER_DIVERGED
                slow = contraction > SLOW_SWEEP and k > 1
                renew = not simple and renewed < 2 and (slow or contraction > EXPLODING)
        known = min(max(memory[SWEEP_RATE], LEAST_RATE), 0.99)
        if norm * known / (1.0 - known) <= tolerance:
            if k == 0:
                # a contraction of earlier steps is trusted less and less
                memory[SWEEP_RATE] = known * RATE_GROWTH
            memory[LAST_SWEEPS] = k + 1
            memory[INNER_EACH] = (counters.inner - start_inner) / stages
            memory[LAST_STEP] = h
            return OK
        before, previous = previous, norm
        if renew:
            # the matrix of the predicted points is not good enough: that of the present ones is
            renewed += 1
            before = np.inf
            status = _refactor(workspace, method, t, h, simple)
            if status != OK:
                return status
    return OUTER_SLOW


@internal
def solve_coupled(workspace: Any, method: Any, t: float, h: float) -> int:
    """Solve all stages of a step of size h from t, into `stage_rows`. Returns OK or what went wrong.

    On failure with old matrices it tries once more with new ones, then once more from stages at rest.
    """
    rate, memory = convergence_at(workspace.rate), weight_rows(method)[MEMORY]
    stages = stage_count(method)
    simple = control_at(workspace.control).outer_loop == 1.0
    counters_at(workspace.counters).stages += stages
    if h > memory[LAST_STEP] > 0.0:
        memory[SWEEP_RATE] *= (h / memory[LAST_STEP]) ** 2
    other_step = abs(h * weight_rows(method)[EMBEDDED, GAMMA] / rate.factor_cv - 1.0) > STEP_CHANGE
    fresh = (
        rate.factor_age < 0.0
        or memory[LAST_SWEEPS] > MOST_SWEEPS
        or memory[INNER_EACH] > MOST_INNER
        or (other_step and memory[SWEEP_RATE] > STIFF_RATE)
        or simple
    )
    guess = best_guess(workspace, method, h)
    for attempt in range(3):
        if attempt == 1 and fresh:
            continue
        guess_stages(workspace, method, t, h, FROM_REST if attempt == 2 else guess)
        if attempt > 0 or fresh:
            status = _refactor(workspace, method, t, h, simple)
            if status != OK:
                return status
        rate.factor_age += stages
        status = _iterate(workspace, method, t, h, simple)
        if status == OK or status == REANALYZE:
            break
    return status
