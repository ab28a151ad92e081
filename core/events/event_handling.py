"""An instant with events, as a whole: what happens is decided, taken, and a new history begins.

`settle` decides from the state alone. Where it needs a structure or a partition that has not been built yet, or fails,
it puts everything back and says so; once Python has built what it needs, it decides again in the same way.
"""

from typing import Any

from ..assembly.evaluate import evaluate_energy, evaluate_power, evaluate_residuals
from ..assembly.structure_switch import take_structure
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..event_detection.contact_sleeping import look_at_all
from ..event_detection.crossings import remember
from ..methods.history import history_time, recall, replace, restart
from ..state.modes import LOSS_JUMP, MEMORY_SIZE, MODE
from ..state.run_records import (
    CLOCK_SIZE,
    COUNTS_SIZE,
    EVENTS,
    GOALS_SIZE,
    HANDLED,
    HANDLED_AT,
    HERE,
    PUSH_STEP,
    PUSHED_FROM,
    STEP_SIZE,
    call_sample,
)
from ..state.workspace_records import CONTROL_SIZE, COUNTERS_SIZE, ENERGY_SCALE, FACTOR_AGE, RATE_SIZE
from .breakpoint import pass_breakpoint
from .decide import decide
from .inconsistent_modes import find_pending, find_unsettled
from .laws import FORCE, MASSLESS
from .massless import settle_massless
from .progress import AT_ONCE, GUARD_SIZE, IN_A_ROW, SINCE, STANDSTILL, START
from .progress import COUNT as GUARDED
from .records import (
    DECLINED,
    MET_LOSS,
    NO_IMPACT,
    NOT_MET,
    SETTLED,
    STILL_APPROACHES,
    TOUCHED,
    TOUCHED_IN_SPACE,
    UNSHARED,
    call_part,
    clear,
    copy,
    real,
    whole,
)
from .report import MOST_EVENTS, report_not_found, room_for
from .zeno import MANY_TOUCH, count_instant, may_push

UNSEEN = 1e-8
"""Of the model's energy: what an instant of many contacts may take of it without an account."""


@internal
def begin_anew(ws: Any, ms: Any, lc: Any) -> None:
    """A history that begins at the current point, whose accelerations are known."""
    _know_rates(ws)
    restart(ws, ms)
    remember(ws, lc)


@internal
def _go_on(ws: Any, ms: Any, lc: Any) -> None:
    """The current point, whose accelerations are known, in place of the newest row."""
    _know_rates(ws)
    replace(ws, ms)
    remember(ws, lc)


@internal
def _know_rates(ws: Any) -> None:
    a, aux = vec(ws.a, ws.n_ext), vec(ws.aux, ws.n_ext)
    evaluate_power(ws)
    for i in range(ws.n_ext):
        aux[i] = a[i]
    vec(ws.rate, RATE_SIZE)[FACTOR_AGE] = -1.0


