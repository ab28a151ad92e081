"""The start of a run as one compiled function of tables and state: `Engine.begin` for runs without Python.

Scales of the model, tolerances, a consistent start, the first step, contacts that touch. The same operations in the
same order, so the same bits. What Python says of a start in a sentence is a status here. Redundant rows are Python's to
find: whoever calls this leaves models with such rows alone.
"""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal, record_view
from ..compiled.types import from_dtype
from ..compiled.views import imat, ivec, mat, vec
from ..events.laws import FORCE
from ..events.prepare import rank_of
from ..events.progress import GUARD_SIZE
from ..events.records import REPEATED_ROWS, SETTLED, call_part, instant_at
from ..events.settle import begin_pending_forces
from ..location.dense_output import query
from ..location.watch import remember
from ..loop.drive import loop_at, method_at, workspace_at
from ..methods.history import restart
from ..model.signals import INPUT_SIZE
from ..rounding import CONSTRAINT_TOLERANCES, RATE_ROUNDING, START_OVERLAP, START_RANK
from ..stage.accelerations import solve_accelerations
from ..state.run_records import (
    CLOCK_SIZE,
    COUNTS_SIZE,
    EVENTS,
    GOALS_SIZE,
    HANDLED_AT,
    MAX_STEP,
    STEP_SIZE,
    call_sample,
    call_settle,
)
from ..state.workspace_records import (
    ATOL,
    CONTROL_SIZE,
    ENERGY_SCALE,
    EXACTNESS,
    OK,
    RATE_SCALE,
    STIFFNESS_SCALE,
    building_at,
    call_engage,
    structure_at,
)
from ..tables.evaluate import evaluate_power, evaluate_residuals
from ..tables.levels import position_level, rate_level
from ..tables.measure import HEAVIEST, MEASURED, SQUARE, STIFFEST, measure_motion, measure_rows
from ..tables.measure import WORK as FOUND_WORK
from ..tables.projection import meet
from ..tables.scales import MOST_TIMES, WORK
from .begin_record import (
    ANGLES,
    ANGULAR_SPEEDS,
    BEGIN_SIZE,
    FIRST_STEP,
    LATER,
    LENGTH,
    LENGTHS,
    LONGEST_STEP,
    NEWTON_TOLERANCE,
    OF_SCALES,
    SPEEDS,
    START_TOLERANCE,
    STEP,
    T0,
)
from .exchange import drive_at
from .exchange_record import EXCHANGE, GOAL, INITIAL_ENERGY, INTERVAL, LAST_CHANGE, NOW, TIMES_SIZE
from .settings import CONSTRAINT_SHARE, DEFAULT_NEWTON_TOLERANCE, LEAST_EXACTNESS
from .settings import SPEEDS as SPEED_SHARE

# what `begin_now` returns besides the statuses of `events/records.py`
NO_POSITIONS, NO_VELOCITIES = 40, 41
"""The given ones violate the constraints beyond repair."""
OVERLAPS = 42
"""Shapes of a constraint contact overlap at the start."""
SINGULAR_START = 43
"""The constraints depend on one another there."""
NO_START = 44
"""There are no accelerations, or no memory for the equations."""

exchange_at = record_view(from_dtype(EXCHANGE))


@compiled
def begin_now(bg: Any) -> int:
    """Begin the run anew with the numbers that its tables have now: SETTLED, or why it cannot."""
    ex, dr = exchange_at(bg.exchange), drive_at(bg.drive)
    ws, ms, lc, ev = workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop), instant_at(dr.instant)
    numbers, clock = vec(bg.numbers, BEGIN_SIZE), vec(lc.clock, CLOCK_SIZE)
    _clear(bg, ex, dr, ws, clock)
    _place(bg, ws)
    if not _measure(bg, dr, ws):
        return NO_START
    _set_tolerances(bg, ws)
    _place(bg, ws)
    status = _make_consistent(bg, ev, dr, ws, ms)
    if status == SETTLED:
        status = _find_touching(dr, ws)
    if status == SETTLED:
        status = call_part(ev.use_modes, ev, dr, ws, ms)
    if status != SETTLED:
        return status
    if not _accelerate(ws):
        return NO_START
    first = numbers[FIRST_STEP]
    clock[STEP_SIZE] = first if first > 0.0 else _first_step(ws, clock[MAX_STEP])
    _new_history(ws, ms, lc)
    status = _begin_forces(dr, ev, ws, ms, lc)
    if status != SETTLED:
        return status
    if query(ws, ms, numbers[T0]) != OK:
        return NO_START
    sample = vec(ex.sample, ex.sample_length)
    call_sample(dr.write_sample, ws, sample)
    energy = sample[bg.energies] + sample[bg.energies + 1] + sample[bg.energies + 2]
    vec(ex.times, TIMES_SIZE)[INITIAL_ENERGY] = energy
    if _any(dr, ws):
        status = call_settle(dr.settle, dr)
    else:
        _new_history(ws, ms, lc)
    _count_from_here(dr, numbers[T0])
    return status


