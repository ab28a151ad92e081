"""Friction of contacts that stick, from the multipliers of their tangents, and on a patch from their torque too."""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import IMPLIED_MOVES, IMPLIED_SLIDES, IMPLIED_TURNS, TURNS
from ..state.modes import AT_LIMIT, CLOSED, OF_NORMAL, STICKS, memories_at
from .levels import acceleration_level, position_level, rate_size


@internal
def in_space(workspace: Any, k: int) -> bool:
    """True if contact k has two tangents."""
    return bool(ivec(workspace.contact_second_rows, workspace.n_contacts)[k] >= 0)


@internal
def is_held(workspace: Any, k: int) -> bool:
    """True if closed contact k sticks along a tangent at least."""
    slide = memories_at(workspace.memory, workspace.n_contacts)[k].slide_mode
    return slide == STICKS or slide == AT_LIMIT


@internal
def implied_margin(workspace: Any, k: int, before: float) -> float:
    """How far closed contact k is from what says that others do not imply its constraints: 1 where they do, 0 where its
    gap has moved by IMPLIED_MOVES, one that sticks slides by IMPLIED_SLIDES, or the gap's acceleration, which was
    `before` at the newest row, has jumped by IMPLIED_TURNS: a corner has come to the end of a face, and the rows that
    are solved for follow its round edge. 1 for a contact that is solved for; -1 at least, since an edge much rounder
    than what turns would make all other margins small beside it."""
    memory, row = (
        memories_at(workspace.memory, workspace.n_contacts)[k],
        ivec(workspace.contact_rows, workspace.n_contacts)[k],
    )
    bits, moved = np.int64(memory.implied_rows), 0.0
    if memory.mode != CLOSED or bits == 0:
        return 1.0
    if bits & OF_NORMAL != 0:
        moved = abs(vec(workspace.phi, workspace.m_ext)[row]) / (
            IMPLIED_MOVES * position_level(workspace) * vec(workspace.row_scale, workspace.m_ext)[row]
        )
        turns = IMPLIED_TURNS * acceleration_level(workspace) * vec(workspace.row_scale, workspace.m_ext)[row]
        if abs(before) <= 0.5 * turns:
            moved = max(moved, abs(vec(workspace.phidd, workspace.m_ext)[row]) / turns)
    if bits != OF_NORMAL and memory.slide_mode == STICKS:
        phid, slide = vec(workspace.phid, workspace.m_ext), ivec(workspace.contact_slide_rows, workspace.n_contacts)[k]
        speed = math.hypot(phid[slide], phid[slide + 1] if in_space(workspace, k) else 0.0)
        moved = max(moved, speed / (IMPLIED_SLIDES * rate_size(workspace, k)))
    return float(max(1.0 - moved, -1.0))


@internal
def friction_limit(workspace: Any, k: int, force: float) -> float:
    """Largest friction of contact k, which sticks with this normal force, N. That of one at its limit turns along the
    tangent of its circle (`state/modes.py`), and may leave it by a little."""
    most = vec(workspace.contact_sticking, workspace.n_contacts)[k] * force
    at_limit = memories_at(workspace.memory, workspace.n_contacts)[k].slide_mode == AT_LIMIT
    return float((1.0 + TURNS) * most if at_limit else most)


@internal
def held_friction(workspace: Any, k: int, lam: Any) -> float:
    """Size of the friction of contact k, which sticks, N, from multipliers `lam` (m_ext,); on a patch that of forces
    and torque on the ellipsoid, the torque at its present part of the full one (`contacts/patch3d.py`)."""
    companion = ivec(workspace.contact_companion, workspace.n_contacts)[k]
    if companion != 0:
        return _held_by_three(workspace, k if companion > 0 else k - 1, lam)
    row = ivec(workspace.contact_slide_rows, workspace.n_contacts)[k]
    if in_space(workspace, k):
        memory = memories_at(workspace.memory, workspace.n_contacts)[k]
        normal = lam[ivec(workspace.contact_rows, workspace.n_contacts)[k]]
        across = lam[row + 1] if memory.slide_mode == STICKS else memory.friction_ratio * normal
        part = vec(workspace.monitor, 3 * workspace.n_contacts)[2 * workspace.n_contacts + k]
        drills = part * vec(workspace.contact_sticking, workspace.n_contacts)[k] * normal
        return math.sqrt(lam[row] * lam[row] + across * across + drills * drills)
    return abs(lam[row])


@internal
def _held_by_three(workspace: Any, k: int, lam: Any) -> float:
    """The same of contact k and the next one, which have three tangents together."""
    slides, memory = (
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
        memories_at(workspace.memory, workspace.n_contacts)[k],
    )
    normal, third = lam[ivec(workspace.contact_rows, workspace.n_contacts)[k]], lam[slides[k + 1]]
    second = lam[slides[k] + 1] if memory.slide_mode == STICKS else memory.friction_ratio * normal
    return math.sqrt(lam[slides[k]] * lam[slides[k]] + second * second + third * third)


@internal
def torque_of_three(workspace: Any, k: int) -> Any:
    """Friction of contact k and the next one, which have three tangents together, along the axes of space, N, as their
    residuals have been evaluated last (`contacts/spherical_friction3d.py`)."""
    n, monitor = workspace.n_contacts, vec(workspace.monitor, 3 * workspace.n_contacts)
    memory = memories_at(workspace.memory, n)[k]
    if memory.mode != CLOSED:
        return 0.0, 0.0, 0.0
    c, s, level, up = (
        math.cos(memory.tangent_angle),
        math.sin(memory.tangent_angle),
        math.cos(memory.sliding_lean),
        math.sin(memory.sliding_lean),
    )
    one, two, three = monitor[n + k], monitor[2 * n + k], monitor[n + k + 1]
    across, third = level * two - up * three, up * two + level * three
    return c * one - s * across, s * one + c * across, third