@internal
def settle(dr: Any, ev: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Let the pending events happen at the newest row: a status of `records`."""
    t, counts, goals = history_time(ms, 0), ivec(dr.counts, COUNTS_SIZE), vec(dr.goals, GOALS_SIZE)
    room = lc.capacity == 0 or ivec(lc.cursor, 1)[0] < lc.capacity
    if not room or not room_for(dr, MOST_EVENTS * ws.n_contacts):
        return DECLINED
    if not _gets_on(dr, t):
        return int(call_part(ev.step_through, ev, dr, ws, ms))
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
    whole(ev)[TOUCHED], pushing = 0, vec(lc.clock, CLOCK_SIZE)[PUSH_STEP] != 0.0
    whole(ev)[TOUCHED_IN_SPACE] = whole(ev)[UNSHARED] = whole(ev)[STILL_APPROACHES] = 0
    begun, status = vec(lc.clock, CLOCK_SIZE)[PUSHED_FROM] == t, SETTLED
    if _any_force(dr, ws):
        status = (
            _settle_forces_where_they_are(ev, dr, ws, ms) if pushing else call_part(ev.settle_forces, ev, dr, ws, ms)
        )
    if status == SETTLED:
        status = settle_massless(ev, dr, ws, ms)
    if status == SETTLED and pushing:
        clear(ivec(ev.unsettled, ws.n_contacts), ws.n_contacts)
        if _any_constraint(dr, ws):
            status = call_part(ev.push_apart, ev, dr, ws, ms)
    elif status == SETTLED and _any_constraint(dr, ws):
        status = decide(ev, dr, ws, ms, lc)
    if status == SETTLED and not pushing and _loses_unseen(ev, ws) and may_push(dr, ws, ms):
        status = NOT_MET
    if status == SETTLED and not pushing:
        status = find_pending(ev, dr, ws, ms, lc)
    ws.kept, touched = 0, whole(ev)[TOUCHED]
    if status != SETTLED:
        goals[HANDLED_AT], counts[HERE], counts[EVENTS] = handled_at, here, events
        _put_back(ev, ws, ms, structure)
        vec(lc.clock, CLOCK_SIZE)[STEP_SIZE] = step
        many = status >= NO_IMPACT and not pushing and touched >= MANY_TOUCH
        if many and call_part(ev.step_through, ev, dr, ws, ms) == SETTLED:
            return SETTLED
        return status
    if pushing and not begun:
        # what lies between two steps of impulses is between what they have left
        _go_on(ws, ms, lc)
    else:
        begin_anew(ws, ms, lc)
    _count(dr, t)
    report_not_found(ev, dr, ws, t)
    crowds = False
    if not pushing:
        crowds = count_instant(ws, lc, t, touched, whole(ev)[TOUCHED_IN_SPACE] >= MANY_TOUCH)
    copy(ivec(dr.pending, ws.n_contacts), ivec(ev.unsettled, ws.n_contacts), ws.n_contacts)
    if crowds:
        call_part(ev.step_through, ev, dr, ws, ms)
    _sample(dr, ws, lc)
    return SETTLED


@internal
def _settle_forces_where_they_are(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Forces that begin and end among steps of impulses, which may have moved their gaps beyond zero: what springs hold
    there all at once is in the contacts' accounts."""
    law, pending = ivec(dr.law, ws.n_contacts), ivec(dr.pending, ws.n_contacts)
    memory, energy, count = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), vec(ws.energy, 3), 0
    evaluate_energy(ws)
    more = energy[0] + energy[1] + energy[2]
    for k in range(ws.n_contacts):
        if law[k] == FORCE and pending[k] != 0:
            count += 1
            more += memory[k, LOSS_JUMP]
    status = int(call_part(ev.settle_forces, ev, dr, ws, ms))
    if status != SETTLED:
        return status
    evaluate_energy(ws)
    more -= energy[0] + energy[1] + energy[2]
    for k in range(ws.n_contacts):
        if law[k] == FORCE and pending[k] != 0:
            more -= memory[k, LOSS_JUMP]
    for k in range(ws.n_contacts):
        if law[k] == FORCE and pending[k] != 0:
            memory[k, LOSS_JUMP] += more / count
    return status


@internal
def _loses_unseen(ev: Any, ws: Any) -> bool:
    """True if many touch in space, and bringing them onto their new constraints has changed the energy by more than
    rounding. (In the plane what is lost so is next to nothing, and events get on.)"""
    most = UNSEEN * vec(ws.control, CONTROL_SIZE)[ENERGY_SCALE]
    return bool(whole(ev)[TOUCHED_IN_SPACE] >= MANY_TOUCH and abs(real(ev)[MET_LOSS]) > most)


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
    """Go on behind the breakpoint that is due; closed contacts that do not fit the new forces, or surfaces that have
    jumped in speed, are pending."""
    _keep(ev, ws, False)
    structure = ws.structure
    ws.kept = structure
    status = pass_breakpoint(ev, dr, ws, ms)
    ws.kept = 0
    if status != SETTLED:
        _put_back(ev, ws, ms, structure)
        return status
    begin_anew(ws, ms, lc)
    pending, moved = ivec(dr.pending, ws.n_contacts), ivec(ev.unsettled, ws.n_contacts)
    unsettled = find_unsettled(ev, ws, pending)
    for k in range(ws.n_contacts):
        if moved[k] != 0:
            pending[k], unsettled = 1, True
    if not unsettled:
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
