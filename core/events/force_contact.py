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
from ..state.impact_law_codes import BY_FORCE
from ..state.modes import ACTIVE, OPEN, RELEASED, memories_at
from ..state.run_records import (
    CLOSE,
    FORCE_NUMBERS,
    OPENS,
    call_accelerations,
    clock_at,
    loop_at,
)
from ..state.workspace_records import OK, control_at
from .records import NO_ACCELERATIONS, SETTLED, call_part, delassus, scalars
from .report import report

HALVINGS = 50
"""Of the search for a static penetration."""


@internal
def settle_forces(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Let the forces of pending contacts begin and end at the current point; then the accelerations fit."""
    loop, law, pending = (
        loop_at(drive.loop),
        ivec(drive.law, workspace.n_contacts),
        ivec(drive.pending, workspace.n_contacts),
    )
    for k in range(workspace.n_contacts):
        if law[k] != BY_FORCE or pending[k] == 0:
            continue
        if memories_at(workspace.memory, workspace.n_contacts)[k].mode == OPEN:
            status = _begin(instant, drive, workspace, method, loop, k)
            if status != SETTLED:
                return status
        else:
            _end(drive, workspace, method, loop, k)
    status = call_part(instant.use_modes, instant, drive, workspace, method)
    if status != SETTLED:
        return int(status)
    if call_accelerations(drive.accelerations, workspace) != OK:
        return NO_ACCELERATIONS
    evaluate_residuals(workspace)
    return SETTLED


@internal
def _begin(instant: Any, drive: Any, workspace: Any, method: Any, loop: Any, k: int) -> int:
    memory, row = (
        memories_at(workspace.memory, workspace.n_contacts)[k],
        ivec(workspace.contact_rows, workspace.n_contacts)[k],
    )
    size, approach = vec(workspace.row_scale, workspace.m_ext)[row], -vec(workspace.phid, workspace.m_ext)[row]
    least = vec(drive.least_approach, workspace.n_contacts)[k]
    if least < 0.0:
        least = LEAST_APPROACH * control_at(workspace.control).rate_scale * size
    pressing, settling, mass = -vec(workspace.phidd, workspace.m_ext)[row], 0.0, 0.0
    if pressing > 0.0 or (approach < least and ivec(drive.by_approach, workspace.n_contacts)[k] != 0):
        ivec(instant.contacts, instant.most)[0], scalars(instant).count = k, 1
        status = call_part(instant.open_touching, instant, drive, workspace, method)
        if status != SETTLED:
            return int(status)
        mass = 1.0 / delassus(instant, 1)[0, 0]
        if pressing > 0.0:
            settling = _settling_speed(drive, workspace, k, pressing, mass, size)
    memory.approach_speed = max(approach, least, settling)
    laid = ivec(drive.by_approach, workspace.n_contacts)[k] != 0 and approach < memory.approach_speed
    memory.laid_mass = mass if laid else 0.0
    memory.mode = ACTIVE
    gap, early = (
        min(vec(workspace.phi, workspace.m_ext)[row], 0.0),
        ivec(drive.ends_early, workspace.n_contacts)[k] != 0,
    )
    if early and gap < 0.0 and _present(drive, workspace, k, -gap, approach)[0] < 0.0:
        # shapes that overlap and come apart so fast that it would pull from the first
        memory.mode = RELEASED
        return SETTLED
    memory.largest_approach = max(memory.largest_approach, approach)
    _let_bristles_go(drive, workspace, k)
    memory.begun_impulse, memory.begun_loss = _impulse(drive, workspace, k), _loss(drive, workspace, k)
    _start_small(loop, size, memory.approach_speed)
    report(drive, history_time(method, 0), CLOSE, k, 0.0, 0.0, approach, 0.0, 0.0, 0.0)
    return SETTLED


@internal
def _end(drive: Any, workspace: Any, method: Any, loop: Any, k: int) -> None:
    memory, row = (
        memories_at(workspace.memory, workspace.n_contacts)[k],
        ivec(workspace.contact_rows, workspace.n_contacts)[k],
    )
    gap, rate = vec(workspace.phi, workspace.m_ext)[row], vec(workspace.phid, workspace.m_ext)[row]
    apart = gap >= -GAP_ROUNDING * position_level(workspace) * vec(workspace.row_scale, workspace.m_ext)[row]
    if memory.mode == RELEASED:
        # either the shapes come apart, where the spring holds nothing against the damper, or the force is back at zero,
        # where it holds as much: while they still separate, if something pushes them together
        force, _, _, spring, _ = _present(drive, workspace, k, max(-gap, 0.0), -rate)
        if apart or (rate > 0.0 and force <= -0.5 * spring):
            memory.mode = OPEN
        else:
            # pressed again before the shapes came apart
            memory.mode = ACTIVE
            memory.loss_jump -= _at_rest(drive, workspace, k, max(-gap, 0.0))[4]
            _start_small(loop, vec(workspace.row_scale, workspace.m_ext)[row], memory.approach_speed)
        return
    early = ivec(drive.ends_early, workspace.n_contacts)[k] != 0 and not apart
    if early:
        # what the spring still holds when the force has reached zero is never given back
        memory.loss_jump += _at_rest(drive, workspace, k, max(-gap, 0.0))[4]
    memory.mode = RELEASED if early else OPEN
    _let_bristles_go(drive, workspace, k)
    impulse, loss = _impulse(drive, workspace, k) - memory.begun_impulse, _loss(drive, workspace, k) - memory.begun_loss
    report(drive, history_time(method, 0), OPENS, k, impulse, loss, memory.approach_speed, rate, 0.0, 0.0)


@internal
def _law(drive: Any, workspace: Any, k: int, penetration: float, rate: float, approach: float) -> Any:
    """(F, dF/d delta, dF/d delta_dot, elastic part, elastic energy) of contact k."""
    p = mat(drive.force_numbers, workspace.n_contacts, FORCE_NUMBERS)[k]
    return call_law(ivec(drive.force_law, workspace.n_contacts)[k], penetration, rate, approach, p[0], p[1], p[2], p[3])


@internal
def _present(drive: Any, workspace: Any, k: int, penetration: float, rate: float) -> Any:
    """The same with the approach speed that it has now (`shapes.normal2d.evaluate_law`)."""
    memory = memories_at(workspace.memory, workspace.n_contacts)[k]
    speed, mass = memory.approach_speed, memory.laid_mass
    if mass > 0.0:
        speed = max(speed, np.sqrt(2.0 * _at_rest(drive, workspace, k, penetration)[4] / mass))
    return _law(drive, workspace, k, penetration, rate, speed)


@internal
def _at_rest(drive: Any, workspace: Any, k: int, penetration: float) -> Any:
    """The same while nothing moves."""
    return _law(drive, workspace, k, penetration, 0.0, 1.0)


@internal
def _settling_speed(drive: Any, workspace: Any, k: int, pressing: float, mass: float, size: float) -> float:
    """Speed with which shapes that are laid on each other settle: sqrt(g d), with g the acceleration that presses them
    and d the static penetration under it, m/s.

    Laws that divide by the approach speed would hold a contact that begins without one like glue. 0 for a law whose
    spring holds nothing.
    """
    low, high, weight = 0.0, FIRST_PENETRATION * size, pressing * mass
    while _at_rest(drive, workspace, k, high)[3] < weight:
        low, high = high, 2.0 * high
        if high > DEEPEST * size:
            return 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _at_rest(drive, workspace, k, middle)[3] < weight:
            low = middle
        else:
            high = middle
    return float(np.sqrt(pressing * high))


@internal
def _let_bristles_go(drive: Any, workspace: Any, k: int) -> None:
    """LuGre's bristles stand straight again; what they held is lost."""
    places, v = imat(drive.bristles, workspace.n_contacts, 2), vec(workspace.v, workspace.n_ext)
    held = 0.5 * vec(drive.bristle_stiffness, workspace.n_contacts)[k]
    for i in range(places[k, 0], places[k, 0] + places[k, 1]):
        memories_at(workspace.memory, workspace.n_contacts)[k].loss_jump += held * v[i] ** 2
        v[i] = 0.0


@internal
def _impulse(drive: Any, workspace: Any, k: int) -> float:
    """Of contact k so far, N s."""
    return float(vec(workspace.v, workspace.n_ext)[ivec(drive.impulse_account, workspace.n_contacts)[k]])


@internal
def _loss(drive: Any, workspace: Any, k: int) -> float:
    """Dissipation of contact k so far, J."""
    dissipated = vec(workspace.v, workspace.n_ext)[ivec(drive.dissipation_account, workspace.n_contacts)[k]]
    return float(dissipated + memories_at(workspace.memory, workspace.n_contacts)[k].loss_jump)


@internal
def _start_small(loop: Any, size: float, speed: float) -> None:
    """Begin with a step in which the gap closes by FIRST_TOUCH of its size, so that the error control sees the force
    grow: a step over the whole contact would find no force at its stages."""
    clock = clock_at(loop.clock)
    clock.step_size = min(clock.step_size, FIRST_TOUCH * size / speed)
