"""The right-hand side with which the condition of the constraints is measured."""

from typing import Any

import numpy as np

from ..compiled.jit import compiled
from ..compiled.views import ivec, vec
from ..state.workspace_records import structure_at

GOLDEN, SILVER = 0.6180339887498949, 0.4142135623730950
"""Whose multiples have fractions in no simple order."""


@compiled
def set_probe(workspace: Any) -> None:
    """A violation of every row that a coordinate moved by its scale would cause, with weights from 1/2 to 3/2 and signs
    in no simple order, to `workspace.probe`."""
    structure = structure_at(workspace.structure)
    starts, columns = (
        ivec(structure.jacobian_start, workspace.m_act + 1),
        ivec(structure.jacobian_col, structure.n_jacobian),
    )
    slots, values = ivec(structure.jacobian_slot, structure.n_jacobian), vec(workspace.values, workspace.n_values)
    probe, scale = vec(workspace.probe, workspace.m_act), vec(workspace.scale, workspace.n)
    for i in range(workspace.m_act):
        size = 0.0
        for e in range(starts[i], starts[i + 1]):
            size = max(size, abs(values[slots[e]]) * scale[columns[e]])
        golden, silver = GOLDEN * i, SILVER * i
        sign = 1.0 if silver - np.floor(silver) < 0.5 else -1.0
        probe[i] = size * (0.5 + golden - np.floor(golden)) * sign
