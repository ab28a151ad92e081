"""Automatic choice of the number of steps k of BDF, EBDF and MEBDF.

With nabla^j y the newest difference of order j, the error of the BDF of k steps is |nabla^(k+1) y|/(k + 1); on an
unequal grid the difference is that between y and its extrapolation through k + 1 rows (Brenan, Campbell and Petzold,
Numerical Solution of IVPs in DAEs, 5.2.4). The errors for k - 1, k and k + 1 tell which k allows the largest step.
EBDF and MEBDF are judged by the same: their first stage is that BDF.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import vec
from ..state.method_records import CHOICE_SIZE, NEXT_K, NEXT_NORM, K
from ..state.workspace_records import OK, control_at
from .coefficients import extrapolation_weights
from .history import history_row, history_time
from .multistep import COUNT_ROW, difference_norm, rows_available, weight_rows

LEAST_K, MOST_K = 1, 2  # parameters of the formula
RESOLVED = 0.07
"""Angle of the model's fastest vibration in a step, rad, from which on a formula that is not A-stable is left: the
vibration would grow in it up to the tolerance, and hold the step at the angle where that ends, 0.1 to 0.5."""
# another k must promise a step larger by this factor: changing costs new coefficients
WORTH = 1.1
# rows of the table of coefficients that no formula needs after its step
NODES, WEIGHTS = 5, 6


@internal
def _error(workspace: Any, method: Any, h: float, k: int) -> float:
    """Error norm that the BDF of k steps would have had at the newest row."""
    n = workspace.n_ext
    table = weight_rows(method)
    s, weights = table[NODES], table[WEIGHTS]
    for j in range(k + 1):
        s[j] = (history_time(method, j + 1) - history_time(method, 0)) / h
    extrapolation_weights(s, k + 1, weights)
    newest = history_row(workspace, method, 0)
    norm = difference_norm(workspace, method, newest[:n], newest[n : 2 * n], weights, 1, k + 1)
    # for equal steps s[k] = -(k + 1)
    return norm / -s[k]


@internal
def select_k(workspace: Any, method: Any, h: float) -> int:
    """Propose the number of steps for what follows, from the history alone."""
    choice, parameters = vec(method.choice, CHOICE_SIZE), vec(method.parameters, 8)
    k = int(choice[K])
    choice[NEXT_K] = 0.0
    best, best_growth, best_norm = k, 0.0, 0.0
    for trial in range(k - 1, k + 2):
        if trial < parameters[LEAST_K] or trial > parameters[MOST_K] or rows_available(method) < trial + 2:
            continue
        norm = _error(workspace, method, h, trial)
        growth = (norm + 1e-30) ** (-1.0 / (trial + 1.0))
        if trial == k:
            growth *= WORTH
        if growth > best_growth:
            best, best_growth, best_norm = trial, growth, norm
    # the coefficients' nodes stood where the errors were formed
    weight_rows(method)[COUNT_ROW, 0] = 0.0
    if best != k:
        choice[NEXT_K], choice[NEXT_NORM] = best, best_norm
    return OK


@internal
def select_stable_k(workspace: Any, method: Any, h: float) -> int:
    """Propose LEAST_K steps, of an A-stable formula, once a step does not resolve the fastest vibration of a model; of
    one without bodies of many vibrations (`Assembly.has_waves`) LEAST_K is MOST_K.

    The vibration is that of the stiffness at the start. A few stiff springs are no reason: both formulas damp what is
    far beyond the step; among the vibrations of a mesh there are always some in between, which grow.
    """
    choice, parameters = vec(method.choice, CHOICE_SIZE), vec(method.parameters, 8)
    k, angle = parameters[LEAST_K], h * np.sqrt(control_at(workspace.control).stiffness_scale)
    choice[NEXT_K] = 0.0
    if choice[K] > k and angle > RESOLVED:
        choice[NEXT_K], choice[NEXT_NORM] = k, vec(method.error, 2)[0]
    return OK
