"""HHT-alpha on all coordinates, with the forces of two times in one equilibrium.

  q_{n+1} = q_n + h v_n + h^2 [(1/2 - beta) a_n + beta a_{n+1}],  v_{n+1} = v_n + h [(1 - gamma) a_n + gamma a_{n+1}]
  M_{n+1} a_{n+1} + (1 + alpha) F_{n+1} - alpha F_n = 0,  F = Phi_q^T lambda - Q,  gamma = 1/2 - alpha,
  beta = (1 - alpha)^2 / 4.
hht_i3: with Phi(q_{n+1}) = 0 (Negrut, Rampalli, Ottarsson and Sajdak 2007).
hht_ggl: on the form of Gear, Gupta and Leimkuhler, with the velocity constraints too (after Yen, Petzold and Raha
1998; the correction of the coordinates is weighted by M, see `stage/index2.py`).

a_{n+1} is the method's only acceleration: it stands for the time t_{n+1} + alpha h, so that as the acceleration at
t_{n+1} it is of order 1. It starts from the accelerations of the constraints, as published: for alpha < 0 that excites
an error O(h) in lambda, which decays by (1 + alpha)/(1 - alpha) a step, and so does each change of the step.
With a step of another size than the one before it a_n is moved to the time t_n + alpha h by its slope: else each
change of the step by d adds alpha d h a' to the velocities, of first order.

So the mass matrix must be that of t_{n+1} + alpha h too: with M_{n+1} a method of order 1 comes out where M depends on
q, as with Euler parameters or a floating frame. Taken is (1 + alpha) M_{n+1} - alpha M_n, whose change against M_{n+1}
acts on a predicted acceleration at predicted coordinates.

The stage solves for b = a_{n+1} / (1 + alpha): M b + F_{n+1} = alpha / (1 + alpha) F_n - alpha (M_{n+1} - M_n) b.
Error estimate of positions (Negrut et al. 2007): (beta - 1/(6 (1 + alpha))) h^2 (a_{n+1} - a_n), of order 2: the step
follows Theta^(-1/6), Theta the square of its norm. Beside it that of the velocities (`velocity_error.py`), in the norm
of all methods: the larger counts.
"""

from typing import Any

from ..assembly.evaluate import evaluate_power, evaluate_residuals
from ..compiled.jit import inlined, internal
from ..compiled.views import vec
from ..stage.solver import weighted_norm
from ..state.method_records import ESTIMATE
from ..state.workspace_records import OK, call_stage
from .history import history_row, history_time, recall
from .multistep import rows_available
from .one_stage import MOST_GROWTH, finish_work, predict_linearly
from .velocity_error import absolute_velocity_error

ALPHA, BETA, GAMMA, INDEX = 0, 1, 2, 3


@internal
def carry_force(workspace: Any, method: Any, factor: float) -> None:
    """offset = factor F_n, with F_n = Phi_q^T lambda - Q at the newest row."""
    n = workspace.n_ext
    offset = vec(workspace.offset, n)
    if factor == 0.0:
        for i in range(workspace.n):
            offset[i] = 0.0
        return
    recall(workspace, method, 0)
    a, r = vec(workspace.a, n), vec(workspace.r, n)
    for i in range(workspace.n):
        a[i] = 0.0
    evaluate_residuals(workspace)
    for i in range(workspace.n):
        offset[i] = factor * r[i]


@internal
def carry_change_of_mass(workspace: Any, method: Any, h: float, alpha: float, ahead: float) -> None:
    """offset -= alpha (M(q_n + h v_n + h^2 a_n / 2) - M(q_n)) b, with b = a_n / (1 + alpha), a_n moved by `ahead`.

    M b is what the residuals with b are more than those without; the power of h that is left out is the third.
    """
    n = workspace.n_ext
    row, older = history_row(workspace, method, 0), history_row(workspace, method, 1)
    offset, q, a, r = vec(workspace.offset, n), vec(workspace.q, n), vec(workspace.a, n), vec(workspace.r, n)
    for k in range(4):
        at_end, with_mass = k // 2 == 1, k % 2 == 1
        recall(workspace, method, 0)
        for i in range(workspace.n):
            a_n = row[2 * n + i] + ahead * (row[2 * n + i] - older[2 * n + i])
            a[i] = a_n / (1.0 + alpha) if with_mass else 0.0
            if at_end:
                q[i] += h * (row[n + i] + 0.5 * h * a_n)
        evaluate_residuals(workspace)
        sign = alpha if at_end == with_mass else -alpha
        for i in range(workspace.n):
            offset[i] -= sign * r[i]


@inlined
def _change(method: Any, h: float) -> float:
    """By how much the step has changed, s."""
    last = history_time(method, 0) - history_time(method, 1)
    return min(h, MOST_GROWTH * last) - last


@inlined
def _between(method: Any, alpha: float) -> float:
    """Time between the newest two accelerations, s; that of the row that begins a history stands for its own time."""
    last = history_time(method, 0) - history_time(method, 1)
    if rows_available(method) > 2:
        return last + alpha * (last - history_time(method, 1) + history_time(method, 2))
    return last + alpha * last


@internal
def hht_dae_step(workspace: Any, method: Any, h: float) -> int:
    parameters = vec(method.parameters, 8)
    alpha, beta, gamma = parameters[ALPHA], parameters[BETA], parameters[GAMMA]
    share = 1.0 + alpha
    n = workspace.n_ext
    row = history_row(workspace, method, 0)
    carry_force(workspace, method, alpha / share)
    q_star, v_star, a = vec(workspace.q_star, n), vec(workspace.v_star, n), vec(workspace.a, n)
    older, ahead = history_row(workspace, method, 1), 0.0
    if rows_available(method) > 1:
        ahead = alpha * _change(method, h) / _between(method, alpha)
    if alpha != 0.0:
        carry_change_of_mass(workspace, method, h, alpha, ahead)
    for i in range(n):
        a_n = row[2 * n + i] + ahead * (row[2 * n + i] - older[2 * n + i])
        q_star[i] = row[i] + h * row[n + i] + h * h * (0.5 - beta) * a_n
        v_star[i] = row[n + i] + h * (1.0 - gamma) * a_n
    predict_linearly(workspace, method, h, share)
    status = call_stage(
        workspace.stage_function, workspace, history_time(method, 0) + h, share * beta * h * h, share * gamma * h
    )
    if status != OK:
        return status
    for i in range(workspace.n):
        a[i] *= share
    evaluate_power(workspace)
    finish_work(workspace, row, h)
    status, of_velocities = OK, 0.0
    if parameters[ESTIMATE] != 0.0:
        status, of_velocities = absolute_velocity_error(workspace, method, h, alpha, parameters[INDEX] == 2.0)
    elif alpha != 0.0:
        evaluate_residuals(workspace)
    error, aux = vec(workspace.rhs, workspace.n), vec(workspace.aux, n)
    factor = (beta - 1.0 / (6.0 * share)) * h * h
    for i in range(workspace.n):
        error[i] = factor * (a[i] - row[2 * n + i])
    for i in range(n):
        aux[i] = a[i]
    norm = weighted_norm(error, vec(workspace.weight_q, n), workspace.n)
    vec(method.error, 2)[0] = max(norm, of_velocities)
    vec(method.error, 2)[1] = 2.0
    return status
