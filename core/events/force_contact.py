"""Contacts that act as forces: what their beginning and end do."""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals
from ..assembly.levels import position_level
from ..compiled.jit import internal
from ..compiled.views import imat, ivec, mat, vec
from ..laws import call_law
from ..methods.history import history_time
from ..rounding import DEEPEST, FIRST_PENETRATION, FIRST_TOUCH, GAP_ROUNDING, LEAST_APPROACH
from ..state.modes import (
    ACTIVE,
    APPROACH_SPEED,
    BEGUN_IMPULSE,
    BEGUN_LOSS,
    LAID_MASS,
    LARGEST_APPROACH,
    LOSS_JUMP,
    MEMORY_SIZE,
    MODE,
    OPEN,
    RELEASED,
)
from ..state.run_records import (
    CLOCK_SIZE,
    CLOSE,
    FORCE_NUMBERS,
    OPENS,
    STEP_SIZE,
    call_accelerations,
    loop_at,
)
from ..state.workspace_records import CONTROL_SIZE, OK, RATE_SCALE
from .laws import FORCE
from .records import COUNT, NO_ACCELERATIONS, SETTLED, call_part, delassus, whole
from .report import report

HALVINGS = 50
"""Of the search for a static penetration."""


@internal
def settle_forces(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Let the forces of pending contacts begin and end at the current point; then the accelerations fit."""
    lc, law, pending = loop_at(dr.loop), ivec(dr.law, ws.n_contacts), ivec(dr.pending, ws.n_contacts)
    for k in range(ws.n_contacts):
        if law[k] != FORCE or pending[k] == 0:
            continue
        if mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, MODE] == OPEN:
            status = _begin(ev, dr, ws, ms, lc, k)
            if status != SETTLED:
                return status
        else:
            _end(dr, ws, ms, lc, k)
    status = call_part(ev.use_modes, ev, dr, ws, ms)
    if status != SETTLED:
        return int(status)
    if call_accelerations(dr.accelerations, ws) != OK:
        return NO_ACCELERATIONS
    evaluate_residuals(ws)
    return SETTLED


@internal
def _begin(ev: Any, dr: Any, ws: Any, ms: Any, lc: Any, k: int) -> int:
    memory, row = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k], ivec(ws.contact_rows, ws.n_contacts)[k]
    size, approach = vec(ws.row_scale, ws.m_ext)[row], -vec(ws.phid, ws.m_ext)[row]
    least = vec(dr.least_approach, ws.n_contacts)[k]
    if least < 0.0:
        least = LEAST_APPROACH * vec(ws.control, CONTROL_SIZE)[RATE_SCALE] * size
    pressing, settling, mass = -vec(ws.phidd, ws.m_ext)[row], 0.0, 0.0
    if pressing > 0.0 or (approach < least and ivec(dr.by_approach, ws.n_contacts)[k] != 0):
        ivec(ev.contacts, ev.most)[0], whole(ev)[COUNT] = k, 1
        status = call_part(ev.open_touching, ev, dr, ws, ms)
        if status != SETTLED:
            return int(status)
        mass = 1.0 / delassus(ev, 1)[0, 0]
        if pressing > 0.0:
            settling = _settling_speed(dr, ws, k, pressing, mass, size)
    memory[APPROACH_SPEED] = max(approach, least, settling)
    laid = ivec(dr.by_approach, ws.n_contacts)[k] != 0 and approach < memory[APPROACH_SPEED]
    memory[LAID_MASS] = mass if laid else 0.0
    memory[MODE] = ACTIVE
    gap, early = min(vec(ws.phi, ws.m_ext)[row], 0.0), ivec(dr.ends_early, ws.n_contacts)[k] != 0
    if early and gap < 0.0 and _present(dr, ws, k, -gap, approach)[0] < 0.0:
        # shapes that overlap and come apart so fast that it would pull from the first
        memory[MODE] = RELEASED
        return SETTLED
    memory[LARGEST_APPROACH] = max(memory[LARGEST_APPROACH], approach)
    _let_bristles_go(dr, ws, k)
    memory[BEGUN_IMPULSE], memory[BEGUN_LOSS] = _impulse(dr, ws, k), _loss(dr, ws, k)
    _start_small(lc, size, memory[APPROACH_SPEED])
    report(dr, history_time(ms, 0), CLOSE, k, 0.0, 0.0, approach, 0.0, 0.0, 0.0)
    return SETTLED


@internal
def _end(dr: Any, ws: Any, ms: Any, lc: Any, k: int) -> None:
    memory, row = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k], ivec(ws.contact_rows, ws.n_contacts)[k]
    gap, rate = vec(ws.phi, ws.m_ext)[row], vec(ws.phid, ws.m_ext)[row]
    apart = gap >= -GAP_ROUNDING * position_level(ws) * vec(ws.row_scale, ws.m_ext)[row]
    if memory[MODE] == RELEASED:
        # either the shapes come apart, where the spring holds nothing against the damper, or the force is back at zero,
        # where it holds as much: while they still separate, if something pushes them together
        force, _, _, spring, _ = _present(dr, ws, k, max(-gap, 0.0), -rate)
        if apart or (rate > 0.0 and force <= -0.5 * spring):
            memory[MODE] = OPEN
        else:
            # pressed again before the shapes came apart
            memory[MODE] = ACTIVE
            memory[LOSS_JUMP] -= _at_rest(dr, ws, k, max(-gap, 0.0))[4]
            _start_small(lc, vec(ws.row_scale, ws.m_ext)[row], memory[APPROACH_SPEED])
        return
    early = ivec(dr.ends_early, ws.n_contacts)[k] != 0 and not apart
    if early:
        # what the spring still holds when the force has reached zero is never given back
        memory[LOSS_JUMP] += _at_rest(dr, ws, k, max(-gap, 0.0))[4]
    memory[MODE] = RELEASED if early else OPEN
    _let_bristles_go(dr, ws, k)
    impulse, loss = _impulse(dr, ws, k) - memory[BEGUN_IMPULSE], _loss(dr, ws, k) - memory[BEGUN_LOSS]
    report(dr, history_time(ms, 0), OPENS, k, impulse, loss, memory[APPROACH_SPEED], rate, 0.0, 0.0)


@internal
def _law(dr: Any, ws: Any, k: int, penetration: float, rate: float, approach: float) -> Any:
    """(F, dF/d delta, dF/d delta_dot, elastic part, elastic energy) of contact k."""
    p = mat(dr.force_numbers, ws.n_contacts, FORCE_NUMBERS)[k]
    return call_law(ivec(dr.force_law, ws.n_contacts)[k], penetration, rate, approach, p[0], p[1], p[2], p[3])


@internal
def _present(dr: Any, ws: Any, k: int, penetration: float, rate: float) -> Any:
    """The same with the approach speed that it has now (`shapes.normal2d.evaluate_law`)."""
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    speed, mass = memory[APPROACH_SPEED], memory[LAID_MASS]
    if mass > 0.0:
        speed = max(speed, np.sqrt(2.0 * _at_rest(dr, ws, k, penetration)[4] / mass))
    return _law(dr, ws, k, penetration, rate, speed)


@internal
def _at_rest(dr: Any, ws: Any, k: int, penetration: float) -> Any:
    """The same while nothing moves."""
    return _law(dr, ws, k, penetration, 0.0, 1.0)


@internal
def _settling_speed(dr: Any, ws: Any, k: int, pressing: float, mass: float, size: float) -> float:
    """Speed with which shapes that are laid on each other settle: sqrt(g d), with g the acceleration that presses them
    and d the static penetration under it, m/s.

    Laws that divide by the approach speed would hold a contact that begins without one like glue. 0 for a law whose
    spring holds nothing.
    """
    low, high, weight = 0.0, FIRST_PENETRATION * size, pressing * mass
    while _at_rest(dr, ws, k, high)[3] < weight:
        low, high = high, 2.0 * high
        if high > DEEPEST * size:
            return 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _at_rest(dr, ws, k, middle)[3] < weight:
            low = middle
        else:
            high = middle
    return float(np.sqrt(pressing * high))


@internal
def _let_bristles_go(dr: Any, ws: Any, k: int) -> None:
    """LuGre's bristles stand straight again; what they held is lost."""
    places, v = imat(dr.bristles, ws.n_contacts, 2), vec(ws.v, ws.n_ext)
    held = 0.5 * vec(dr.bristle_stiffness, ws.n_contacts)[k]
    for i in range(places[k, 0], places[k, 0] + places[k, 1]):
        mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, LOSS_JUMP] += held * v[i] ** 2
        v[i] = 0.0


@internal
def _impulse(dr: Any, ws: Any, k: int) -> float:
    """Of contact k so far, N s."""
    return float(vec(ws.v, ws.n_ext)[ivec(dr.impulse_account, ws.n_contacts)[k]])


@internal
def _loss(dr: Any, ws: Any, k: int) -> float:
    """Dissipation of contact k so far, J."""
    dissipated = vec(ws.v, ws.n_ext)[ivec(dr.dissipation_account, ws.n_contacts)[k]]
    return float(dissipated + mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, LOSS_JUMP])


@internal
def _start_small(lc: Any, size: float, speed: float) -> None:
    """Begin with a step in which the gap closes by FIRST_TOUCH of its size, so that the error control sees the force
    grow: a step over the whole contact would find no force at its stages."""
    clock = vec(lc.clock, CLOCK_SIZE)
    clock[STEP_SIZE] = min(clock[STEP_SIZE], FIRST_TOUCH * size / speed)
