"""Contacts that touch at one instant: their directions, and how an impulse at one moves the others.

A row of `responses` is M_b g^T of a direction g (a row of the gaps' or the sliding distances' Jacobian): the motion
that a unit impulse along it causes with the joints intact, from [M Phi_q^T; Phi_q 0] (x, mu) = (g^T, 0). Glocker 2001,
chapter 5; Pfeiffer and Glocker 1996, chapter 5.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..linalg.record import WANT_ROOM
from ..location.probe import can_look, gradient_alone, tell_gradients
from ..rounding import COORDINATE_NOISE, GAP_ROUNDING, IMMOVABLE, NO_ACCELERATION, NO_JERK, RATE_ROUNDING
from ..state.modes import CLOSED, GAP_START, MEMORY_SIZE, MODE, OPEN, RATIO, SLIDE, SLIDE_START, STICKS
from ..state.run_records import COUNTS_SIZE, HERE, call_accelerations, loop_at
from ..state.workspace_records import OK
from ..tables.compatibility import analyze_equations, solve_equations
from ..tables.evaluate import evaluate_energy, evaluate_tangent
from ..tables.levels import acceleration_level, position_level, rate_level
from ..tables.switch import engage_modes
from .laws import FORCE, MASSLESS
from .records import (
    ALONE,
    COUNT,
    GAP,
    IMMOVABLE_CONTACT,
    NO_FREE_ACCELERATIONS,
    RATE,
    SETTLED,
    SINGULAR_JOINTS,
    SLIDE_RATE,
    SLIDE_VALUE,
    STOP_IMPULSE,
    STOP_LOSS,
    WANT_MEMORY,
    WHO,
    clear,
    col,
    delassus,
    whole,
)


@internal
def find_touching(ev: Any, dr: Any, ws: Any, every: bool) -> bool:
    """Constraint contacts without a gap at the current point: closed ones, pending ones, and others that touch; `every`
    one, or those that are decided now. Those at massless ends are left out: they take no impulse. False if there is no
    room for them."""
    memory, law = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(dr.law, ws.n_contacts)
    pending, rows = ivec(dr.pending, ws.n_contacts), ivec(ws.contact_rows, ws.n_contacts)
    phi, scale, contacts = vec(ws.phi, ws.m_ext), vec(ws.row_scale, ws.m_ext), ivec(ev.contacts, ev.most)
    kinds = ivec(ws.contact_tangents, ws.n_contacts)
    level, count, asleep = GAP_ROUNDING * position_level(ws), 0, ivec(ws.asleep, ws.n_contacts)
    for k in range(ws.n_contacts):
        if law[k] == FORCE or law[k] == MASSLESS or asleep[k] != 0 or not (every or kinds[k] == ws.tangents):
            continue
        if pending[k] != 0 or memory[k, MODE] == CLOSED or abs(phi[rows[k]]) <= level * scale[rows[k]]:
            if count == ev.most:
                return False
            contacts[count] = k
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
def open_touching(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Open the touching contacts, and find how impulses at them move the others."""
    count, contacts = whole(ev)[COUNT], ivec(ev.contacts, ev.most)
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)
    for i in range(count):
        k = contacts[i]
        memory[k, MODE], memory[k, SLIDE], memory[k, RATIO] = OPEN, STICKS, 0.0
    if engage_modes(ws) != OK:
        return WANT_MEMORY
    # as constraints that stick, the contacts say their gradients; no matrix holds them
    for i in range(count):
        memory[contacts[i], MODE] = CLOSED
    lc = loop_at(dr.loop)
    tell_touching(ev, ws, lc)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    directions = mat(ev.directions, 2 * count, ws.n)
    for i in range(count):
        k = contacts[i]
        if can_look(lc, k):
            tell_gradients(ws, lc, k)
        find_gradient(ws, lc, k, rows[k], directions[i])
        if slides[k] >= 0:
            find_gradient(ws, lc, k, slides[k], directions[count + i])
        else:
            clear(directions[count + i], ws.n)
        memory[k, MODE] = OPEN
    evaluate_tangent(ws, 0.0, 0.0)
    # pivots of an earlier visit to this structure would be a state that no State holds
    code = analyze_equations(ws, ws.kkt_query)
    if code != OK:
        return WANT_MEMORY if code == WANT_ROOM else SINGULAR_JOINTS
    _respond(ev, ws, count, slides)
    return refuse_immovable(ev, ws, count)


