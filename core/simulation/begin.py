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
from ..event_detection.balls import MARKS, WITHOUT_SLOT
from ..event_detection.broad_phase import begin_pools
from ..event_detection.crossings import remember
from ..events.event_handling import begin_pending_forces
from ..events.prepare import rank_of
from ..events.records import NO_SLOT, REPEATED_ROWS, SETTLED, call_part
from ..methods.history import restart
from ..rounding import RATE_ROUNDING, START_OVERLAP, START_RANK
from ..stage.accelerations import solve_accelerations
from ..state.impact_law_codes import BY_FORCE
from ..state.run_records import clock_at
from ..state.workspace_records import OK, control_at
from .begin_measure import place
from .begin_record import (
    BEGIN_SIZE,
    GIVEN_FIRST_STEP,
    GIVEN_START_TOLERANCE,
    LOOK_AT_RANK,
    MOVED_MOST,
    MOVED_POSITIONS,
    MOVED_RATES,
    START_FOUND_SIZE,
)

# statuses besides those of `events/records.py`
NO_POSITIONS, NO_VELOCITIES = 40, 41
"""The given ones violate the constraints beyond repair."""
OVERLAPS = 42
"""Shapes of a constraint contact overlap at the start."""
SINGULAR_START = 43
"""The constraints depend on one another there."""
START_UNSOLVED = 44
"""There are no accelerations, or no memory for the equations."""


@internal
def start(begin: Any, drive: Any, instant: Any, workspace: Any, method: Any, loop: Any) -> int:
    """Start with the numbers that the tables have now, as far as contacts with force laws that act: SETTLED, or why it
    cannot. Other contacts that touch are left pending."""
    place(begin, workspace)
    begin_pools(workspace, loop)
    if loop.n_slots > 0 and ivec(loop.broad, MARKS)[WITHOUT_SLOT] > 0:
        return NO_SLOT
    status = _make_consistent(begin, instant, drive, workspace, method)
    if status == SETTLED:
        status = _find_touching(begin, drive, workspace)
    if status == SETTLED:
        status = call_part(instant.use_modes, instant, drive, workspace, method)
    if status != SETTLED:
        return int(status)
    if not _accelerate(workspace):
        return START_UNSOLVED
    clock, first = clock_at(loop.clock), vec(begin.numbers, BEGIN_SIZE)[GIVEN_FIRST_STEP]
    clock.step_size = first if first > 0.0 else _first_step(workspace, clock.max_step)
    new_history(workspace, method, loop)
    return _begin_forces(drive, instant, workspace, method, loop)


