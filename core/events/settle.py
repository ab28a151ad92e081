"""An instant with events: impacts, then which of the touching constraint contacts stay, and which stick or slide.

`settle` decides from the state alone. Where it needs a structure or a partition that has not been built yet, or fails,
it puts everything back and says so; once Python has built what it needs, it decides again in the same way.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..cones.complementarity import MANY
from ..location.asleep import look_at_all
from ..location.watch import remember
from ..methods.history import history_time, recall, restart
from ..rounding import DIRECTION_RANK, GAP_ROUNDING, UNSOLVED
from ..state.modes import (
    AXIS,
    CLOSED,
    GAP_START,
    IMPULSE_JUMP,
    LOSS_JUMP,
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
from ..state.run_records import (
    CLOCK_SIZE,
    CLOSE,
    COUNTS_SIZE,
    CROWDED,
    EVENTS,
    GOALS_SIZE,
    GRAZE,
    HANDLED,
    HANDLED_AT,
    HERE,
    OPENS,
    REST,
    SLIP,
    STEP_SIZE,
    STICK,
    call_accelerations,
    call_sample,
)
from ..state.workspace_records import COUNTERS_SIZE, FACTOR_AGE, OK, RATE_SIZE
from ..tables.evaluate import evaluate_power, evaluate_residuals
from ..tables.levels import position_level, rate_size
from ..tables.switch import take_structure
from .blow import impact
from .breakpoint import pass_breakpoint
from .crowding import count_instant
from .in_space import BEGINS
from .laws import FORCE, MASSLESS
from .left_over import take_away_left
from .massless import settle_massless
from .meeting import meet_constraints
from .progress import AT_ONCE, GUARD_SIZE, IN_A_ROW, SINCE, STANDSTILL, START
from .progress import COUNT as GUARDED
from .reading import largest_acceleration, read_before, slow_sliding
from .records import (
    ACCELERATIONS,
    AXIS_NOW,
    COS_WAY,
    COUNT,
    DECLINED,
    DIRECTION,
    FIRST,
    FLAG,
    GAP,
    KINETIC,
    LEFT,
    NEW_RATIO,
    NEW_SLIDE,
    NO_ACCELERATIONS,
    NO_FORCES,
    NOT_MET,
    RANK,
    RATE,
    REPEATED_ROWS,
    RESTITUTION,
    RESTS,
    ROUNDING,
    SETTLED,
    SIN_WAY,
    SINGULAR_MATRIX,
    SLID,
    SLIDE_RATE,
    SLIDE_VALUE,
    SLOW,
    STATIC,
    STOP_IMPULSE,
    STOP_LOSS,
    STRUCK,
    WANT_ROOM,
    WAS,
    WHO,
    call_part,
    col,
    copy,
    real,
    whole,
)
from .report import MOST_EVENTS, report, room_for
from .resting import LOOSEST_RANK, RANK_OF_MANY, choose, keep_others, pulls
from .touching import find_touching, looks_again, read_rates, read_values
from .unsettled import find_pending, find_unsettled
from .wedging import MOST_WEDGES, wedge


@internal
def begin_anew(ws: Any, ms: Any, lc: Any) -> None:
    """A history that begins at the current point, whose accelerations are known."""
    a, aux = vec(ws.a, ws.n_ext), vec(ws.aux, ws.n_ext)
    evaluate_power(ws)
    for i in range(ws.n_ext):
        aux[i] = a[i]
    vec(ws.rate, RATE_SIZE)[FACTOR_AGE] = -1.0
    restart(ws, ms)
    remember(ws, lc)


@internal
def settle(dr: Any, ev: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Let the pending events happen at the newest row: a status of `records`."""
    t, counts, goals = history_time(ms, 0), ivec(dr.counts, COUNTS_SIZE), vec(dr.goals, GOALS_SIZE)
    room = lc.capacity == 0 or ivec(lc.cursor, 1)[0] < lc.capacity
    if not room or not room_for(dr, MOST_EVENTS * ws.n_contacts) or not _gets_on(dr, t):
        return DECLINED
    _keep(ev, ws, False)
    step = vec(lc.clock, CLOCK_SIZE)[STEP_SIZE]
    # samples may have been asked for since the step that ended here
    recall(ws, ms, 0)
    evaluate_residuals(ws)
    modes = vec(ev.modes, ws.n_contacts)
    for k in range(ws.n_contacts):
        modes[k] = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, MODE]
    # structures are not given up as long as this may be the one to come back to
    structure = ws.structure
    ws.kept = structure
    handled_at, here, events = goals[HANDLED_AT], counts[HERE], counts[EVENTS]
    counts[HERE] = here + 1 if t == handled_at else 1
    goals[HANDLED_AT] = t
    status = call_part(ev.settle_forces, ev, dr, ws, ms) if _any_force(dr, ws) else SETTLED
    if status == SETTLED:
        status = settle_massless(ev, dr, ws, ms)
    if status == SETTLED and _any_constraint(dr, ws):
        status = _decide(ev, dr, ws, ms, lc)
    if status == SETTLED:
        status = find_pending(ev, dr, ws, ms, lc)
    ws.kept = 0
    if status != SETTLED:
        goals[HANDLED_AT], counts[HERE], counts[EVENTS] = handled_at, here, events
        _put_back(ev, ws, ms, structure)
        vec(lc.clock, CLOCK_SIZE)[STEP_SIZE] = step
        return status
    begin_anew(ws, ms, lc)
    _count(dr, t)
    count_instant(ws, lc, t)
    copy(ivec(dr.pending, ws.n_contacts), ivec(ev.unsettled, ws.n_contacts), ws.n_contacts)
    _sample(dr, ws, lc)
    return SETTLED


