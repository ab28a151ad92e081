"""Generalized-alpha for constrained systems (Chung and Hulbert 1993; Arnold and Bruls 2007).

  (1 - am) A_{n+1} + am A_n = (1 - af) a_{n+1} + af a_n,   M a + Phi_q^T lambda = Q at t_{n+1},
  q_{n+1} = q_n + h v_n + h^2 [(1/2 - beta) A_n + beta A_{n+1}],  v_{n+1} = v_n + h [(1 - gamma) A_n + gamma A_{n+1}]
with a the true and A the algorithmic acceleration; r the spectral radius for infinite frequency,
  am = (2 r - 1)/(r + 1), af = r/(r + 1), gamma = 1/2 + af - am, beta = (gamma + 1/2)^2 / 4.
Form "index3": Phi(q_{n+1}) = 0. Form "index2": Phi_q v + Phi_t = 0 too, by a correction of the coordinates
-h M^-1 Phi_q^T mu (Arnold, Bruls and Cardona 2015, where it is not weighted by M).

A_n stands for t_n + (am - af) h. Start "shifted": A_0 = a_0 + (am - af) (a(h) - a_0), with a(h) from the constraints
at the end of a step that starts from A_0 = a_0. In index 3 exact coordinates go with velocities that are off by
-C h^2 a' along the constraints, C = (am - af)/2 + beta - 1/6, and the first step starts from such. Start "plain":
A_0 = a_0 and v_0 themselves, an error O(h) in lambda that decays by r a step. Perturbed starting values: Arnold,
Bruls and Cardona (2015). A step of another size sees A_n - a_n scaled with it; in index 3 its velocities do not fit,
which excites lambda by O(h) anew.

Error estimate of positions C h^2 (a_{n+1} - a_n): with A_n = a_n + (am - af) h a' the formula adds
h^3 a' [(am - af)/2 + beta], the solution h^3 a'/6. Beside it that of the velocities (`velocity_error.py`).
"""

from typing import Any

from ..assembly.evaluate import evaluate_power, evaluate_residuals
from ..assembly.redundant_reactions import solve_equations
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, vec
from ..stage.accelerations import solve_accelerations
from ..stage.solver import weighted_norm
from ..state.method_records import ESTIMATE
from ..state.workspace_records import OK, call_stage
from .history import history_row, history_time
from .multistep import rows_available
from .one_stage import MOST_GROWTH, finish_work, predict_linearly
from .velocity_error import absolute_velocity_error

AM, AF, BETA, GAMMA, SHIFTED, INDEX = 0, 1, 2, 3, 4, 5


@inlined
def _error_constant(parameters: Any) -> float:
    """C: what the formula adds beyond the solution, in units of h^3 a'."""
    return parameters[BETA] + 0.5 * (parameters[AM] - parameters[AF]) - 1.0 / 6.0


@internal
def _advance(workspace: Any, method: Any, h: float) -> int:
    """One stage from the newest row, with A_n in `base_a` and what v_n is changed by in `base_v`."""
    parameters = vec(method.parameters, 8)
    am, af, beta, gamma = parameters[AM], parameters[AF], parameters[BETA], parameters[GAMMA]
    n = workspace.n_ext
    row, algorithmic, shift = history_row(workspace, method, 0), vec(workspace.base_a, n), vec(workspace.base_v, n)
    q_star, v_star = vec(workspace.q_star, n), vec(workspace.v_star, n)
    of_true = (1.0 - af) / (1.0 - am)
    for i in range(workspace.n):
        known = (af * row[2 * n + i] - am * algorithmic[i]) / (1.0 - am)
        v = row[n + i] + shift[i]
        q_star[i] = row[i] + h * v + h * h * ((0.5 - beta) * algorithmic[i] + beta * known)
        v_star[i] = v + h * ((1.0 - gamma) * algorithmic[i] + gamma * known)
    predict_linearly(workspace, method, h, 1.0)
    return call_stage(
        workspace.stage_function, workspace, history_time(method, 0) + h, of_true * beta * h * h, of_true * gamma * h
    )


@internal
def _find_algorithmic(workspace: Any, method: Any, h: float) -> int:
    """A_n of the newest row for a step of size h into `base_a`, the change of v_n into `base_v`."""
    parameters = vec(method.parameters, 8)
    n = workspace.n_ext
    row, algorithmic, a = history_row(workspace, method, 0), vec(workspace.base_a, n), vec(workspace.a, n)
    v_shift = vec(workspace.base_v, n)
    for i in range(workspace.n):
        v_shift[i] = 0.0
    if rows_available(method) > 1:
        ratio = min(h / (history_time(method, 0) - history_time(method, 1)), MOST_GROWTH)
        for i in range(workspace.n):
            algorithmic[i] = row[2 * n + i] + ratio * (row[3 * n + i] - row[2 * n + i])
        return OK
    for i in range(workspace.n):
        algorithmic[i] = row[2 * n + i]
    if parameters[SHIFTED] == 0.0:
        return OK
    status = _advance(workspace, method, h)
    if status != OK:
        return status
    status = solve_accelerations(workspace)
    if status != OK:
        return status
    for i in range(workspace.n):
        change = a[i] - row[2 * n + i]
        algorithmic[i] += (parameters[AM] - parameters[AF]) * change
        # phidd vanished with a: now it is -C h Phi_q (a(h) - a_0)
        a[i] -= _error_constant(parameters) * h * change
    if parameters[INDEX] == 3.0 and workspace.m_act > 0:
        evaluate_residuals(workspace)
        rhs, phidd = vec(workspace.rhs, workspace.n + workspace.m_act), vec(workspace.phidd, workspace.m_ext)
        active = ivec(workspace.active, workspace.m_act)
        for i in range(workspace.n):
            rhs[i] = 0.0
        for i in range(workspace.m_act):
            rhs[workspace.n + i] = phidd[active[i]]
        solve_equations(workspace, workspace.kkt_query)
        for i in range(workspace.n):
            v_shift[i] = rhs[i]
    return OK


@internal
def generalized_alpha_step(workspace: Any, method: Any, h: float) -> int:
    parameters = vec(method.parameters, 8)
    am, af = parameters[AM], parameters[AF]
    n = workspace.n_ext
    status = _find_algorithmic(workspace, method, h)
    if status != OK:
        return status
    status = _advance(workspace, method, h)
    if status != OK:
        return status
    evaluate_power(workspace)
    row, algorithmic = history_row(workspace, method, 0), vec(workspace.base_a, n)
    finish_work(workspace, row, h)
    a, aux, error = vec(workspace.a, n), vec(workspace.aux, n), vec(workspace.rhs, workspace.n)
    factor = _error_constant(parameters) * h * h
    for i in range(workspace.n):
        aux[i] = ((1.0 - af) * a[i] + af * row[2 * n + i] - am * algorithmic[i]) / (1.0 - am)
        error[i] = factor * (a[i] - row[2 * n + i])
    norm = weighted_norm(error, vec(workspace.weight_q, n), workspace.n)
    vec(method.error, 2)[0] = norm
    vec(method.error, 2)[1] = 2.0
    if parameters[ESTIMATE] == 0.0:
        return OK
    status, of_velocities = absolute_velocity_error(workspace, method, h, 0.0, parameters[INDEX] == 2.0)
    vec(method.error, 2)[0] = max(norm, of_velocities)
    return status
