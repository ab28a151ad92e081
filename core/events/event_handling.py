"""An instant with events, as a whole: what happens is decided, taken, and a new history begins.

`settle` decides from the state alone. Where it needs a structure or a partition that has not been built yet, or fails,
it puts everything back and says so; once Python has built what it needs, it decides again in the same way.
"""

from typing import Any

from ..assembly.evaluate import evaluate_energy, evaluate_power, evaluate_residuals
from ..assembly.structure_switch import take_structure
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..event_detection.contact_sleeping import look_at_all, show_elements, show_pending
from ..event_detection.crossings import remember
from ..methods.history import history_time, recall, replace, restart
from ..state.impact_law_codes import AT_MASSLESS, BY_FORCE
from ..state.modes import MEMORY_SIZE, memories_at
from ..state.run_records import (
    call_sample,
    clock_at,
    counts_at,
    goals_at,
)
from ..state.workspace_records import COUNTERS_SIZE, RATE_SIZE, control_at, convergence_at
from .breakpoint import pass_breakpoint
from .inconsistent_modes import find_pending, find_unsettled
from .massless import settle_massless
from .mode_selection import decide
from .progress import COUNTED_SINCE, GUARD_SIZE, IN_A_ROW, MOST_AT_ONCE, RUN_BEGAN, STANDSTILL
from .progress import EVENTS_COUNTED as GUARDED
from .records import DECLINED, NO_IMPACT, NOT_MET, SETTLED, call_part, clear, copy, scalars
from .report import MOST_EVENTS, report_not_found, room_for
from .zeno import MANY_TOUCH, begin_impulses, count_instant, may_push, only_impulses

UNSEEN = 1e-8
"""Of the model's energy: what an instant of many contacts may take of it without an account."""


@internal
def begin_anew(workspace: Any, method: Any, loop: Any) -> None:
    """A history that begins at the current point, whose accelerations are known."""
    _know_rates(workspace, 0)
    restart(workspace, method)
    remember(workspace, loop)


@internal
def _go_on(workspace: Any, method: Any, loop: Any) -> None:
    """The current point behind a step of impulses in place of the newest row; `aux` has the accelerations of the smooth
    motion already (`moreau_jean_step.py`)."""
    _know_rates(workspace, workspace.n)
    replace(workspace, method)
    remember(workspace, loop)


@internal
def _know_rates(workspace: Any, first: int) -> None:
    """Rates of the work accounts; `aux` has the accelerations, from coordinate `first` on."""
    a, aux = vec(workspace.a, workspace.n_ext), vec(workspace.aux, workspace.n_ext)
    evaluate_power(workspace)
    for i in range(first, workspace.n_ext):
        aux[i] = a[i]
    convergence_at(workspace.rate).factor_age = -1.0


