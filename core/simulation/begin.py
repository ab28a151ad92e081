"""The start of a run, compiled: positions and velocities on the constraints, contacts that touch, the first step.

Python's runs start by it too (`start.py`), which makes sentences of the statuses, and finds rows that repeat others.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_power, evaluate_residuals
from ..assembly.levels import position_level, rate_level, rate_size
from ..assembly.projection import meet
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..event_detection.crossings import remember
from ..events.event_handling import begin_pending_forces
from ..events.laws import FORCE
from ..events.prepare import rank_of
from ..events.records import REPEATED_ROWS, SETTLED, call_part
from ..methods.history import restart
from ..rounding import RATE_ROUNDING, START_OVERLAP, START_RANK
from ..stage.accelerations import solve_accelerations
from ..state.run_records import CLOCK_SIZE, MAX_STEP, STEP_SIZE
from ..state.workspace_records import CONTROL_SIZE, OK, RATE_SCALE
from .begin_measure import place
from .begin_record import (
    BEGIN_SIZE,
    FIRST_STEP,
    FOUND_SIZE,
    LOOK_AT_RANK,
    MOVED,
    MOVED_RATES,
    START_TOLERANCE,
    WHO,
)

# statuses besides those of `events/records.py`
NO_POSITIONS, NO_VELOCITIES = 40, 41
"""The given ones violate the constraints beyond repair."""
OVERLAPS = 42
"""Shapes of a constraint contact overlap at the start."""
SINGULAR_START = 43
"""The constraints depend on one another there."""
NO_START = 44
"""There are no accelerations, or no memory for the equations."""


@internal
def start(bg: Any, dr: Any, ev: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Start with the numbers that the tables have now, as far as contacts with force laws that act: SETTLED, or why it
    cannot. Other contacts that touch are left pending."""
    place(bg, ws)
    status = _make_consistent(bg, ev, dr, ws, ms)
    if status == SETTLED:
        status = _find_touching(bg, dr, ws)
    if status == SETTLED:
        status = call_part(ev.use_modes, ev, dr, ws, ms)
    if status != SETTLED:
        return int(status)
    if not _accelerate(ws):
        return NO_START
    clock, first = vec(lc.clock, CLOCK_SIZE), vec(bg.numbers, BEGIN_SIZE)[FIRST_STEP]
    clock[STEP_SIZE] = first if first > 0.0 else _first_step(ws, clock[MAX_STEP])
    new_history(ws, ms, lc)
    return _begin_forces(dr, ev, ws, ms, lc)


