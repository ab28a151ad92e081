"""Baumgarte's stabilised equations (Baumgarte 1972), by explicit Runge-Kutta formulas or implicitly.

Phi'' + 2 alpha Phi' + beta^2 Phi = 0 in place of Phi'' = 0; all coordinates are integrated as an ODE. The violation
of an exact solution decays as two exponentials with rates alpha -+ sqrt(alpha^2 - beta^2); that of a numerical one
settles where the local errors feed it. rule "step": alpha = 1/h, beta = sqrt(2)/h, from the Taylor expansion of Phi
over a step; the violation is then asked to vanish after each. With error-controlled steps that ends in ever smaller
ones: the smaller the step, the more suddenly the violation is to vanish.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_power
from ..compiled.jit import inlined, internal
from ..compiled.views import vec
from ..stage.solver import weighted_norm
from ..state.workspace_records import OK, call_stage, control_at
from .explicit import explicit_step
from .history import history_row, history_time
from .multistep import rows_available
from .one_stage import finish_work, predict_linearly
from .sdirk import sdirk_step
from .velocity_error import velocity_error

# columns of `parameters`
ALPHA, BETA, BY_STEP, SCHEME = 0, 1, 2, 3


@inlined
def _set_stabilisation(workspace: Any, parameters: Any, h: float) -> None:
    control = control_at(workspace.control)
    if parameters[BY_STEP] != 0.0:
        control.stage_alpha, control.stage_beta = 1.0 / h, np.sqrt(2.0) / h
    else:
        control.stage_alpha, control.stage_beta = parameters[ALPHA], parameters[BETA]


@internal
def baumgarte_explicit_step(workspace: Any, method: Any, h: float) -> int:
    """A step of an explicit formula.

    The newest row has the accelerations of the first stage unless it begins a history (they are then those of the
    constraints themselves) or alpha and beta have changed with h.
    """
    parameters = vec(method.parameters, 8)
    _set_stabilisation(workspace, parameters, h)
    reuse = rows_available(method) > 1 and parameters[BY_STEP] == 0.0
    return explicit_step(workspace, method, h, int(parameters[SCHEME]), reuse)


@internal
def baumgarte_sdirk_step(workspace: Any, method: Any, h: float) -> int:
    """A step of the SDIRK formula of order 4, over all coordinates."""
    _set_stabilisation(workspace, vec(method.parameters, 8), h)
    return sdirk_step(workspace, method, h)


@internal
def baumgarte_trapezoidal_step(workspace: Any, method: Any, h: float) -> int:
    """A step of the trapezoidal rule, over all coordinates; error estimate h^2 (a_{n+1} - a_n) / 12 of positions, and
    that of velocities."""
    _set_stabilisation(workspace, vec(method.parameters, 8), h)
    n = workspace.n_ext
    row = history_row(workspace, method, 0)
    q_star, v_star, a = vec(workspace.q_star, n), vec(workspace.v_star, n), vec(workspace.a, n)
    for i in range(n):
        q_star[i] = row[i] + h * row[n + i] + 0.25 * h * h * row[2 * n + i]
        v_star[i] = row[n + i] + 0.5 * h * row[2 * n + i]
    predict_linearly(workspace, method, h, 1.0)
    status = call_stage(workspace.stage_function, workspace, history_time(method, 0) + h, 0.25 * h * h, 0.5 * h)
    if status != OK:
        return status
    evaluate_power(workspace)
    finish_work(workspace, row, h)
    error, aux = vec(workspace.rhs, workspace.n), vec(workspace.aux, n)
    for i in range(workspace.n):
        error[i] = h * h / 12.0 * (a[i] - row[2 * n + i])
    for i in range(n):
        aux[i] = a[i]
    norm = weighted_norm(error, vec(workspace.weight_q, n), workspace.n)
    vec(method.error, 2)[0] = max(norm, velocity_error(workspace, method, h))
    vec(method.error, 2)[1] = 2.0
    return OK
