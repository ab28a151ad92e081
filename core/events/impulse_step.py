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
from ..compiled.views import ivec, mat, vec
from ..contact_solvers.contact_blocks import blocks_at
from ..contact_solvers.row_sweeps import along, press_apart, sweep_rows
from ..methods.history import history_time
from ..rounding import GAP_ROUNDING
from ..state.modes import CLOSED, IMPULSE_JUMP, LARGEST_APPROACH, LOSS_JUMP, MEMORY_SIZE, MODE, PUSHED
from ..state.run_records import (
    CALM,
    CLOCK_SIZE,
    IMPACT,
    PUSHED_FROM,
    PUSHES,
    PUSHES_LEFT,
    call_accelerations,
    loop_at,
)
from ..state.workspace_records import CONTROL_SIZE, OK, RATE_SCALE
from .constraint_projection import meet_constraints
from .impulse_rows import ARM, BEFORE, INVERSE, OFF, TAKES, P, open_rows, part, prepare_rows, room, rows_of
from .records import (
    APPROACH,
    COUNT,
    FALLS,
    GAP,
    LARGEST,
    LOSS,
    NO_ACCELERATIONS,
    NOT_MET,
    RESTS,
    SETTLED,
    SWEPT,
    TOUCHED,
    WANT_ROOM,
    call_part,
    col,
    real,
    whole,
)
from .report import report
from .touching import find_touching
from .zeno import end_pushing

TOLERANCE, SWEEPS = 1e-7, 1000
"""Sweeps end when no rate changes by more than this part of the largest there was, or after so many."""
SHIFTS, SHIFT_TURNS = 3, 30
"""Looks at gaps that are still negative, and turns for each."""
FEW = 5.0
"""Steps within which what flies off must not be back, or it is no bounce."""
QUIET, QUIET_PART = 6, 0.125
"""Steps in which no contact comes, goes or bounces, after which the crowd is over: so many, and such a part of the row,
so that a crowd that comes back at once is not looked at again and again."""


