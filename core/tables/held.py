"""Friction of contacts that stick, from the multipliers of their tangents, and on a patch from their torque too."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
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
    """Size of the friction of contact k, which sticks, N, from multipliers `lam` (m_ext,); on a patch that of forces
    and torque on the ellipsoid, the torque at its present part of the full one (`shapes/patch3d.py`)."""
    row = ivec(ws.contact_slide_rows, ws.n_contacts)[k]
    if in_space(ws, k):
        memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
        normal = lam[ivec(ws.contact_rows, ws.n_contacts)[k]]
        across = lam[row + 1] if memory[SLIDE] == STICKS else memory[RATIO] * normal
        part = vec(ws.monitor, 3 * ws.n_contacts)[2 * ws.n_contacts + k]
        drills = part * vec(ws.contact_sticking, ws.n_contacts)[k] * normal
        return math.sqrt(lam[row] * lam[row] + across * across + drills * drills)
    return abs(lam[row])
