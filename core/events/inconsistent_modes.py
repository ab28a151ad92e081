"""Closed contacts whose mode does not fit the forces that have been found."""

from typing import Any

from ..assembly.levels import force_level
from ..assembly.sticking_force import friction_limit, held_friction, is_held
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..rounding import FORCE_ROUNDING, SLIP_EXCESS
from ..state.modes import AXIS, CLOSED, MEMORY_SIZE, MODE, RATIO, SLIDE
from ..state.run_records import CLOCK_SIZE, MAX_STEP, STEP_SIZE, call_accelerations
from ..state.workspace_records import OK, structure_at
from .laws import MASSLESS
from .rates import read_level
from .reading import comes_back
from .records import (
    ALONE,
    B_N,
    B_S,
    B_T,
    COUNT,
    NO_ACCELERATIONS,
    SETTLED,
    SPARE,
    WANT_MEMORY,
    call_part,
    col,
    whole,
)
from .touching import force_noise, free_jerks

NO, YES = -1, -2


@internal
def find_unsettled(ev: Any, ws: Any, found: Any) -> bool:
    """Contacts that pull, or are held beyond their friction, at the current point: 1 in `found` (n_contacts,)."""
    memory, lam = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), vec(ws.lam, ws.m_ext)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    work = FORCE_ROUNDING * force_level(ws)
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
        if slides[k] >= 0 and is_held(ws, k):
            if held_friction(ws, k, lam) > friction_limit(ws, k, force) * (1.0 + SLIP_EXCESS) + none:
                found[k], any_found = 1, True
    return any_found


@internal
def find_pending(ev: Any, dr: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Contacts to settle next at this instant, to `unsettled`.

    Left out are those that have just closed because they would open by less than can be told from zero: they pull by
    what the errors of the steps have left in the waves of an elastic body, and would open and close for ever.
    """
    found, modes, law = ivec(ev.unsettled, ws.n_contacts), vec(ev.modes, ws.n_contacts), ivec(dr.law, ws.n_contacts)
    if not find_unsettled(ev, ws, found):
        return SETTLED
    for k in range(ws.n_contacts):
        if found[k] != 0 and modes[k] != CLOSED and law[k] != MASSLESS:
            status = _returns_at_once(ev, dr, ws, ms, lc, k)
            if status == YES:
                found[k] = 0
            elif status != NO:
                return status
    return SETTLED


@internal
def _returns_at_once(ev: Any, dr: Any, ws: Any, ms: Any, lc: Any, k: int) -> int:
    """YES if contact k, closed, pulls by no more than lets its gap open by what could not be told from zero before it
    closes again. The next step then goes beyond that. NO, or what is wanted to know it."""
    memory, clock = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k], vec(lc.clock, CLOCK_SIZE)
    mode, slide, ratio, axis = memory[MODE], memory[SLIDE], memory[RATIO], memory[AXIS]
    ivec(ev.contacts, ev.most)[0], whole(ev)[COUNT] = k, 1
    motion, jerks = col(ev, B_N), col(ev, SPARE)
    whole(ev)[ALONE] = 0
    status = call_part(ev.open_touching, ev, dr, ws, ms)
    if status == SETTLED:
        status = SETTLED if call_accelerations(dr.accelerations, ws) == OK else NO_ACCELERATIONS
        read_level(ev, ws, vec(ws.phidd, ws.m_ext), motion, col(ev, B_T), col(ev, B_S))
        free_jerks(ev, ws, jerks)
    memory[MODE], memory[SLIDE], memory[RATIO], memory[AXIS] = mode, slide, ratio, axis
    if status == WANT_MEMORY:
        return status
    back = call_part(ev.use_modes, ev, dr, ws, ms)
    if back == SETTLED and call_accelerations(dr.accelerations, ws) != OK:
        back = NO_ACCELERATIONS
    if back != SETTLED:
        return back
    # the others may hold it, with the friction of those that slide: which of them stay is for all to settle;
    # one that presses is unsettled by its friction, which is for the stick and slip to settle
    if status != SETTLED or not motion[0] > 0.0 or not comes_back(ws, k, jerks[0], motion[0]):
        return NO
    # b + j t, the acceleration of the open gap, has turned well before this
    clock[STEP_SIZE] = max(clock[STEP_SIZE], min(4.0 * motion[0] / -jerks[0], clock[MAX_STEP]))
    return YES


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
