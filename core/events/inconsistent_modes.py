"""Closed contacts whose mode does not fit the forces that have been found."""

from typing import Any

from ..assembly.levels import force_level
from ..assembly.sticking_force import friction_limit, held_friction, is_held
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import FORCE_ROUNDING, SLIP_EXCESS
from ..state.impact_law_codes import AT_MASSLESS
from ..state.modes import CLOSED, memories_at
from ..state.run_records import call_accelerations, clock_at
from ..state.workspace_records import OK, structure_at
from .rates import read_level
from .reading import comes_back
from .records import NO_ACCELERATIONS, SETTLED, WANT_MEMORY, call_part, scalars, touching
from .touching import force_noise, free_jerks

NO, YES = -1, -2


@internal
def find_unsettled(instant: Any, workspace: Any, found: Any) -> bool:
    """Contacts that pull, or are held beyond their friction, at the current point: 1 in `found` (n_contacts,)."""
    memory, lam = memories_at(workspace.memory, workspace.n_contacts), vec(workspace.lam, workspace.m_ext)
    rows, slides = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
    )
    work = FORCE_ROUNDING * force_level(workspace)
    scale, any_found, noisy = vec(workspace.row_scale, workspace.m_ext), False, False
    for k in range(workspace.n_contacts):
        found[k] = 0
        if memory[k].mode != CLOSED:
            continue
        force, none = -lam[rows[k]], work / scale[rows[k]]
        if force < -none:
            if not noisy:
                force_noise(instant, workspace)
                noisy = True
            if force < -_contact_noise(instant, workspace, rows[k]):
                found[k], any_found = 1, True
                continue
        if slides[k] >= 0 and is_held(workspace, k):
            if held_friction(workspace, k, lam) > friction_limit(workspace, k, force) * (1.0 + SLIP_EXCESS) + none:
                found[k], any_found = 1, True
    return any_found


@internal
def find_pending(instant: Any, drive: Any, workspace: Any, method: Any, loop: Any) -> int:
    """Contacts to settle next at this instant, to `unsettled`.

    Left out are those that have just closed because they would open by less than can be told from zero: they pull by
    what the errors of the steps have left in the waves of an elastic body, and would open and close for ever.
    """
    found, modes, law = (
        ivec(instant.unsettled, workspace.n_contacts),
        vec(instant.modes, workspace.n_contacts),
        ivec(drive.law, workspace.n_contacts),
    )
    if not find_unsettled(instant, workspace, found):
        return SETTLED
    for k in range(workspace.n_contacts):
        if found[k] != 0 and modes[k] != CLOSED and law[k] != AT_MASSLESS:
            status = _returns_at_once(instant, drive, workspace, method, loop, k)
            if status == YES:
                found[k] = 0
            elif status != NO:
                return status
    return SETTLED


@internal
def _returns_at_once(instant: Any, drive: Any, workspace: Any, method: Any, loop: Any, k: int) -> int:
    """YES if contact k, closed, pulls by no more than lets its gap open by what could not be told from zero before it
    closes again. The next step then goes beyond that. NO, or what is wanted to know it."""
    contact = touching(instant)
    memory, clock = memories_at(workspace.memory, workspace.n_contacts)[k], clock_at(loop.clock)
    mode, slide, ratio, axis = memory.mode, memory.slide_mode, memory.friction_ratio, memory.tangent_axis
    ivec(instant.contacts, instant.most)[0], scalars(instant).count = k, 1
    motion, jerks = contact.free_gap_acceleration, vec(instant.jerks, instant.most)
    status = call_part(instant.open_touching, instant, drive, workspace, method)
    if status == SETTLED:
        status = SETTLED if call_accelerations(drive.accelerations, workspace) == OK else NO_ACCELERATIONS
        read_level(
            instant,
            workspace,
            vec(workspace.phidd, workspace.m_ext),
            motion,
            contact.free_sliding_acceleration,
            contact.free_sliding_acceleration2,
        )
        free_jerks(instant, workspace, jerks)
    memory.mode, memory.slide_mode, memory.friction_ratio, memory.tangent_axis = mode, slide, ratio, axis
    if status == WANT_MEMORY:
        return status
    back = call_part(instant.use_modes, instant, drive, workspace, method)
    if back == SETTLED and call_accelerations(drive.accelerations, workspace) != OK:
        back = NO_ACCELERATIONS
    if back != SETTLED:
        return back
    # the others may hold it, with the friction of those that slide: which of them stay is for all to settle;
    # one that presses is unsettled by its friction, which is for the stick and slip to settle
    if status != SETTLED or not motion[0] > 0.0 or not comes_back(workspace, k, jerks[0], motion[0]):
        return NO
    # b + j t, the acceleration of the open gap, has turned well before this
    clock.step_size = max(clock.step_size, min(4.0 * motion[0] / -jerks[0], clock.max_step))
    return YES


@internal
def _contact_noise(instant: Any, workspace: Any, row: int) -> float:
    """What rounding of the coordinates leaves in the force of the closed contact with this row, N."""
    noise, values, scale = (
        vec(instant.terms, workspace.n),
        vec(workspace.values, workspace.n_values),
        vec(workspace.scale, workspace.n),
    )
    active, largest, through, structure = (
        ivec(workspace.active, workspace.m_act),
        0.0,
        False,
        structure_at(workspace.structure),
    )
    starts, columns = (
        ivec(structure.jacobian_start, workspace.m_act + 1),
        ivec(structure.jacobian_col, structure.n_jacobian),
    )
    slots = ivec(structure.jacobian_slot, structure.n_jacobian)
    for i in range(workspace.m_act):
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
    for i in range(workspace.n):
        work = max(work, noise[i] * scale[i])
    return work / vec(workspace.row_scale, workspace.m_ext)[row]
