"""What rounding leaves in the rows of Phi and their derivatives where they stand now.

The levels (`levels.py`) are of the whole system, and rows count by how fast they change at the start. A slider that has
left its joint far behind makes a long lever of that joint: its rows are sums of larger numbers than at the start.
"""

from typing import Any

from ..compiled.jit import compiled
from ..compiled.views import ivec, vec
from ..rounding import ROW_ROUNDING
from ..state.workspace_records import structure_at


@compiled
def row_rounding(ws: Any, x_address: int, quadratic: bool) -> float:
    """Largest rounding of Phi_q x among the active rows, in parts of their scales as `constraint_norm` counts, with
    the Phi_q evaluated last.

    `quadratic` : x are accelerations. Terms that are quadratic in the velocities come to |Phi_q v| times the fastest of
    these, in parts of the coordinates' scales.
    """
    st = structure_at(ws.structure)
    starts, columns = ivec(st.jacobian_start, ws.m_act + 1), ivec(st.jacobian_col, st.n_jacobian)
    slots, values = ivec(st.jacobian_slot, st.n_jacobian), vec(ws.values, ws.n_values)
    active, row_scale = ivec(ws.active, ws.m_act), vec(ws.row_scale, ws.m_ext)
    x, v, scale = vec(x_address, ws.n_ext), vec(ws.v, ws.n_ext), vec(ws.scale, ws.n_ext)
    fastest, largest = 0.0, 0.0
    if quadratic:
        for i in range(ws.n):
            fastest = max(fastest, abs(v[i]) / scale[i])
    for k in range(ws.m_act):
        total = 0.0
        for e in range(starts[k], starts[k + 1]):
            j = columns[e]
            total += abs(values[slots[e]]) * (abs(x[j]) + fastest * abs(v[j]))
        largest = max(largest, total / row_scale[active[k]])
    return ROW_ROUNDING * largest
