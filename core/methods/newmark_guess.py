"""Starting values of a step of Newmark's or HHT's formula: a pure function of the history.

Where motion is smooth, a polynomial through many rows of the history gives accelerations and multipliers so well that
one outer iteration is enough. Dependent positions and velocities, which no formula integrates, are extrapolated too:
q* + c_q a misses them by the formula's local error, which the inner loop would have to make up for at every step. Not
so where constraints are linear: then it meets them.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from .coefficients import extrapolation_weights
from .history import history_row, history_time
from .multistep import rows_available
from .one_stage import MOST_GROWTH

FEW_ROWS = 3
"""Of the history, from which positions are extrapolated where motion is not smooth."""
MANY_ROWS = 5
"""From which everything is where it is."""
BY_LINE, BY_MANY_ROWS, ALL_BY_MANY_ROWS, BY_POSITIONS = range(4)
"""What is predicted: accelerations through two rows or through many, dependent coordinates through many rows too, or
positions and the accelerations that belong to them."""


@internal
def _weights(workspace: Any, method: Any, first: int, t: float, count: int) -> Any:
    """Weights in `scratch` that extrapolate rows first ... first + count - 1 of the history to t."""
    nodes, weights = vec(workspace.scratch, MANY_ROWS), vec(workspace.scratch + 8 * MANY_ROWS, MANY_ROWS)
    for j in range(count):
        nodes[j] = history_time(method, first + j) - t
    extrapolation_weights(nodes, count, weights)
    return weights


@internal
def _rows_beat_formula(workspace: Any, method: Any, weights: Any, alpha: float, gamma: float) -> bool:
    """Whether `weights` of the many rows before the newest would have predicted its dependent velocities better than
    the formula with its accelerations. (Those that it carried then are no part of a state; here they are made of the
    true ones.)"""
    n, h = workspace.n_ext, history_time(method, 0) - history_time(method, 1)
    newest, row1, row2 = (
        history_row(workspace, method, 0),
        history_row(workspace, method, 1),
        history_row(workspace, method, 2),
    )
    row3, row4, row5 = (
        history_row(workspace, method, 3),
        history_row(workspace, method, 4),
        history_row(workspace, method, 5),
    )
    w1, w2, w3, w4, w5 = weights[0], weights[1], weights[2], weights[3], weights[4]
    ratio = min(h / (history_time(method, 1) - history_time(method, 2)), MOST_GROWTH)
    dependent, weight_v = ivec(workspace.dependent, workspace.m_act), vec(workspace.weight_v, n)
    by_formula, by_many = 0.0, 0.0
    for k in range(workspace.m_act):
        i, unit = n + dependent[k], 1.0 / weight_v[dependent[k]]
        true = row1[n + i]
        algorithmic = (1.0 + alpha) * true - alpha * row2[n + i]
        mean = (1.0 - gamma) * (true + ratio * (algorithmic - true)) + gamma * newest[2 * n + i]
        off = unit * (newest[i] - row1[i] - h * mean)
        by_formula += off * off
        off = unit * (newest[i] - w1 * row1[i] - w2 * row2[i] - w3 * row3[i] - w4 * row4[i] - w5 * row5[i])
        by_many += off * off
    return by_many < by_formula


@internal
def best_guess(workspace: Any, method: Any, c_q: float, alpha: float, gamma: float) -> int:
    """What would have predicted the newest row best. Accelerations of stiff components are large and change their sign
    from step to step: there it is positions."""
    rows = rows_available(method)
    if rows <= FEW_ROWS:
        return BY_LINE
    n, t = workspace.n_ext, history_time(method, 0)
    newest, row1 = history_row(workspace, method, 0), history_row(workspace, method, 1)
    row2, row3 = history_row(workspace, method, 2), history_row(workspace, method, 3)
    weights, weight_q = _weights(workspace, method, 1, t, FEW_ROWS), vec(workspace.weight_q, n)
    w1, w2, w3 = weights[0], weights[1], weights[2]
    ahead = (t - history_time(method, 1)) / (history_time(method, 1) - history_time(method, 2))
    by_q, by_line = 0.0, 0.0
    for i in range(workspace.n):
        j, unit = 2 * n + i, 1.0 / weight_q[i]
        dq = unit * (newest[i] - w1 * row1[i] - w2 * row2[i] - w3 * row3[i])
        da = unit * (newest[j] - row1[j] - ahead * (row1[j] - row2[j]))
        by_q += dq * dq
        by_line += da * da
    by_line *= c_q * c_q
    guess = BY_POSITIONS if by_q < by_line else BY_LINE
    if rows <= MANY_ROWS:
        return guess
    row4, row5 = history_row(workspace, method, 4), history_row(workspace, method, 5)
    weights = _weights(workspace, method, 1, t, MANY_ROWS)
    w1, w2, w3, w4, w5 = weights[0], weights[1], weights[2], weights[3], weights[4]
    by_many = 0.0
    for i in range(workspace.n):
        j = 2 * n + i
        da = (newest[j] - w1 * row1[j] - w2 * row2[j] - w3 * row3[j] - w4 * row4[j] - w5 * row5[j]) / weight_q[i]
        by_many += da * da
    if not c_q * c_q * by_many < min(by_q, by_line):
        return guess
    return ALL_BY_MANY_ROWS if _rows_beat_formula(workspace, method, weights, alpha, gamma) else BY_MANY_ROWS


@internal
def guess_by_line(workspace: Any, method: Any, h: float) -> None:
    """Accelerations and multipliers extrapolated from the newest two rows."""
    n, ahead = workspace.n_ext, 0.0
    if rows_available(method) > 1:
        ahead = h / (history_time(method, 0) - history_time(method, 1))
    row, older = history_row(workspace, method, 0), history_row(workspace, method, 1)
    a, lam = vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    for i in range(workspace.n):
        a[i] = row[2 * n + i] + ahead * (row[2 * n + i] - older[2 * n + i])
    for i in range(workspace.m_ext):
        lam[i] = row[4 * n + i] + ahead * (row[4 * n + i] - older[4 * n + i])


@internal
def guess_by_many_rows(workspace: Any, method: Any, h: float, c_q: float, c_v: float, everything: bool) -> None:
    """Accelerations and multipliers extrapolated from many rows; if `everything`, q* and v* of dependent coordinates
    such that they too are predicted to be where their own extrapolation is."""
    n = workspace.n_ext
    weights = _weights(workspace, method, 0, history_time(method, 0) + h, MANY_ROWS)
    w0, w1, w2, w3, w4 = weights[0], weights[1], weights[2], weights[3], weights[4]
    row0, row1, row2 = (
        history_row(workspace, method, 0),
        history_row(workspace, method, 1),
        history_row(workspace, method, 2),
    )
    row3, row4 = history_row(workspace, method, 3), history_row(workspace, method, 4)
    a, lam, q_star, v_star = (
        vec(workspace.a, n),
        vec(workspace.lam, workspace.m_ext),
        vec(workspace.q_star, n),
        vec(workspace.v_star, n),
    )
    for i in range(workspace.n):
        j = 2 * n + i
        a[i] = w0 * row0[j] + w1 * row1[j] + w2 * row2[j] + w3 * row3[j] + w4 * row4[j]
    for i in range(workspace.m_ext):
        j = 4 * n + i
        lam[i] = w0 * row0[j] + w1 * row1[j] + w2 * row2[j] + w3 * row3[j] + w4 * row4[j]
    if not everything:
        return
    dependent = ivec(workspace.dependent, workspace.m_act)
    for k in range(workspace.m_act):
        i = dependent[k]
        j = n + i
        if k < workspace.m_held:
            q_star[i] = w0 * row0[i] + w1 * row1[i] + w2 * row2[i] + w3 * row3[i] + w4 * row4[i] - c_q * a[i]
        v_star[i] = w0 * row0[j] + w1 * row1[j] + w2 * row2[j] + w3 * row3[j] + w4 * row4[j] - c_v * a[i]


@internal
def guess_by_positions(workspace: Any, method: Any, h: float, c_q: float) -> None:
    """The accelerations that belong to positions extrapolated from the newest rows, or at the start by velocities; the
    multipliers of the newest row."""
    n, count = workspace.n_ext, min(rows_available(method), FEW_ROWS)
    weights = _weights(workspace, method, 0, history_time(method, 0) + h, count)
    newest, q_star, a, lam = (
        history_row(workspace, method, 0),
        vec(workspace.q_star, n),
        vec(workspace.a, n),
        vec(workspace.lam, workspace.m_ext),
    )
    for i in range(workspace.n):
        q = newest[i] + h * newest[n + i]
        if count > 1:
            q = 0.0
            for j in range(count):
                q += weights[j] * history_row(workspace, method, j)[i]
        a[i] = (q - q_star[i]) / c_q
    for i in range(workspace.m_ext):
        lam[i] = newest[4 * n + i]
