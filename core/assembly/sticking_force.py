"""Friction of contacts that stick, from the multipliers of their tangents, and on a patch from their torque too."""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..rounding import IMPLIED_MOVES, IMPLIED_SLIDES, IMPLIED_TURNS, TURNS
from ..state.modes import AT_LIMIT, CLOSED, IMPLIED, LEAN, MEMORY_SIZE, MODE, OF_NORMAL, RATIO, SLIDE, STICKS, WAY
from .levels import acceleration_level, position_level, rate_size


@internal
def in_space(ws: Any, k: int) -> bool:
    """True if contact k has two tangents."""
    return bool(ivec(ws.contact_second_rows, ws.n_contacts)[k] >= 0)


@internal
def is_held(ws: Any, k: int) -> bool:
    """True if closed contact k sticks along a tangent at least."""
    slide = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, SLIDE]
    return slide == STICKS or slide == AT_LIMIT


@internal
def implied_margin(ws: Any, k: int, before: float) -> float:
    """How far closed contact k is from what says that others do not imply its constraints: 1 where they do, 0 where its
    gap has moved by IMPLIED_MOVES, one that sticks slides by IMPLIED_SLIDES, or the gap's acceleration, which was
    `before` at the newest row, has jumped by IMPLIED_TURNS: a corner has come to the end of a face, and the rows that
    are solved for follow its round edge. 1 for a contact that is solved for; -1 at least, since an edge much rounder
    than what turns would make all other margins small beside it."""
    memory, row = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k], ivec(ws.contact_rows, ws.n_contacts)[k]
    bits, moved = np.int64(memory[IMPLIED]), 0.0
    if memory[MODE] != CLOSED or bits == 0:
        return 1.0
    if bits & OF_NORMAL != 0:
        moved = abs(vec(ws.phi, ws.m_ext)[row]) / (
            IMPLIED_MOVES * position_level(ws) * vec(ws.row_scale, ws.m_ext)[row]
        )
        turns = IMPLIED_TURNS * acceleration_level(ws) * vec(ws.row_scale, ws.m_ext)[row]
        if abs(before) <= 0.5 * turns:
            moved = max(moved, abs(vec(ws.phidd, ws.m_ext)[row]) / turns)
    if bits != OF_NORMAL and memory[SLIDE] == STICKS:
        phid, slide = vec(ws.phid, ws.m_ext), ivec(ws.contact_slide_rows, ws.n_contacts)[k]
        speed = math.hypot(phid[slide], phid[slide + 1] if in_space(ws, k) else 0.0)
        moved = max(moved, speed / (IMPLIED_SLIDES * rate_size(ws, k)))
    return float(max(1.0 - moved, -1.0))


@internal
def friction_limit(ws: Any, k: int, force: float) -> float:
    """Largest friction of contact k, which sticks with this normal force, N. That of one at its limit turns along the
    tangent of its circle (`state/modes.py`), and may leave it by a little."""
    most = vec(ws.contact_sticking, ws.n_contacts)[k] * force
    at_limit = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, SLIDE] == AT_LIMIT
    return float((1.0 + TURNS) * most if at_limit else most)


@internal
def held_friction(ws: Any, k: int, lam: Any) -> float:
    """Size of the friction of contact k, which sticks, N, from multipliers `lam` (m_ext,); on a patch that of forces
    and torque on the ellipsoid, the torque at its present part of the full one (`contacts/patch3d.py`)."""
    companion = ivec(ws.contact_companion, ws.n_contacts)[k]
    if companion != 0:
        return _held_by_three(ws, k if companion > 0 else k - 1, lam)
    row = ivec(ws.contact_slide_rows, ws.n_contacts)[k]
    if in_space(ws, k):
        memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
        normal = lam[ivec(ws.contact_rows, ws.n_contacts)[k]]
        across = lam[row + 1] if memory[SLIDE] == STICKS else memory[RATIO] * normal
        part = vec(ws.monitor, 3 * ws.n_contacts)[2 * ws.n_contacts + k]
        drills = part * vec(ws.contact_sticking, ws.n_contacts)[k] * normal
        return math.sqrt(lam[row] * lam[row] + across * across + drills * drills)
    return abs(lam[row])


@internal
def _held_by_three(ws: Any, k: int, lam: Any) -> float:
    """The same of contact k and the next one, which have three tangents together."""
    slides, memory = ivec(ws.contact_slide_rows, ws.n_contacts), mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    normal, third = lam[ivec(ws.contact_rows, ws.n_contacts)[k]], lam[slides[k + 1]]
    second = lam[slides[k] + 1] if memory[SLIDE] == STICKS else memory[RATIO] * normal
    return math.sqrt(lam[slides[k]] * lam[slides[k]] + second * second + third * third)


@internal
def torque_of_three(ws: Any, k: int) -> Any:
    """Friction of contact k and the next one, which have three tangents together, along the axes of space, N, as their
    residuals have been evaluated last (`contacts/spherical_friction3d.py`)."""
    n, monitor = ws.n_contacts, vec(ws.monitor, 3 * ws.n_contacts)
    memory = mat(ws.memory, n, MEMORY_SIZE)[k]
    if memory[MODE] != CLOSED:
        return 0.0, 0.0, 0.0
    c, s, level, up = math.cos(memory[WAY]), math.sin(memory[WAY]), math.cos(memory[LEAN]), math.sin(memory[LEAN])
    one, two, three = monitor[n + k], monitor[2 * n + k], monitor[n + k + 1]
    across, third = level * two - up * three, up * two + level * three
    return c * one - s * across, s * one + c * across, third
