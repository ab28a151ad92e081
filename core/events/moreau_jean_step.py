"""A step of velocities and impulses, without events (Moreau 1988; Jean and Moreau 1992; Jean 1999).

All contacts are open in a step; those that overlap at its end are pushed apart there. The impulses are those with
which none approaches, each within its friction cone: of what a step takes, weight as well as impacts. What they do to
the velocities they do to the positions with half the step, as if they had acted in its middle, so what rests or sticks
stays where it is. Gaps that are negative all the same are closed by the least motion along the normals that does so.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_energy
from ..assembly.levels import position_level
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..contact_solvers.contact_blocks import WIDE, block_rates
from ..contact_solvers.row_sweeps import press_apart, sweep_rows
from ..methods.history import history_time
from ..rounding import GAP_ROUNDING
from ..state.modes import CLOSED, memories_at
from ..state.run_records import (
    IMPACT,
    call_accelerations,
    clock_at,
    loop_at,
)
from ..state.workspace_records import (
    OK,
    control_at,
    counters_at,
)
from .constraint_projection import meet_positions, meet_rates
from .impulse_rows import BEFORE, OFF, ROW_ARM, ROW_INVERSE, TAKES, P, open_rows, part, prepare_rows, room, rows_of
from .records import NO_ACCELERATIONS, NOT_MET, SETTLED, WANTS_ROOM, call_part, copy, scalars, touching
from .report import report
from .row_blocks import blocks_of
from .touching import find_touching
from .zeno import end_pushing, only_impulses

TOLERANCE = 1e-7
"""Sweeps end when no rate changes by more than this part of the largest there was, or after `most_sweeps` of DRIVE."""
SHIFTS, SHIFT_TURNS, SHIFT_PART = 2, 30, 1e-3
"""Shifts of what overlaps, each along the normals before it; turns for each, and part of the deepest overlap that it
may leave, since it is known to first order only."""
FEW = 5.0
"""Steps within which what flies off must not be back, or it is no bounce."""
QUIET, QUIET_PART = 6, 0.125
"""Steps in which no contact comes, goes or bounces, after which the crowd is over: so many, and such a part of the row,
so that a crowd that comes back at once is not looked at again and again."""


@internal
def push_apart(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Push apart what overlaps at the end of a step of impulses, which is the newest row."""
    loop = loop_at(drive.loop)
    clock, t, energy = clock_at(loop.clock), history_time(method, 0), vec(workspace.energy, 3)
    h = t - clock.pushed_from
    if not find_touching(instant, drive, workspace):
        return WANTS_ROOM
    held = _look(instant, workspace)
    status = open_rows(instant, drive, workspace, method)
    if status != SETTLED:
        return status
    prepare_rows(instant, workspace, h)
    _bounce(instant, drive, workspace, h)
    evaluate_energy(workspace)
    before, kinetic = energy[0] + energy[1] + energy[2], energy[0]
    _push(instant, drive, workspace, h)
    changed, lost = _record(instant, drive, workspace, h, t)
    if drive.input_account >= 0:
        evaluate_energy(workspace)
        driven = energy[0] - kinetic + lost
        vec(workspace.v, workspace.n_ext)[drive.input_account] += driven
        before += driven
    if held:
        status = call_part(instant.use_modes, instant, drive, workspace, method)
        if status != SETTLED:
            return int(status)
    if not _close_overlaps(instant, workspace):
        return NOT_MET
    evaluate_energy(workspace)
    _account(instant, workspace, before - energy[0] - energy[1] - energy[2] - lost)
    if call_accelerations(drive.accelerations, workspace) != OK:
        return NO_ACCELERATIONS
    copy(vec(workspace.aux, workspace.n), vec(workspace.a, workspace.n), workspace.n)
    scalars(instant).touched = scalars(instant).count
    clock.pushed_from, clock.calm = t, 0.0 if changed else clock.calm + 1.0
    if clock.pushes_left <= 0.0 or clock.calm >= max(QUIET, QUIET_PART * clock.pushes):
        end_pushing(workspace, loop, t)
        _leave_unsettled(instant, workspace)
    elif h > 0.0:
        _carry(instant, workspace, h)
    return SETTLED


