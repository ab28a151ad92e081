"""Dense output: Hermite interpolation of (q, v, a) through the newest rows, then projection.

The interpolant gives the independent coordinates; the dependent ones follow from the constraints and (a, lambda)
from the augmented system, so that a sample between steps satisfies every level as well as a step's end does.
It is a pure function of the history: asking does not change what comes after.
"""

from typing import Any

from ..assembly.evaluate import evaluate_residuals
from ..compiled.jit import compiled, compiled_unlocked, internal
from ..compiled.views import mat, vec
from ..methods.history import bridge_rows, history_row, history_time, recall
from ..methods.multistep import rows_available
from ..rounding import NO_STEP
from ..state.workspace_records import OK, SINGULAR
from .repivoting import project_between

BETWEEN = 100
"""`_find`: the point has been interpolated, and is to be projected."""
APART = 0.1
"""Of the newest step: rows nearer to one another than this make divided differences of rounding."""
ALIKE = 3
"""Conditions of a coordinate at each node, value and two derivatives; a work account has the first two."""


@internal
def _hermite(z: Any, rows: int, alike: int, s: float, values: Any, slopes: Any) -> None:
    """Weights of what is known at the nodes z[:rows] for the polynomial's value at s, and for its slope there.

    values[j, l], slopes[j, l] belong to the Taylor coefficient l < `alike` at node j. The polynomial of such a weight
    is B^alike, B = product of (s - z_k)/(z_j - z_k) over the others, which is zero at those as often as it has to be,
    times as much of the series of 1/B^alike at z_j as makes it one there: c0 + c1 u + c2 u^2, u = s - z_j.
    """
    for j in range(rows):
        b, db, inverse_sum, square_sum = 1.0, 0.0, 0.0, 0.0
        for k in range(rows):
            if k != j:
                inverse = 1.0 / (z[j] - z[k])
                db = (db * (s - z[k]) + b) * inverse
                b *= (s - z[k]) * inverse
                inverse_sum += inverse
                square_sum += inverse * inverse
        u = s - z[j]
        c1 = -alike * inverse_sum
        c2 = 0.5 * alike * (square_sum + alike * inverse_sum * inverse_sum) if alike == ALIKE else 0.0
        below = b if alike == 2 else b * b
        power, dpower = below * b, alike * below * db
        # u^l times the beginning of the series
        first, dfirst = 1.0 + u * (c1 + u * c2), c1 + 2.0 * c2 * u
        values[j, 0], slopes[j, 0] = power * first, dpower * first + power * dfirst
        second, dsecond = (u, 1.0) if alike == 2 else (u * (1.0 + c1 * u), 1.0 + 2.0 * c1 * u)
        values[j, 1], slopes[j, 1] = power * second, dpower * second + power * dsecond
        values[j, 2], slopes[j, 2] = power * u * u, dpower * u * u + 2.0 * power * u


@internal
def _add_row(row: Any, base: Any, n: int, h: float, values: Any, slopes: Any, q: Any, v: Any) -> None:
    """What a row gives to the coordinates and velocities beyond the base, a row near to all others: so rounding of the
    weights counts by how far rows are apart. The weights' unit of time is h."""
    value, rate, curvature = values[0], h * values[1], 0.5 * h * h * values[2]
    dvalue, drate, dcurvature = slopes[0] / h, slopes[1], 0.5 * h * slopes[2]
    for i in range(len(q)):
        difference, speed, acceleration = row[i] - base[i], row[n + i], row[2 * n + i]
        q[i] += value * difference + rate * speed + curvature * acceleration
        v[i] += dvalue * difference + drate * speed + dcurvature * acceleration


@internal
def third_row(method: Any) -> int:
    """The newest row that is well apart from the newest two; 0 if there is none."""
    start = history_time(method, 1)
    apart = APART * (history_time(method, 0) - start)
    for back in range(2, rows_available(method)):
        if start - history_time(method, back) >= apart:
            return back
    return 0


