"""Fully implicit Runge-Kutta methods (Gauss, Radau IIA) inside TLISMNI: full classical order, since it is the
state-space equation of the independent coordinates that they integrate.

The stages are solved in `coupled.py`. Then v_{n+1} = v_n + h sum b_i a_i and
q_{n+1} = q_n + h v_n + h^2 sum (b^T A)_i a_i; with Radau IIA that is the last stage.
Error estimate: y_{n+1} - yhat, yhat = y_n + h (b0 f_n + sum_i bhat_i f_i + gamma f(t_{n+1}, yhat)): one more stage
with the same matrix (de Swart and Soederlind 1997). Gauss methods take it times its ratio to a difference of one order
less (`Tableau.lower_difference`).
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_power, evaluate_residuals
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..stage.accelerations import solve_accelerations
from ..stage.inner import inner_loop
from ..stage.solver import weighted_norm
from ..state.method_records import ESTIMATE
from ..state.workspace_records import COUNTERS_SIZE, FACTORIZATIONS, LAST_INNER, LAST_OUTER, OK, RATE_SIZE
from .coupled import solve_coupled
from .history import history_row, history_time
from .multistep import finish_stage, weight_rows
from .stages import BA, EMBEDDED, END, GAMMA, LOWER, START, VECTORS, B, load_stage, stage_count, stage_rows

# parameters, besides STAGE_COUNT
STIFFLY_ACCURATE = 1
ERROR_ORDER = 2


@internal
def _rates_of_work(ws: Any, ms: Any, t: float, h: float) -> None:
    """Rates of the work accounts at the stages, into their rows."""
    if ws.n_work == 0:
        return
    n = ws.n_ext
    a, rows = vec(ws.a, n), stage_rows(ws)
    for i in range(stage_count(ms)):
        load_stage(ws, ms, i, t, h)
        evaluate_power(ws)
        for l in range(n - ws.n_work, n):
            rows[i, 2 * n + l] = a[l]


@internal
def _extrapolate_to_end(ws: Any, ms: Any) -> None:
    """a and lambda from the stages to the end of the step."""
    n = ws.n_ext
    table, rows = weight_rows(ms), stage_rows(ws)
    a, lam = vec(ws.a, n), vec(ws.lam, ws.m_ext)
    stages = stage_count(ms)
    for l in range(ws.n):
        a[l] = 0.0
        for i in range(stages):
            a[l] += table[VECTORS, END + i] * rows[i, 2 * n + l]
    for l in range(ws.m_ext):
        lam[l] = 0.0
        for i in range(stages):
            lam[l] += table[VECTORS, END + i] * rows[i, 4 * n + l]


@internal
def _embedded(ws: Any, ms: Any, t: float, h: float) -> int:
    """yhat at t + h, into base_q and base_v."""
    n = ws.n_ext
    table, rows, old = weight_rows(ms), stage_rows(ws), history_row(ws, ms, 0)
    q_star, v_star = vec(ws.q_star, n), vec(ws.v_star, n)
    stages = stage_count(ms)
    c_v = h * table[EMBEDDED, GAMMA]
    for l in range(n):
        p_q = table[EMBEDDED, START] * old[n + l]
        p_v = table[EMBEDDED, START] * old[2 * n + l]
        for i in range(stages):
            p_q += table[EMBEDDED, i] * rows[i, n + l]
            p_v += table[EMBEDDED, i] * rows[i, 2 * n + l]
        v_star[l] = old[n + l] + h * p_v
        q_star[l] = old[l] + h * p_q + c_v * v_star[l]
    _extrapolate_to_end(ws, ms)
    rate = vec(ws.rate, RATE_SIZE)
    # whether the matrices are good enough is for the sweeps to say
    rate[LAST_OUTER], rate[LAST_INNER] = 0.0, 0.0
    status = finish_stage(ws, t + h, c_v)
    q, v = vec(ws.q, n), vec(ws.v, n)
    hat_q, hat_v = vec(ws.base_q, n), vec(ws.base_v, n)
    for l in range(n):
        hat_q[l] = q[l]
        hat_v[l] = v[l]
    return status


@internal
def _end(ws: Any, ms: Any, t: float, h: float) -> int:
    """The new point, consistent at all levels."""
    n = ws.n_ext
    table, rows, old = weight_rows(ms), stage_rows(ws), history_row(ws, ms, 0)
    parameters = vec(ms.parameters, 8)
    stages = stage_count(ms)
    q, v = vec(ws.q, n), vec(ws.v, n)
    if parameters[STIFFLY_ACCURATE] == 1.0:
        load_stage(ws, ms, stages - 1, t, h)
        evaluate_residuals(ws)
        status = inner_loop(ws, ws.lu_d, 1.0, 1.0)
    else:
        vec(ws.t, 1)[0] = t + h
        for l in range(ws.n):
            move_q, move_v = 0.0, 0.0
            for i in range(stages):
                move_q += table[VECTORS, BA + i] * rows[i, 2 * n + l]
                move_v += table[VECTORS, B + i] * rows[i, 2 * n + l]
            q[l] = old[l] + h * (old[n + l] + h * move_q)
            v[l] = old[n + l] + h * move_v
        _extrapolate_to_end(ws, ms)
        evaluate_residuals(ws)
        status = inner_loop(ws, ws.lu_d, 1.0, np.inf)
        if status == OK:
            status = solve_accelerations(ws)
            ivec(ws.counters, COUNTERS_SIZE)[FACTORIZATIONS] += 1
    for l in range(n - ws.n_work, n):
        work = 0.0
        for i in range(stages):
            work += table[VECTORS, B + i] * rows[i, 2 * n + l]
        v[l] = old[n + l] + h * work
    evaluate_power(ws)
    return status


@internal
def _norm(ws: Any, of_q: Any, of_v: Any) -> float:
    """Weighted norm of differences of coordinates, velocities and work accounts."""
    weight_v = vec(ws.weight_v, ws.n_ext)
    norm = max(weighted_norm(of_q, vec(ws.weight_q, ws.n_ext), ws.n), weighted_norm(of_v, weight_v, ws.n))
    for l in range(ws.n_ext - ws.n_work, ws.n_ext):
        norm = max(norm, abs(of_v[l]) / weight_v[l])
    return norm


@internal
def _error_of_step(ws: Any, ms: Any, h: float) -> float:
    """Norm of (q, v, work) less yhat; times its ratio to the lower difference where the method has one."""
    n = ws.n_ext
    table, rows, stages = weight_rows(ms), stage_rows(ws), stage_count(ms)
    q, v = vec(ws.q, n), vec(ws.v, n)
    hat_q, hat_v = vec(ws.base_q, n), vec(ws.base_v, n)
    for l in range(n):
        hat_q[l] -= q[l]
        hat_v[l] -= v[l]
    distance = _norm(ws, hat_q, hat_v)
    for l in range(n):
        hat_q[l], hat_v[l] = 0.0, 0.0
        for i in range(stages):
            hat_q[l] += h * table[EMBEDDED, LOWER + i] * rows[i, n + l]
            hat_v[l] += h * table[EMBEDDED, LOWER + i] * rows[i, 2 * n + l]
    lower = _norm(ws, hat_q, hat_v)
    return distance * distance / np.hypot(distance, lower) if distance > 0.0 else distance


@internal
def irk_step(ws: Any, ms: Any, h: float) -> int:
    """One step with the tableau in the method record; the error estimate only where it is asked for."""
    parameters, error = vec(ms.parameters, 8), vec(ms.error, 2)
    t = history_time(ms, 0)
    error[0], error[1] = 0.0, parameters[ERROR_ORDER]
    status = solve_coupled(ws, ms, t, h)
    if status != OK:
        return status
    _rates_of_work(ws, ms, t, h)
    if parameters[ESTIMATE] != 0.0:
        status = _embedded(ws, ms, t, h)
        if status != OK:
            return status
    status = _end(ws, ms, t, h)
    if status == OK and parameters[ESTIMATE] != 0.0:
        error[0] = _error_of_step(ws, ms, h)
    return status
