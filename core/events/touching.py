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
from ..state.modes import CLOSED, GAP_START, MEMORY_SIZE, MODE, SLIDE, SLIDE_START, STICKS
from ..state.run_records import COUNTS_SIZE, HERE
from .laws import FORCE, MASSLESS
from .records import (
    COMPANION,
    COUNT,
    GAP,
    IMMOVABLE_CONTACT,
    RATE,
    SETTLED,
    SLIDE_RATE,
    SLIDE_VALUE,
    WHO,
    col,
    delassus,
    whole,
)


@internal
def find_touching(ev: Any, dr: Any, ws: Any) -> bool:
    """Constraint contacts without a gap at the current point: closed ones, pending ones, and others that touch.
    Those at massless ends are left out: they take no impulse. False if there is no room for them."""
    memory, law = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(dr.law, ws.n_contacts)
    pending, rows = ivec(dr.pending, ws.n_contacts), ivec(ws.contact_rows, ws.n_contacts)
    phi, scale, contacts = vec(ws.phi, ws.m_ext), vec(ws.row_scale, ws.m_ext), ivec(ev.contacts, ev.most)
    level, count, sleeping = GAP_ROUNDING * position_level(ws), 0, ivec(ws.sleeping, ws.n_contacts)
    companion = ivec(ws.contact_companion, ws.n_contacts)
    for k in range(ws.n_contacts):
        if pending[k] != 0 and companion[k] != 0:
            pending[k + companion[k]] = 1
    for k in range(ws.n_contacts):
        if law[k] == FORCE or law[k] == MASSLESS or sleeping[k] != 0:
            continue
        if pending[k] != 0 or memory[k, MODE] == CLOSED or abs(phi[rows[k]]) <= level * scale[rows[k]]:
            if count == ev.most:
                return False
            contacts[count], col(ev, COMPANION)[count] = k, companion[k]
            count += 1
    whole(ev)[COUNT] = count
    return True


@internal
def tell_touching(ev: Any, ws: Any, lc: Any) -> None:
    """Where some of the touching contacts cannot be evaluated alone, evaluate all of them with the system."""
    contacts, alone = ivec(ev.contacts, ev.most), True
    for i in range(whole(ev)[COUNT]):
        alone = alone and can_look(lc, contacts[i])
    if not alone:
        evaluate_tangent(ws, 0.0, 0.0)


@internal
def find_gradient(ws: Any, lc: Any, k: int, row: int, out: Any) -> None:
    """Gradient (n,) of row `row`, one of contact k, after `tell_touching`, and `tell_gradients` where k can be
    evaluated alone."""
    if can_look(lc, k):
        gradient_alone(ws, lc, k, row, out)
        return
    start, values = ivec(ws.gradient_start, ws.m_ext), vec(ws.values, ws.n_values)
    for i in range(ws.n):
        out[i] = 0.0
    for e in range(start[row], start[row + 1]):
        out[ivec(ws.gradient_col, e + 1)[e]] = values[ivec(ws.gradient_slot, e + 1)[e]]


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
def refuse_immovable(ev: Any, ws: Any, count: int) -> int:
    """A contact whose shapes joints and drivers hold both takes no impulse."""
    n, values, slots = ws.n, vec(ws.values, ws.n_values), ivec(ws.mass_slot, ws.n_mass)
    entry_row, entry_col = ivec(ws.entry_row, ws.n_values), ivec(ws.entry_col, ws.n_values)
    directions, a, largest, scale = mat(ev.directions, 2 * count, n), delassus(ev, count), 0.0, vec(ws.scale, n)
    for e in range(ws.n_mass):
        i = entry_row[slots[e]]
        if i == entry_col[slots[e]]:
            largest = max(largest, values[slots[e]] * scale[i] ** 2)
    for i in range(count):
        length, of_mass = 0.0, 0.0
        for j in range(n):
            length += (scale[j] * directions[i, j]) ** 2
        for e in range(ws.n_mass):
            s, row, column = slots[e], entry_row[slots[e]], entry_col[slots[e]]
            sizes = (scale[row] * scale[column]) ** 2
            of_mass += sizes * directions[i, row] * values[s] * directions[i, column]
        # without joints it is at least this, (g . x)^2/(x . M x) for x = S^2 g with the scales S of the coordinates
        # (Cauchy and Schwarz); whatever the unit of length, what Euler parameters add along themselves is no more
        # (a frame without mass of its own counts as the heaviest)
        free = length * length / (of_mass if of_mass != 0.0 else largest * length)
        if not a[i, i] > IMMOVABLE * free:
            whole(ev)[WHO] = ivec(ev.contacts, ev.most)[i]
            return IMMOVABLE_CONTACT
    return SETTLED


