"""Explicit Runge-Kutta steps over all coordinates, with scipy's formulas and error estimates.

rk23: Bogacki and Shampine (1989); rk45: Dormand and Prince (1980); dop853: Hairer, Norsett and Wanner, Solving ODEs I,
II.10. The coefficients are those of `scipy.integrate`. Each formula ends with the derivative at the new point, which
is the first stage of the next step.
"""

from typing import Any

import numpy as np
from scipy.integrate import DOP853, RK23, RK45

from ..assembly.evaluate import evaluate_power, evaluate_residuals
from ..assembly.workspace import MOST_STAGES
from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..state.workspace_records import OK, call_stage
from .history import history_row, history_time
from .schemes import EXPLICIT_SCHEMES

_BY_NAME = {"rk23": RK23, "rk45": RK45, "dop853": DOP853}
_FORMULAS = tuple(_BY_NAME[name] for name in EXPLICIT_SCHEMES)


def _table() -> tuple[np.ndarray, ...]:
    """(A, C, E, E3) by scheme, zero-padded; the last used row of A holds the weights B of the new point."""
    a, c = np.zeros((3, MOST_STAGES, MOST_STAGES)), np.zeros((3, MOST_STAGES))
    e, e3 = np.zeros((3, MOST_STAGES)), np.zeros((3, MOST_STAGES))
    for k, formula in enumerate(_FORMULAS):
        s = formula.n_stages
        a[k, :s, :s] = formula.A[:s, :s] if formula.A.shape[1] >= s else np.pad(formula.A, ((0, 0), (0, 1)))
        a[k, s, :s] = formula.B
        c[k, :s], c[k, s] = formula.C[:s], 1.0
        if formula is DOP853:
            e[k, : s + 1], e3[k, : s + 1] = formula.E5, formula.E3
        else:
            e[k, : s + 1] = formula.E
    return a, c, e, e3


A, C, E, E3 = _table()
LAST = np.array([formula.n_stages for formula in _FORMULAS])
ESTIMATE_ORDER = np.array([float(formula.error_estimator_order) for formula in _FORMULAS])


@internal
def _norm(stages: Any, weight: Any, first: int, last: int, h: float, scheme: int) -> float:
    """Error norm of entries first ... last - 1: root mean square, for dop853 combined of both its estimates."""
    square, square3 = 0.0, 0.0
    for i in range(first, last):
        error, error3 = 0.0, 0.0
        for j in range(LAST[scheme] + 1):
            error += E[scheme, j] * stages[j, i]
            error3 += E3[scheme, j] * stages[j, i]
        square += (error / weight[i]) ** 2
        square3 += (error3 / weight[i]) ** 2
    if square == 0.0 and square3 == 0.0:
        return 0.0
    return h * square / np.sqrt((square + 0.01 * square3) * (last - first))


@internal
def explicit_step(workspace: Any, method: Any, h: float, scheme: int, reuse: bool) -> int:
    """One step from the newest row; `reuse`: its accelerations are those of the first stage.

    Each stage's accelerations come from the stage function, which reads alpha and beta in `control`.
    """
    n = workspace.n_ext
    row = history_row(workspace, method, 0)
    t = history_time(method, 0)
    stage_v, stage_a = mat(workspace.stage_v, MOST_STAGES, n), mat(workspace.stage_a, MOST_STAGES, n)
    q_star, v_star = vec(workspace.q_star, n), vec(workspace.v_star, n)
    v, a, lam = vec(workspace.v, n), vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    first_work = n - workspace.n_work
    for i in range(n):
        a[i] = row[2 * n + i]
    for i in range(workspace.m_ext):
        lam[i] = row[4 * n + i]
    for s in range(LAST[scheme] + 1):
        for i in range(n):
            p_q, p_v = 0.0, 0.0
            for j in range(s):
                p_q += A[scheme, s, j] * stage_v[j, i]
                p_v += A[scheme, s, j] * stage_a[j, i]
            q_star[i] = row[i] + h * p_q
            v_star[i] = row[n + i] + h * p_v
        if s > 0 or not reuse:
            status = call_stage(workspace.stage_function, workspace, t + C[scheme, s] * h, 0.0, 0.0)
            if status != OK:
                return status
            evaluate_power(workspace)
        for i in range(n):
            stage_v[s, i] = v_star[i]
            stage_a[s, i] = a[i]
    for i in range(first_work, n):
        v[i] = v_star[i]
    evaluate_residuals(workspace)
    weight_v = vec(workspace.weight_v, n)
    norm = max(
        _norm(stage_v, vec(workspace.weight_q, n), 0, workspace.n, h, scheme),
        _norm(stage_a, weight_v, 0, workspace.n, h, scheme),
    )
    for i in range(first_work, n):
        norm = max(norm, _norm(stage_a, weight_v, i, i + 1, h, scheme))
    error, aux = vec(method.error, 2), vec(workspace.aux, n)
    error[0], error[1] = norm, ESTIMATE_ORDER[scheme]
    for i in range(n):
        aux[i] = a[i]
    return OK