@internal
def _make_consistent(begin: Any, instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Positions and velocities on the constraints by the least change in the M-norm."""
    evaluate_residuals(workspace)
    status = call_part(instant.use_modes, instant, drive, workspace, method)
    if status != SETTLED:
        return SINGULAR_START if status == REPEATED_ROWS else status
    evaluate_residuals(workspace)
    level = rate_level(workspace)
    if not _meet(begin, workspace, False, 1.0):
        return NO_POSITIONS
    if not _meet(begin, workspace, True, level):
        return NO_VELOCITIES
    if workspace.n == 0 or workspace.m_act == 0:
        return SETTLED
    evaluate_residuals(workspace)
    status, look = (
        call_part(instant.use_modes, instant, drive, workspace, method),
        vec(begin.numbers, BEGIN_SIZE)[LOOK_AT_RANK] != 0.0,
    )
    if status == REPEATED_ROWS or (
        status == SETTLED and look and rank_of(instant, workspace, START_RANK) < workspace.m_act
    ):
        return SINGULAR_START
    return status


@internal
def _meet(begin: Any, workspace: Any, rates: bool, level: float) -> bool:
    """Bring q, or v, onto the constraints; False if that takes more than a start may be moved."""
    x, scale, before = (
        vec(workspace.v if rates else workspace.q, workspace.n),
        vec(workspace.scale, workspace.n),
        vec(begin.mass, workspace.n),
    )
    found, place = vec(begin.found, START_FOUND_SIZE), MOVED_RATES if rates else MOVED_POSITIONS
    for i in range(workspace.n):
        before[i] = x[i]
    found[place] = -1.0
    if not meet(workspace, rates):
        return False
    found[place], found[MOVED_MOST] = 0.0, 0.0
    for i in range(workspace.n):
        moved = abs(x[i] - before[i]) / (scale[i] * level)
        if not (moved <= found[place] or np.isnan(found[place])):
            found[place], found[MOVED_MOST] = moved, i
    return bool(found[place] <= vec(begin.numbers, BEGIN_SIZE)[GIVEN_START_TOLERANCE])


@internal
def _accelerate(workspace: Any) -> bool:
    """Accelerations, multipliers and rates of the work accounts."""
    if solve_accelerations(workspace) != OK:
        return False
    evaluate_power(workspace)
    a, aux = vec(workspace.a, workspace.n_ext), vec(workspace.aux, workspace.n_ext)
    for i in range(workspace.n_ext):
        aux[i] = a[i]
    return True


@internal
def _find_touching(begin: Any, drive: Any, workspace: Any) -> int:
    """Contacts that touch at the start are pending."""
    rows, law = ivec(workspace.contact_rows, workspace.n_contacts), ivec(drive.law, workspace.n_contacts)
    pending, scale = ivec(drive.pending, workspace.n_contacts), vec(workspace.row_scale, workspace.m_ext)
    phi, phid, phidd = (
        vec(workspace.phi, workspace.m_ext),
        vec(workspace.phid, workspace.m_ext),
        vec(workspace.phidd, workspace.m_ext),
    )
    for k in range(workspace.n_contacts):
        row, force = rows[k], law[k] == BY_FORCE
        gap, most = phi[row], START_OVERLAP * (position_level(workspace) * scale[row])
        if gap < -most and not force:
            vec(begin.found, START_FOUND_SIZE)[MOVED_MOST] = k
            return OVERLAPS
        if gap > most:
            continue
        rate, still = phid[row], RATE_ROUNDING * rate_size(workspace, k)
        touches = rate <= still
        if force:
            touches = gap < -most or rate < -still
            if not touches and rate <= still:
                if not _accelerate(workspace):
                    return START_UNSOLVED
                touches = phidd[row] < 0.0
        pending[k] = 1 if touches else 0
    return SETTLED


@internal
def _begin_forces(drive: Any, instant: Any, workspace: Any, method: Any, loop: Any) -> int:
    """Pending contacts with force laws act from the start; the others are left pending."""
    pending, law, kept = (
        ivec(drive.pending, workspace.n_contacts),
        ivec(drive.law, workspace.n_contacts),
        np.zeros(workspace.n_contacts),
    )
    any_force = False
    for k in range(workspace.n_contacts):
        if pending[k] != 0 and law[k] == BY_FORCE:
            any_force = True
        elif pending[k] != 0:
            kept[k] = 1.0
            pending[k] = 0
    status = int(begin_pending_forces(drive, instant, workspace, method, loop)) if any_force else SETTLED
    for k in range(workspace.n_contacts):
        pending[k] = 1 if kept[k] != 0.0 else 0
    return status


@internal
def _first_step(workspace: Any, longest: float) -> float:
    """A step in which nothing moves by more than a hundredth of its scale; error control takes it from there."""
    v, a, scale = vec(workspace.v, workspace.n), vec(workspace.a, workspace.n), vec(workspace.scale, workspace.n)
    speed, acceleration = 0.0, 0.0
    for i in range(workspace.n):
        speed, acceleration = max(speed, abs(v[i]) / scale[i]), max(acceleration, abs(a[i]) / scale[i])
    guess = 0.1 * (1.0 / control_at(workspace.control).rate_scale)
    if speed > 0.0:
        guess = min(guess, 0.01 / speed)
    if acceleration > 0.0:
        guess = min(guess, 0.1 / np.sqrt(acceleration))
    return min(guess, longest)


@internal
def new_history(workspace: Any, method: Any, loop: Any) -> None:
    """A history that begins at the current point."""
    evaluate_residuals(workspace)
    restart(workspace, method)
    remember(workspace, loop)
