"""What the one-stage formulas of the comparison methods share: the prediction, and the work accounts."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from .history import history_row, history_time
from .multistep import rows_available

MOST_GROWTH = 5.0
"""Of the step from one to the next, up to which what hangs on its size is carried over; after a step that ended at some
time just ahead the next may be larger by any factor, and so would noise of the accelerations."""


@internal
def predict_linearly(workspace: Any, method: Any, h: float, factor: float) -> None:
    """Extrapolate a and lambda through the newest two rows (or keep those of the only one); a is divided by `factor`,
    what the stage's unknown is less than the acceleration."""
    n = workspace.n_ext
    newest, older = history_row(workspace, method, 0), history_row(workspace, method, 1)
    ahead = 0.0
    if rows_available(method) > 1:
        ahead = h / (history_time(method, 0) - history_time(method, 1))
    a, lam = vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    for i in range(workspace.n):
        a[i] = (newest[2 * n + i] + ahead * (newest[2 * n + i] - older[2 * n + i])) / factor
    for i in range(workspace.m_ext):
        lam[i] = newest[4 * n + i] + ahead * (newest[4 * n + i] - older[4 * n + i])


@internal
def finish_work(workspace: Any, row: Any, h: float) -> None:
    """Work accounts by the trapezoidal rule, from the powers at both ends of the step."""
    n = workspace.n_ext
    v, a = vec(workspace.v, n), vec(workspace.a, n)
    for i in range(n - workspace.n_work, n):
        v[i] = row[n + i] + 0.5 * h * (row[2 * n + i] + a[i])