@internal
def _leave_unsettled(instant: Any, workspace: Any) -> None:
    """What touches at the end of a row is for an instant of its own to settle."""
    contacts, rows, level = (
        ivec(instant.contacts, instant.most),
        ivec(workspace.contact_rows, workspace.n_contacts),
        GAP_ROUNDING,
    )
    for i in range(scalars(instant).count):
        row = rows[contacts[i]]
        touches = (
            vec(workspace.phi, workspace.m_ext)[row]
            <= level * position_level(workspace) * vec(workspace.row_scale, workspace.m_ext)[row]
        )
        ivec(instant.unsettled, workspace.n_contacts)[contacts[i]] = 1 if touches else 0


@internal
def _carry(instant: Any, workspace: Any, h: float) -> None:
    """Accelerations as the contacts' mean forces of the last step (s) make them: what is seen of the motion until the
    next one, which does not begin with them."""
    a, changes = vec(workspace.a, workspace.n_ext), vec(instant.velocities, workspace.n)
    for j in range(workspace.n):
        a[j] += changes[j] / h


@internal
def _look(instant: Any, workspace: Any) -> bool:
    """Gaps of the touching contacts, and with which accelerations they close, before any impulse; True if one was
    closed: at the first of a row of steps."""
    contacts, rows, held = (
        ivec(instant.contacts, instant.most),
        ivec(workspace.contact_rows, workspace.n_contacts),
        False,
    )
    for i in range(scalars(instant).count):
        k = contacts[i]
        touching(instant)[i].gap, touching(instant)[i].closing_acceleration = (
            vec(workspace.phi, workspace.m_ext)[rows[k]],
            -vec(workspace.phidd, workspace.m_ext)[rows[k]],
        )
        held = held or memories_at(workspace.memory, workspace.n_contacts)[k].mode == CLOSED
    return held


@internal
def _bounce(instant: Any, drive: Any, workspace: Any, h: float) -> None:
    """Newton's law for contacts that have just met, by 1 in `comes_to_rest`: those that pressed in the last
    step already are parts of one blow, and what the accelerations here stop within a few steps is no bounce."""
    contact = touching(instant)
    rows, contacts, memory = (
        rows_of(instant, workspace),
        ivec(instant.contacts, instant.most),
        memories_at(workspace.memory, workspace.n_contacts),
    )
    off, rate, takes = part(instant, rows, OFF), part(instant, rows, BEFORE), part(instant, rows, TAKES)
    contact_rows, alone = ivec(workspace.contact_rows, workspace.n_contacts), only_impulses(loop_at(drive.loop))
    # of a crowd, whose steps are a part of the model's own time; those of a whole run may be any
    falls_of_model = 0.0 if alone else control_at(workspace.control).rate_scale ** 2
    for i in range(scalars(instant).count):
        k, approach, falls = contacts[i], -rate[i], max(contact[i].closing_acceleration, 0.0)
        e = vec(drive.restitution, workspace.n_contacts)[k]
        slow = FEW * h * max(falls, falls_of_model * vec(workspace.row_scale, workspace.m_ext)[contact_rows[k]])
        least = max(vec(drive.rest_ratio, workspace.n_contacts)[k] * memory[k].largest_approach, slow)
        new = takes[i] > 0.0 and memory[k].step_force[0] == 0.0
        contact[i].approach_speed = max(approach, 0.0)
        contact[i].comes_to_rest = 1.0 if new and e * approach > least else 0.0
        if contact[i].comes_to_rest != 0.0:
            off[i] += e * rate[i]
        elif alone and h > 0.0:
            # a gap that is there may close in the next step
            off[i] += max(contact[i].gap, 0.0) / h


@internal
def _push(instant: Any, drive: Any, workspace: Any, h: float) -> None:
    """Impulses of all rows; the velocities change by them, and the positions by half of h (s) of that."""
    count, rows, n, x = (
        scalars(instant).count,
        rows_of(instant, workspace),
        workspace.n,
        vec(instant.bounced, workspace.n),
    )
    v, q, changes = vec(workspace.v, workspace.n_ext), vec(workspace.q, workspace.n_ext), vec(instant.velocities, n)
    wholes, reals = blocks_of(instant)
    tolerance = TOLERANCE * scalars(instant).largest_rate
    scalars(instant).sweeps, left = sweep_rows(
        count, 2, rows > 3 * count, rows, n, wholes, reals,
        part(instant, rows, TAKES), part(instant, rows, OFF), part(instant, rows, ROW_ARM), part(instant, rows, P), x,
        room(instant, rows, n),
        tolerance, drive.most_sweeps,
    )  # fmt: skip
    if left > tolerance:
        counters_at(workspace.counters).unfinished_sweeps += 1
    for j in range(n):
        v[j] += x[j]
        q[j] += 0.5 * h * x[j]
        changes[j] = x[j]