@internal
def _make_consistent(bg: Any, ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Positions and velocities on the constraints by the least change in the M-norm."""
    evaluate_residuals(ws)
    status = call_part(ev.use_modes, ev, dr, ws, ms)
    if status != SETTLED:
        return SINGULAR_START if status == REPEATED_ROWS else status
    evaluate_residuals(ws)
    level = rate_level(ws)
    if not _meet(bg, ws, False, 1.0):
        return NO_POSITIONS
    if not _meet(bg, ws, True, level):
        return NO_VELOCITIES
    if ws.n == 0 or ws.m_act == 0:
        return SETTLED
    evaluate_residuals(ws)
    status, look = call_part(ev.use_modes, ev, dr, ws, ms), vec(bg.numbers, BEGIN_SIZE)[LOOK_AT_RANK] != 0.0
    if status == REPEATED_ROWS or (status == SETTLED and look and rank_of(ev, ws, START_RANK) < ws.m_act):
        return SINGULAR_START
    return status


@internal
def _meet(bg: Any, ws: Any, rates: bool, level: float) -> bool:
    """Bring q, or v, onto the constraints; False if that takes more than a start may be moved."""
    x, scale, before = vec(ws.v if rates else ws.q, ws.n), vec(ws.scale, ws.n), vec(bg.mass, ws.n)
    found, place = vec(bg.found, FOUND_SIZE), MOVED_RATES if rates else MOVED
    for i in range(ws.n):
        before[i] = x[i]
    found[place] = -1.0
    if not meet(ws, rates):
        return False
    found[place], found[WHO] = 0.0, 0.0
    for i in range(ws.n):
        moved = abs(x[i] - before[i]) / (scale[i] * level)
        if not (moved <= found[place] or np.isnan(found[place])):
            found[place], found[WHO] = moved, i
    return bool(found[place] <= vec(bg.numbers, BEGIN_SIZE)[START_TOLERANCE])


@internal
def _accelerate(ws: Any) -> bool:
    """Accelerations, multipliers and rates of the work accounts."""
    if solve_accelerations(ws) != OK:
        return False
    evaluate_power(ws)
    a, aux = vec(ws.a, ws.n_ext), vec(ws.aux, ws.n_ext)
    for i in range(ws.n_ext):
        aux[i] = a[i]
    return True


@internal
def _find_touching(bg: Any, dr: Any, ws: Any) -> int:
    """Contacts that touch at the start are pending."""
    rows, law = ivec(ws.contact_rows, ws.n_contacts), ivec(dr.law, ws.n_contacts)
    pending, scale = ivec(dr.pending, ws.n_contacts), vec(ws.row_scale, ws.m_ext)
    phi, phid, phidd = vec(ws.phi, ws.m_ext), vec(ws.phid, ws.m_ext), vec(ws.phidd, ws.m_ext)
    for k in range(ws.n_contacts):
        row, force = rows[k], law[k] == FORCE
        gap, most = phi[row], START_OVERLAP * (position_level(ws) * scale[row])
        if gap < -most and not force:
            vec(bg.found, FOUND_SIZE)[WHO] = k
            return OVERLAPS
        if gap > most:
            continue
        rate, still = phid[row], RATE_ROUNDING * rate_size(ws, k)
        touches = rate <= still
        if force:
            touches = gap < -most or rate < -still
            if not touches and rate <= still:
                if not _accelerate(ws):
                    return NO_START
                touches = phidd[row] < 0.0
        pending[k] = 1 if touches else 0
    return SETTLED


@internal
def _begin_forces(dr: Any, ev: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Pending contacts with force laws act from the start; the others are left pending."""
    pending, law, kept = ivec(dr.pending, ws.n_contacts), ivec(dr.law, ws.n_contacts), np.zeros(ws.n_contacts)
    any_force = False
    for k in range(ws.n_contacts):
        if pending[k] != 0 and law[k] == FORCE:
            any_force = True
        elif pending[k] != 0:
            kept[k] = 1.0
            pending[k] = 0
    status = int(begin_pending_forces(dr, ev, ws, ms, lc)) if any_force else SETTLED
    for k in range(ws.n_contacts):
        pending[k] = 1 if kept[k] != 0.0 else 0
    return status


@internal
def _first_step(ws: Any, longest: float) -> float:
    """A step in which nothing moves by more than a hundredth of its scale; error control takes it from there."""
    v, a, scale = vec(ws.v, ws.n), vec(ws.a, ws.n), vec(ws.scale, ws.n)
    speed, acceleration = 0.0, 0.0
    for i in range(ws.n):
        speed, acceleration = max(speed, abs(v[i]) / scale[i]), max(acceleration, abs(a[i]) / scale[i])
    guess = 0.1 * (1.0 / vec(ws.control, CONTROL_SIZE)[RATE_SCALE])
    if speed > 0.0:
        guess = min(guess, 0.01 / speed)
    if acceleration > 0.0:
        guess = min(guess, 0.1 / np.sqrt(acceleration))
    return min(guess, longest)


@internal
def new_history(ws: Any, ms: Any, lc: Any) -> None:
    """A history that begins at the current point."""
    evaluate_residuals(ws)
    restart(ws, ms)
    remember(ws, lc)