@internal
def _clear(bg: Any, ex: Any, dr: Any, ws: Any, clock: Any) -> None:
    """As before a run begins, but for the longest step and the inputs, which are numbers of the model."""
    longest, t0 = clock[MAX_STEP], vec(bg.numbers, BEGIN_SIZE)[T0]
    inputs, kept = mat(ws.inputs, ex.n_inputs, INPUT_SIZE), mat(ex.before, ex.n_inputs, INPUT_SIZE)
    for k in range(ex.n_inputs):
        for i in range(INPUT_SIZE):
            kept[k, i] = inputs[k, i]
    state, blank = ivec(bg.state, bg.n_blank), ivec(bg.blank, bg.n_blank)
    for i in range(bg.n_blank):
        state[i] = blank[i]
    clock[MAX_STEP] = longest
    for k in range(ex.n_inputs):
        for i in range(INPUT_SIZE):
            inputs[k, i] = kept[k, i]
    vec(dr.goals, GOALS_SIZE)[HANDLED_AT] = np.nan
    ivec(dr.counts, COUNTS_SIZE)[EVENTS] = 0
    pending = ivec(dr.pending, ws.n_contacts)
    for k in range(ws.n_contacts):
        pending[k] = 0
    times = vec(ex.times, TIMES_SIZE)
    times[NOW], times[GOAL], times[LAST_CHANGE], times[INTERVAL] = t0, t0, t0, np.inf
    _count_from_here(dr, t0)


@internal
def _count_from_here(dr: Any, t0: float) -> None:
    """Counters and the guard against endless events begin."""
    counts, guard = ivec(dr.counts, COUNTS_SIZE), vec(dr.guard, GUARD_SIZE)
    for i in range(COUNTS_SIZE):
        if i != EVENTS:
            counts[i] = 0
    guard[0], guard[1], guard[2] = t0, t0, 0.0


@internal
def _place(bg: Any, ws: Any) -> None:
    """The start as it is given, at rest in accelerations; coordinates with a driver where that says."""
    q, v, a, lam = vec(ws.q, ws.n_ext), vec(ws.v, ws.n_ext), vec(ws.a, ws.n_ext), vec(ws.lam, ws.m_ext)
    q0, v0 = vec(bg.q0, ws.n), vec(bg.v0, ws.n)
    for i in range(ws.n_ext):
        q[i] = q0[i] if i < ws.n else 0.0
        v[i] = v0[i] if i < ws.n else 0.0
        a[i] = 0.0
    for i in range(ws.m_ext):
        lam[i] = 0.0
    vec(ws.t, 1)[0] = vec(bg.numbers, BEGIN_SIZE)[T0]
    if bg.n_placed > 0:
        evaluate_residuals(ws)
        placed, phi, phid = imat(bg.placed, bg.n_placed, 2), vec(ws.phi, ws.m_ext), vec(ws.phid, ws.m_ext)
        for k in range(bg.n_placed):
            q[placed[k, 0]] -= phi[placed[k, 1]]
            v[placed[k, 0]] -= phid[placed[k, 1]]


