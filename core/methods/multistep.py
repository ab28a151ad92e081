"""What BDF and EBDF share: nodes, linear combinations of history rows, one BDF stage.

The formulas are applied to (q, v) with (v, a) as derivatives: v_i = P_v + h b a_i, q_i = P_q + h b v_i, hence
c_v = h b, c_q = (h b)^2, q* = P_q + h b P_v, v* = P_v.
"""

from typing import Any

from ..assembly.evaluate import evaluate_power
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, mat, vec
from ..stage.solver import weighted_norm
from ..state.method_records import MAX_NODES
from ..state.workspace_records import call_stage
from .history import history_row, history_time


@inlined
def weight_rows(ms: Any) -> Any:
    """Table of the coefficients."""
    return mat(ms.weights, 8, MAX_NODES)


COUNT_ROW = 7  # of the table of coefficients: for how many nodes it was made


@internal
def nodes(ms: Any, h: float, count: int, out: Any) -> bool:
    """s_j = (t_j - t_new)/h of the newest `count` rows into `out`; True if they differ from what stood there."""
    t_new = history_time(ms, 0) + h
    of_table = weight_rows(ms)[COUNT_ROW]
    changed = of_table[0] != count
    of_table[0] = count
    for j in range(count):
        if abs((history_time(ms, j) - t_new) / h - out[j]) > 1e-12:
            changed = True
    if changed:
        for j in range(count):
            out[j] = (history_time(ms, j) - t_new) / h
    return changed


@internal
def combine_stars(ws: Any, ms: Any, base_q: Any, base_v: Any, weights: Any, first: int, count: int, c_v: float) -> None:
    """q*, v* from rows first ... first + count - 1 of the history with `weights`, and from the point (base_q, base_v)
    with what is missing of them to 1; added to what stands there.

    On the way in q_star and v_star hold what other terms give to P_q and P_v. Only differences from the base are
    weighted: the rounding of the weights then counts by how far the rows are apart, not by how far from the origin,
    and so does not add up from step to step.
    """
    n = ws.n_ext
    q_star, v_star = vec(ws.q_star, n), vec(ws.v_star, n)
    for j in range(count):
        row = history_row(ws, ms, first + j)
        w = weights[j]
        for i in range(n):
            q_star[i] += w * (row[i] - base_q[i])
            v_star[i] += w * (row[n + i] - base_v[i])
    for i in range(n):
        v_star[i] += base_v[i]
        q_star[i] += base_q[i] + c_v * v_star[i]


@internal
def predict(ws: Any, ms: Any, weights: Any, first: int, count: int) -> None:
    """Extrapolate a and lambda through rows of the history, on top of what stands in a and lam."""
    n = ws.n_ext
    a, lam = vec(ws.a, n), vec(ws.lam, ws.m_ext)
    for j in range(count):
        row = history_row(ws, ms, first + j)
        w = weights[j]
        for i in range(ws.n):
            a[i] += w * row[2 * n + i]
        for i in range(ws.m_ext):
            lam[i] += w * row[4 * n + i]


@internal
def clear(address: int, n: int) -> None:
    """Zero a vector."""
    x = vec(address, n)
    for i in range(n):
        x[i] = 0.0


@internal
def finish_stage(ws: Any, t: float, c_v: float) -> int:
    """Solve the stage; then power and work accounts."""
    status = call_stage(ws.stage_function, ws, t, c_v * c_v, c_v)
    if status != 0:
        return status
    if ws.n_spins == 0:
        evaluate_power(ws)
    n = ws.n_ext
    v, v_star, a = vec(ws.v, n), vec(ws.v_star, n), vec(ws.a, n)
    for i in range(n - ws.n_work, n):
        v[i] = v_star[i] + c_v * a[i]
    return status


@internal
def bdf_stage(ws: Any, ms: Any, h: float, k: int, coefficients: Any, extrapolation: Any) -> int:
    """y_{n+1} = sum_j coefficients_j y_{n-j} + coefficients_k h y'_{n+1}."""
    n = ws.n_ext
    newest = history_row(ws, ms, 0)
    c_v = h * coefficients[k]
    clear(ws.q_star, n)
    clear(ws.v_star, n)
    combine_stars(ws, ms, newest[:n], newest[n : 2 * n], coefficients[1:], 1, k - 1, c_v)
    clear(ws.a, ws.n)
    clear(ws.lam, ws.m_ext)
    predict(ws, ms, extrapolation, 0, k + 1)
    return finish_stage(ws, history_time(ms, 0) + h, c_v)


@internal
def difference_norm(ws: Any, ms: Any, q: Any, v: Any, weights: Any, first: int, count: int) -> float:
    """Norm of the coordinates (q, v) less what `weights` (of sum 1) make of the rows first ... first + count - 1 of the
    history; the work accounts do not count."""
    n = ws.n_ext
    difference = vec(ws.rhs, ws.n)
    base = history_row(ws, ms, first)
    norm = 0.0
    for kind in range(2):
        for i in range(ws.n):
            difference[i] = (v[i] if kind else q[i]) - base[kind * n + i]
        for j in range(1, count):
            row = history_row(ws, ms, first + j)
            for i in range(ws.n):
                difference[i] -= weights[j] * (row[kind * n + i] - base[kind * n + i])
        norm = max(norm, weighted_norm(difference, vec(ws.weight_v if kind else ws.weight_q, n), ws.n))
    return norm


@internal
def predictor_error(ws: Any, ms: Any, weights: Any, count: int) -> float:
    """Norm of (q, v) less its extrapolation through `count` rows: the next backward difference."""
    n = ws.n_ext
    v, weight_v = vec(ws.v, n), vec(ws.weight_v, n)
    norm = difference_norm(ws, ms, vec(ws.q, n), v, weights, 0, count)
    newest = history_row(ws, ms, 0)
    for i in range(n - ws.n_work, n):
        off = v[i] - newest[n + i]
        for j in range(1, count):
            off -= weights[j] * (history_row(ws, ms, j)[n + i] - newest[n + i])
        norm = max(norm, abs(off) / weight_v[i])
    return norm


@inlined
def rows_available(ms: Any) -> int:
    """Number of rows in the history."""
    return ivec(ms.ring, 2)[1]
