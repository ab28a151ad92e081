"""The modes that an instant gives its contacts: they are set, the constraints that come with them are met, and what has
changed goes to the events.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_energy
from ..assembly.levels import position_level
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_time
from ..rounding import GAP_ROUNDING
from ..state.modes import (
    AT_LIMIT,
    AXIS,
    CLOSED,
    GAP_START,
    IMPLIED,
    LEAN,
    MEMORY_SIZE,
    MODE,
    OPEN,
    RATIO,
    SLIDE,
    SLIDE_START,
    WAY,
)
from ..state.modes import SLOW as SLOW_SLIDING
from ..state.modes import STICKS as STUCK
from ..state.run_records import CLOSE, GRAZE, OPENS, REST, SLIP, STICK, call_accelerations
from ..state.workspace_records import OK
from .constraint_projection import meet_constraints
from .contact_forces import BEGINS
from .progress import GUARD_SIZE, START
from .reading import slow_sliding
from .records import (
    AXIS_NOW,
    COMPANION,
    COS_WAY,
    COUNT,
    DIRECTION,
    FLAG,
    GAP,
    HELD_SPIN,
    MET_LOSS,
    NEW_IMPLIED,
    NEW_RATIO,
    NEW_SLIDE,
    NO_ACCELERATIONS,
    NOT_MET,
    RATE,
    RESTS,
    ROUNDING,
    SETTLED,
    SIN_WAY,
    SLID,
    SLIDE_RATE,
    SLIDE_VALUE,
    SPIN,
    STRUCK,
    SWAY_RATE,
    WAS,
    call_part,
    col,
    real,
    whole,
)
from .report import report
from .three_tangents import first_of

BEGINS_AT_REST = 0.9
"""Part of the torque against spinning up to which a contact that begins to slide creeps."""


@internal
def take_modes(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Set the modes, bring gaps that are more than rounding and all rates of new constraints to zero, and solve for the
    accelerations."""
    contacts, slides = ivec(ev.contacts, ev.most), ivec(ws.contact_slide_rows, ws.n_contacts)
    scale, rows = vec(ws.row_scale, ws.m_ext), ivec(ws.contact_rows, ws.n_contacts)
    energy = vec(ws.energy, 3)
    level, changed, some = GAP_ROUNDING * position_level(ws), False, False
    for i in range(whole(ev)[COUNT]):
        k, was, taken = contacts[i], col(ev, WAS)[i], col(ev, FLAG)[i] != 0.0
        memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
        some = some or taken or was == CLOSED
        # a gap that others held, and that is now held itself, stays where it is to rounding
        held_now = was == CLOSED and np.int64(memory[IMPLIED]) & ~np.int64(col(ev, NEW_IMPLIED)[i]) != 0
        memory[MODE] = CLOSED if taken else OPEN
        memory[SLIDE] = col(ev, NEW_SLIDE)[i] if taken else STUCK
        memory[RATIO] = col(ev, NEW_RATIO)[i] if taken else 0.0
        memory[IMPLIED] = col(ev, NEW_IMPLIED)[i] if taken else 0.0
        if taken and not in_space(ws, k):
            _take_in_plane(memory, col(ev, COS_WAY)[i])
        if not taken:
            memory[GAP_START] = 0.0
            continue
        gap = col(ev, GAP)[i]
        if was != CLOSED or held_now:
            memory[GAP_START] = gap if abs(gap) <= level * scale[rows[k]] else 0.0
        kept = was == CLOSED and not held_now and col(ev, SLID)[i] == memory[SLIDE]
        # (one that would open by less than can be seen stays, with the rate that an impact has given it)
        changed = changed or not kept or abs(col(ev, RATE)[i]) > col(ev, ROUNDING)[i]
        if in_space(ws, k):
            memory[WAY], memory[AXIS] = np.arctan2(col(ev, SIN_WAY)[i], col(ev, COS_WAY)[i]), col(ev, AXIS_NOW)[i]
            memory[SLOW_SLIDING] = slow_sliding(ws, k)
            memory[LEAN] = _lean(ev, i) if abs(memory[SLIDE]) == 1.0 else 0.0
            if col(ev, COMPANION)[i] != 0.0:
                _take_three_tangents(ev, i, memory)
        elif memory[SLIDE] == STUCK and not kept and slides[k] >= 0:
            memory[SLIDE_START] = col(ev, SLIDE_VALUE)[i]
    if some:
        status = call_part(ev.use_modes, ev, dr, ws, ms)
        if status != SETTLED:
            return status
    if changed and ms.exact != 0:
        evaluate_energy(ws)
        before = energy[0] + energy[1] + energy[2]
        if not meet_constraints(ws):
            return NOT_MET
        evaluate_energy(ws)
        real(ev)[MET_LOSS] += before - energy[0] - energy[1] - energy[2]
    return SETTLED if call_accelerations(dr.accelerations, ws) == OK else NO_ACCELERATIONS


