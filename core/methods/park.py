"""Park's formula inside TLISMNI (Park 1975; used by Aboubakr and Shabana 2015), order 2, on the actual grid.

The mean of the derivative formulas of BDF 2 and BDF 3; for equal steps
y_{n+1} = (15 y_n - 6 y_{n-1} + y_{n-2})/10 + 0.6 h y'_{n+1}, A- and L-stable.
Error estimate: with D = y_{n+1} less its extrapolation through the last three points, half of the error of BDF 2 in the
derivative times b h: b D / (2 |s_2|), s_2 = (t_{n-2} - t_{n+1})/h; D/10 for equal steps.
"""

from typing import Any

from ..compiled.jit import compiled, internal
from ..compiled.views import vec
from ..state.workspace_records import OK
from .coefficients import bdf_coefficients, extrapolation_weights
from .multistep import bdf_stage, nodes, predictor_error, weight_rows

NODES, PARK, SECOND, EXTRAPOLATION = range(4)
STEPS = 3


@compiled
def park_coefficients(s: Any, out: Any, scratch: Any) -> None:
    """y(0) = sum_j out_j y_j + out_3 y'(0), nodes s_j < 0, j < 3."""
    bdf_coefficients(s, 2, scratch)
    bdf_coefficients(s, 3, out)
    # y' = (y(0) - sum c_j y_j)/b of both, then their mean
    own = 0.5 * (1.0 / scratch[2] + 1.0 / out[3])
    for j in range(3):
        slope = out[j] / out[3]
        if j < 2:
            slope += scratch[j] / scratch[2]
        out[j] = 0.5 * slope / own
    out[3] = 1.0 / own


@internal
def park_step(workspace: Any, method: Any, h: float) -> int:
    table = weight_rows(method)
    if nodes(method, h, STEPS, table[NODES]):
        park_coefficients(table[NODES], table[PARK], table[SECOND])
        extrapolation_weights(table[NODES], STEPS, table[EXTRAPOLATION])
    # bdf_stage predicts through one row more than the formula uses
    table[EXTRAPOLATION, STEPS] = 0.0
    status = bdf_stage(workspace, method, h, STEPS, table[PARK], table[EXTRAPOLATION])
    if status != OK:
        return status
    ratio = 0.5 * table[PARK, STEPS] / -table[NODES, STEPS - 1]
    vec(method.error, 2)[0] = predictor_error(workspace, method, table[EXTRAPOLATION], STEPS) * ratio
    vec(method.error, 2)[1] = 2.0
    return OK