@internal
def read_rates(ev: Any, ws: Any) -> None:
    """Rates of gaps and sliding distances, as the residuals have been evaluated last."""
    _read(ev, ws, vec(ws.phid, ws.m_ext), col(ev, RATE), col(ev, SLIDE_RATE))


@internal
def _read(ev: Any, ws: Any, level: Any, of_gap: Any, of_slide: Any) -> None:
    contacts = ivec(ev.contacts, ev.most)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    for i in range(whole(ev)[COUNT]):
        k = contacts[i]
        of_gap[i] = level[rows[k]]
        of_slide[i] = level[slides[k]] if slides[k] >= 0 else 0.0


@internal
def read_values(ev: Any, ws: Any) -> None:
    """Gaps (of closed contacts what rounding has left them) and sliding distances, m."""
    gaps, distances = col(ev, GAP), col(ev, SLIDE_VALUE)
    memory, contacts = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(ev.contacts, ev.most)
    _read(ev, ws, vec(ws.phi, ws.m_ext), gaps, distances)
    for i in range(whole(ev)[COUNT]):
        k = contacts[i]
        if memory[k, MODE] == CLOSED:
            gaps[i] += memory[k, GAP_START]
            distances[i] += memory[k, SLIDE_START] if memory[k, SLIDE] == STICKS else 0.0


@internal
def tangent_product(ev: Any, ws: Any, c_q: float, c_v: float, x: Any) -> None:
    """(c_v D + c_q K) x without the mass matrix goes to `sum`, that of the magnitudes of all terms to `terms`; both are
    added."""
    total, sizes = vec(ev.sum, ws.n), vec(ev.terms, ws.n)
    slots, values = ivec(ws.mass_slot, ws.n_mass), vec(ws.values, ws.n_values)
    entry_row, entry_col = ivec(ws.entry_row, ws.n_values), ivec(ws.entry_col, ws.n_values)
    evaluate_tangent(ws, c_q, c_v)
    with_motion = vec(ev.slots_work, ws.n_mass)
    for e in range(ws.n_mass):
        with_motion[e] = values[slots[e]]
    evaluate_tangent(ws, 0.0, 0.0)
    for e in range(ws.n_mass):
        s = slots[e]
        term = (with_motion[e] - values[s]) * x[entry_col[s]]
        total[entry_row[s]] += term
        sizes[entry_row[s]] += abs(term)


@internal
def force_noise(ev: Any, ws: Any) -> Any:
    """What rounding of the coordinates leaves in the forces (n,), N (`ContactSide.force_noise`)."""
    scale, q, noise = vec(ws.scale, ws.n), vec(ws.q, ws.n_ext), vec(ev.noise, ws.n)
    total, sizes, largest = vec(ev.sum, ws.n), vec(ev.terms, ws.n), 0.0
    for i in range(ws.n):
        largest = max(largest, abs(q[i]) / scale[i])
        total[i] = sizes[i] = 0.0
    for i in range(ws.n):
        noise[i] = COORDINATE_NOISE * largest * scale[i]
    tangent_product(ev, ws, 1.0, 0.0, noise)
    return sizes


@internal
def free_jerks(ev: Any, ws: Any, jerks: Any) -> None:
    """Rates of the gaps' free accelerations, m/s^3, as the forces' dependence on the motion makes them:
    M a' = -(K v + D a). What is not more than rounding, of the sum or of velocities and accelerations, is zero."""
    count, n, total, sizes = whole(ev)[COUNT], ws.n, vec(ev.sum, ws.n), vec(ev.terms, ws.n)
    responses, noise, scale = mat(ev.responses, 2 * count, n), vec(ev.noise, n), vec(ws.scale, n)
    for i in range(n):
        total[i] = sizes[i] = 0.0
        noise[i] = RATE_ROUNDING * rate_level(ws) * scale[i]
    tangent_product(ev, ws, 1.0, 0.0, noise)
    for i in range(n):
        noise[i] = NO_ACCELERATION * acceleration_level(ws) * scale[i]
    tangent_product(ev, ws, 0.0, 1.0, noise)
    for i in range(count):
        jerks[i] = 0.0
        for j in range(n):
            jerks[i] += abs(responses[i, j]) * sizes[j]
    for i in range(n):
        total[i] = sizes[i] = 0.0
    tangent_product(ev, ws, 1.0, 0.0, vec(ws.v, ws.n_ext))
    tangent_product(ev, ws, 0.0, 1.0, vec(ws.a, ws.n_ext))
    for i in range(count):
        jerk, size = 0.0, 0.0
        for j in range(n):
            jerk -= responses[i, j] * total[j]
            size += abs(responses[i, j]) * sizes[j]
        jerks[i] = 0.0 if abs(jerk) <= max(NO_JERK * size, jerks[i]) else jerk


@internal
def looks_again(dr: Any) -> int:
    """How often events have been handled at this instant, this time included."""
    return int(ivec(dr.counts, COUNTS_SIZE)[HERE])
