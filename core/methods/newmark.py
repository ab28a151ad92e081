"""Newmark and HHT inside TLISMNI (Shabana and Hussein 2009): one stage, accelerations as unknowns, order 2.

a^ = (1 + alpha) a_{n+1} - alpha a_n  (alpha = 0: Newmark; a is the true acceleration, a^ the algorithmic one)
q_{n+1} = q_n + h v_n + h^2 [(1/2 - beta) a^_n + beta a^_{n+1}],  v_{n+1} = v_n + h [(1 - gamma) a^_n + gamma a^_{n+1}]
a^_n stands for t_n + alpha h: before a step of another size its distance to a_n is scaled with the step, else each
change of the step by d adds alpha d h a' to the velocities, of first order.
Error estimate of positions: (beta - 1/(6 (1 + alpha))) h^2 (a_{n+1} - a_n)  (Negrut et al. 2007); of velocities and
work accounts: `velocity_error.py`. The larger of both norms counts, as with the multistep formulas.
"""

from typing import Any

from ..assembly.evaluate import evaluate_power
from ..compiled.jit import internal
from ..compiled.views import vec
from ..stage.solver import weighted_norm
from ..state.method_records import ESTIMATE
from ..state.workspace_records import OK, call_stage
from .history import history_row, history_time
from .multistep import rows_available
from .newmark_guess import (
    ALL_BY_MANY_ROWS,
    BY_LINE,
    BY_POSITIONS,
    best_guess,
    guess_by_line,
    guess_by_many_rows,
    guess_by_positions,
)
from .one_stage import MOST_GROWTH
from .velocity_error import filtered_velocity_error

ALPHA, BETA, GAMMA = 0, 1, 2


@internal
def newmark_step(workspace: Any, method: Any, h: float) -> int:
    parameters = vec(method.parameters, 8)
    alpha, beta, gamma = parameters[ALPHA], parameters[BETA], parameters[GAMMA]
    n = workspace.n_ext
    row = history_row(workspace, method, 0)
    q_star, v_star, a = vec(workspace.q_star, n), vec(workspace.v_star, n), vec(workspace.a, n)
    c_q, c_v = beta * h * h * (1.0 + alpha), gamma * h * (1.0 + alpha)
    ratio = 1.0
    if rows_available(method) > 1:
        ratio = min(h / (history_time(method, 0) - history_time(method, 1)), MOST_GROWTH)
    for i in range(n):
        true = row[2 * n + i]
        algorithmic = true + ratio * (row[3 * n + i] - true)
        q_star[i] = row[i] + h * row[n + i] + h * h * ((0.5 - beta) * algorithmic - beta * alpha * true)
        v_star[i] = row[n + i] + h * ((1.0 - gamma) * algorithmic - gamma * alpha * true)
    guess = best_guess(workspace, method, c_q, alpha, gamma)
    if guess == BY_POSITIONS:
        guess_by_positions(workspace, method, h, c_q)
    elif guess != BY_LINE:
        guess_by_many_rows(workspace, method, h, c_q, c_v, guess == ALL_BY_MANY_ROWS)
    else:
        guess_by_line(workspace, method, h)
    status = call_stage(workspace.stage_function, workspace, history_time(method, 0) + h, c_q, c_v)
    if status != OK and guess != BY_POSITIONS:
        guess_by_positions(workspace, method, h, c_q)
        status = call_stage(workspace.stage_function, workspace, history_time(method, 0) + h, c_q, c_v)
    if status != OK:
        return status
    if workspace.n_spins == 0:
        evaluate_power(workspace)
    v, aux = vec(workspace.v, n), vec(workspace.aux, n)
    for i in range(n - workspace.n_work, n):
        v[i] = v_star[i] + c_v * a[i]
    error = vec(workspace.rhs, workspace.n)
    factor = (beta - 1.0 / (6.0 * (1.0 + alpha))) * h * h
    for i in range(workspace.n):
        error[i] = factor * (a[i] - row[2 * n + i])
    norm = weighted_norm(error, vec(workspace.weight_q, n), workspace.n)
    if parameters[ESTIMATE] != 0.0:
        norm = filtered_velocity_error(workspace, method, h, norm)
    for i in range(n):
        aux[i] = (1.0 + alpha) * a[i] - alpha * row[2 * n + i]
    vec(method.error, 2)[0] = norm
    vec(method.error, 2)[1] = 2.0 if abs(gamma + alpha - 0.5) < 1e-12 else 1.0
    return OK
