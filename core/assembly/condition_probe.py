"""The right-hand side with which the condition of the constraints is measured."""

from typing import Any

import numpy as np

from ..compiled.jit import compiled
from ..compiled.views import ivec, vec
from ..state.workspace_records import structure_at

GOLDEN, SILVER = 0.6180339887498949, 0.4142135623730950
"""Whose multiples have fractions in no simple order."""


@compiled
def set_probe(ws: Any) -> None:
    """A violation of every row that a coordinate moved by its scale would cause, with weights from 1/2 to 3/2 and signs
    in no simple order, to `ws.probe`."""
    st = structure_at(ws.structure)
    starts, columns = ivec(st.jacobian_start, ws.m_act + 1), ivec(st.jacobian_col, st.n_jacobian)
    slots, values = ivec(st.jacobian_slot, st.n_jacobian), vec(ws.values, ws.n_values)
    probe, scale = vec(ws.probe, ws.m_act), vec(ws.scale, ws.n)
    for i in range(ws.m_act):
        size = 0.0
        for e in range(starts[i], starts[i + 1]):
            size = max(size, abs(values[slots[e]]) * scale[columns[e]])
        golden, silver = GOLDEN * i, SILVER * i
        sign = 1.0 if silver - np.floor(silver) < 0.5 else -1.0
        probe[i] = size * (0.5 + golden - np.floor(golden)) * sign