@internal
def begin_pending_forces(dr: Any, ev: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Let the force laws of pending contacts act from the current point on, at the start; where something is wanted,
    nothing has happened."""
    _keep(ev, ws, False)
    events, step = ivec(dr.counts, COUNTS_SIZE)[EVENTS], vec(lc.clock, CLOCK_SIZE)[STEP_SIZE]
    structure = ws.structure
    ws.kept = structure
    status = int(call_part(ev.settle_forces, ev, dr, ws, ms))
    ws.kept = 0
    if status == SETTLED:
        begin_anew(ws, ms, lc)
        return status
    _put_back(ev, ws, ms, structure)
    ivec(dr.counts, COUNTS_SIZE)[EVENTS], vec(lc.clock, CLOCK_SIZE)[STEP_SIZE] = events, step
    return status


@internal
def go_on_behind(dr: Any, ev: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Go on behind the breakpoint that is due; closed contacts that do not fit the new forces are pending."""
    status = pass_breakpoint(ev, dr, ws, ms)
    if status != SETTLED:
        return status
    begin_anew(ws, ms, lc)
    if not find_unsettled(ev, ws, ivec(dr.pending, ws.n_contacts)):
        _sample(dr, ws, lc)
    return SETTLED


@internal
def _put_back(ev: Any, ws: Any, ms: Any, structure: int) -> None:
    """As it was before the instant."""
    if ws.structure != structure:
        take_structure(ws, structure)
    recall(ws, ms, 0)
    evaluate_residuals(ws)
    _keep(ev, ws, True)


@internal
def _keep(ev: Any, ws: Any, back: bool) -> None:
    """What an instant changes of the state, besides what the newest row holds: kept, or put `back`."""
    size = ws.n_contacts * MEMORY_SIZE
    memory, kept = vec(ws.memory, size), vec(ev.kept_memory, size)
    rate, kept_rate = vec(ws.rate, RATE_SIZE), vec(ev.kept_rate, RATE_SIZE)
    counters, kept_counters = ivec(ws.counters, COUNTERS_SIZE), ivec(ev.kept_counters, COUNTERS_SIZE)
    if back:
        copy(memory, kept, size)
        copy(rate, kept_rate, RATE_SIZE)
        copy(counters, kept_counters, COUNTERS_SIZE)
        rate[FACTOR_AGE] = -1.0
    else:
        copy(kept, memory, size)
        copy(kept_rate, rate, RATE_SIZE)
        copy(kept_counters, counters, COUNTERS_SIZE)


@internal
def _any_force(dr: Any, ws: Any) -> bool:
    """True if a contact with a force law is pending."""
    law, pending = ivec(dr.law, ws.n_contacts), ivec(dr.pending, ws.n_contacts)
    for k in range(ws.n_contacts):
        if law[k] == FORCE and pending[k] != 0:
            return True
    return False


@internal
def _any_constraint(dr: Any, ws: Any) -> bool:
    """True if a contact constraint with mass on both sides is pending."""
    law, pending = ivec(dr.law, ws.n_contacts), ivec(dr.pending, ws.n_contacts)
    for k in range(ws.n_contacts):
        if pending[k] != 0 and law[k] != MASSLESS and law[k] != FORCE:
            return True
    return False


@internal
def _gets_on(dr: Any, t: float) -> bool:
    """False if the guard against runs that events keep from going on would speak (`events/progress.py`)."""
    goals, counts, guard = vec(dr.goals, GOALS_SIZE), ivec(dr.counts, COUNTS_SIZE), vec(dr.guard, GUARD_SIZE)
    if t == goals[HANDLED_AT] and counts[HERE] >= AT_ONCE:
        return False
    if guard[GUARDED] < IN_A_ROW:
        return True
    return abs(t - guard[SINCE]) > STANDSTILL * abs(t - guard[START])


@internal
def _count(dr: Any, t: float) -> None:
    """One more instant."""
    counts, guard = ivec(dr.counts, COUNTS_SIZE), vec(dr.guard, GUARD_SIZE)
    counts[HANDLED] += 1
    guard[GUARDED] += 1.0
    if guard[GUARDED] > IN_A_ROW:
        guard[SINCE], guard[GUARDED] = t, 0.0


@internal
def _sample(dr: Any, ws: Any, lc: Any) -> None:
    if lc.capacity > 0:
        cursor = ivec(lc.cursor, 1)
        look_at_all(ws, lc)
        call_sample(dr.write_sample, ws, mat(lc.samples, lc.capacity, lc.sample_length)[cursor[0]])
        cursor[0] += 1


@internal
def _decide(ev: Any, dr: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Impacts, forces, and what they mean."""
    if not find_touching(ev, dr, ws):
        return WANT_ROOM
    read_before(ev, dr, ws)
    read_values(ev, ws)
    count, contacts, accelerations = whole(ev)[COUNT], ivec(ev.contacts, ev.most), largest_acceleration(ws)
    crowded = vec(lc.clock, CLOCK_SIZE)[CROWDED] != 0.0
    friction, static = vec(dr.friction, ws.n_contacts), vec(ws.contact_sticking, ws.n_contacts)
    for i in range(count):
        k = contacts[i]
        col(ev, KINETIC)[i], col(ev, STATIC)[i] = friction[k], static[k]
        col(ev, RESTITUTION)[i] = vec(dr.restitution, ws.n_contacts)[k]
        col(ev, RESTS)[i] = col(ev, FIRST)[i] = col(ev, STOP_IMPULSE)[i] = col(ev, STOP_LOSS)[i] = 0.0
        col(ev, SLOW)[i] = vec(dr.rest_ratio, ws.n_contacts)[k] * rate_size(ws, k) if crowded else 0.0
    status = call_part(ev.open_touching, ev, dr, ws, ms)
    if status != SETTLED:
        return status
    read_rates(ev, ws)
    if _approach(ev, ws, ms):
        status = impact(ev, dr, ws, ms)
        if status != SETTLED:
            return status
        for i in range(count):
            col(ev, ROUNDING)[i] *= max(1.0, 2.0 * real(ev)[LEFT])
        accelerations = 0.0
    real(ev)[ACCELERATIONS] = accelerations
    for _ in range(MOST_WEDGES):
        status = call_part(ev.begin_rest, ev, dr, ws, ms)
        if status == SETTLED:
            status = choose(ev, dr, ws, ms)
        # one contact alone that jams is for the user to hear of
        given_up = whole(ev)[WHO] >= 0 or ms.exact == 0 or ws.tangents == 2
        if status != NO_FORCES or given_up or not wedge(ev, dr, ws, ms):
            break
    if status != SETTLED:
        return status
    _account_stops(ev, ws)
    rank = DIRECTION_RANK if count <= MANY else RANK_OF_MANY
    real(ev)[RANK] = min(rank * 100.0 ** max(looks_again(dr) - 2, 0), LOOSEST_RANK)
    call_part(ev.keep, ev, dr, ws, ms)
    while True:
        status = _take(ev, dr, ws, ms)
        repeats = status == REPEATED_ROWS or status == SINGULAR_MATRIX or status == NO_ACCELERATIONS
        others = ws.tangents == 1 and (repeats or (status == SETTLED and pulls(ev, ws)))
        if others and keep_others(ev, ws):
            call_part(ev.keep, ev, dr, ws, ms)
            continue
        # contacts that each can be told from any other repeat each other together
        if not repeats or real(ev)[RANK] >= LOOSEST_RANK or not _any(ev, FLAG):
            break
        real(ev)[RANK] = min(100.0 * real(ev)[RANK], LOOSEST_RANK)
        call_part(ev.keep, ev, dr, ws, ms)
    if status == SETTLED:
        _report(ev, dr, ws, ms)
    return status


@internal
def _account_stops(ev: Any, ws: Any) -> None:
    """What stopped without a collision, to the contacts' memories."""
    memory, contacts = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(ev.contacts, ev.most)
    for i in range(whole(ev)[COUNT]):
        memory[contacts[i], IMPULSE_JUMP] += col(ev, STOP_IMPULSE)[i]
        memory[contacts[i], LOSS_JUMP] += col(ev, STOP_LOSS)[i]


@internal
def _any(ev: Any, k: int) -> bool:
    for i in range(whole(ev)[COUNT]):
        if col(ev, k)[i] != 0.0:
            return True
    return False


@internal
def _approach(ev: Any, ws: Any, ms: Any) -> bool:
    """True if a touching contact approaches by more than what rounding leaves."""
    count, rate, rounding, largest = whole(ev)[COUNT], col(ev, RATE), col(ev, ROUNDING), 0.0
    for i in range(count):
        largest = max(largest, abs(rate[i]), abs(col(ev, SLIDE_RATE)[i]))
    found, left = False, False
    for i in range(count):
        # what an impact of many leaves is no reason for another
        if count > MANY and -UNSOLVED * largest <= rate[i] < -rounding[i]:
            rounding[i], left = 2.0 * abs(rate[i]), True
        found = found or (rate[i] < -rounding[i] and (col(ev, WAS)[i] == OPEN or ms.exact != 0))
    if left and not found and ms.exact != 0:
        take_away_left(ev, ws)
    return found


@internal
def _take(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Set the modes, bring gaps that are more than rounding and all rates of new constraints to zero, and solve for the
    accelerations."""
    contacts, slides = ivec(ev.contacts, ev.most), ivec(ws.contact_slide_rows, ws.n_contacts)
    scale, rows = vec(ws.row_scale, ws.m_ext), ivec(ws.contact_rows, ws.n_contacts)
    level, changed, some = GAP_ROUNDING * position_level(ws), False, False
    for i in range(whole(ev)[COUNT]):
        k, was, taken = contacts[i], col(ev, WAS)[i], col(ev, FLAG)[i] != 0.0
        memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
        some = some or taken or was == CLOSED
        memory[MODE] = CLOSED if taken else OPEN
        memory[SLIDE] = col(ev, NEW_SLIDE)[i] if taken else STUCK
        memory[RATIO] = col(ev, NEW_RATIO)[i] if taken else 0.0
        if not taken:
            memory[GAP_START] = 0.0
            continue
        gap = col(ev, GAP)[i]
        if was != CLOSED:
            memory[GAP_START] = gap if abs(gap) <= level * scale[rows[k]] else 0.0
        kept = was == CLOSED and col(ev, SLID)[i] == memory[SLIDE]
        changed = changed or not kept
        if ws.tangents == 2:
            memory[WAY], memory[AXIS] = np.arctan2(col(ev, SIN_WAY)[i], col(ev, COS_WAY)[i]), col(ev, AXIS_NOW)[i]
            memory[SLOW_SLIDING] = slow_sliding(ws, k)
        elif memory[SLIDE] == STUCK and not kept and slides[k] >= 0:
            memory[SLIDE_START] = col(ev, SLIDE_VALUE)[i]
    if some:
        status = call_part(ev.use_modes, ev, dr, ws, ms)
        if status != SETTLED:
            return status
    if changed and ms.exact != 0 and not meet_constraints(ws):
        return NOT_MET
    return SETTLED if call_accelerations(dr.accelerations, ws) == OK else NO_ACCELERATIONS


@internal
def _report(ev: Any, dr: Any, ws: Any, ms: Any) -> None:
    """Events of contacts that have closed, opened, begun to slide or to stick."""
    contacts, pending = ivec(ev.contacts, ev.most), ivec(dr.pending, ws.n_contacts)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    t, phid = history_time(ms, 0), vec(ws.phid, ws.m_ext)
    started = t > vec(dr.guard, GUARD_SIZE)[START]
    for i in range(whole(ev)[COUNT]):
        k, was, slid = contacts[i], col(ev, WAS)[i], col(ev, SLID)[i]
        memory, kind = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k], -1
        closed = memory[MODE] == CLOSED
        if closed and was != CLOSED:
            kind = REST if col(ev, RESTS)[i] != 0.0 else CLOSE
        elif not closed and was == CLOSED:
            kind = OPENS
        elif not closed and whole(ev)[STRUCK] == 0 and pending[k] != 0 and started:
            kind = GRAZE
        elif closed and slides[k] >= 0 and (memory[SLIDE] != slid or col(ev, DIRECTION)[i] == BEGINS):
            kind = SLIP if abs(memory[SLIDE]) == 1.0 else (STICK if abs(slid) == 1.0 else -1)
        if kind >= 0:
            report(dr, t, kind, k, 0.0, 0.0, 0.0, max(phid[rows[k]], 0.0) if kind == OPENS else 0.0, 0.0, 0.0)
