"""What BDF and EBDF share: nodes, linear combinations of history rows, one BDF stage.

The formulas are applied to (q, v) with (v, a) as derivatives: v_i = P_v + h b a_i, q_i = P_q + h b v_i, hence
c_v = h b, c_q = (h b)^2, q* = P_q + h b P_v, v* = P_v.
"""

from typing import Any

from ..assembly.evaluate import evaluate_power
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, mat, vec
from ..stage.solver import weighted_norm
from ..state.method_records import WEIGHTS_WIDTH
from ..state.workspace_records import call_stage
from .history import history_row, history_time


@inlined
def weight_rows(method: Any) -> Any:
    """Table of the coefficients."""
    return mat(method.weights, 8, WEIGHTS_WIDTH)


COUNT_ROW = 7  # of the table of coefficients: for how many nodes it was made


@internal
def nodes(method: Any, h: float, count: int, out: Any) -> bool:
    """s_j = (t_j - t_new)/h of the newest `count` rows into `out`; True if they differ from what stood there."""
    t_new = history_time(method, 0) + h
    of_table = weight_rows(method)[COUNT_ROW]
    changed = of_table[0] != count
    of_table[0] = count
    for j in range(count):
        if abs((history_time(method, j) - t_new) / h - out[j]) > 1e-12:
            changed = True
    if changed:
        for j in range(count):
            out[j] = (history_time(method, j) - t_new) / h
    return changed


@internal
def combine_stars(
    workspace: Any, method: Any, base_q: Any, base_v: Any, weights: Any, first: int, count: int, c_v: float
) -> None:
    """q*, v* from rows first ... first + count - 1 of the history with `weights`, and from the point (base_q, base_v)
    with what is missing of them to 1; added to what stands there.

    On the way in q_star and v_star hold what other terms give to P_q and P_v. Only differences from the base are
    weighted: the rounding of the weights then counts by how far the rows are apart, not by how far from the origin,
    and so does not add up from step to step.
    """
    n = workspace.n_ext
    q_star, v_star = vec(workspace.q_star, n), vec(workspace.v_star, n)
    for j in range(count):
        row = history_row(workspace, method, first + j)
        w = weights[j]
        for i in range(n):
            q_star[i] += w * (row[i] - base_q[i])
            v_star[i] += w * (row[n + i] - base_v[i])
    for i in range(n):
        v_star[i] += base_v[i]
        q_star[i] += base_q[i] + c_v * v_star[i]


@internal
def predict(workspace: Any, method: Any, weights: Any, first: int, count: int) -> None:
    """Extrapolate a and lambda through rows of the history, on top of what stands in a and lam."""
    n = workspace.n_ext
    a, lam = vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    for j in range(count):
        row = history_row(workspace, method, first + j)
        w = weights[j]
        for i in range(workspace.n):
            a[i] += w * row[2 * n + i]
        for i in range(workspace.m_ext):
            lam[i] += w * row[4 * n + i]


@internal
def clear(address: int, n: int) -> None:
    """Zero a vector."""
    x = vec(address, n)
    for i in range(n):
        x[i] = 0.0


@internal
def finish_stage(workspace: Any, t: float, c_v: float) -> int:
    """Solve the stage; then power and work accounts."""
    status = call_stage(workspace.stage_function, workspace, t, c_v * c_v, c_v)
    if status != 0:
        return status
    if workspace.n_spins == 0:
        evaluate_power(workspace)
    n = workspace.n_ext
    v, v_star, a = vec(workspace.v, n), vec(workspace.v_star, n), vec(workspace.a, n)
    for i in range(n - workspace.n_work, n):
        v[i] = v_star[i] + c_v * a[i]
    return status


@internal
def bdf_stage(workspace: Any, method: Any, h: float, k: int, coefficients: Any, extrapolation: Any) -> int:
    """y_{n+1} = sum_j coefficients_j y_{n-j} + coefficients_k h y'_{n+1}."""
    n = workspace.n_ext
    newest = history_row(workspace, method, 0)
    c_v = h * coefficients[k]
    clear(workspace.q_star, n)
    clear(workspace.v_star, n)
    combine_stars(workspace, method, newest[:n], newest[n : 2 * n], coefficients[1:], 1, k - 1, c_v)
    clear(workspace.a, workspace.n)
    clear(workspace.lam, workspace.m_ext)
    predict(workspace, method, extrapolation, 0, k + 1)
    return finish_stage(workspace, history_time(method, 0) + h, c_v)


@internal
def difference_norm(workspace: Any, method: Any, q: Any, v: Any, weights: Any, first: int, count: int) -> float:
    """Norm of the coordinates (q, v) less what `weights` (of sum 1) make of the rows first ... first + count - 1 of the
    history; the work accounts do not count."""
    n = workspace.n_ext
    difference = vec(workspace.rhs, workspace.n)
    base = history_row(workspace, method, first)
    norm = 0.0
    for kind in range(2):
        for i in range(workspace.n):
            difference[i] = (v[i] if kind else q[i]) - base[kind * n + i]
        for j in range(1, count):
            row = history_row(workspace, method, first + j)
            for i in range(workspace.n):
                difference[i] -= weights[j] * (row[kind * n + i] - base[kind * n + i])
        norm = max(
            norm, weighted_norm(difference, vec(workspace.weight_v if kind else workspace.weight_q, n), workspace.n)
        )
    return norm


@internal
def predictor_error(workspace: Any, method: Any, weights: Any, count: int) -> float:
    """Norm of (q, v) less its extrapolation through `count` rows: the next backward difference."""
    n = workspace.n_ext
    v, weight_v = vec(workspace.v, n), vec(workspace.weight_v, n)
    norm = difference_norm(workspace, method, vec(workspace.q, n), v, weights, 0, count)
    newest = history_row(workspace, method, 0)
    for i in range(n - workspace.n_work, n):
        off = v[i] - newest[n + i]
        for j in range(1, count):
            off -= weights[j] * (history_row(workspace, method, j)[n + i] - newest[n + i])
        norm = max(norm, abs(off) / weight_v[i])
    return norm


@inlined
def rows_available(method: Any) -> int:
    """Number of rows in the history."""
    return ivec(method.ring, 2)[1]
