"""Do events follow each other in next to no time?

Coulomb friction of several contacts can make them stick and slip in turns that become shorter by a thousandth each
time: as accumulating bounces do, but tens of thousands of them. Bounces end by the rest rule; so does this. While
instants crowd, a closed contact that slides more slowly than `rest_ratio` times the speeds there are counts as one that
does not slide: the forces say whether it sticks.

Where many contacts touch, instants crowd without any of these limits: an impact opens contacts that fall back within
microseconds, and each of them is an impact of all. Then the run goes on in steps of impulses (`moreau_jean_step.py`),
a row of them, until for some steps no contact comes or goes, or the row is at its end. If instants crowd again behind
it, the next row is twice as long.
"""

from typing import Any

import numpy as np

from ..assembly.levels import position_level
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..event_detection.contact_evaluation import can_look
from ..methods.history import history_time
from ..rounding import GAP_ROUNDING
from ..state.impact_law_codes import AT_MASSLESS, BY_FORCE
from ..state.modes import CLOSED, memories_at
from ..state.modes import STEP_FORCES as BLOCKS
from ..state.run_records import (
    clock_at,
    counts_at,
    loop_at,
)
from ..state.workspace_records import control_at
from .progress import COUNTED_SINCE, EVENTS_COUNTED, GUARD_SIZE
from .records import DECLINED, SETTLED

WINDOW = 64
"""Instants that are looked at together."""
NEXT_TO_NO_TIME, NEXT_TO_NO_TIME_OF_MANY, IN_SPACE = 1e-6, 1e-5, 2e-3
"""Of the model's own time: for so many instants, and for so many at which many contacts touch, in the plane and in
space: heaps of disks come to rest event by event, and their crowds end by themselves."""
MANY_TOUCH = 8
SIZE = 5e-4
"""Of a step of impulses, in parts of the model's own time."""
FEWEST, MOST = 8, 4096
"""Steps of impulses in a row."""
FEW_AGAIN = 16
"""Instants within the time of one step behind a row, after which the next begins."""
SOON = 64
"""Steps of impulses: what crowds again within the time of so many behind the last row goes on crowding."""


@internal
def count_instant(workspace: Any, loop: Any, t: float, touching: int, spatial: bool) -> bool:
    """One more instant, at time t, with so many touching contacts, many of them in space or not; True if the run is to
    go on in steps of impulses."""
    clock = clock_at(loop.clock)
    many = touching >= MANY_TOUCH and clock.push_step == 0.0
    clock.window_count += 1.0
    again = clock.pushes > 0.0 and t <= clock.pushed_until + _size(workspace) and clock.window_count >= FEW_AGAIN
    if clock.window_count >= WINDOW:
        span = abs(t - clock.window_start) * control_at(workspace.control).rate_scale
        clock.crowded = 1.0 if span < NEXT_TO_NO_TIME else 0.0
        clock.window_start, clock.window_count = t, 0.0
        again = again or span < (IN_SPACE if spatial else NEXT_TO_NO_TIME_OF_MANY)
    return bool(many and again)


@internal
def _size(workspace: Any) -> float:
    return float(SIZE / control_at(workspace.control).rate_scale)


@internal
def only_impulses(loop: Any) -> bool:
    """True if all steps of the run are steps of impulses (`method="moreau"`), and none looks for events."""
    return bool(loop.only_impulses != 0)


@internal
def pushed_lately(workspace: Any, loop: Any, t: float) -> bool:
    """True if the last row of steps of impulses ended a short time before t."""
    clock = clock_at(loop.clock)
    return bool(clock.pushes > 0.0 and t <= clock.pushed_until + SOON * _size(workspace))


@internal
def near_level(workspace: Any, h: float) -> float:
    """Gaps in parts of their rows' scales that count as none at the end of a step of impulses of h (s): those that the
    model's own accelerations close within the next one. What rests presses in each step then, not in every other."""
    way = h * control_at(workspace.control).rate_scale
    return float(GAP_ROUNDING * position_level(workspace) + 0.5 * way * way)