@internal
def _take_in_plane(memory: Any, way: float) -> None:
    """What has been decided with two tangents, for the memory of a contact with one; `way`: cosine of its direction."""
    if memory[SLIDE] == AT_LIMIT:
        memory[SLIDE], memory[RATIO] = STUCK, 0.0
    elif memory[SLIDE] == 1.0:
        memory[SLIDE] = np.sign(way)
    memory[RATIO] *= way


@internal
def _take_three_tangents(ev: Any, i: int, memory: Any) -> None:
    """The direction, or the frame, of contact i and its companion, for the memory of one of them."""
    own = first_of(ev, i)
    c, s, level, lean = (
        col(ev, COS_WAY)[own], col(ev, SIN_WAY)[own], col(ev, COS_WAY)[own + 1], col(ev, SIN_WAY)[own + 1]
    )  # fmt: skip
    if abs(memory[SLIDE]) == 1.0:
        level, lean = np.hypot(c, s), level
    memory[WAY], memory[LEAN] = np.arctan2(s, c), np.arctan2(lean, level)


@internal
def _lean(ev: Any, i: int) -> float:
    """Angle out of the tangent plane at which contact i slides and spins; where it begins to, that of its friction."""
    part = col(ev, HELD_SPIN)[i]
    if col(ev, DIRECTION)[i] == BEGINS and abs(part) < BEGINS_AT_REST:
        return float(np.arctan2(part, np.sqrt((1.0 - part) * (1.0 + part))))
    return float(np.arctan2(col(ev, SPIN)[i], np.hypot(col(ev, SLIDE_RATE)[i], col(ev, SWAY_RATE)[i])))


@internal
def report_modes(ev: Any, dr: Any, ws: Any, ms: Any) -> None:
    """Events of contacts that have closed, opened, begun to slide or to stick."""
    contacts, pending = ivec(ev.contacts, ev.most), ivec(dr.pending, ws.n_contacts)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    t, phid = history_time(ms, 0), vec(ws.phid, ws.m_ext)
    started = t > vec(dr.guard, GUARD_SIZE)[START]
    for i in range(whole(ev)[COUNT]):
        k, was, slid = contacts[i], col(ev, WAS)[i], col(ev, SLID)[i]
        if col(ev, COMPANION)[i] < 0.0:
            continue
        memory, kind = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k], -1
        closed = memory[MODE] == CLOSED
        if closed and was != CLOSED:
            kind = REST if col(ev, RESTS)[i] != 0.0 else CLOSE
        elif not closed and was == CLOSED:
            kind = OPENS
        elif not closed and whole(ev)[STRUCK] == 0 and pending[k] != 0 and started:
            kind = GRAZE
        elif (
            closed
            and slides[k] >= 0
            and (memory[SLIDE] != slid or (col(ev, DIRECTION)[i] == BEGINS and in_space(ws, k)))
        ):
            kind = SLIP if abs(memory[SLIDE]) == 1.0 else (STICK if abs(slid) == 1.0 else -1)
        if kind >= 0:
            report(dr, t, kind, k, 0.0, 0.0, 0.0, max(phid[rows[k]], 0.0) if kind == OPENS else 0.0, 0.0, 0.0)
