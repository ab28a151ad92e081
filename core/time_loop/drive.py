"""The run as one compiled function: steps, event location and what is settled at events, until it reaches its goal or
something comes up that Python has to do.

`run` makes steps; `drive` goes on where these end at events, and where they fail by `recover` (`recovery/policy.py`).
What it leaves to others it leaves untouched, with a code of `state/run_records` that says what it is.
"""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, compiled_unlocked, internal, record_view
from ..compiled.views import ivec, vec
from ..event_detection.balls import MARKS, WITHOUT_SLOT
from ..event_detection.broad_phase import begin_watch
from ..event_detection.contact_pool import write_all_tables
from ..event_detection.contact_sleeping import wake_all
from ..event_detection.event_search import locate
from ..event_detection.repivoting import orientation
from ..events.event_handling import go_on_behind, settle
from ..events.inconsistent_modes import find_unsettled
from ..events.moved_surfaces import find_moved
from ..events.records import DECLINED, NO_SLOT, SETTLED, WANT_MEMORY, call_part, instant_at
from ..events.zeno import only_impulses, without_impulse
from ..methods.history import history_time, recall
from ..rounding import NO_STEP
from ..state.method_records import METHOD_TYPE
from ..state.run_records import (
    CHUNK,
    DRIVE_TYPE,
    DUE,
    EVENT,
    EVENTS_FULL,
    FAILED,
    JAM,
    LOOP_TYPE,
    REACHED,
    REPARTITION,
    SETTLE,
    UNLOCATED,
    WANTED,
    call_find_events,
    call_locate,
    call_recover,
    call_run,
    call_settle,
    call_trial,
    clock_at,
    counts_at,
    goals_at,
)
from ..state.workspace_records import (
    OK,
    WORKSPACE_TYPE,
    convergence_at,
    counters_at,
)
from .sliding import any_slides
from .time_stepping import make_push_step

MANY = 6
"""Contacts from which on it pays to let those sleep that are far from touching."""

workspace_at, method_at, loop_at, drive_at = map(record_view, (WORKSPACE_TYPE, METHOD_TYPE, LOOP_TYPE, DRIVE_TYPE))


@internal
def _aim(drive: Any, method: Any, loop: Any) -> int:
    """Set the clock of the loop for the way to the goal; REACHED or DUE where there is no way to go."""
    goals, clock = goals_at(drive.goals), clock_at(loop.clock)
    breakpoints = vec(drive.breakpoints, drive.n_breakpoints)
    now, goal, last_stop, ahead = history_time(method, 0), goals.goal, goals.last_stop, np.inf
    if clock.halvings > 0.0:
        # a fixed step that is divided is made to its end
        goal, last_stop = max(goal, clock.divided_until), min(last_stop, clock.parts_until)
    if now >= goal:
        return REACHED
    for i in range(drive.n_breakpoints):
        if now < breakpoints[i] < ahead:
            ahead = breakpoints[i]
    # steps end just before a breakpoint, so that they see what holds to the left of it
    last, goals.passed = np.nextafter(ahead, -np.inf), ahead
    if last - now <= NO_STEP * abs(now):
        return DUE
    if goal - now <= NO_STEP * abs(goal):
        return REACHED
    clock.break_time, clock.stop_time, clock.target_time = ahead, min(last_stop, last), goal
    return REACHED if clock.stop_time - now <= NO_STEP * abs(now) else OK


@internal
def drive_on(drive: Any, workspace: Any, method: Any, loop: Any, hold: bool) -> int:
    """Steps and events up to the goal; `hold`: only up to where events are pending. Where `recover` has asked for
    something, its answer counts first."""
    counts = counts_at(drive.counts)
    last = counters_at(workspace.counters).steps + counts.handled + counts.budget
    code = OK if counts.remedy == 0 else call_recover(drive.recover, drive, OK)
    while code == OK:
        loop.may_sleep = 1 if workspace.n_contacts >= MANY else 0
        clock = clock_at(loop.clock)
        h = clock.fixed_step if clock.fixed_step > 0.0 else max(clock.step_size, clock.push_step)
        begin_watch(workspace, method, loop, h)
        code = _drive_on(drive, workspace, method, loop, hold, last)
        loop.may_sleep = 0
        # whoever builds what is wanted does not look at gaps, and comes back at once
        if code != WANTED:
            wake_all(workspace, method, loop)
            code = call_recover(drive.recover, drive, code)
    return code