@internal
def _respond(ev: Any, ws: Any, count: int, slides: Any) -> None:
    contacts, n = ivec(ev.contacts, ev.most), ws.n
    directions, responses, a = mat(ev.directions, 2 * count, n), mat(ev.responses, 2 * count, n), delassus(ev, count)
    rhs = vec(ws.rhs, n + ws.m_act)
    for i in range(2 * count):
        if i >= count and slides[contacts[i - count]] < 0:
            clear(responses[i], n)
            continue
        for j in range(n):
            rhs[j] = directions[i, j]
        for j in range(ws.m_act):
            rhs[n + j] = 0.0
        solve_equations(ws, ws.kkt_query)
        for j in range(n):
            responses[i, j] = rhs[j]
    alone = whole(ev)[ALONE] != 0
    for i in range(2 * count):
        for j in range(i if alone else 0, i + 1 if alone else 2 * count):
            product = 0.0
            for e in range(n):
                product += directions[i, e] * responses[j, e]
            a[i, j] = product
    for i in range(0 if alone else 2 * count):
        for j in range(i):
            a[i, j] = a[j, i] = 0.5 * (a[i, j] + a[j, i])


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
    directions, a, largest = mat(ev.directions, 2 * count, n), delassus(ev, count), 0.0
    for e in range(ws.n_mass):
        if entry_row[slots[e]] == entry_col[slots[e]]:
            largest = max(largest, values[slots[e]])
    for i in range(count):
        length, of_mass = 0.0, 0.0
        for j in range(n):
            length += directions[i, j] * directions[i, j]
        for e in range(ws.n_mass):
            s = slots[e]
            of_mass += directions[i, entry_row[s]] * values[s] * directions[i, entry_col[s]]
        # without joints it is at least this (Cauchy and Schwarz)
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
def push(ev: Any, ws: Any, normal: Any, tangential: Any) -> None:
    """Add the velocities that impulses in N s, one for each contact, cause to the current ones; the rates follow from
    the inverse masses."""
    count, v = whole(ev)[COUNT], vec(ws.v, ws.n_ext)
    responses, a, rate, slide_rate = (
        mat(ev.responses, 2 * count, ws.n), delassus(ev, count), col(ev, RATE), col(ev, SLIDE_RATE)
    )  # fmt: skip
    for i in range(2 * count):
        impulse = normal[i] if i < count else tangential[i - count]
        if impulse == 0.0:
            continue
        for j in range(ws.n):
            v[j] += impulse * responses[i, j]
        for j in range(count):
            rate[j] += impulse * a[j, i]
            slide_rate[j] += impulse * a[count + j, i]


@internal
def push_and_account(ev: Any, dr: Any, ws: Any, normal: Any, tangential: Any) -> None:
    """`push`, of contacts that do not collide: impulses and the energy that they take (half the impulse times the sum
    of the rates before and after it) are added to STOP_IMPULSE and STOP_LOSS, the rest to the work of inputs."""
    rate, slide_rate, loss = col(ev, RATE), col(ev, SLIDE_RATE), col(ev, STOP_LOSS)
    energy, lost = vec(ws.energy, 3), 0.0
    evaluate_energy(ws)
    before = energy[0]
    for i in range(whole(ev)[COUNT]):
        loss[i] -= 0.5 * (normal[i] * rate[i] + tangential[i] * slide_rate[i])
        lost -= 0.5 * (normal[i] * rate[i] + tangential[i] * slide_rate[i])
    push(ev, ws, normal, tangential)
    for i in range(whole(ev)[COUNT]):
        loss[i] -= 0.5 * (normal[i] * rate[i] + tangential[i] * slide_rate[i])
        lost -= 0.5 * (normal[i] * rate[i] + tangential[i] * slide_rate[i])
        col(ev, STOP_IMPULSE)[i] += normal[i]
    evaluate_energy(ws)
    if dr.input_account >= 0:
        vec(ws.v, ws.n_ext)[dr.input_account] += energy[0] - before + lost


@internal
def free_accelerations(ev: Any, dr: Any, ws: Any, of_gap: Any, of_slide: Any, ahead: float) -> int:
    """Accelerations of gaps and sliding distances without contact forces; as they are `ahead` seconds later if the
    velocities stay."""
    q, v = vec(ws.q, ws.n_ext), vec(ws.v, ws.n_ext)
    if ahead > 0.0:
        here = vec(ev.noise, ws.n)
        for i in range(ws.n):
            here[i] = q[i]
            q[i] += ahead * v[i]
        status = call_accelerations(dr.accelerations, ws)
        _read(ev, ws, vec(ws.phidd, ws.m_ext), of_gap, of_slide)
        for i in range(ws.n):
            q[i] = here[i]
        if status != OK or call_accelerations(dr.accelerations, ws) != OK:
            return NO_FREE_ACCELERATIONS
        return SETTLED
    if call_accelerations(dr.accelerations, ws) != OK:
        return NO_FREE_ACCELERATIONS
    _read(ev, ws, vec(ws.phidd, ws.m_ext), of_gap, of_slide)
    return SETTLED


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
