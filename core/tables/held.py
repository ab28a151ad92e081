"""Friction of contacts that stick, from the multipliers of their tangents."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat
from ..state.modes import ALONG, MEMORY_SIZE, RATIO, SLIDE, STICKS


@internal
def in_space(ws: Any, k: int) -> bool:
    """True if contact k has two tangents."""
    return bool(ivec(ws.contact_second_rows, ws.n_contacts)[k] >= 0)


@internal
def is_held(ws: Any, k: int) -> bool:
    """True if closed contact k sticks along a tangent at least."""
    slide = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, SLIDE]
    return slide == STICKS or slide == ALONG


@internal
def held_friction(ws: Any, k: int, lam: Any) -> float:
    """Size of the friction of contact k, which sticks, N, from multipliers `lam` (m_ext,)."""
    row = ivec(ws.contact_slide_rows, ws.n_contacts)[k]
    if in_space(ws, k):
        memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
        share = memory[RATIO] * lam[ivec(ws.contact_rows, ws.n_contacts)[k]]
        across = lam[row + 1] if memory[SLIDE] == STICKS else share
        return math.sqrt(lam[row] * lam[row] + across * across)
    return abs(lam[row])