@internal
def _drive_on(drive: Any, workspace: Any, method: Any, loop: Any, hold: bool, last: int) -> int:
    """Up to so many steps and instants in all as `last` says."""
    counts, steps = counts_at(drive.counts), counters_at(workspace.counters)
    side = 0.0  # the sign of a determinant at the newest row, while contacts slide; 0: not looked at yet
    while True:
        if loop.n_slots > 0 and ivec(loop.broad, MARKS)[WITHOUT_SLOT] > 0:
            counts.status = NO_SLOT
            return FAILED
        if is_due(drive, workspace):
            side = 0.0
            # which redundant rows are left out is for Python to look at, at every instant; steps of impulses take those
            # that a new partition leaves out
            beyond = history_time(method, 0) > goals_at(drive.goals).goal
            if (workspace.n_redundant > 0 or hold or beyond) and clock_at(loop.clock).push_step == 0.0:
                return SETTLE
            status = call_settle(drive.settle, drive)
            if status != SETTLED:
                counts.status = status
                return SETTLE if status == DECLINED else (WANTED if status <= WANT_MEMORY else FAILED)
            continue
        code = _aim(drive, method, loop)
        side = 0.0 if code == DUE else side
        if code == DUE and workspace.n_redundant == 0:
            if loop.capacity > 0 and ivec(loop.cursor, 1)[0] >= loop.capacity:
                return EVENTS_FULL
            status = call_settle(drive.pass_breakpoint, drive)
            if status != SETTLED:
                counts.status = status
                return WANTED if status <= WANT_MEMORY else FAILED
            continue
        if code != OK:
            return code
        left = last - steps.steps - counts.handled
        if left <= 0:
            return CHUNK
        if clock_at(loop.clock).push_step != 0.0 or only_impulses(loop):
            side, code = 0.0, call_settle(drive.push_step, drive)
            if code != OK:
                return code
            continue
        # while a contact slides, each step is looked at: on the way to where it jams the forces grow without bound, and
        # behind it the determinant has the other sign
        sliding, before = any_slides(workspace), history_time(method, 0)
        if sliding and side == 0.0:
            recall(workspace, method, 0)
            side = _known(orientation(workspace))
        code = call_run(drive.run, workspace, method, loop, 1 if sliding else left)
        if (code == CHUNK or code == REPARTITION) and sliding:
            if history_time(method, 0) > before:
                now = orientation(workspace)
                if now == now and now != side and side != 0.0:
                    return JAM
                side = _known(now)
            if code == CHUNK:
                continue
        if code == REACHED:
            continue
        if code != EVENT:
            return code
        if call_locate(drive.locate, drive, False) != OK:
            return UNLOCATED


@internal
def _known(side: float) -> float:
    """0 for NaN."""
    return side if side == side else 0.0


@internal
def is_due(drive: Any, workspace: Any) -> bool:
    """True if events are pending."""
    pending = ivec(drive.pending, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        if pending[k] != 0:
            return True
    return False


@compiled_unlocked
def drive(drive: Any, hold: bool) -> int:
    """Go to the goal; a code of `records` or the status of a step that cannot be made."""
    return drive_on(drive, workspace_at(drive.workspace), method_at(drive.method), loop_at(drive.loop), hold)


@compiled
def aim_now(drive: Any) -> int:
    """`_aim`, for Python."""
    return _aim(drive, method_at(drive.method), loop_at(drive.loop))


@compiled
def bind_now(drive: Any) -> None:
    """Tables for the pairs that have the slots of contact pools in the state that has been taken."""
    write_all_tables(workspace_at(drive.workspace), loop_at(drive.loop))


@compiled
def wake_now(drive: Any) -> None:
    """`wake_all`, for Python."""
    wake_all(workspace_at(drive.workspace), method_at(drive.method), loop_at(drive.loop))


@compiled
def settle_pending(drive: Any) -> int:
    """Let the pending events happen at the newest row: a status of `events/records.py`."""
    workspace, method, loop = workspace_at(drive.workspace), method_at(drive.method), loop_at(drive.loop)
    return settle(drive, instant_at(drive.instant), workspace, method, loop)


@compiled
def push_step(drive: Any) -> int:
    """One step of impulses, as `make_push_step` says."""
    return make_push_step(drive, workspace_at(drive.workspace), method_at(drive.method), loop_at(drive.loop))


@compiled
def pass_breakpoint(drive: Any) -> int:
    """Go on behind the breakpoint `passed` of the goals: a status of `events/records.py`."""
    workspace, method, loop = workspace_at(drive.workspace), method_at(drive.method), loop_at(drive.loop)
    return go_on_behind(drive, instant_at(drive.instant), workspace, method, loop)


@compiled
def unsettled_now(drive: Any) -> bool:
    """Contacts that do not fit the forces, or the speeds of their surfaces, at the current point, for Python."""
    workspace, instant = workspace_at(drive.workspace), instant_at(drive.instant)
    unsettled = ivec(instant.unsettled, workspace.n_contacts)
    found = find_unsettled(instant, workspace, unsettled)
    return find_moved(workspace, method_at(drive.method), unsettled) or found


@compiled
def without_impulse_now(drive: Any) -> int:
    """`without_impulse`, for Python."""
    return without_impulse(drive, workspace_at(drive.workspace))


@compiled
def open_now(drive: Any) -> int:
    """`open_touching` at the current point, for Python."""
    instant = instant_at(drive.instant)
    return call_part(instant.open_touching, instant, drive, workspace_at(drive.workspace), method_at(drive.method))


@compiled
def locate_now(drive: Any, again: bool) -> int:
    """`locate`, after `drive` has returned. `again`: the step of size TRIAL_STEP is made again first; UNLOCATED: it has
    no event any more. With any other code than OK nothing is accepted, and the newest row is the current point."""
    workspace, method, loop = workspace_at(drive.workspace), method_at(drive.method), loop_at(drive.loop)
    status, h = OK, clock_at(loop.clock).trial_step
    if again:
        recall(workspace, method, 0)
        status = call_trial(drive.trial, workspace, method, loop, h)
        if status == OK and not call_find_events(loop.find_events, workspace, method, loop, h, False):
            status = UNLOCATED
    if status == OK:
        status = locate(drive, workspace, method, loop)
    if status != OK:
        recall(workspace, method, 0)
        convergence_at(workspace.rate).factor_age = -1.0
    return status
