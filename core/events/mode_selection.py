"""What the touching constraint contacts do at an instant: impacts first, then which of them stay, stick or slide."""

import math
from typing import Any

from ..assembly.levels import rate_size
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..contact_solvers.complementarity import MANY
from ..rounding import DIRECTION_RANK, UNSOLVED
from ..state.modes import OPEN, memories_at
from ..state.run_records import clock_at
from ..state.workspace_records import building_at
from .active_set import choose
from .friction_rows import LOOSEST_RANK, RANK_OF_MANY
from .impact import impact
from .mode_switch import report_modes, take_modes
from .reading import largest_acceleration, read_before
from .records import (
    NO_ACCELERATIONS,
    OF_DECIDED,
    REPEATED_ROWS,
    SETTLED,
    SINGULAR_MATRIX,
    WANTS_ROOM,
    call_part,
    scalars,
    touching,
)
from .residual_approach import take_away_left
from .touching import find_touching, read_rates, read_values


@internal
def decide(instant: Any, drive: Any, workspace: Any, method: Any, loop: Any) -> int:
    """Impacts, forces, and what they mean."""
    contact = touching(instant)
    if not find_touching(instant, drive, workspace):
        return WANTS_ROOM
    if scalars(instant).count > instant.most_decided:
        scalars(instant).short_of = OF_DECIDED
        return WANTS_ROOM
    read_before(instant, drive, workspace)
    read_values(instant, workspace)
    scalars(instant).touched, scalars(instant).projection_loss = scalars(instant).count, 0.0
    scalars(instant).touched_in_space = 0
    for i in range(scalars(instant).count):
        scalars(instant).touched_in_space += 1 if in_space(workspace, ivec(instant.contacts, instant.most)[i]) else 0
    count, contacts, accelerations = (
        scalars(instant).count,
        ivec(instant.contacts, instant.most),
        largest_acceleration(workspace),
    )
    crowded = clock_at(loop.clock).crowded != 0.0
    friction, static = vec(drive.friction, workspace.n_contacts), vec(workspace.contact_sticking, workspace.n_contacts)
    compliance, rows = (
        vec(building_at(workspace.building).compliance, workspace.m_ext),
        ivec(workspace.contact_rows, workspace.n_contacts),
    )
    for i in range(count):
        k = contacts[i]
        contact[i].firmness = 1.0 / math.sqrt(compliance[rows[k]])
        contact[i].kinetic_friction, contact[i].static_friction = friction[k], static[k]
        contact[i].restitution = vec(drive.restitution, workspace.n_contacts)[k]
        contact[i].comes_to_rest = contact[i].stopping_impulse = contact[i].stopping_loss = 0.0
        contact[i].least_sliding_speed = (
            vec(drive.rest_ratio, workspace.n_contacts)[k] * rate_size(workspace, k) if crowded else 0.0
        )
    status = call_part(instant.open_touching, instant, drive, workspace, method)
    if status != SETTLED:
        return status
    read_rates(instant, workspace)
    if _approach(instant, workspace, method):
        status = impact(instant, drive, workspace, method)
        if status != SETTLED:
            return status
        for i in range(count):
            contact[i].rate_rounding *= max(1.0, 2.0 * scalars(instant).approach_left)
        accelerations = 0.0
    scalars(instant).acceleration_scale = accelerations
    status = call_part(instant.begin_rest, instant, drive, workspace, method)
    if status == SETTLED:
        status = choose(instant, drive, workspace, method)
    if status != SETTLED:
        return status
    _account_stops(instant, workspace)
    scalars(instant).rank_tolerance = DIRECTION_RANK if count <= MANY else RANK_OF_MANY
    call_part(instant.keep, instant, drive, workspace, method)
    while True:
        status = take_modes(instant, drive, workspace, method)
        repeats = status == REPEATED_ROWS or status == SINGULAR_MATRIX or status == NO_ACCELERATIONS
        # contacts that each can be told from any other repeat each other together
        if not repeats or scalars(instant).rank_tolerance >= LOOSEST_RANK or not _any_included(instant):
            break
        scalars(instant).rank_tolerance = min(100.0 * scalars(instant).rank_tolerance, LOOSEST_RANK)
        call_part(instant.keep, instant, drive, workspace, method)
    if status == SETTLED:
        report_modes(instant, drive, workspace, method)
    return status


@internal
def _account_stops(instant: Any, workspace: Any) -> None:
    """What stopped without a collision, to the contacts' memories."""
    memory, contacts = memories_at(workspace.memory, workspace.n_contacts), ivec(instant.contacts, instant.most)
    for i in range(scalars(instant).count):
        memory[contacts[i]].impulse_jump += touching(instant)[i].stopping_impulse
        memory[contacts[i]].loss_jump += touching(instant)[i].stopping_loss


@internal
def _any_included(instant: Any) -> bool:
    included = vec(instant.included, instant.most)
    for i in range(scalars(instant).count):
        if included[i] != 0.0:
            return True
    return False


@internal
def _approach(instant: Any, workspace: Any, method: Any) -> bool:
    """True if a touching contact approaches by more than what rounding leaves."""
    contact = touching(instant)
    count, rate, rounding, largest = scalars(instant).count, contact.gap_rate, contact.rate_rounding, 0.0
    for i in range(count):
        largest = max(largest, abs(rate[i]), abs(contact[i].sliding_rate))
    found, left = False, False
    for i in range(count):
        # what an impact of many leaves is no reason for another
        if count > MANY and -UNSOLVED * largest <= rate[i] < -rounding[i]:
            rounding[i], left = 2.0 * abs(rate[i]), True
        found = found or (rate[i] < -rounding[i] and (contact[i].mode_before == OPEN or method.exact != 0))
    if left and not found and method.exact != 0:
        take_away_left(instant, workspace)
    return found
