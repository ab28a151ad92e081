"""Dense output: Hermite interpolation of (q, v, a) through the newest rows, then projection.

The interpolant gives the independent coordinates; the dependent ones follow from the constraints and (a, lambda)
from the augmented system, so that a sample between steps satisfies every level as well as a step's end does.
It is a pure function of the history: asking does not change what comes after.
"""

from typing import Any

from ..compiled.jit import compiled, compiled_unlocked, internal
from ..compiled.views import mat, vec
from ..methods.history import bridge_rows, history_row, history_time, recall
from ..methods.multistep import rows_available
from ..rounding import NO_STEP
from ..stage.project import project, project_motion
from ..state.workspace_records import OK, SINGULAR
from ..tables.evaluate import evaluate_residuals

BETWEEN = 100
"""`_find`: the point has been interpolated, and is to be projected."""
APART = 0.1
"""Of the newest step: rows nearer to one another than this make divided differences of rounding."""


@internal
def _divided_differences(z: Any, table: Any, count: int) -> None:
    """Newton coefficients in place; table[j] holds f, and seeds for confluent nodes stand in `table[:, 1:3]`."""
    # z has each node `repeat` times in a row; table[:, 0] = f, table[:, 1] = f', table[:, 2] = f''/2
    for order in range(1, count):
        for j in range(count - 1, order - 1, -1):
            if z[j] != z[j - order]:
                table[j, 0] = (table[j, 0] - table[j - 1, 0]) / (z[j] - z[j - order])
            elif order == 1:
                table[j, 0] = table[j, 1]
            else:
                table[j, 0] = table[j, 2]


@internal
def _newton_value(z: Any, table: Any, count: int, s: float) -> Any:
    """Value and derivative of the Newton form at s."""
    f, df = table[count - 1, 0], 0.0
    for j in range(count - 2, -1, -1):
        df = df * (s - z[j]) + f
        f = f * (s - z[j]) + table[j, 0]
    return f, df


@internal
def third_row(ms: Any) -> int:
    """The newest row that is well apart from the newest two; 0 if there is none."""
    start = history_time(ms, 1)
    apart = APART * (history_time(ms, 0) - start)
    for back in range(2, rows_available(ms)):
        if start - history_time(ms, back) >= apart:
            return back
    return 0


@internal
def _interpolate_bridge(ws: Any, ms: Any, t: float) -> None:
    """The polynomials through all points of a long step, whose nodes make that accurate."""
    n, count = ws.n_ext, bridge_rows(ms)
    span = history_time(ms, 0) - history_time(ms, count - 1)
    weights, total = vec(ws.scratch, count), 0.0
    for j in range(count):
        distance = (t - history_time(ms, j)) / span
        if distance == 0.0:
            recall(ws, ms, j)
            return
        weights[j] = 1.0 / distance
        for l in range(count):
            if l != j:
                weights[j] /= 4.0 * (history_time(ms, j) - history_time(ms, l)) / span
        total += weights[j]
    q, v, a, lam = vec(ws.q, n), vec(ws.v, n), vec(ws.a, n), vec(ws.lam, ws.m_ext)
    for i in range(n):
        q[i], v[i], a[i] = 0.0, 0.0, 0.0
    for i in range(ws.m_ext):
        lam[i] = 0.0
    for j in range(count):
        row, weight = history_row(ws, ms, j), weights[j] / total
        for i in range(n):
            q[i] += weight * row[i]
            v[i] += weight * row[n + i]
            a[i] += weight * row[2 * n + i]
        for i in range(ws.m_ext):
            lam[i] += weight * row[4 * n + i]
    vec(ws.t, 1)[0] = t


@compiled
def interpolate(ws: Any, ms: Any, t: float) -> None:
    """q, v and the work accounts at t from the newest rows, into the workspace."""
    if bridge_rows(ms) > 0:
        _interpolate_bridge(ws, ms, t)
        return
    n = ws.n_ext
    third = third_row(ms)
    rows = 2 if third == 0 else 3
    h = history_time(ms, 0) - history_time(ms, 1)
    s = (t - history_time(ms, 0)) / h
    z, table = vec(ws.scratch, 9), mat(ws.scratch + 9 * 8, 9, 3)
    q, v = vec(ws.q, n), vec(ws.v, n)
    for i in range(ws.n):
        for j in range(rows):
            back = third if j == 2 else j
            row = history_row(ws, ms, back)
            node = (history_time(ms, back) - history_time(ms, 0)) / h
            for l in range(3):
                z[3 * j + l] = node
                table[3 * j + l, 0] = row[i]
                table[3 * j + l, 1] = h * row[n + i]
                table[3 * j + l, 2] = 0.5 * h * h * row[2 * n + i]
        _divided_differences(z, table, 3 * rows)
        f, df = _newton_value(z, table, 3 * rows, s)
        q[i], v[i] = f, df / h
    for i in range(n - ws.n_work, n):
        for j in range(rows):
            back = third if j == 2 else j
            row = history_row(ws, ms, back)
            node = (history_time(ms, back) - history_time(ms, 0)) / h
            for l in range(2):
                z[2 * j + l] = node
                table[2 * j + l, 0] = row[n + i]
                table[2 * j + l, 1] = h * row[2 * n + i]
        _divided_differences(z, table, 2 * rows)
        v[i], _ = _newton_value(z, table, 2 * rows, s)
    # linear: what is shown of a method that does not meet the constraints, a first guess for the others
    newest, older = history_row(ws, ms, 0), history_row(ws, ms, 1)
    a, lam = vec(ws.a, n), vec(ws.lam, ws.m_ext)
    for i in range(ws.n):
        a[i] = newest[2 * n + i] + s * (newest[2 * n + i] - older[2 * n + i])
    for i in range(ws.m_ext):
        lam[i] = newest[4 * n + i] + s * (newest[4 * n + i] - older[4 * n + i])
    vec(ws.t, 1)[0] = t


@internal
def _find(ws: Any, ms: Any, t: float) -> int:
    """The point at time t between the newest two rows, or at one of them: OK, BETWEEN or SINGULAR."""
    for back in range(min(rows_available(ms), 2)):
        if t == history_time(ms, back):
            recall(ws, ms, back)
            evaluate_residuals(ws)
            return OK
    if rows_available(ms) < 2:
        # an event just before a communication point, with no step between the two
        if abs(t - history_time(ms, 0)) > NO_STEP * abs(t):
            return SINGULAR
        recall(ws, ms, 0)
        evaluate_residuals(ws)
        return OK
    interpolate(ws, ms, t)
    if ms.exact == 0:
        evaluate_residuals(ws)
        return OK
    return BETWEEN


@compiled_unlocked
def query(ws: Any, ms: Any, t: float) -> int:
    """The point at time t between the newest two rows (or at one of them) becomes the workspace's current point."""
    status = _find(ws, ms, t)
    return project(ws) if status == BETWEEN else status


@compiled_unlocked
def query_motion(ws: Any, ms: Any, t: float) -> int:
    """The same without its accelerations, multipliers and forces: coordinates and velocities, bit for bit."""
    status = _find(ws, ms, t)
    return project_motion(ws) if status == BETWEEN else status