@internal
def may_push(drive: Any, workspace: Any, method: Any) -> bool:
    """False where steps of impulses cannot be made: with methods that do not meet the constraints at all levels, and
    where contacts are at massless ends, constraints in space that cannot be looked at alone, or friction with three
    tangents, of which a row of impulses knows two."""
    return method.exact != 0 and without_impulse(drive, workspace) < 0


@internal
def without_impulse(drive: Any, workspace: Any) -> int:
    """The first contact that has no row in steps of impulses; -1: all have."""
    law, loop = ivec(drive.law, workspace.n_contacts), loop_at(drive.loop)
    for k in range(workspace.n_contacts):
        if ivec(workspace.contact_companion, workspace.n_contacts)[k] != 0:
            return k
        if law[k] == AT_MASSLESS or (law[k] != BY_FORCE and in_space(workspace, k) and not can_look(loop, k)):
            return k
    return -1


@internal
def any_force_law(drive: Any, workspace: Any) -> bool:
    """True if some contacts act as forces."""
    law = ivec(drive.law, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        if law[k] == BY_FORCE:
            return True
    return False


@internal
def step_through(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Go on from the newest row by steps of impulses; DECLINED, and nothing has happened, where there are none."""
    loop = loop_at(drive.loop)
    if (
        clock_at(loop.clock).push_step != 0.0
        or not may_push(drive, workspace, method)
        or _make_pending(drive, workspace) < MANY_TOUCH
    ):
        return DECLINED
    steps = float(FEWEST)
    if pushed_lately(workspace, loop, history_time(method, 0)):
        steps = min(2.0 * clock_at(loop.clock).pushes, MOST)
    _begin_row(drive, workspace, method, loop, steps)
    return SETTLED


@internal
def begin_impulses(drive: Any, workspace: Any, method: Any, loop: Any) -> None:
    """Begin the one row of steps of a run that has no others."""
    _make_pending(drive, workspace)
    _begin_row(drive, workspace, method, loop, np.inf)


@internal
def _begin_row(drive: Any, workspace: Any, method: Any, loop: Any, steps: float) -> None:
    t, guard, clock = history_time(method, 0), vec(drive.guard, GUARD_SIZE), clock_at(loop.clock)
    fixed = clock.fixed_step if only_impulses(loop) else 0.0
    clock.pushes = clock.pushes_left = steps
    clock.push_step, clock.calm, clock.pushed_from = fixed if fixed > 0.0 else _size(workspace), 0.0, t
    if any_force_law(drive, workspace):
        clock.step_size = clock.push_step
    # these steps get on
    counts_at(drive.counts).here, guard[COUNTED_SINCE], guard[EVENTS_COUNTED] = 0, t, 0.0


@internal
def _make_pending(drive: Any, workspace: Any) -> int:
    """Closed constraint contacts, and others of them that touch, become pending; how many are now."""
    memory, pending = memories_at(workspace.memory, workspace.n_contacts), ivec(drive.pending, workspace.n_contacts)
    rows, phi, scale = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        vec(workspace.phi, workspace.m_ext),
        vec(workspace.row_scale, workspace.m_ext),
    )
    level, sleeping = GAP_ROUNDING * position_level(workspace), ivec(workspace.sleeping, workspace.n_contacts)
    law, count = ivec(drive.law, workspace.n_contacts), 0
    for k in range(workspace.n_contacts):
        if law[k] == BY_FORCE:
            continue
        touches = sleeping[k] == 0 and phi[rows[k]] <= level * scale[rows[k]]
        if memory[k].mode == CLOSED or touches:
            pending[k] = 1
        count += 1 if pending[k] != 0 else 0
    return count


@internal
def end_pushing(workspace: Any, loop: Any, t: float) -> None:
    """What touches now is for an instant of its own to settle."""
    clock = clock_at(loop.clock)
    clock.push_step = clock.pushes_left = clock.calm = clock.pushed_from = 0.0
    clock.pushed_until, clock.window_start, clock.window_count = t, t, 0.0
    for k in range(workspace.n_contacts):
        for block in range(BLOCKS):
            memories_at(workspace.memory, workspace.n_contacts)[k].step_force[block] = 0.0
