"""Contacts whose surfaces have jumped in speed, at a breakpoint or as an input changes: they are settled anew."""

from typing import Any

from ..assembly.levels import rate_level
from ..assembly.sticking_force import in_space, is_held
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..event_detection.crossings import friction_margin, no_sliding
from ..rounding import CONTINUOUS
from ..state.modes import CLOSED, IDLE, OPEN, STICKS, memories_at


@internal
def find_moved(workspace: Any, method: Any, found: Any) -> bool:
    """Closed contacts that slide although they stick, or the other way, at the current point: 1 in `found`
    (n_contacts,), where others stay as they are. (Of a method that does not meet constraints of velocities nobody can
    tell.)"""
    memory, slides = (
        memories_at(workspace.memory, workspace.n_contacts),
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
    )
    rates, scale, any_found = vec(workspace.phid, workspace.m_ext), vec(workspace.row_scale, workspace.m_ext), False
    for k in range(workspace.n_contacts):
        rubs = slides[k] >= 0 and vec(workspace.contact_sticking, workspace.n_contacts)[k] > 0.0
        if method.exact == 0 or not rubs or memory[k].mode != CLOSED or memory[k].slide_mode == IDLE:
            continue
        if is_held(workspace, k):
            most = CONTINUOUS * rate_level(workspace) * scale[slides[k]]
            across = in_space(workspace, k) and memory[k].slide_mode == STICKS and abs(rates[slides[k] + 1]) > most
            moved = abs(rates[slides[k]]) > most or across
        else:
            moved = friction_margin(workspace, k) < -no_sliding(workspace, k)
        if moved:
            found[k], any_found = 1, True
    return any_found


@internal
def is_moved_row(workspace: Any, found: Any, row: int) -> bool:
    """True if this is a row of a tangent of one of these contacts."""
    slides = ivec(workspace.contact_slide_rows, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        if found[k] != 0 and (row == slides[k] or (in_space(workspace, k) and row == slides[k] + 1)):
            return True
    return False


@internal
def release_sticking(workspace: Any, found: Any) -> None:
    """Open those among them that stick: what strikes at the same instant must not pull them along."""
    for k in range(workspace.n_contacts):
        if found[k] != 0 and is_held(workspace, k):
            memory = memories_at(workspace.memory, workspace.n_contacts)[k]
            memory.mode, memory.slide_mode = OPEN, STICKS
            memory.friction_ratio = memory.implied_rows = memory.closed_gap = 0.0
