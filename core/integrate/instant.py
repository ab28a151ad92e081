"""An instant with events, compiled: impacts after which the shapes part again, the greater part of all events.

What else can happen at an instant (`contact/machine.py`) is left to Python: `settle` declines it and changes nothing.
Formulas: `contact/impact.py`, `contact/touching.py`.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contact.complementarity import IMMOVABLE
from ..contact.modes import (
    APPROACH_SPEED,
    CLOSED,
    IMPULSE_JUMP,
    LARGEST_APPROACH,
    LOSS_JUMP,
    MEMORY_SIZE,
    MODE,
    OPEN,
    RATIO,
    SLIDE,
    STICKS,
)
from ..contact.progress import AT_ONCE, COUNT, GUARD_SIZE, IN_A_ROW, SINCE, STANDSTILL, START
from ..contact.sweeps import one_contact
from ..linalg import factor, lu_at, solve
from ..methods.history import history_time, recall, restart
from ..rounding import GAP_ROUNDING, RATE_ROUNDING, UNRESOLVED
from ..system.evaluate import evaluate_energy, evaluate_power, evaluate_residuals, evaluate_tangent
from ..system.levels import position_level, rate_level
from ..system.records import FACTOR_AGE, OK, RATE_SIZE
from .records import (
    COUNTS_SIZE,
    EVENT_ROWS,
    EVENT_SIZE,
    EVENTS,
    GOALS_SIZE,
    GRAZE,
    HANDLED,
    HANDLED_AT,
    HERE,
    IMPACT,
    call_accelerations,
    call_sample,
)
from .watch import remember

OTHER, UNTOUCHED, NEWTON, POISSON = range(4)
"""How the impact of a contact is solved: by Python; not at all (force laws, contacts at massless ends)."""
GAIN = 1e-12
"""Of the kinetic energy: an impact that gains more is one to report."""


@internal
def _alone(dr: Any, ws: Any) -> int:
    """The contact that touches now, if it is one that is struck here and no other touches; else -1."""
    memory, law = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(dr.law, ws.n_contacts)
    pending, rows = ivec(dr.pending, ws.n_contacts), ivec(ws.contact_rows, ws.n_contacts)
    phi, level, found = vec(ws.phi, ws.m_ext), GAP_ROUNDING * position_level(ws), -1
    for k in range(ws.n_contacts):
        if memory[k, MODE] == CLOSED:
            return -1
        if law[k] == UNTOUCHED:
            if pending[k] != 0:
                return -1
        elif pending[k] != 0 or abs(phi[rows[k]]) <= level * vec(ws.row_scale, ws.m_ext)[rows[k]]:
            if found >= 0 or law[k] == OTHER:
                return -1
            found = k
    return found


@internal
def _gets_on(dr: Any, t: float) -> bool:
    """False if the guard against runs that events keep from going on would speak (`contact/progress.py`)."""
    goals, counts, guard = vec(dr.goals, GOALS_SIZE), ivec(dr.counts, COUNTS_SIZE), vec(dr.guard, GUARD_SIZE)
    if t == goals[HANDLED_AT] and counts[HERE] >= AT_ONCE:
        return False
    if guard[COUNT] < IN_A_ROW:
        return True
    return abs(t - guard[SINCE]) > STANDSTILL * abs(t - guard[START])


@internal
def _count(dr: Any, t: float) -> None:
    """One more instant."""
    goals, counts, guard = vec(dr.goals, GOALS_SIZE), ivec(dr.counts, COUNTS_SIZE), vec(dr.guard, GUARD_SIZE)
    counts[HERE] = counts[HERE] + 1 if t == goals[HANDLED_AT] else 1
    goals[HANDLED_AT] = t
    counts[HANDLED] += 1
    guard[COUNT] += 1.0
    if guard[COUNT] > IN_A_ROW:
        guard[SINCE], guard[COUNT] = t, 0.0


@internal
def _direction(dr: Any, ws: Any, row: int, response: Any) -> float:
    """Inverse effective mass of the gap (or sliding distance) in this row of Phi, 1/kg: its gradient goes to
    `gradient`, and the motion that a unit impulse along it causes to `response`."""
    gradient, values = vec(dr.gradient, ws.n), vec(ws.values, ws.n_values)
    start = ivec(ws.gradient_start, ws.m_ext)
    for i in range(ws.n):
        gradient[i] = 0.0
    for e in range(start[row], start[row + 1]):
        gradient[ivec(ws.gradient_col, e + 1)[e]] = values[ivec(ws.gradient_slot, e + 1)[e]]
    rhs = vec(ws.rhs, ws.n + ws.m_act)
    for i in range(ws.n):
        rhs[i] = gradient[i]
    for i in range(ws.m_act):
        rhs[ws.n + i] = 0.0
    solve(lu_at(ws.kkt_query), ws.rhs)
    inverse = 0.0
    for i in range(ws.n):
        response[i] = rhs[i]
        inverse += gradient[i] * rhs[i]
    return inverse


@internal
def _movable(dr: Any, ws: Any, inverse: float) -> bool:
    """True if joints and drivers surely let the contact move whose `gradient` this is."""
    gradient, values = vec(dr.gradient, ws.n), vec(ws.values, ws.n_values)
    slots, length, of_mass = ivec(ws.mass_slot, ws.n_mass), 0.0, 0.0
    for i in range(ws.n):
        length += gradient[i] * gradient[i]
    for i in range(ws.n_mass):
        row, col = ivec(ws.entry_row, slots[i] + 1)[slots[i]], ivec(ws.entry_col, slots[i] + 1)[slots[i]]
        of_mass += gradient[row] * values[slots[i]] * gradient[col]
    # without joints it is at least this (Cauchy and Schwarz)
    return of_mass > 0.0 and inverse > IMMOVABLE * length * length / of_mass


@internal
def _report(
    dr: Any, t: float, kind: int, k: int, impulse: float, loss: float, approach: float, separation: float,
    residual: float, friction: float,
) -> None:  # fmt: skip
    """An event goes to the ring."""
    counts = ivec(dr.counts, COUNTS_SIZE)
    row = mat(dr.events, EVENT_ROWS, EVENT_SIZE)[counts[EVENTS]]
    counts[EVENTS] += 1
    row[0], row[1], row[2], row[3], row[4] = t, kind, k, impulse, loss
    row[5], row[6], row[7], row[8] = approach, separation, residual, friction


@internal
def begin_anew(ws: Any, ms: Any, lc: Any) -> None:
    """A history that begins at the current point, whose accelerations are known."""
    a, aux = vec(ws.a, ws.n_ext), vec(ws.aux, ws.n_ext)
    evaluate_power(ws)
    for i in range(ws.n_ext):
        aux[i] = a[i]
    vec(ws.rate, RATE_SIZE)[FACTOR_AGE] = -1.0
    evaluate_residuals(ws)
    restart(ws, ms)
    remember(ws, lc)


@internal
def settle(dr: Any, ws: Any, ms: Any, lc: Any) -> bool:
    """Let the pending events happen at the newest row, if that is the impact of one contact that bounces back; False,
    with nothing changed, if it is anything else."""
    t = history_time(ms, 0)
    room = lc.capacity == 0 or ivec(lc.cursor, 1)[0] < lc.capacity
    if not room or ivec(dr.counts, COUNTS_SIZE)[EVENTS] >= EVENT_ROWS or not _gets_on(dr, t):
        return False
    # samples may have been asked for since the step that ended here
    recall(ws, ms, 0)
    evaluate_residuals(ws)
    k = _alone(dr, ws)
    if k < 0:
        return False
    row, slide = ivec(ws.contact_rows, ws.n_contacts)[k], ivec(ws.contact_slide_rows, ws.n_contacts)[k]
    memory, law = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k], ivec(dr.law, ws.n_contacts)[k]
    mu, restitution = vec(dr.friction, ws.n_contacts)[k], vec(dr.restitution, ws.n_contacts)[k]
    v, velocities, phid = vec(ws.v, ws.n_ext), vec(dr.velocities, ws.n_ext), vec(ws.phid, ws.m_ext)
    size = vec(ws.row_scale, ws.m_ext)[row]
    if slide >= 0:
        size = max(size, vec(ws.row_scale, ws.m_ext)[slide])
    rounding = RATE_ROUNDING * rate_level(ws) * size
    approach, along, falls = -phid[row], phid[slide] if slide >= 0 else 0.0, -vec(ws.phidd, ws.m_ext)[row]
    along = along if abs(along) > rounding else 0.0
    if approach <= rounding or restitution == 0.0 or (law == POISSON and mu > 0.0):
        return False
    active, joint_rates = ivec(ws.active, ws.m_act), vec(dr.joint_rates, ws.m_act)
    for i in range(ws.m_act):
        joint_rates[i] = phid[active[i]]
    if not _strike(dr, ws, ms, k, row, slide, mu, restitution, approach, along, falls, rounding):
        for i in range(ws.n_ext):
            v[i] = velocities[i]
        memory[MODE] = OPEN
        recall(ws, ms, 0)
        evaluate_residuals(ws)
        return False
    _count(dr, t)
    begin_anew(ws, ms, lc)
    pending = ivec(dr.pending, ws.n_contacts)
    for i in range(ws.n_contacts):
        pending[i] = 0
    if lc.capacity > 0:
        cursor = ivec(lc.cursor, 1)
        call_sample(dr.write_sample, ws, mat(lc.samples, lc.capacity, lc.sample_length)[cursor[0]])
        cursor[0] += 1
    return True


@internal
def _strike(
    dr: Any, ws: Any, ms: Any, k: int, row: int, slide: int, mu: float, restitution: float, approach: float,
    along: float, falls: float, rounding: float,
) -> bool:  # fmt: skip
    """The impact of contact k, with the accelerations after it; False if it is not one that bounces back."""
    n, v, velocities = ws.n, vec(ws.v, ws.n_ext), vec(dr.velocities, ws.n_ext)
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    for i in range(ws.n_ext):
        velocities[i] = v[i]
    evaluate_energy(ws)
    kinetic = vec(ws.energy, 3)[0]
    # as a constraint that sticks, the contact says its gradients; no matrix holds them
    memory[MODE], memory[SLIDE], memory[RATIO] = CLOSED, STICKS, 0.0
    evaluate_tangent(ws, 0.0, 0.0)
    memory[MODE] = OPEN
    if factor(lu_at(ws.kkt_query), ws.values) != OK:
        return False
    response, sideways = vec(dr.response, n), vec(dr.sideways, n)
    a_tt = _direction(dr, ws, slide, sideways) if mu > 0.0 else 0.0
    a_nn = _direction(dr, ws, row, response)
    a_nt = 0.0
    if mu > 0.0:
        for i in range(n):
            a_nt += vec(dr.gradient, n)[i] * sideways[i]
    if not _movable(dr, ws, a_nn):
        return False
    normal, tangential = (1.0 + restitution) * approach / a_nn, 0.0
    if mu > 0.0:
        normal, tangential = one_contact(a_nn, a_nt, a_tt, -(1.0 + restitution) * approach, along, mu, 0.0, 0.0)
        if not normal > 0.0:
            return False
    for i in range(n):
        v[i] += normal * response[i]
        if mu > 0.0:
            v[i] += tangential * sideways[i]
    if call_accelerations(dr.accelerations, ws) != OK:
        return False
    phid = vec(ws.phid, ws.m_ext)
    separation, after = phid[row], phid[slide] if slide >= 0 else 0.0
    unresolved = UNRESOLVED * position_level(ws) * vec(ws.row_scale, ws.m_ext)[row]
    falls_after = -vec(ws.phidd, ws.m_ext)[row]
    # what opens by less than can be told from zero comes to rest
    if separation <= max(rounding, np.sqrt(2.0 * unresolved * max(falls_after, 0.0))):
        return False
    largest = max(memory[LARGEST_APPROACH], approach)
    lowest = max(vec(dr.rest_ratio, ws.n_contacts)[k] * largest, np.sqrt(2.0 * unresolved * max(falls, 0.0)))
    if separation <= lowest:
        return False
    loss = -0.5 * (normal * (separation - approach) + tangential * (along + after))
    if loss < -GAIN * max(kinetic, 1e-300):
        return False
    evaluate_energy(ws)
    if dr.input_account >= 0:
        v[dr.input_account] += vec(ws.energy, 3)[0] - kinetic + loss
    residual, active = abs(separation - restitution * approach), ivec(ws.active, ws.m_act)
    for i in range(ws.m_act):
        residual = max(residual, abs(phid[active[i]] - vec(dr.joint_rates, ws.m_act)[i]))
    memory[IMPULSE_JUMP] += normal
    memory[LOSS_JUMP] += loss
    memory[APPROACH_SPEED], memory[LARGEST_APPROACH] = approach, largest
    grazes = approach <= np.sqrt(2.0 * unresolved * max(-falls, 0.0))
    _report(
        dr, history_time(ms, 0), GRAZE if grazes else IMPACT, k, normal, loss, approach, separation, residual,
        tangential,
    )  # fmt: skip
    return True
