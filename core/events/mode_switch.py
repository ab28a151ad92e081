"""The modes that an instant gives its contacts: they are set, the constraints that come with them are met, and what has
changed goes to the events.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_energy
from ..assembly.levels import position_level
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..methods.history import history_time
from ..rounding import GAP_ROUNDING
from ..state.modes import AT_LIMIT, CLOSED, OPEN, memories_at
from ..state.modes import STICKS as STUCK
from ..state.run_records import CLOSE, GRAZE, OPENS, REST, SLIP, STICK, call_accelerations
from ..state.workspace_records import OK
from .constraint_projection import meet_constraints
from .contact_forces import BEGINS
from .progress import GUARD_SIZE, RUN_BEGAN
from .reading import slow_sliding
from .records import NO_ACCELERATIONS, NOT_MET, SETTLED, call_part, scalars, touching
from .report import report
from .three_tangents import first_of

BEGINS_AT_REST = 0.9
"""Part of the torque against spinning up to which a contact that begins to slide creeps."""


@internal
def take_modes(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Set the modes, bring gaps that are more than rounding and all rates of new constraints to zero, and solve for the
    accelerations."""
    contact = touching(instant)
    contacts, slides = ivec(instant.contacts, instant.most), ivec(workspace.contact_slide_rows, workspace.n_contacts)
    scale, rows = vec(workspace.row_scale, workspace.m_ext), ivec(workspace.contact_rows, workspace.n_contacts)
    energy = vec(workspace.energy, 3)
    level, changed, some = GAP_ROUNDING * position_level(workspace), False, False
    for i in range(scalars(instant).count):
        k, was, taken = contacts[i], contact[i].mode_before, vec(instant.included, instant.most)[i] != 0.0
        memory = memories_at(workspace.memory, workspace.n_contacts)[k]
        some = some or taken or was == CLOSED
        # a gap that others held, and that is now held itself, stays where it is to rounding
        held_now = was == CLOSED and np.int64(memory.implied_rows) & ~np.int64(contact[i].new_implied) != 0
        memory.mode = CLOSED if taken else OPEN
        memory.slide_mode = contact[i].new_slide_mode if taken else STUCK
        memory.friction_ratio = contact[i].new_ratio if taken else 0.0
        memory.implied_rows = contact[i].new_implied if taken else 0.0
        if taken and not in_space(workspace, k):
            _take_in_plane(memory, contact[i].direction_cos)
        if not taken:
            memory.closed_gap = 0.0
            continue
        gap = contact[i].gap
        if was != CLOSED or held_now:
            memory.closed_gap = gap if abs(gap) <= level * scale[rows[k]] else 0.0
        kept = was == CLOSED and not held_now and contact[i].slide_mode_before == memory.slide_mode
        # (one that would open by less than can be seen stays, with the rate that an impact has given it)
        changed = changed or not kept or abs(contact[i].gap_rate) > contact[i].rate_rounding
        if in_space(workspace, k):
            memory.tangent_angle, memory.tangent_axis = (
                np.arctan2(contact[i].direction_sin, contact[i].direction_cos),
                contact[i].tangent_axis,
            )
            memory.slow_sliding = slow_sliding(workspace, k)
            memory.sliding_lean = _lean(instant, i) if abs(memory.slide_mode) == 1.0 else 0.0
            if contact[i].companion != 0.0:
                _take_three_tangents(instant, i, memory)
        elif memory.slide_mode == STUCK and not kept and slides[k] >= 0:
            memory.slide_start = contact[i].sliding_distance
    if some:
        status = call_part(instant.use_modes, instant, drive, workspace, method)
        if status != SETTLED:
            return status
    if changed and method.exact != 0:
        evaluate_energy(workspace)
        before = energy[0] + energy[1] + energy[2]
        if not meet_constraints(workspace):
            return NOT_MET
        evaluate_energy(workspace)
        scalars(instant).projection_loss += before - energy[0] - energy[1] - energy[2]
    return SETTLED if call_accelerations(drive.accelerations, workspace) == OK else NO_ACCELERATIONS


@internal
def _take_in_plane(memory: Any, way: float) -> None:
    """What has been decided with two tangents, for the memory of a contact with one; `way`: cosine of its direction."""
    if memory.slide_mode == AT_LIMIT:
        memory.slide_mode, memory.friction_ratio = STUCK, 0.0
    elif memory.slide_mode == 1.0:
        memory.slide_mode = np.sign(way)
    memory.friction_ratio *= way


@internal
def _take_three_tangents(instant: Any, i: int, memory: Any) -> None:
    """The direction, or the frame, of contact i and its companion, for the memory of one of them."""
    contact = touching(instant)
    own = first_of(instant, i)
    c, s, level, lean = (
        contact[own].direction_cos,
        contact[own].direction_sin,
        contact[own + 1].direction_cos,
        contact[own + 1].direction_sin,
    )
    if abs(memory.slide_mode) == 1.0:
        level, lean = np.hypot(c, s), level
    memory.tangent_angle, memory.sliding_lean = np.arctan2(s, c), np.arctan2(lean, level)


@internal
def _lean(instant: Any, i: int) -> float:
    """Angle out of the tangent plane at which contact i slides and spins; where it begins to, that of its friction."""
    contact = touching(instant)
    part = contact[i].spin_share
    if vec(instant.slides, instant.most)[i] == BEGINS and abs(part) < BEGINS_AT_REST:
        return float(np.arctan2(part, np.sqrt((1.0 - part) * (1.0 + part))))
    return float(np.arctan2(contact[i].spin_rate, np.hypot(contact[i].sliding_rate, contact[i].sliding_rate2)))


@internal
def report_modes(instant: Any, drive: Any, workspace: Any, method: Any) -> None:
    """Events of contacts that have closed, opened, begun to slide or to stick."""
    contact = touching(instant)
    contacts, pending = ivec(instant.contacts, instant.most), ivec(drive.pending, workspace.n_contacts)
    rows, slides = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
    )
    t, phid = history_time(method, 0), vec(workspace.phid, workspace.m_ext)
    started = t > vec(drive.guard, GUARD_SIZE)[RUN_BEGAN]
    for i in range(scalars(instant).count):
        k, was, slid = contacts[i], contact[i].mode_before, contact[i].slide_mode_before
        if contact[i].companion < 0.0:
            continue
        memory, kind = memories_at(workspace.memory, workspace.n_contacts)[k], -1
        closed = memory.mode == CLOSED
        if closed and was != CLOSED:
            kind = REST if contact[i].comes_to_rest != 0.0 else CLOSE
        elif not closed and was == CLOSED:
            kind = OPENS
        elif not closed and scalars(instant).struck == 0 and pending[k] != 0 and started:
            kind = GRAZE
        elif (
            closed
            and slides[k] >= 0
            and (
                memory.slide_mode != slid or (vec(instant.slides, instant.most)[i] == BEGINS and in_space(workspace, k))
            )
        ):
            kind = SLIP if abs(memory.slide_mode) == 1.0 else (STICK if abs(slid) == 1.0 else -1)
        if kind >= 0:
            report(drive, t, kind, k, 0.0, 0.0, 0.0, max(phid[rows[k]], 0.0) if kind == OPENS else 0.0, 0.0, 0.0)
