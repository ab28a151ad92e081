"""BDF inside TLISMNI: coordinates and velocities, orders 1 to 6, variable step on the actual grid.

Error estimate: (y - extrapolation of degree k) h/(t_{n+1} - t_{n-k}), the next difference over k + 1 for equal steps.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..state.method_records import CHOICE_SIZE, K
from ..state.workspace_records import OK
from .coefficients import bdf_coefficients, extrapolation_weights
from .history import history_time
from .multistep import bdf_stage, nodes, predictor_error, weight_rows


@internal
def bdf_step(workspace: Any, method: Any, h: float) -> int:
    k = int(vec(method.choice, CHOICE_SIZE)[K])
    table = weight_rows(method)
    if nodes(method, h, k + 1, table[0]):
        bdf_coefficients(table[0], k, table[1])
        extrapolation_weights(table[0], k + 1, table[2])
    status = bdf_stage(workspace, method, h, k, table[1], table[2])
    if status != OK:
        return status
    span = history_time(method, 0) + h - history_time(method, k)
    vec(method.error, 2)[0] = predictor_error(workspace, method, table[2], k + 1) * h / span
    vec(method.error, 2)[1] = k
    return OK
