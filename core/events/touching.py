"""Contacts that touch at one instant: their directions, and how an impulse at one moves the others.

A row of `responses` is M_b g^T of a direction g (a row of the gaps' or the sliding distances' Jacobian): the motion
that a unit impulse along it causes with the joints intact, from [M Phi_q^T; Phi_q 0] (x, mu) = (g^T, 0). Glocker 2001,
chapter 5; Pfeiffer and Glocker 1996, chapter 5.
"""

from typing import Any

from ..assembly.evaluate import evaluate_tangent
from ..assembly.levels import acceleration_level, position_level, rate_level
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..event_detection.contact_evaluation import can_look, gradient_alone
from ..rounding import COORDINATE_NOISE, GAP_ROUNDING, IMMOVABLE, NO_ACCELERATION, NO_JERK, RATE_ROUNDING
from ..state.impact_law_codes import AT_MASSLESS, BY_FORCE
from ..state.modes import CLOSED, STICKS, memories_at
from ..state.run_records import counts_at, loop_at
from .records import IMMOVABLE_CONTACT, OF_CONTACTS, SETTLED, delassus, scalars, touching


@internal
def find_touching(instant: Any, drive: Any, workspace: Any) -> bool:
    """Constraint contacts without a gap at the current point: closed ones, pending ones, and others that touch.
    Those at massless ends are left out: they take no impulse. False if there is no room for them."""
    memory, law = memories_at(workspace.memory, workspace.n_contacts), ivec(drive.law, workspace.n_contacts)
    pending, rows = ivec(drive.pending, workspace.n_contacts), ivec(workspace.contact_rows, workspace.n_contacts)
    phi, scale, contacts = (
        vec(workspace.phi, workspace.m_ext),
        vec(workspace.row_scale, workspace.m_ext),
        ivec(instant.contacts, instant.most),
    )
    level, count, sleeping = GAP_ROUNDING * position_level(workspace), 0, ivec(workspace.sleeping, workspace.n_contacts)
    companion = ivec(workspace.contact_companion, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        if pending[k] != 0 and companion[k] != 0:
            pending[k + companion[k]] = 1
    for k in range(workspace.n_contacts):
        if law[k] == BY_FORCE or law[k] == AT_MASSLESS or sleeping[k] != 0:
            continue
        if pending[k] != 0 or memory[k].mode == CLOSED or abs(phi[rows[k]]) <= level * scale[rows[k]]:
            if count == instant.most:
                scalars(instant).short_of = OF_CONTACTS
                return False
            contacts[count], touching(instant)[count].companion = k, companion[k]
            count += 1
    scalars(instant).count = count
    loop = loop_at(drive.loop)
    if loop.n_slots > 0:
        _sort_by_pairs(loop, contacts, count)
    return True


@internal
def _sort_by_pairs(loop: Any, contacts: Any, count: int) -> None:
    """Contacts of pools in the order of their pairs, so that nothing hangs on which slot a pair has taken."""
    slots, pairs = (
        ivec(loop.contact_slot, contacts[count - 1] + 1 if count > 0 else 0),
        ivec(loop.slot_pair, loop.n_slots),
    )
    for i in range(1, count):
        k, at = contacts[i], i
        if slots[k] < 0:
            continue
        while at > 0 and slots[contacts[at - 1]] >= 0 and pairs[slots[contacts[at - 1]]] > pairs[slots[k]]:
            contacts[at] = contacts[at - 1]
            at -= 1
        contacts[at] = k


@internal
def tell_touching(instant: Any, workspace: Any, loop: Any) -> None:
    """Where some of the touching contacts cannot be evaluated alone, evaluate all of them with the system."""
    contacts, alone = ivec(instant.contacts, instant.most), True
    for i in range(scalars(instant).count):
        alone = alone and can_look(loop, contacts[i])
    if not alone:
        evaluate_tangent(workspace, 0.0, 0.0)


@internal
def find_gradient(workspace: Any, loop: Any, k: int, row: int, out: Any) -> None:
    """Gradient (n,) of row `row`, one of contact k, after `tell_touching`, and `tell_gradients` where k can be
    evaluated alone."""
    if can_look(loop, k):
        gradient_alone(workspace, loop, k, row, out)
        return
    start, values = ivec(workspace.gradient_start, workspace.m_ext), vec(workspace.values, workspace.n_values)
    for i in range(workspace.n):
        out[i] = 0.0
    for e in range(start[row], start[row + 1]):
        out[ivec(workspace.gradient_col, e + 1)[e]] = values[ivec(workspace.gradient_slot, e + 1)[e]]


@internal
def entries_of(x: Any, n: int, some: Any) -> int:
    """Which entries of x (n,) are not zero, to `some`; how many."""
    count = 0
    for j in range(n):
        if x[j] != 0.0:
            some[count] = j
            count += 1
    return count


@internal
def refuse_immovable(instant: Any, workspace: Any, count: int) -> int:
    """A contact whose shapes joints and drivers hold both takes no impulse."""
    n, values, slots = (
        workspace.n,
        vec(workspace.values, workspace.n_values),
        ivec(workspace.mass_slot, workspace.n_mass),
    )
    entry_row, entry_col = ivec(workspace.entry_row, workspace.n_values), ivec(workspace.entry_col, workspace.n_values)
    directions, a, largest, scale = (
        mat(instant.directions, 2 * count, n),
        delassus(instant, count),
        0.0,
        vec(workspace.scale, n),
    )
    for e in range(workspace.n_mass):
        i = entry_row[slots[e]]
        if i == entry_col[slots[e]]:
            largest = max(largest, values[slots[e]] * scale[i] ** 2)
    for i in range(count):
        length, of_mass = 0.0, 0.0
        for j in range(n):
            length += (scale[j] * directions[i, j]) ** 2
        for e in range(workspace.n_mass):
            s, row, column = slots[e], entry_row[slots[e]], entry_col[slots[e]]
            sizes = (scale[row] * scale[column]) ** 2
            of_mass += sizes * directions[i, row] * values[s] * directions[i, column]
        # without joints it is at least this, (g . x)^2/(x . M x) for x = S^2 g with the scales S of the coordinates
        # (Cauchy and Schwarz); whatever the unit of length, what Euler parameters add along themselves is no more
        # (a frame without mass of its own counts as the heaviest)
        free = length * length / (of_mass if of_mass != 0.0 else largest * length)
        if not a[i, i] > IMMOVABLE * free:
            scalars(instant).failed_contact = ivec(instant.contacts, instant.most)[i]
            return IMMOVABLE_CONTACT
    return SETTLED


@internal
def read_rates(instant: Any, workspace: Any) -> None:
    """Rates of gaps and sliding distances, as the residuals have been evaluated last."""
    _read(
        instant,
        workspace,
        vec(workspace.phid, workspace.m_ext),
        touching(instant).gap_rate,
        touching(instant).sliding_rate,
    )


@internal
def _read(instant: Any, workspace: Any, level: Any, of_gap: Any, of_slide: Any) -> None:
    contacts = ivec(instant.contacts, instant.most)
    rows, slides = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
    )
    for i in range(scalars(instant).count):
        k = contacts[i]
        of_gap[i] = level[rows[k]]
        of_slide[i] = level[slides[k]] if slides[k] >= 0 else 0.0


