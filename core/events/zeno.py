"""Do events follow each other in next to no time?

Coulomb friction of several contacts can make them stick and slip in turns that become shorter by a thousandth each
time: as accumulating bounces do, but tens of thousands of them. Bounces end by the rest rule; so does this. While
instants crowd, a closed contact that slides more slowly than `rest_ratio` times the speeds there are counts as one that
does not slide: the forces say whether it sticks.

Where many contacts touch, instants crowd without any of these limits: an impact opens contacts that fall back within
microseconds, and each of them is an impact of all. Then the run goes on in steps of impulses (`impulse_step.py`), a row
of them, until for some steps no contact comes or goes, or the row is at its end. If instants crowd again behind it, the
next row is twice as long.
"""

from typing import Any

from ..assembly.levels import position_level
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..event_detection.contact_evaluation import can_look
from ..methods.history import history_time
from ..rounding import GAP_ROUNDING
from ..state.modes import CLOSED, MEMORY_SIZE, MODE, PUSHED
from ..state.modes import PUSHES as BLOCKS
from ..state.run_records import (
    CALM,
    CLOCK_SIZE,
    COUNTS_SIZE,
    CROWDED,
    HERE,
    PUSH_STEP,
    PUSHED_FROM,
    PUSHED_UNTIL,
    PUSHES,
    PUSHES_LEFT,
    STEP_SIZE,
    WINDOW_COUNT,
    WINDOW_START,
    loop_at,
)
from ..state.workspace_records import CONTROL_SIZE, RATE_SCALE
from .laws import FORCE, MASSLESS
from .progress import COUNT, GUARD_SIZE, SINCE
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
def count_instant(ws: Any, lc: Any, t: float, touching: int, spatial: bool) -> bool:
    """One more instant, at time t, with so many touching contacts, many of them in space or not; True if the run is to
    go on in steps of impulses."""
    clock = vec(lc.clock, CLOCK_SIZE)
    many = touching >= MANY_TOUCH and clock[PUSH_STEP] == 0.0
    clock[WINDOW_COUNT] += 1.0
    again = clock[PUSHES] > 0.0 and t <= clock[PUSHED_UNTIL] + _size(ws) and clock[WINDOW_COUNT] >= FEW_AGAIN
    if clock[WINDOW_COUNT] >= WINDOW:
        span = abs(t - clock[WINDOW_START]) * vec(ws.control, CONTROL_SIZE)[RATE_SCALE]
        clock[CROWDED] = 1.0 if span < NEXT_TO_NO_TIME else 0.0
        clock[WINDOW_START], clock[WINDOW_COUNT] = t, 0.0
        again = again or span < (IN_SPACE if spatial else NEXT_TO_NO_TIME_OF_MANY)
    return bool(many and again)


@internal
def _size(ws: Any) -> float:
    return float(SIZE / vec(ws.control, CONTROL_SIZE)[RATE_SCALE])


@internal
def pushed_lately(ws: Any, lc: Any, t: float) -> bool:
    """True if the last row of steps of impulses ended a short time before t."""
    clock = vec(lc.clock, CLOCK_SIZE)
    return bool(clock[PUSHES] > 0.0 and t <= clock[PUSHED_UNTIL] + SOON * _size(ws))


@internal
def near_level(ws: Any, h: float) -> float:
    """Gaps in parts of their rows' scales that count as none at the end of a step of impulses of h (s): those that the
    model's own accelerations close within the next one. What rests presses in each step then, not in every other."""
    way = h * vec(ws.control, CONTROL_SIZE)[RATE_SCALE]
    return float(GAP_ROUNDING * position_level(ws) + 0.5 * way * way)


@internal
def may_push(dr: Any, ws: Any, ms: Any) -> bool:
    """False where steps of impulses cannot be made: with methods that do not meet the constraints at all levels, and
    where contacts are at massless ends, constraints in space that cannot be looked at alone, or friction with three
    tangents, of which a row of impulses knows two."""
    law, lc = ivec(dr.law, ws.n_contacts), loop_at(dr.loop)
    if ms.exact == 0:
        return False
    for k in range(ws.n_contacts):
        if ivec(ws.contact_companion, ws.n_contacts)[k] != 0:
            return False
        if law[k] == MASSLESS or (law[k] != FORCE and in_space(ws, k) and not can_look(lc, k)):
            return False
    return True


@internal
def any_force_law(dr: Any, ws: Any) -> bool:
    """True if some contacts act as forces."""
    law = ivec(dr.law, ws.n_contacts)
    for k in range(ws.n_contacts):
        if law[k] == FORCE:
            return True
    return False


@internal
def step_through(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Go on from the newest row by steps of impulses; DECLINED, and nothing has happened, where there are none."""
    lc, t, guard = loop_at(dr.loop), history_time(ms, 0), vec(dr.guard, GUARD_SIZE)
    clock = vec(lc.clock, CLOCK_SIZE)
    if clock[PUSH_STEP] != 0.0 or not may_push(dr, ws, ms) or _make_pending(dr, ws) < MANY_TOUCH:
        return DECLINED
    clock[PUSHES] = min(2.0 * clock[PUSHES], MOST) if pushed_lately(ws, lc, t) else FEWEST
    clock[PUSH_STEP], clock[PUSHES_LEFT], clock[CALM], clock[PUSHED_FROM] = _size(ws), clock[PUSHES], 0.0, t
    if any_force_law(dr, ws):
        clock[STEP_SIZE] = clock[PUSH_STEP]
    # these steps get on
    ivec(dr.counts, COUNTS_SIZE)[HERE], guard[SINCE], guard[COUNT] = 0, t, 0.0
    return SETTLED


@internal
def _make_pending(dr: Any, ws: Any) -> int:
    """Closed constraint contacts, and others of them that touch, become pending; how many are now."""
    memory, pending = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(dr.pending, ws.n_contacts)
    rows, phi, scale = ivec(ws.contact_rows, ws.n_contacts), vec(ws.phi, ws.m_ext), vec(ws.row_scale, ws.m_ext)
    level, sleeping = GAP_ROUNDING * position_level(ws), ivec(ws.sleeping, ws.n_contacts)
    law, count = ivec(dr.law, ws.n_contacts), 0
    for k in range(ws.n_contacts):
        if law[k] == FORCE:
            continue
        touches = sleeping[k] == 0 and phi[rows[k]] <= level * scale[rows[k]]
        if memory[k, MODE] == CLOSED or touches:
            pending[k] = 1
        count += 1 if pending[k] != 0 else 0
    return count


@internal
def end_pushing(ws: Any, lc: Any, t: float) -> None:
    """What touches now is for an instant of its own to settle."""
    clock = vec(lc.clock, CLOCK_SIZE)
    clock[PUSH_STEP] = clock[PUSHES_LEFT] = clock[CALM] = clock[PUSHED_FROM] = 0.0
    clock[PUSHED_UNTIL], clock[WINDOW_START], clock[WINDOW_COUNT] = t, t, 0.0
    for k in range(ws.n_contacts):
        for block in range(BLOCKS):
            mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, PUSHED + block] = 0.0
