"""Fully implicit Runge-Kutta methods (Gauss, Radau IIA) inside TLISMNI: full classical order, since it is the
state-space equation of the independent coordinates that they integrate.

The stages are solved in `coupled.py`. Then v_{n+1} = v_n + h sum b_i a_i and
q_{n+1} = q_n + h v_n + h^2 sum (b^T A)_i a_i; with Radau IIA that is the last stage.
Error estimate: y_{n+1} - yhat, yhat = y_n + h (b0 f_n + sum_i bhat_i f_i + gamma f(t_{n+1}, yhat)): one more stage
with the same matrix (de Swart and Soederlind 1997). Gauss methods take it times its ratio to a difference of one order
less (`Tableau.lower_difference`), but never less than what a jump within the step would show
(`Tableau.jump_difference`).
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_power, evaluate_residuals
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..stage.accelerations import solve_accelerations
from ..stage.corotating import enter_frame, leave_frame
from ..stage.inner import inner_loop
from ..stage.solver import weighted_norm
from ..state.method_records import ESTIMATE
from ..state.workspace_records import (
    OK,
    convergence_at,
    counters_at,
)
from .coupled import solve_coupled
from .history import history_row, history_time
from .multistep import finish_stage, weight_rows
from .stages import BA, EMBEDDED, END, GAMMA, JUMP, LOWER, START, VECTORS, B, load_stage, stage_count, stage_rows

# parameters, besides STAGE_COUNT
STIFFLY_ACCURATE = 1
ERROR_ORDER = 2


@internal
def _rates_of_work(workspace: Any, method: Any, t: float, h: float) -> None:
    """Rates of the work accounts at the stages, into their rows."""
    if workspace.n_work == 0:
        return
    n = workspace.n_ext
    a, rows = vec(workspace.a, n), stage_rows(workspace)
    for i in range(stage_count(method)):
        load_stage(workspace, method, i, t, h)
        evaluate_power(workspace)
        for l in range(n - workspace.n_work, n):
            rows[i, 2 * n + l] = a[l]


@internal
def _extrapolate_to_end(workspace: Any, method: Any) -> None:
    """a and lambda from the stages to the end of the step."""
    n = workspace.n_ext
    table, rows = weight_rows(method), stage_rows(workspace)
    a, lam = vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    stages = stage_count(method)
    for l in range(workspace.n):
        a[l] = 0.0
        for i in range(stages):
            a[l] += table[VECTORS, END + i] * rows[i, 2 * n + l]
    for l in range(workspace.m_ext):
        lam[l] = 0.0
        for i in range(stages):
            lam[l] += table[VECTORS, END + i] * rows[i, 4 * n + l]


@internal
def _embedded(workspace: Any, method: Any, t: float, h: float) -> int:
    """yhat at t + h, into base_q and base_v."""
    n = workspace.n_ext
    table, rows, old = weight_rows(method), stage_rows(workspace), history_row(workspace, method, 0)
    q_star, v_star = vec(workspace.q_star, n), vec(workspace.v_star, n)
    stages = stage_count(method)
    c_v = h * table[EMBEDDED, GAMMA]
    for l in range(n):
        p_q = table[EMBEDDED, START] * old[n + l]
        p_v = table[EMBEDDED, START] * old[2 * n + l]
        for i in range(stages):
            p_q += table[EMBEDDED, i] * rows[i, n + l]
            p_v += table[EMBEDDED, i] * rows[i, 2 * n + l]
        v_star[l] = old[n + l] + h * p_v
        q_star[l] = old[l] + h * p_q + c_v * v_star[l]
    _extrapolate_to_end(workspace, method)
    rate = convergence_at(workspace.rate)
    # whether the matrices are good enough is for the sweeps to say
    rate.last_outer, rate.last_inner = 0.0, 0.0
    status = finish_stage(workspace, t + h, c_v)
    q, v = vec(workspace.q, n), vec(workspace.v, n)
    hat_q, hat_v = vec(workspace.base_q, n), vec(workspace.base_v, n)
    for l in range(n):
        hat_q[l] = q[l]
        hat_v[l] = v[l]
    return status


@internal
def _end(workspace: Any, method: Any, t: float, h: float) -> int:
    """The new point, consistent at all levels."""
    n = workspace.n_ext
    table, rows, old = weight_rows(method), stage_rows(workspace), history_row(workspace, method, 0)
    parameters = vec(method.parameters, 8)
    stages = stage_count(method)
    q, v = vec(workspace.q, n), vec(workspace.v, n)
    if parameters[STIFFLY_ACCURATE] == 1.0:
        load_stage(workspace, method, stages - 1, t, h)
        evaluate_residuals(workspace)
        status = inner_loop(workspace, workspace.lu_d, 1.0, 1.0)
    else:
        vec(workspace.t, 1)[0] = t + h
        for l in range(workspace.n):
            move_q, move_v = 0.0, 0.0
            for i in range(stages):
                move_q += table[VECTORS, BA + i] * rows[i, 2 * n + l]
                move_v += table[VECTORS, B + i] * rows[i, 2 * n + l]
            q[l] = old[l] + h * (old[n + l] + h * move_q)
            v[l] = old[n + l] + h * move_v
        _extrapolate_to_end(workspace, method)
        leave_frame(workspace)
        evaluate_residuals(workspace)
        status = inner_loop(workspace, workspace.lu_d, 1.0, np.inf)
        if status == OK:
            status = solve_accelerations(workspace)
            counters_at(workspace.counters).factorizations += 1
    for l in range(n - workspace.n_work, n):
        work = 0.0
        for i in range(stages):
            work += table[VECTORS, B + i] * rows[i, 2 * n + l]
        v[l] = old[n + l] + h * work
    evaluate_power(workspace)
    enter_frame(workspace)
    return status


@internal
def _norm(workspace: Any, of_q: Any, of_v: Any) -> float:
    """Weighted norm of differences of coordinates, velocities and work accounts."""
    weight_v = vec(workspace.weight_v, workspace.n_ext)
    norm = max(
        weighted_norm(of_q, vec(workspace.weight_q, workspace.n_ext), workspace.n),
        weighted_norm(of_v, weight_v, workspace.n),
    )
    for l in range(workspace.n_ext - workspace.n_work, workspace.n_ext):
        norm = max(norm, abs(of_v[l]) / weight_v[l])
    return norm


@internal
def _error_of_step(workspace: Any, method: Any, h: float) -> float:
    """Norm of (q, v, work) less yhat; times its ratio to the lower difference where the method has one, and at least
    the difference that sees jumps."""
    n = workspace.n_ext
    table, rows, stages = weight_rows(method), stage_rows(workspace), stage_count(method)
    q, v = vec(workspace.q, n), vec(workspace.v, n)
    hat_q, hat_v = vec(workspace.base_q, n), vec(workspace.base_v, n)
    for l in range(n):
        hat_q[l] -= q[l]
        hat_v[l] -= v[l]
    distance = _norm(workspace, hat_q, hat_v)
    for l in range(n):
        hat_q[l], hat_v[l] = 0.0, 0.0
        for i in range(stages):
            hat_q[l] += h * table[EMBEDDED, LOWER + i] * rows[i, n + l]
            hat_v[l] += h * table[EMBEDDED, LOWER + i] * rows[i, 2 * n + l]
    lower = _norm(workspace, hat_q, hat_v)
    if lower == 0.0:
        return distance
    a, old = vec(workspace.a, n), history_row(workspace, method, 0)
    start, end = h * table[EMBEDDED, JUMP], h * table[EMBEDDED, JUMP + stages + 1]
    for l in range(n):
        hat_q[l] = start * old[n + l] + end * v[l]
        hat_v[l] = start * old[2 * n + l] + end * a[l]
        for i in range(stages):
            hat_q[l] += h * table[EMBEDDED, JUMP + 1 + i] * rows[i, n + l]
            hat_v[l] += h * table[EMBEDDED, JUMP + 1 + i] * rows[i, 2 * n + l]
    # what depends on the others jumps with them, and may swing where they do not (positions of hinged bodies in frames)
    dependent = ivec(workspace.dependent, workspace.m_act)
    for d in range(workspace.m_act):
        hat_v[dependent[d]] = 0.0
        if d < workspace.m_held:
            hat_q[dependent[d]] = 0.0
    return max(_norm(workspace, hat_q, hat_v), distance * distance / np.hypot(distance, lower))


@internal
def irk_step(workspace: Any, method: Any, h: float) -> int:
    """One step with the tableau in the method record; the error estimate only where it is asked for."""
    parameters, error = vec(method.parameters, 8), vec(method.error, 2)
    t = history_time(method, 0)
    error[0], error[1] = 0.0, parameters[ERROR_ORDER]
    status = solve_coupled(workspace, method, t, h)
    if status != OK:
        return status
    _rates_of_work(workspace, method, t, h)
    if parameters[ESTIMATE] != 0.0:
        status = _embedded(workspace, method, t, h)
        if status != OK:
            return status
    status = _end(workspace, method, t, h)
    if status == OK and parameters[ESTIMATE] != 0.0:
        error[0] = _error_of_step(workspace, method, h)
    return status