@internal
def _measure(bg: Any, dr: Any, ws: Any) -> bool:
    """Scales of the model (`tables/scales.py`), and the structure of open contacts with pivots in these units; False
    without room for it."""
    n, m, scale, row_scale = ws.n, ws.m_ext - 1, vec(ws.scale, ws.n), vec(ws.row_scale, ws.m_ext)
    sizes, own, internal, found = vec(bg.sizes, m), vec(bg.scale, n), ivec(bg.internal, n), np.zeros(MEASURED)
    measure_rows(ws, scale, sizes)
    for i in range(m):
        row_scale[i] = sizes[i]
    for i in range(n):
        own[i] = 0.0 if internal[i] != 0 else scale[i]
    mass, later = vec(bg.mass, n), vec(bg.later, _later_times(bg, dr))
    for i in range(n):
        mass[i] = 0.0
    measure_motion(ws, own, vec(bg.v0, n), later, bg.m_joints, mass, found)
    square = found[SQUARE] if found[SQUARE] != 0.0 else found[STIFFEST]
    rate = np.sqrt(square) if square != 0.0 else 1.0
    heaviest = found[HEAVIEST] if found[HEAVIEST] != 0.0 else 1.0
    energy = found[FOUND_WORK] if found[FOUND_WORK] != 0.0 else heaviest * (rate * rate)
    control = vec(ws.control, CONTROL_SIZE)
    control[RATE_SCALE], control[ENERGY_SCALE], control[STIFFNESS_SCALE] = rate, energy, found[STIFFEST]
    work, given = vec(ws.work_scale, ws.n_ext), vec(bg.work_sizes, ws.n_ext)
    for i in range(ws.n_ext):
        work[i] = WORK * energy
    rows, accounts = ivec(ws.contact_rows, ws.n_contacts), ivec(dr.impulse_account, ws.n_contacts)
    for k in range(ws.n_contacts):
        work[accounts[k]] = WORK * energy / (rate * row_scale[rows[k]])
    for i in range(ws.n_ext):
        if given[i] > 0.0:
            work[i] = given[i]
    return _use_units(ws, np.sqrt(heaviest))


@internal
def _use_units(ws: Any, root: float) -> bool:
    """Units that make M and Phi_q numbers of about 1, and a structure with them."""
    b = building_at(ws.building)
    units, scale, row_scale = vec(b.units, ws.n + ws.m_ext), vec(ws.scale, ws.n), vec(ws.row_scale, ws.m_ext)
    for i in range(ws.n):
        units[i] = scale[i] / root
    for i in range(ws.m_ext):
        units[ws.n + i] = root / row_scale[i]
    places, wanted = ivec(b.structures, b.n_slots), ivec(ws.wanted, ws.n_contacts)
    for i in range(b.n_slots):
        structure_at(places[i]).built = 0
    for k in range(ws.n_contacts):
        wanted[k] = 0
    return bool(call_engage(ws.engage, ws) == OK)


