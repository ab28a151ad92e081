"""What a run measures before it starts: scales of the model (`assembly/scales.py`), units for pivots, tolerances."""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals
from ..assembly.measure import (
    MEASURED,
    MEASURED_HEAVIEST,
    MEASURED_SQUARE,
    MEASURED_STIFFEST,
    measure_motion,
    measure_rows,
)
from ..assembly.measure import MEASURED_WORK as FOUND_WORK
from ..assembly.scales import MOST_TIMES, SMALL_WORK
from ..compiled.jit import internal
from ..compiled.views import imat, ivec, vec
from ..events.records import SETTLED, WANT_MEMORY
from ..rounding import CONSTRAINT_TOLERANCES
from ..state.run_records import loop_at
from ..state.workspace_records import COUNTERS_SIZE, OK, building_at, call_engage, control_at, structure_at
from .begin_record import (
    ANGLE_TOLERANCE,
    ANGULAR_SPEED_TOLERANCE,
    BEGIN_SIZE,
    GIVEN_LENGTH,
    GIVEN_STEP,
    GIVEN_TOLERANCE,
    LATER,
    LENGTH_TOLERANCE,
    LONGEST_STEP,
    OF_SCALES,
    SPEED_TOLERANCE,
    T0,
)
from .settings import CONSTRAINT_SHARE, DEFAULT_NEWTON_TOLERANCE, LEAST_EXACTNESS
from .settings import SPEEDS as SPEED_SHARE

POOLED_SIZE = 2.0
"""Lengths of the model by which the gap of two bodies changes that move by one each."""


@internal
def place(begin: Any, workspace: Any) -> None:
    """The start as it is given, at rest in accelerations; coordinates with a driver where that says."""
    q, v, a, lam = (
        vec(workspace.q, workspace.n_ext),
        vec(workspace.v, workspace.n_ext),
        vec(workspace.a, workspace.n_ext),
        vec(workspace.lam, workspace.m_ext),
    )
    q0, v0 = vec(begin.q0, workspace.n), vec(begin.v0, workspace.n)
    for i in range(workspace.n_ext):
        q[i] = q0[i] if i < workspace.n else 0.0
        v[i] = v0[i] if i < workspace.n else 0.0
        a[i] = 0.0
    for i in range(workspace.m_ext):
        lam[i] = 0.0
    vec(workspace.t, 1)[0] = vec(begin.numbers, BEGIN_SIZE)[T0]
    if begin.n_placed > 0:
        evaluate_residuals(workspace)
        placed, phi, phid = (
            imat(begin.placed, begin.n_placed, 2),
            vec(workspace.phi, workspace.m_ext),
            vec(workspace.phid, workspace.m_ext),
        )
        for k in range(begin.n_placed):
            q[placed[k, 0]] -= phi[placed[k, 1]]
            v[placed[k, 0]] -= phid[placed[k, 1]]


@internal
def measure(begin: Any, drive: Any, workspace: Any) -> int:
    """Scales of the model at the start as it is given, tolerances that are parts of them, and the structure of open
    contacts with pivots in these units: SETTLED, or what memory it takes."""
    place(begin, workspace)
    counters = ivec(workspace.counters, COUNTERS_SIZE)
    before = counters.copy()
    root = _measure_scales(begin, drive, workspace)
    counters[:] = before
    _set_tolerances(begin, workspace)
    return _use_units(workspace, root)


@internal
def _set_pooled(begin: Any, drive: Any, workspace: Any, sizes: Any) -> None:
    """Sizes of the rows of pooled contacts, which nothing moves yet: those of two bodies that move by the model's
    length against each other."""
    loop, size = loop_at(drive.loop), POOLED_SIZE * vec(begin.numbers, BEGIN_SIZE)[GIVEN_LENGTH]
    contacts, rows = ivec(loop.slot_contact, loop.n_slots), ivec(workspace.contact_rows, workspace.n_contacts)
    first = ivec(workspace.contact_slide_rows, workspace.n_contacts)
    second = ivec(workspace.contact_second_rows, workspace.n_contacts)
    for slot in range(loop.n_slots):
        k = contacts[slot]
        for row in (rows[k], first[k], second[k]):
            if row >= 0:
                sizes[row] = size


