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
def row_rounding(workspace: Any, x_address: int, quadratic: bool) -> float:
    """Largest rounding of Phi_q x among the active rows, in parts of their scales as `constraint_norm` counts, with
    the Phi_q evaluated last.

    `quadratic` : x are accelerations. Terms that are quadratic in the velocities come to |Phi_q v| times the fastest of
    these, in parts of the coordinates' scales.
    """
    structure = structure_at(workspace.structure)
    starts, columns = (
        ivec(structure.jacobian_start, workspace.m_act + 1),
        ivec(structure.jacobian_col, structure.n_jacobian),
    )
    slots, values = ivec(structure.jacobian_slot, structure.n_jacobian), vec(workspace.values, workspace.n_values)
    active, row_scale = ivec(workspace.active, workspace.m_act), vec(workspace.row_scale, workspace.m_ext)
    x, v, scale = (
        vec(x_address, workspace.n_ext),
        vec(workspace.v, workspace.n_ext),
        vec(workspace.scale, workspace.n_ext),
    )
    fastest, largest = 0.0, 0.0
    if quadratic:
        for i in range(workspace.n):
            fastest = max(fastest, abs(v[i]) / scale[i])
    for k in range(workspace.m_act):
        total = 0.0
        for e in range(starts[k], starts[k + 1]):
            j = columns[e]
            total += abs(values[slots[e]]) * (abs(x[j]) + fastest * abs(v[j]))
        largest = max(largest, total / row_scale[active[k]])
    return ROW_ROUNDING * largest
