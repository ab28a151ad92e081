"""Extended BDF (Cash 1980) and modified extended BDF (Cash 1983) inside TLISMNI, k = 1..8, order k + 1.

Three stages a step:

(i) BDF to t_{n+1}; (ii) the same formula one step further, to t_{n+2} = t_{n+1} + h;
(iii) EBDF: y_{n+1} = sum A_j y_{n-j} + h B y'_{n+1} + h B1 ybar'_{n+2};
(iii') MEBDF: y_{n+1} = sum A_j y_{n-j} + h b y'_{n+1} + h (B - b) ybar'_{n+1} + h B1 ybar'_{n+2}, with b of the BDF:
all three stages then have the same matrix.
Error estimate: ||y_{n+1} - ybar_{n+1}||, the difference of orders k + 1 and k: safe, and free.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..stage.solver import weighted_norm
from ..state.method_records import CHOICE_SIZE, K
from ..state.workspace_records import OK
from .coefficients import bdf_coefficients, ebdf_coefficients, extrapolation_weights
from .history import history_row, history_time
from .multistep import bdf_stage, clear, combine_stars, finish_stage, nodes, predict, weight_rows

NODES, BDF, EXTRAPOLATION, ADVANCED_NODES, ADVANCED, ADVANCED_EXTRAPOLATION, EXTENDED = range(7)
MODIFIED = 0  # parameter: 1 for MEBDF


@internal
def _coefficients(method: Any, h: float, k: int, table: Any) -> None:
    """All coefficients of the step, renewed when the grid has changed."""
    if not nodes(method, h, k + 1, table[NODES]):
        return
    s = table[NODES]
    bdf_coefficients(s, k, table[BDF])
    extrapolation_weights(s, k + 1, table[EXTRAPOLATION])
    advanced = table[ADVANCED_NODES]
    advanced[0] = -1.0
    for j in range(k):
        advanced[j + 1] = s[j] - 1.0
    bdf_coefficients(advanced, k, table[ADVANCED])
    extrapolation_weights(advanced, k + 1, table[ADVANCED_EXTRAPOLATION])
    ebdf_coefficients(s, k, table[EXTENDED])


@internal
def ebdf_step(workspace: Any, method: Any, h: float) -> int:
    k, n = int(vec(method.choice, CHOICE_SIZE)[K]), workspace.n_ext
    table = weight_rows(method)
    _coefficients(method, h, k, table)
    t_new = history_time(method, 0) + h
    q, v, a, lam = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    q_star, v_star = vec(workspace.q_star, n), vec(workspace.v_star, n)
    bar_q, bar_v, bar_a = vec(workspace.base_q, n), vec(workspace.base_v, n), vec(workspace.base_a, n)
    bar_lam = mat(workspace.stage_a, 8, n + workspace.m_ext)[0]

    status = bdf_stage(workspace, method, h, k, table[BDF], table[EXTRAPOLATION])
    if status != OK:
        return status
    for i in range(n):
        bar_q[i], bar_v[i], bar_a[i] = q[i], v[i], a[i]
    for i in range(workspace.m_ext):
        bar_lam[i] = lam[i]

    coefficients, extrapolation = table[ADVANCED], table[ADVANCED_EXTRAPOLATION]
    clear(workspace.q_star, n)
    clear(workspace.v_star, n)
    for i in range(workspace.n):
        a[i] = extrapolation[0] * bar_a[i]
    for i in range(workspace.m_ext):
        lam[i] = extrapolation[0] * bar_lam[i]
    c_v = h * coefficients[k]
    combine_stars(workspace, method, bar_q, bar_v, coefficients[1:], 0, k - 1, c_v)
    predict(workspace, method, extrapolation[1:], 0, k)
    status = finish_stage(workspace, t_new + h, c_v)
    if status != OK:
        return status

    coefficients = table[EXTENDED]
    ahead = h * coefficients[k + 1]
    own = table[BDF][k] if vec(method.parameters, 8)[MODIFIED] != 0.0 else coefficients[k]
    beside = h * (coefficients[k] - own)
    for i in range(n):
        q_star[i] = ahead * v[i] + beside * bar_v[i]
        v_star[i] = ahead * a[i] + beside * bar_a[i]
    for i in range(workspace.n):
        a[i] = bar_a[i]
    for i in range(workspace.m_ext):
        lam[i] = bar_lam[i]
    c_v = h * own
    newest = history_row(workspace, method, 0)
    combine_stars(workspace, method, newest[:n], newest[n : 2 * n], coefficients[1:], 1, k - 1, c_v)
    status = finish_stage(workspace, t_new, c_v)
    if status != OK:
        return status
    for i in range(workspace.n):
        bar_q[i] -= q[i]
        bar_v[i] -= v[i]
    weight_v = vec(workspace.weight_v, n)
    of_work = 0.0
    for i in range(n - workspace.n_work, n):
        of_work = max(of_work, abs(bar_v[i] - v[i]) / weight_v[i])
    error = vec(method.error, 2)
    error[0] = max(
        of_work,
        weighted_norm(bar_q, vec(workspace.weight_q, n), workspace.n),
        weighted_norm(bar_v, weight_v, workspace.n),
    )
    error[1] = k
    return OK