@internal
def _record(instant: Any, drive: Any, workspace: Any, h: float, t: float) -> Any:
    """Impulses to the contacts' memories, bounces to the events. (True if a contact has come, gone or bounced; what all
    impulses have taken of the energy, J: half of each times the sum of its rates before and after.)"""
    contact = touching(instant)
    count, rows, x = scalars(instant).count, rows_of(instant, workspace), vec(instant.bounced, workspace.n)
    contacts, rate, p = ivec(instant.contacts, instant.most), part(instant, rows, BEFORE), part(instant, rows, P)
    wholes, reals = blocks_of(instant)
    changed, total, moved = False, 0.0, np.zeros(WIDE)
    for i in range(count):
        k, lost, after = contacts[i], 0.0, rate[i]
        memory = memories_at(workspace.memory, workspace.n_contacts)[k]
        changed = changed or (p[i] > 0.0) != (memory.step_force[0] > 0.0) or contact[i].comes_to_rest != 0.0
        block_rates(i, count, wholes, reals, x, moved)
        for block in range(rows // count):
            r = block * count + i
            after = rate[i] + moved[block] if block == 0 else after
            lost -= p[r] * (rate[r] + 0.5 * moved[block])
            memory.step_force[block] = p[r] / h if h > 0.0 else 0.0
        memory.impulse_jump += p[i]
        contact[i].impact_loss = lost
        total += lost
        if contact[i].comes_to_rest != 0.0:
            approach = contact[i].approach_speed
            memory.largest_approach = max(memory.largest_approach, approach)
            report(drive, t, IMPACT, k, p[i], lost, approach, max(after, 0.0), 0.0, 0.0)
    return changed, total


@internal
def _account(instant: Any, workspace: Any, more: float) -> None:
    """The losses go to the contacts' memories, with `more` (J) that motions along the constraints have taken, as their
    impulses share it."""
    count, contacts, total = scalars(instant).count, ivec(instant.contacts, instant.most), 0.0
    p, memory = part(instant, rows_of(instant, workspace), P), memories_at(workspace.memory, workspace.n_contacts)
    for i in range(count):
        total += p[i]
    for i in range(count):
        share = p[i] / total if total > 0.0 else 1.0 / count
        memory[contacts[i]].loss_jump += touching(instant)[i].impact_loss + share * more


@internal
def _close_overlaps(instant: Any, workspace: Any) -> bool:
    """Meet the joints, and shift what overlaps along the normals; False where joints cannot be met."""
    count, rows, n, x = (
        scalars(instant).count,
        rows_of(instant, workspace),
        workspace.n,
        vec(instant.bounced, workspace.n),
    )
    off, scale, contacts = (
        part(instant, rows, OFF),
        vec(workspace.row_scale, workspace.m_ext),
        ivec(instant.contacts, instant.most),
    )
    contact_rows, level = ivec(workspace.contact_rows, workspace.n_contacts), GAP_ROUNDING * position_level(workspace)
    wholes, reals = blocks_of(instant)
    for turn in range(SHIFTS + 1):
        if not meet_positions(workspace):
            return False
        worst, least = 0.0, np.inf
        for i in range(count):
            row = contact_rows[contacts[i]]
            off[i], least = vec(workspace.phi, workspace.m_ext)[row], min(least, scale[row])
            worst = max(worst, -off[i] - level * scale[row])
        if worst <= 0.0 or turn == SHIFTS:
            break
        press_apart(
            count, rows, n, wholes, reals, part(instant, rows, ROW_INVERSE), off, part(instant, rows, BEFORE), x,
            room(instant, rows, n), max(0.1 * level * least, SHIFT_PART * worst), SHIFT_TURNS,
        )  # fmt: skip
        for j in range(n):
            vec(workspace.q, workspace.n_ext)[j] += x[j]
    return bool(meet_rates(workspace))