@internal
def read_values(instant: Any, workspace: Any) -> None:
    """Gaps (of closed contacts what rounding has left them) and sliding distances, m."""
    gaps, distances = touching(instant).gap, touching(instant).sliding_distance
    memory, contacts = memories_at(workspace.memory, workspace.n_contacts), ivec(instant.contacts, instant.most)
    _read(instant, workspace, vec(workspace.phi, workspace.m_ext), gaps, distances)
    for i in range(scalars(instant).count):
        k = contacts[i]
        if memory[k].mode == CLOSED:
            gaps[i] += memory[k].closed_gap
            distances[i] += memory[k].slide_start if memory[k].slide_mode == STICKS else 0.0


@internal
def tangent_product(instant: Any, workspace: Any, c_q: float, c_v: float, x: Any) -> None:
    """(c_v D + c_q K) x without the mass matrix goes to `sum`, that of the magnitudes of all terms to `terms`; both are
    added."""
    total, sizes = vec(instant.sum, workspace.n), vec(instant.terms, workspace.n)
    slots, values = ivec(workspace.mass_slot, workspace.n_mass), vec(workspace.values, workspace.n_values)
    entry_row, entry_col = ivec(workspace.entry_row, workspace.n_values), ivec(workspace.entry_col, workspace.n_values)
    evaluate_tangent(workspace, c_q, c_v)
    with_motion = vec(instant.slots_work, workspace.n_mass)
    for e in range(workspace.n_mass):
        with_motion[e] = values[slots[e]]
    evaluate_tangent(workspace, 0.0, 0.0)
    for e in range(workspace.n_mass):
        s = slots[e]
        term = (with_motion[e] - values[s]) * x[entry_col[s]]
        total[entry_row[s]] += term
        sizes[entry_row[s]] += abs(term)


