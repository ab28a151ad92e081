"""Friction of contacts that stick, from the multipliers of their tangents."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat
from ..state.modes import ALONG, MEMORY_SIZE, SLIDE, STICKS


@internal
def is_held(ws: Any, k: int) -> bool:
    """True if closed contact k sticks along a tangent at least."""
    slide = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, SLIDE]
    return slide == STICKS or slide == ALONG


@internal
def held_friction(ws: Any, k: int, lam: Any) -> float:
    """Size of the friction of contact k, which sticks, N, from multipliers `lam` (m_ext,)."""
    row = ivec(ws.contact_slide_rows, ws.n_contacts)[k]
    if ws.tangents == 2 and mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, SLIDE] == STICKS:
        return math.sqrt(lam[row] * lam[row] + lam[row + 1] * lam[row + 1])
    return abs(lam[row])