@internal
def push_apart(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Push apart what overlaps at the end of a step of impulses, which is the newest row."""
    lc = loop_at(dr.loop)
    clock, t, energy = vec(lc.clock, CLOCK_SIZE), history_time(ms, 0), vec(ws.energy, 3)
    h = t - clock[PUSHED_FROM]
    if not find_touching(ev, dr, ws):
        return WANT_ROOM
    held = _look(ev, ws)
    status = open_rows(ev, dr, ws, ms)
    if status != SETTLED:
        return status
    prepare_rows(ev, ws, h)
    _bounce(ev, dr, ws, h)
    evaluate_energy(ws)
    before, kinetic = energy[0] + energy[1] + energy[2], energy[0]
    _push(ev, ws, h)
    changed, lost = _record(ev, dr, ws, h, t)
    if dr.input_account >= 0:
        evaluate_energy(ws)
        driven = energy[0] - kinetic + lost
        vec(ws.v, ws.n_ext)[dr.input_account] += driven
        before += driven
    if held:
        status = call_part(ev.use_modes, ev, dr, ws, ms)
        if status != SETTLED:
            return int(status)
    if not _close_overlaps(ev, ws):
        return NOT_MET
    evaluate_energy(ws)
    _account(ev, ws, before - energy[0] - energy[1] - energy[2] - lost)
    if call_accelerations(dr.accelerations, ws) != OK:
        return NO_ACCELERATIONS
    whole(ev)[TOUCHED] = whole(ev)[COUNT]
    clock[PUSHED_FROM], clock[CALM] = t, 0.0 if changed else clock[CALM] + 1.0
    if clock[PUSHES_LEFT] <= 0.0 or clock[CALM] >= max(QUIET, QUIET_PART * clock[PUSHES]):
        end_pushing(ws, lc, t)
        _leave_unsettled(ev, ws)
    elif h > 0.0:
        _carry(ev, ws, h)
    return SETTLED


@internal
def _leave_unsettled(ev: Any, ws: Any) -> None:
    """What touches at the end of a row is for an instant of its own to settle."""
    contacts, rows, level = ivec(ev.contacts, ev.most), ivec(ws.contact_rows, ws.n_contacts), GAP_ROUNDING
    for i in range(whole(ev)[COUNT]):
        row = rows[contacts[i]]
        touches = vec(ws.phi, ws.m_ext)[row] <= level * position_level(ws) * vec(ws.row_scale, ws.m_ext)[row]
        ivec(ev.unsettled, ws.n_contacts)[contacts[i]] = 1 if touches else 0


@internal
def _carry(ev: Any, ws: Any, h: float) -> None:
    """Accelerations as the contacts' mean forces of the last step (s) make them: what is seen of the motion until the
    next one, which does not begin with them."""
    a, changes = vec(ws.a, ws.n_ext), vec(ev.velocities, ws.n)
    for j in range(ws.n):
        a[j] += changes[j] / h


@internal
def _look(ev: Any, ws: Any) -> bool:
    """Gaps of the touching contacts, and with which accelerations they close, before any impulse; True if one was
    closed: at the first of a row of steps."""
    contacts, rows, held = ivec(ev.contacts, ev.most), ivec(ws.contact_rows, ws.n_contacts), False
    for i in range(whole(ev)[COUNT]):
        k = contacts[i]
        col(ev, GAP)[i], col(ev, FALLS)[i] = vec(ws.phi, ws.m_ext)[rows[k]], -vec(ws.phidd, ws.m_ext)[rows[k]]
        held = held or mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, MODE] == CLOSED
    return held


@internal
def _bounce(ev: Any, dr: Any, ws: Any, h: float) -> None:
    """Newton's law for contacts that have just met, by 1 in `RESTS`: those that pressed in the last step already are
    parts of one blow, and what the accelerations here stop within a few steps is no bounce."""
    rows, contacts, memory = rows_of(ev, ws), ivec(ev.contacts, ev.most), mat(ws.memory, ws.n_contacts, MEMORY_SIZE)
    off, rate, takes = part(ev, rows, OFF), part(ev, rows, BEFORE), part(ev, rows, TAKES)
    falls_of_model, contact_rows = vec(ws.control, CONTROL_SIZE)[RATE_SCALE] ** 2, ivec(ws.contact_rows, ws.n_contacts)
    for i in range(whole(ev)[COUNT]):
        k, approach, falls = contacts[i], -rate[i], max(col(ev, FALLS)[i], 0.0)
        e = vec(dr.restitution, ws.n_contacts)[k]
        slow = FEW * h * max(falls, falls_of_model * vec(ws.row_scale, ws.m_ext)[contact_rows[k]])
        least = max(vec(dr.rest_ratio, ws.n_contacts)[k] * memory[k, LARGEST_APPROACH], slow)
        new = takes[i] > 0.0 and memory[k, PUSHED] == 0.0
        col(ev, APPROACH)[i] = max(approach, 0.0)
        col(ev, RESTS)[i] = 1.0 if new and e * approach > least else 0.0
        if col(ev, RESTS)[i] != 0.0:
            off[i] += e * rate[i]


@internal
def _push(ev: Any, ws: Any, h: float) -> None:
    """Impulses of all rows; the velocities change by them, and the positions by half of h (s) of that."""
    count, rows, n, x = whole(ev)[COUNT], rows_of(ev, ws), ws.n, vec(ev.bounced, ws.n)
    v, q, changes = vec(ws.v, ws.n_ext), vec(ws.q, ws.n_ext), vec(ev.velocities, n)
    wholes, reals = blocks_at(ev.block_wholes, ev.block_reals, ev.most, n)
    real(ev)[SWEPT] = sweep_rows(
        count, 2, rows > 3 * count, rows, n, wholes, reals,
        part(ev, rows, TAKES), part(ev, rows, OFF), part(ev, rows, ARM), part(ev, rows, P), x, room(ev, rows, n),
        TOLERANCE * real(ev)[LARGEST], SWEEPS,
    )  # fmt: skip
    for j in range(n):
        v[j] += x[j]
        q[j] += 0.5 * h * x[j]
        changes[j] = x[j]


@internal
def _record(ev: Any, dr: Any, ws: Any, h: float, t: float) -> Any:
    """Impulses to the contacts' memories, bounces to the events. (True if a contact has come, gone or bounced; what all
    impulses have taken of the energy, J: half of each times the sum of its rates before and after.)"""
    count, rows, n, x = whole(ev)[COUNT], rows_of(ev, ws), ws.n, vec(ev.bounced, ws.n)
    directions, contacts, rate, p = (
        mat(ev.directions, rows, n), ivec(ev.contacts, ev.most), part(ev, rows, BEFORE), part(ev, rows, P)
    )  # fmt: skip
    changed, total = False, 0.0
    for i in range(count):
        k, lost, after = contacts[i], 0.0, rate[i]
        memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
        changed = changed or (p[i] > 0.0) != (memory[PUSHED] > 0.0) or col(ev, RESTS)[i] != 0.0
        for block in range(rows // count):
            r = block * count + i
            moved = along(r, n, rows, ev.columns, directions, x)
            after = rate[i] + moved if block == 0 else after
            lost -= p[r] * (rate[r] + 0.5 * moved)
            memory[PUSHED + block] = p[r] / h if h > 0.0 else 0.0
        memory[IMPULSE_JUMP] += p[i]
        col(ev, LOSS)[i] = lost
        total += lost
        if col(ev, RESTS)[i] != 0.0:
            approach = col(ev, APPROACH)[i]
            memory[LARGEST_APPROACH] = max(memory[LARGEST_APPROACH], approach)
            report(dr, t, IMPACT, k, p[i], lost, approach, max(after, 0.0), 0.0, 0.0)
    return changed, total


@internal
def _account(ev: Any, ws: Any, more: float) -> None:
    """The losses go to the contacts' memories, with `more` (J) that motions along the constraints have taken, as their
    impulses share it."""
    count, contacts, total = whole(ev)[COUNT], ivec(ev.contacts, ev.most), 0.0
    p, memory = part(ev, rows_of(ev, ws), P), mat(ws.memory, ws.n_contacts, MEMORY_SIZE)
    for i in range(count):
        total += p[i]
    for i in range(count):
        share = p[i] / total if total > 0.0 else 1.0 / count
        memory[contacts[i], LOSS_JUMP] += col(ev, LOSS)[i] + share * more


@internal
def _close_overlaps(ev: Any, ws: Any) -> bool:
    """Meet the joints, and shift what overlaps along the normals; False where joints cannot be met."""
    count, rows, n, x = whole(ev)[COUNT], rows_of(ev, ws), ws.n, vec(ev.bounced, ws.n)
    off, scale, contacts = part(ev, rows, OFF), vec(ws.row_scale, ws.m_ext), ivec(ev.contacts, ev.most)
    contact_rows, level = ivec(ws.contact_rows, ws.n_contacts), GAP_ROUNDING * position_level(ws)
    for turn in range(SHIFTS + 1):
        if not meet_constraints(ws):
            return False
        worst, least = 0.0, np.inf
        for i in range(count):
            row = contact_rows[contacts[i]]
            off[i], least = vec(ws.phi, ws.m_ext)[row], min(least, scale[row])
            worst = max(worst, -off[i] - level * scale[row])
        if worst <= 0.0 or turn == SHIFTS:
            break
        press_apart(
            count, rows, n, ev.directions, ev.responses, ev.columns, part(ev, rows, INVERSE), off,
            part(ev, rows, BEFORE), x, room(ev, rows, n), 0.1 * level * least, SHIFT_TURNS,
        )  # fmt: skip
        for j in range(n):
            vec(ws.q, ws.n_ext)[j] += x[j]
    return True
