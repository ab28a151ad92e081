"""Contacts whose surfaces have jumped in speed, at a breakpoint or as an input changes: they are settled anew."""

from typing import Any

from ..assembly.levels import rate_level
from ..assembly.sticking_force import in_space, is_held
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..event_detection.crossings import friction_margin, no_sliding
from ..rounding import CONTINUOUS
from ..state.modes import CLOSED, GAP_START, IDLE, IMPLIED, MEMORY_SIZE, MODE, OPEN, RATIO, SLIDE, STICKS


@internal
def find_moved(ws: Any, ms: Any, found: Any) -> bool:
    """Closed contacts that slide although they stick, or the other way, at the current point: 1 in `found`
    (n_contacts,), where others stay as they are. (Of a method that does not meet constraints of velocities nobody can
    tell.)"""
    memory, slides = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(ws.contact_slide_rows, ws.n_contacts)
    rates, scale, any_found = vec(ws.phid, ws.m_ext), vec(ws.row_scale, ws.m_ext), False
    for k in range(ws.n_contacts):
        rubs = slides[k] >= 0 and vec(ws.contact_sticking, ws.n_contacts)[k] > 0.0
        if ms.exact == 0 or not rubs or memory[k, MODE] != CLOSED or memory[k, SLIDE] == IDLE:
            continue
        if is_held(ws, k):
            most = CONTINUOUS * rate_level(ws) * scale[slides[k]]
            across = in_space(ws, k) and memory[k, SLIDE] == STICKS and abs(rates[slides[k] + 1]) > most
            moved = abs(rates[slides[k]]) > most or across
        else:
            moved = friction_margin(ws, k) < -no_sliding(ws, k)
        if moved:
            found[k], any_found = 1, True
    return any_found


@internal
def is_moved_row(ws: Any, found: Any, row: int) -> bool:
    """True if this is a row of a tangent of one of these contacts."""
    slides = ivec(ws.contact_slide_rows, ws.n_contacts)
    for k in range(ws.n_contacts):
        if found[k] != 0 and (row == slides[k] or (in_space(ws, k) and row == slides[k] + 1)):
            return True
    return False


@internal
def release_sticking(ws: Any, found: Any) -> None:
    """Open those among them that stick: what strikes at the same instant must not pull them along."""
    for k in range(ws.n_contacts):
        if found[k] != 0 and is_held(ws, k):
            memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
            memory[MODE], memory[SLIDE] = OPEN, STICKS
            memory[RATIO] = memory[IMPLIED] = memory[GAP_START] = 0.0