@internal
def _interpolate_bridge(workspace: Any, method: Any, t: float) -> None:
    """The polynomials through all points of a long step, whose nodes make that accurate."""
    n, count = workspace.n_ext, bridge_rows(method)
    span = history_time(method, 0) - history_time(method, count - 1)
    weights, total = vec(workspace.scratch, count), 0.0
    for j in range(count):
        distance = (t - history_time(method, j)) / span
        if distance == 0.0:
            recall(workspace, method, j)
            return
        weights[j] = 1.0 / distance
        for l in range(count):
            if l != j:
                weights[j] /= 4.0 * (history_time(method, j) - history_time(method, l)) / span
        total += weights[j]
    q, v, a, lam = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    for i in range(n):
        q[i], v[i], a[i] = 0.0, 0.0, 0.0
    for i in range(workspace.m_ext):
        lam[i] = 0.0
    for j in range(count):
        row, weight = history_row(workspace, method, j), weights[j] / total
        for i in range(n):
            q[i] += weight * row[i]
            v[i] += weight * row[n + i]
            a[i] += weight * row[2 * n + i]
        for i in range(workspace.m_ext):
            lam[i] += weight * row[4 * n + i]
    vec(workspace.t, 1)[0] = t


@compiled
def interpolate(workspace: Any, method: Any, t: float) -> None:
    """q, v and the work accounts at t from the newest rows, into the workspace."""
    if bridge_rows(method) > 0:
        _interpolate_bridge(workspace, method, t)
        return
    n = workspace.n_ext
    third = third_row(method)
    rows = 2 if third == 0 else 3
    h = history_time(method, 0) - history_time(method, 1)
    s = (t - history_time(method, 0)) / h
    z, values, slopes = (
        vec(workspace.scratch, 3),
        mat(workspace.scratch + 3 * 8, 3, 3),
        mat(workspace.scratch + 12 * 8, 3, 3),
    )
    for j in range(rows):
        z[j] = (history_time(method, third if j == 2 else j) - history_time(method, 0)) / h
    _hermite(z, rows, ALIKE, s, values, slopes)
    newest, older = history_row(workspace, method, 0), history_row(workspace, method, 1)
    q, v = vec(workspace.q, n), vec(workspace.v, n)
    for i in range(workspace.n):
        q[i], v[i] = older[i], 0.0
    for j in range(rows):
        row = history_row(workspace, method, third if j == 2 else j)
        _add_row(row, older, n, h, values[j], slopes[j], q[: workspace.n], v[: workspace.n])
    _hermite(z, rows, 2, s, values, slopes)
    for i in range(n - workspace.n_work, n):
        v[i] = older[n + i]
        for j in range(rows):
            row = history_row(workspace, method, third if j == 2 else j)
            v[i] += values[j, 0] * (row[n + i] - older[n + i]) + h * values[j, 1] * row[2 * n + i]
    # linear: what is shown of a method that does not meet the constraints, a first guess for the others
    a, lam = vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    for i in range(workspace.n):
        a[i] = newest[2 * n + i] + s * (newest[2 * n + i] - older[2 * n + i])
    for i in range(workspace.m_ext):
        lam[i] = newest[4 * n + i] + s * (newest[4 * n + i] - older[4 * n + i])
    vec(workspace.t, 1)[0] = t


@internal
def _find(workspace: Any, method: Any, t: float) -> int:
    """The point at time t between the newest two rows, or at one of them: OK, BETWEEN or SINGULAR."""
    for back in range(min(rows_available(method), 2)):
        if t == history_time(method, back):
            recall(workspace, method, back)
            evaluate_residuals(workspace)
            return OK
    if rows_available(method) < 2:
        # an event just before a communication point, with no step between the two
        if abs(t - history_time(method, 0)) > NO_STEP * abs(t):
            return SINGULAR
        recall(workspace, method, 0)
        evaluate_residuals(workspace)
        return OK
    interpolate(workspace, method, t)
    if method.exact == 0:
        evaluate_residuals(workspace)
        return OK
    return BETWEEN


@compiled_unlocked
def query(workspace: Any, method: Any, t: float) -> int:
    """The point at time t between the newest two rows (or at one of them) becomes the workspace's current point.
    REANALYZE: matrices need more memory (`Workspace.give_room`) before it is asked again."""
    status = _find(workspace, method, t)
    return project_between(workspace, False) if status == BETWEEN else status


@compiled_unlocked
def query_motion(workspace: Any, method: Any, t: float) -> int:
    """The same without its accelerations, multipliers and forces: coordinates and velocities, bit for bit."""
    status = _find(workspace, method, t)
    return project_between(workspace, True) if status == BETWEEN else status