@internal
def _later_times(bg: Any, dr: Any) -> int:
    """Times after the start at which forces and drivers that rest at first have begun; how many."""
    numbers, later, breakpoints = (
        vec(bg.numbers, BEGIN_SIZE),
        vec(bg.later, LATER),
        vec(dr.breakpoints, dr.n_breakpoints),
    )
    t, longest, ahead = numbers[T0], numbers[LONGEST_STEP], 0
    for i in range(dr.n_breakpoints):
        ahead += 1 if breakpoints[i] > t else 0
    stride = max(1, (ahead + MOST_TIMES - 1) // MOST_TIMES)
    later[0], count, seen = 0.0, 1, 0
    for i in range(dr.n_breakpoints):
        if breakpoints[i] > t:
            if seen % stride == 0:
                later[count] = breakpoints[i] - t
                count += 1
            seen += 1
    if np.isfinite(longest):
        later[count], later[count + 1] = 0.5 * longest, longest
        count += 2
    return count


@internal
def _tolerance(numbers: Any, kind: int, size: float) -> float:
    return float(numbers[kind] * (size if numbers[kind + OF_SCALES] != 0.0 else 1.0))


@internal
def _set_tolerances(bg: Any, ws: Any) -> None:
    """What `settings.set_control` makes of the scales."""
    numbers, control, scale = vec(bg.numbers, BEGIN_SIZE), vec(ws.control, CONTROL_SIZE), vec(ws.scale, ws.n)
    internal, angle = ivec(bg.internal, ws.n), ivec(bg.angle, ws.n)
    atol_q, atol_v = vec(ws.atol_q, ws.n), vec(ws.atol_v, ws.n)
    rate, length, given = control[RATE_SCALE], numbers[LENGTH], numbers[NEWTON_TOLERANCE]
    fixed, finest = numbers[STEP] > 0.0, 1.0
    for i in range(ws.n):
        size_q = length / rate if internal[i] != 0 else scale[i]
        size_v = length if internal[i] != 0 else SPEED_SHARE * scale[i] * rate
        if fixed:
            tolerance = given if given > 0.0 else DEFAULT_NEWTON_TOLERANCE
            speed = size_v if internal[i] != 0 else size_v / SPEED_SHARE
            atol_q[i] = tolerance * (1.0 if given > 0.0 else size_q)
            atol_v[i] = tolerance * (1.0 if given > 0.0 else speed)
        else:
            atol_q[i] = _tolerance(numbers, ANGLES if angle[i] != 0 else LENGTHS, size_q)
            atol_v[i] = _tolerance(numbers, ANGULAR_SPEEDS if angle[i] != 0 else SPEEDS, size_v)
            if internal[i] != 0:
                atol_v[i] = _tolerance(numbers, LENGTHS, size_v)
            finest = min(finest, atol_q[i] / size_q)
    if fixed:
        finest = given if given > 0.0 else 1.0
    else:
        control[ATOL] = finest
    control[EXACTNESS] = min(1.0, max(LEAST_EXACTNESS, CONSTRAINT_SHARE * finest / CONSTRAINT_TOLERANCES[0]))


@internal
def _make_consistent(bg: Any, ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Positions and velocities on the constraints (`tables/consistent.py`)."""
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
    status = call_part(ev.use_modes, ev, dr, ws, ms)
    if status == REPEATED_ROWS or (status == SETTLED and rank_of(ev, ws, START_RANK) < ws.m_act):
        return SINGULAR_START
    return status


@internal
def _meet(bg: Any, ws: Any, rates: bool, level: float) -> bool:
    """Bring q, or v, onto the constraints; False if that takes more than a start may be moved."""
    x, scale, before = vec(ws.v if rates else ws.q, ws.n), vec(ws.scale, ws.n), vec(bg.mass, ws.n)
    for i in range(ws.n):
        before[i] = x[i]
    if not meet(ws, rates):
        return False
    most = vec(bg.numbers, BEGIN_SIZE)[START_TOLERANCE]
    for i in range(ws.n):
        if not abs(x[i] - before[i]) / (scale[i] * level) <= most:
            return False
    return True


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
def _find_touching(dr: Any, ws: Any) -> int:
    """Contacts that touch at the start are pending."""
    rows, slides, law = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts), dr.law
    pending, scale = ivec(dr.pending, ws.n_contacts), vec(ws.row_scale, ws.m_ext)
    phi, phid, phidd = vec(ws.phi, ws.m_ext), vec(ws.phid, ws.m_ext), vec(ws.phidd, ws.m_ext)
    for k in range(ws.n_contacts):
        row, force = rows[k], ivec(law, ws.n_contacts)[k] == FORCE
        gap, most = phi[row], START_OVERLAP * (position_level(ws) * scale[row])
        if gap < -most and not force:
            return OVERLAPS
        if gap > most:
            continue
        rate, along = phid[row], scale[slides[k]] if slides[k] >= 0 else 0.0
        still = RATE_ROUNDING * (rate_level(ws) * max(scale[row], along))
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
def _any(dr: Any, ws: Any) -> bool:
    pending = ivec(dr.pending, ws.n_contacts)
    for k in range(ws.n_contacts):
        if pending[k] != 0:
            return True
    return False


@internal
def _first_step(ws: Any, longest: float) -> float:
    """A step in which nothing moves by more than a hundredth of its scale (`Engine._first_step`)."""
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
def _new_history(ws: Any, ms: Any, lc: Any) -> None:
    evaluate_residuals(ws)
    restart(ws, ms)
    remember(ws, lc)