@internal
def settle(drive: Any, instant: Any, workspace: Any, method: Any, loop: Any) -> int:
    """Let the pending events happen at the newest row: a status of `records`."""
    t, counts, goals = history_time(method, 0), counts_at(drive.counts), goals_at(drive.goals)
    room = loop.capacity == 0 or ivec(loop.cursor, 1)[0] < loop.capacity
    if not room or not room_for(drive, MOST_EVENTS * workspace.n_contacts):
        return DECLINED
    if not _gets_on(drive, t):
        return int(call_part(instant.step_through, instant, drive, workspace, method))
    if only_impulses(loop) and clock_at(loop.clock).push_step == 0.0:
        begin_impulses(drive, workspace, method, loop)
        return SETTLED
    _keep(instant, workspace, False)
    step, pushing = clock_at(loop.clock).step_size, clock_at(loop.clock).push_step != 0.0
    # samples may have been asked for since the step that ended here
    recall(workspace, method, 0)
    if pushing:
        show_pending(workspace, drive.pending, drive.law)
    evaluate_residuals(workspace)
    modes = vec(instant.modes, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        modes[k] = memories_at(workspace.memory, workspace.n_contacts)[k].mode
    # structures are not given up as long as this may be the one to come back to
    structure = workspace.structure
    workspace.kept = structure
    handled_at, here, events = goals.handled_at, counts.here, counts.events
    counts.here = here + 1 if t == handled_at else 1
    goals.handled_at = t
    scalars(instant).touched = 0
    scalars(instant).touched_in_space = scalars(instant).unshared_contact = scalars(instant).approaching_contact = 0
    begun, status = clock_at(loop.clock).pushed_from == t, SETTLED
    if _any_force(drive, workspace):
        status = (
            _settle_forces_where_they_are(instant, drive, workspace, method)
            if pushing
            else call_part(instant.settle_forces, instant, drive, workspace, method)
        )
    if status == SETTLED:
        status = settle_massless(instant, drive, workspace, method)
    if status == SETTLED and pushing:
        clear(ivec(instant.unsettled, workspace.n_contacts), workspace.n_contacts)
        if _any_constraint(drive, workspace):
            status = call_part(instant.push_apart, instant, drive, workspace, method)
    elif status == SETTLED and _any_constraint(drive, workspace):
        status = decide(instant, drive, workspace, method, loop)
    if status == SETTLED and not pushing and _loses_unseen(instant, workspace) and may_push(drive, workspace, method):
        status = NOT_MET
    if status == SETTLED and not pushing:
        status = find_pending(instant, drive, workspace, method, loop)
    workspace.kept, touched = 0, scalars(instant).touched
    if pushing:
        show_elements(workspace)
    if status != SETTLED:
        goals.handled_at, counts.here, counts.events = handled_at, here, events
        _put_back(instant, workspace, method, structure)
        clock_at(loop.clock).step_size = step
        many = status >= NO_IMPACT and not pushing and touched >= MANY_TOUCH
        if many and call_part(instant.step_through, instant, drive, workspace, method) == SETTLED:
            return SETTLED
        return status
    if pushing:
        evaluate_residuals(workspace)
    if pushing and not begun:
        # what lies between two steps of impulses is between what they have left
        _go_on(workspace, method, loop)
    else:
        begin_anew(workspace, method, loop)
    _count(drive, t)
    report_not_found(instant, drive, workspace, t)
    crowds = False
    if not pushing:
        crowds = count_instant(workspace, loop, t, touched, scalars(instant).touched_in_space >= MANY_TOUCH)
    copy(ivec(drive.pending, workspace.n_contacts), ivec(instant.unsettled, workspace.n_contacts), workspace.n_contacts)
    if crowds:
        call_part(instant.step_through, instant, drive, workspace, method)
    _sample(drive, workspace, loop)
    return SETTLED


@internal
def _settle_forces_where_they_are(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Forces that begin and end among steps of impulses, which may have moved their gaps beyond zero: what springs hold
    there all at once is in the contacts' accounts."""
    law, pending = ivec(drive.law, workspace.n_contacts), ivec(drive.pending, workspace.n_contacts)
    memory, energy, count = memories_at(workspace.memory, workspace.n_contacts), vec(workspace.energy, 3), 0
    evaluate_energy(workspace)
    more = energy[0] + energy[1] + energy[2]
    for k in range(workspace.n_contacts):
        if law[k] == BY_FORCE and pending[k] != 0:
            count += 1
            more += memory[k].loss_jump
    status = int(call_part(instant.settle_forces, instant, drive, workspace, method))
    if status != SETTLED:
        return status
    evaluate_energy(workspace)
    more -= energy[0] + energy[1] + energy[2]
    for k in range(workspace.n_contacts):
        if law[k] == BY_FORCE and pending[k] != 0:
            more -= memory[k].loss_jump
    for k in range(workspace.n_contacts):
        if law[k] == BY_FORCE and pending[k] != 0:
            memory[k].loss_jump += more / count
    return status


@internal
def _loses_unseen(instant: Any, workspace: Any) -> bool:
    """True if many touch in space, and bringing them onto their new constraints has changed the energy by more than
    rounding. (In the plane what is lost so is next to nothing, and events get on.)"""
    most = UNSEEN * control_at(workspace.control).energy_scale
    return bool(scalars(instant).touched_in_space >= MANY_TOUCH and abs(scalars(instant).projection_loss) > most)


@internal
def begin_pending_forces(drive: Any, instant: Any, workspace: Any, method: Any, loop: Any) -> int:
    """Let the force laws of pending contacts act from the current point on, at the start; where something is wanted,
    nothing has happened."""
    _keep(instant, workspace, False)
    events, step = counts_at(drive.counts).events, clock_at(loop.clock).step_size
    structure = workspace.structure
    workspace.kept = structure
    status = int(call_part(instant.settle_forces, instant, drive, workspace, method))
    workspace.kept = 0
    if status == SETTLED:
        begin_anew(workspace, method, loop)
        return status
    _put_back(instant, workspace, method, structure)
    counts_at(drive.counts).events, clock_at(loop.clock).step_size = events, step
    return status


@internal
def go_on_behind(drive: Any, instant: Any, workspace: Any, method: Any, loop: Any) -> int:
    """Go on behind the breakpoint that is due; closed contacts that do not fit the new forces, or surfaces that have
    jumped in speed, are pending."""
    _keep(instant, workspace, False)
    structure = workspace.structure
    workspace.kept = structure
    status = pass_breakpoint(instant, drive, workspace, method)
    workspace.kept = 0
    if status != SETTLED:
        _put_back(instant, workspace, method, structure)
        return status
    begin_anew(workspace, method, loop)
    pending, moved = ivec(drive.pending, workspace.n_contacts), ivec(instant.unsettled, workspace.n_contacts)
    unsettled = find_unsettled(instant, workspace, pending)
    for k in range(workspace.n_contacts):
        if moved[k] != 0:
            pending[k], unsettled = 1, True
    if not unsettled:
        _sample(drive, workspace, loop)
    return SETTLED


@internal
def _put_back(instant: Any, workspace: Any, method: Any, structure: int) -> None:
    """As it was before the instant."""
    if workspace.structure != structure:
        take_structure(workspace, structure)
    recall(workspace, method, 0)
    evaluate_residuals(workspace)
    _keep(instant, workspace, True)


@internal
def _keep(instant: Any, workspace: Any, back: bool) -> None:
    """What an instant changes of the state, besides what the newest row holds: kept, or put `back`."""
    size = workspace.n_contacts * MEMORY_SIZE
    memory, kept = vec(workspace.memory, size), vec(instant.kept_memory, size)
    rate, kept_rate = vec(workspace.rate, RATE_SIZE), vec(instant.kept_rate, RATE_SIZE)
    counters, kept_counters = ivec(workspace.counters, COUNTERS_SIZE), ivec(instant.kept_counters, COUNTERS_SIZE)
    if back:
        copy(memory, kept, size)
        copy(rate, kept_rate, RATE_SIZE)
        copy(counters, kept_counters, COUNTERS_SIZE)
        convergence_at(workspace.rate).factor_age = -1.0
    else:
        copy(kept, memory, size)
        copy(kept_rate, rate, RATE_SIZE)
        copy(kept_counters, counters, COUNTERS_SIZE)


@internal
def _any_force(drive: Any, workspace: Any) -> bool:
    """True if a contact with a force law is pending."""
    law, pending = ivec(drive.law, workspace.n_contacts), ivec(drive.pending, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        if law[k] == BY_FORCE and pending[k] != 0:
            return True
    return False


@internal
def _any_constraint(drive: Any, workspace: Any) -> bool:
    """True if a contact constraint with mass on both sides is pending."""
    law, pending = ivec(drive.law, workspace.n_contacts), ivec(drive.pending, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        if pending[k] != 0 and law[k] != AT_MASSLESS and law[k] != BY_FORCE:
            return True
    return False


@internal
def _gets_on(drive: Any, t: float) -> bool:
    """False if the guard against runs that events keep from going on would speak (`events/progress.py`)."""
    goals, counts, guard = goals_at(drive.goals), counts_at(drive.counts), vec(drive.guard, GUARD_SIZE)
    if t == goals.handled_at and counts.here >= MOST_AT_ONCE:
        return False
    if guard[GUARDED] < IN_A_ROW:
        return True
    return abs(t - guard[COUNTED_SINCE]) > STANDSTILL * abs(t - guard[RUN_BEGAN])


@internal
def _count(drive: Any, t: float) -> None:
    """One more instant."""
    counts, guard = counts_at(drive.counts), vec(drive.guard, GUARD_SIZE)
    counts.handled += 1
    guard[GUARDED] += 1.0
    if guard[GUARDED] > IN_A_ROW:
        guard[COUNTED_SINCE], guard[GUARDED] = t, 0.0


@internal
def _sample(drive: Any, workspace: Any, loop: Any) -> None:
    if loop.capacity > 0:
        cursor = ivec(loop.cursor, 1)
        look_at_all(workspace, loop)
        call_sample(drive.write_sample, workspace, mat(loop.samples, loop.capacity, loop.sample_length)[cursor[0]])
        cursor[0] += 1
