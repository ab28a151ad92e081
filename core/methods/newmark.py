"""Newmark and HHT inside TLISMNI (Shabana and Hussein 2009): one stage, accelerations as unknowns, order 2.

a^ = (1 + alpha) a_{n+1} - alpha a_n  (alpha = 0: Newmark; a is the true acceleration, a^ the algorithmic one)
q_{n+1} = q_n + h v_n + h^2 [(1/2 - beta) a^_n + beta a^_{n+1}],  v_{n+1} = v_n + h [(1 - gamma) a^_n + gamma a^_{n+1}]
Error estimate: (beta - 1/(6 (1 + alpha))) h^2 (a_{n+1} - a_n)  (Negrut et al. 2007); of the work accounts, whose power
is integrated by the trapezoidal rule or nearly so, h^3/12 of the second derivative of the power through three points.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..stage.solver import weighted_norm
from ..system.evaluate import evaluate_power
from ..system.records import OK, call_stage
from .history import history_row, history_time

ALPHA, BETA, GAMMA = 0, 1, 2


@internal
def newmark_step(ws: Any, ms: Any, h: float) -> int:
    parameters = vec(ms.parameters, 8)
    alpha, beta, gamma = parameters[ALPHA], parameters[BETA], parameters[GAMMA]
    n = ws.n_ext
    row = history_row(ws, ms, 0)
    q_star, v_star, a = vec(ws.q_star, n), vec(ws.v_star, n), vec(ws.a, n)
    lam = vec(ws.lam, ws.m_ext)
    c_q, c_v = beta * h * h * (1.0 + alpha), gamma * h * (1.0 + alpha)
    for i in range(n):
        true, algorithmic = row[2 * n + i], row[3 * n + i]
        q_star[i] = row[i] + h * row[n + i] + h * h * ((0.5 - beta) * algorithmic - beta * alpha * true)
        v_star[i] = row[n + i] + h * ((1.0 - gamma) * algorithmic - gamma * alpha * true)
    extrapolation = 0.0
    if ivec(ms.ring, 2)[1] > 1:
        extrapolation = h / (history_time(ms, 0) - history_time(ms, 1))
    older = history_row(ws, ms, 1)
    for i in range(ws.n):
        a[i] = row[2 * n + i] + extrapolation * (row[2 * n + i] - older[2 * n + i])
    for i in range(ws.m_ext):
        lam[i] = row[4 * n + i] + extrapolation * (row[4 * n + i] - older[4 * n + i])
    status = call_stage(ws.stage_function, ws, history_time(ms, 0) + h, c_q, c_v)
    if status != OK:
        return status
    evaluate_power(ws)
    v, aux = vec(ws.v, n), vec(ws.aux, n)
    for i in range(n - ws.n_work, n):
        v[i] = v_star[i] + c_v * a[i]
    for i in range(n):
        aux[i] = (1.0 + alpha) * a[i] - alpha * row[2 * n + i]
    error = vec(ws.rhs, ws.n)
    factor = (beta - 1.0 / (6.0 * (1.0 + alpha))) * h * h
    for i in range(ws.n):
        error[i] = factor * (a[i] - row[2 * n + i])
    norm = weighted_norm(error, vec(ws.weight_q, n), ws.n)
    weight_v = vec(ws.weight_v, n)
    for i in range(n - ws.n_work, n):
        slope = (a[i] - row[2 * n + i]) / h
        if extrapolation > 0.0:
            before = h / extrapolation
            curvature = (slope - (row[2 * n + i] - older[2 * n + i]) / before) / (h + before)
        else:
            # no third point: as if the power had been constant before
            curvature = 0.5 * slope / h
        norm = max(norm, abs(curvature) * h**3 / 6.0 / weight_v[i])
    vec(ms.error, 2)[0] = norm
    vec(ms.error, 2)[1] = 2.0
    return OK