@internal
def force_noise(instant: Any, workspace: Any) -> Any:
    """What rounding of the coordinates leaves in the forces (n,), N (`ContactSide.force_noise`)."""
    scale, q, noise = (
        vec(workspace.scale, workspace.n),
        vec(workspace.q, workspace.n_ext),
        vec(instant.noise, workspace.n),
    )
    total, sizes, largest = vec(instant.sum, workspace.n), vec(instant.terms, workspace.n), 0.0
    for i in range(workspace.n):
        largest = max(largest, abs(q[i]) / scale[i])
        total[i] = sizes[i] = 0.0
    for i in range(workspace.n):
        noise[i] = COORDINATE_NOISE * largest * scale[i]
    tangent_product(instant, workspace, 1.0, 0.0, noise)
    return sizes


@internal
def free_jerks(instant: Any, workspace: Any, jerks: Any) -> None:
    """Rates of the gaps' free accelerations, m/s^3, as the forces' dependence on the motion makes them:
    M a' = -(K v + D a). What is not more than rounding, of the sum or of velocities and accelerations, is zero."""
    count, n, total, sizes = (
        scalars(instant).count,
        workspace.n,
        vec(instant.sum, workspace.n),
        vec(instant.terms, workspace.n),
    )
    responses, noise, scale = mat(instant.responses, 2 * count, n), vec(instant.noise, n), vec(workspace.scale, n)
    for i in range(n):
        total[i] = sizes[i] = 0.0
        noise[i] = RATE_ROUNDING * rate_level(workspace) * scale[i]
    tangent_product(instant, workspace, 1.0, 0.0, noise)
    for i in range(n):
        noise[i] = NO_ACCELERATION * acceleration_level(workspace) * scale[i]
    tangent_product(instant, workspace, 0.0, 1.0, noise)
    for i in range(count):
        jerks[i] = 0.0
        for j in range(n):
            jerks[i] += abs(responses[i, j]) * sizes[j]
    for i in range(n):
        total[i] = sizes[i] = 0.0
    tangent_product(instant, workspace, 1.0, 0.0, vec(workspace.v, workspace.n_ext))
    tangent_product(instant, workspace, 0.0, 1.0, vec(workspace.a, workspace.n_ext))
    for i in range(count):
        jerk, size = 0.0, 0.0
        for j in range(n):
            jerk -= responses[i, j] * total[j]
            size += abs(responses[i, j]) * sizes[j]
        jerks[i] = 0.0 if abs(jerk) <= max(NO_JERK * size, jerks[i]) else jerk


@internal
def looks_again(drive: Any) -> int:
    """How often events have been handled at this instant, this time included."""
    return int(counts_at(drive.counts).here)
