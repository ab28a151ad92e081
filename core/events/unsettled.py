"""Closed contacts whose mode does not fit the forces that have been found."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contact.modes import CLOSED, MEMORY_SIZE, MODE, SLIDE, STICKS
from ..rounding import FORCE_ROUNDING, SLIP_EXCESS
from ..system.levels import force_level
from ..system.records import structure_at
from .touching import force_noise


@internal
def find_unsettled(ev: Any, ws: Any, found: Any) -> bool:
    """Contacts that pull, or are held beyond their friction, at the current point: 1 in `found` (n_contacts,)."""
    memory, lam = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), vec(ws.lam, ws.m_ext)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    work, static = FORCE_ROUNDING * force_level(ws), vec(ws.contact_sticking, ws.n_contacts)
    scale, any_found, noisy = vec(ws.row_scale, ws.m_ext), False, False
    for k in range(ws.n_contacts):
        found[k] = 0
        if memory[k, MODE] != CLOSED:
            continue
        force, none = -lam[rows[k]], work / scale[rows[k]]
        if force < -none:
            if not noisy:
                force_noise(ev, ws)
                noisy = True
            if force < -_contact_noise(ev, ws, rows[k]):
                found[k], any_found = 1, True
                continue
        if slides[k] >= 0 and memory[k, SLIDE] == STICKS:
            if abs(lam[slides[k]]) > static[k] * force * (1.0 + SLIP_EXCESS) + none:
                found[k], any_found = 1, True
    return any_found


@internal
def _contact_noise(ev: Any, ws: Any, row: int) -> float:
    """What rounding of the coordinates leaves in the force of the closed contact with this row, N."""
    noise, values, scale = vec(ev.terms, ws.n), vec(ws.values, ws.n_values), vec(ws.scale, ws.n)
    active, largest, through, st = ivec(ws.active, ws.m_act), 0.0, False, structure_at(ws.structure)
    starts, columns = ivec(st.jacobian_start, ws.m_act + 1), ivec(st.jacobian_col, st.n_jacobian)
    slots = ivec(st.jacobian_slot, st.n_jacobian)
    for i in range(ws.m_act):
        if active[i] != row:
            continue
        for e in range(starts[i], starts[i + 1]):
            value = values[slots[e]]
            if value != 0.0:
                through = through or noise[columns[e]] != 0.0
                largest = max(largest, noise[columns[e]] / abs(value))
    if through:
        return largest
    # on frames without stiffness of their own, which hand on the forces of others
    work = 0.0
    for i in range(ws.n):
        work = max(work, noise[i] * scale[i])
    return work / vec(ws.row_scale, ws.m_ext)[row]