@internal
def _measure_scales(begin: Any, drive: Any, workspace: Any) -> float:
    """The scales into `control`, those of rows and of work accounts into their arrays; returns the root of the largest
    mass, kg^0.5 m."""
    n, m, scale, row_scale = (
        workspace.n,
        workspace.m_ext - 1,
        vec(workspace.scale, workspace.n),
        vec(workspace.row_scale, workspace.m_ext),
    )
    sizes, own, internal, found = vec(begin.sizes, m), vec(begin.scale, n), ivec(begin.internal, n), np.zeros(MEASURED)
    if begin.n_row_sizes > 0:
        given = vec(begin.row_sizes, m)
        for i in range(m):
            sizes[i] = given[i]
    else:
        measure_rows(workspace, scale, sizes)
        _set_pooled(begin, drive, workspace, sizes)
    for i in range(m):
        row_scale[i] = sizes[i]
    for i in range(n):
        # the rate of an internal state is no acceleration, its unit mass no mass
        own[i] = 0.0 if internal[i] != 0 else scale[i]
    mass, later = vec(begin.mass, n), vec(begin.later, _later_times(begin, drive))
    for i in range(n):
        mass[i] = 0.0
    measure_motion(workspace, own, vec(begin.usual_v0, n), later, begin.m_joints, mass, found)
    # all at rest without loads: what vibrates gives the time
    square = found[MEASURED_SQUARE] if found[MEASURED_SQUARE] != 0.0 else found[MEASURED_STIFFEST]
    rate = np.sqrt(square) if square != 0.0 else 1.0
    heaviest = found[MEASURED_HEAVIEST] if found[MEASURED_HEAVIEST] != 0.0 else 1.0
    energy = found[FOUND_WORK] if found[FOUND_WORK] != 0.0 else heaviest * (rate * rate)
    control = control_at(workspace.control)
    control.rate_scale, control.energy_scale, control.stiffness_scale = rate, energy, found[MEASURED_STIFFEST]
    work, given = vec(workspace.work_scale, workspace.n_ext), vec(begin.work_sizes, workspace.n_ext)
    for i in range(workspace.n_ext):
        work[i] = SMALL_WORK * energy
    rows, accounts = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        ivec(drive.impulse_account, workspace.n_contacts),
    )
    for k in range(workspace.n_contacts):
        work[accounts[k]] = SMALL_WORK * energy / (rate * row_scale[rows[k]])
    for i in range(workspace.n_ext):
        if given[i] > 0.0:
            work[i] = given[i]
    return float(np.sqrt(heaviest))


@internal
def _use_units(workspace: Any, root: float) -> int:
    """Units that make M and Phi_q numbers of about 1, and a structure with them."""
    b = building_at(workspace.building)
    units, scale, row_scale = (
        vec(b.units, workspace.n + workspace.m_ext),
        vec(workspace.scale, workspace.n),
        vec(workspace.row_scale, workspace.m_ext),
    )
    for i in range(workspace.n):
        units[i] = scale[i] / root
    for i in range(workspace.m_ext):
        units[workspace.n + i] = root / row_scale[i]
    places, wanted = ivec(b.structures, b.n_slots), ivec(workspace.wanted, workspace.n_contacts)
    for i in range(b.n_slots):
        structure_at(places[i]).built = 0
    for k in range(workspace.n_contacts):
        wanted[k] = 0
    return SETTLED if call_engage(workspace.engage, workspace) == OK else WANT_MEMORY


@internal
def _later_times(begin: Any, drive: Any) -> int:
    """Times after the start at which forces and drivers that rest at first have begun; how many."""
    numbers, later, breakpoints = (
        vec(begin.numbers, BEGIN_SIZE),
        vec(begin.later, LATER),
        vec(drive.breakpoints, drive.n_breakpoints),
    )
    t, longest, ahead = numbers[T0], numbers[LONGEST_STEP], 0
    for i in range(drive.n_breakpoints):
        ahead += 1 if breakpoints[i] > t else 0
    stride = max(1, (ahead + MOST_TIMES - 1) // MOST_TIMES)
    later[0], count, seen = 0.0, 1, 0
    for i in range(drive.n_breakpoints):
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
def _set_tolerances(begin: Any, workspace: Any) -> None:
    """Absolute tolerances, in parts of the scales or as they are given, and how exactly constraints are to be met."""
    numbers, control, scale = (
        vec(begin.numbers, BEGIN_SIZE),
        control_at(workspace.control),
        vec(workspace.scale, workspace.n),
    )
    internal, angle = ivec(begin.internal, workspace.n), ivec(begin.angle, workspace.n)
    atol_q, atol_v = vec(workspace.atol_q, workspace.n), vec(workspace.atol_v, workspace.n)
    rate, length, given = control.rate_scale, numbers[GIVEN_LENGTH], numbers[GIVEN_TOLERANCE]
    fixed, finest = numbers[GIVEN_STEP] > 0.0, 1.0
    for i in range(workspace.n):
        # the state is the velocity of an internal coordinate, and a length; a tolerance as large as what it is for
        # would let all pass
        size_q = length / rate if internal[i] != 0 else scale[i]
        size_v = length if internal[i] != 0 else SPEED_SHARE * scale[i] * rate
        if fixed:
            # without error weights the outer loop's tolerance takes their place, with weight 1
            tolerance = given if given > 0.0 else DEFAULT_NEWTON_TOLERANCE
            speed = size_v if internal[i] != 0 else size_v / SPEED_SHARE
            atol_q[i] = tolerance * (1.0 if given > 0.0 else size_q)
            atol_v[i] = tolerance * (1.0 if given > 0.0 else speed)
        else:
            atol_q[i] = _tolerance(numbers, ANGLE_TOLERANCE if angle[i] != 0 else LENGTH_TOLERANCE, size_q)
            atol_v[i] = _tolerance(numbers, ANGULAR_SPEED_TOLERANCE if angle[i] != 0 else SPEED_TOLERANCE, size_v)
            if internal[i] != 0:
                atol_v[i] = _tolerance(numbers, LENGTH_TOLERANCE, size_v)
            finest = min(finest, atol_q[i] / size_q)
    if fixed:
        finest = given if given > 0.0 else 1.0
    else:
        control.atol = finest
    # differences over several steps see what the constraints leave open: it has to be small against the tolerances
    control.exactness = min(1.0, max(LEAST_EXACTNESS, CONSTRAINT_SHARE * finest / CONSTRAINT_TOLERANCES[0]))
