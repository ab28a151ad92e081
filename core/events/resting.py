"""Which of the touching contacts are at rest, and which slide, and where to: their rates tell.

What an instant finds out about the direction of sliding is kept as `tangent_angle`.
"""

import math
from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals
from ..assembly.levels import rate_size
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..rounding import NO_ACCELERATION, PERHAPS_REST
from ..state.modes import CLOSED, OF_NORMAL, memories_at
from ..state.run_records import call_accelerations
from ..state.workspace_records import OK
from .rates import read_all_rates, read_level
from .reading import largest_acceleration, unresolved_speed
from .records import NO_FREE_ACCELERATIONS, SETTLED, scalars, touching
from .spins import brake_by_spins, read_spins
from .three_tangents import size_of
from .touching import force_noise

ENDS_WITH = 2.0
"""Of the sliding speed that has no direction: with less where sliding ends, the contact has stopped."""


@internal
def _look(instant: Any, drive: Any, workspace: Any) -> None:
    """Which contacts slide or spin, and where to: 1 in `known_direction`; 0 where friction
    decides."""
    contact = touching(instant)
    read_spins(instant, drive, workspace)
    contacts, stopped = ivec(instant.contacts, instant.most), 0.0
    for i in range(scalars(instant).count):
        x, y, none = (
            contact[i].sliding_rate,
            contact[i].sliding_rate2,
            max(contact[i].least_sliding_speed, contact[i].rate_rounding),
        )
        speed, z = size_of(instant, i, contact.sliding_rate, contact.sliding_rate2), contact[i].spin_rate
        stood = z != 0.0 and contact[i].mode_before == CLOSED and abs(contact[i].slide_mode_before) != 1.0
        if (stood or contact[i].stops != 0.0) and scalars(instant).struck == 0:
            # it has gone on in its direction to where error control does not resolve another; or it creeps
            none = max(none, ENDS_WITH * memories_at(workspace.memory, workspace.n_contacts)[contacts[i]].slow_sliding)
            if not in_space(workspace, contacts[i]) and contact[i].slide_mode_before * x >= -none:
                # its sliding velocity has come to zero, as finely as the time of that is known
                none = max(none, speed)
        slides = math.sqrt(speed * speed + z * z) > none and contact[i].static_friction > 0.0
        vec(instant.known_direction, instant.most)[i] = 1.0 if slides else 0.0
        contact[i].direction_cos, contact[i].direction_sin = (
            (x / speed, y / speed) if slides and speed > 0.0 else (1.0, 0.0)
        )
        if contact[i].stops != 0.0 and not slides:
            stopped = max(stopped, speed)
    # what moves no faster than a contact that stops has stopped with it, as finely as the time of that is known
    for i in range(scalars(instant).count if scalars(instant).struck == 0 else 0):
        speed = size_of(instant, i, contact.sliding_rate, contact.sliding_rate2)
        if contact[i].spin_rate == 0.0 and speed <= ENDS_WITH * stopped:
            vec(instant.known_direction, instant.most)[i], contact[i].direction_cos, contact[i].direction_sin = (
                0.0,
                1.0,
                0.0,
            )
    brake_by_spins(instant, drive, workspace)


@internal
def begin_rest(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Which contacts neither separate nor approach. `ACCELERATIONS` of the coordinates before, 1/s^2, are given."""
    contact = touching(instant)
    count, at_rest, contacts = (
        scalars(instant).count,
        vec(instant.at_rest, instant.most),
        ivec(instant.contacts, instant.most),
    )
    # forces that were found to see whether contacts rest may have stopped some
    evaluate_residuals(workspace)
    read_all_rates(instant, workspace)
    _look(instant, drive, workspace)
    slow, memory = scalars(instant).struck == 0, memories_at(workspace.memory, workspace.n_contacts)
    for i in range(count):
        implied = method.exact != 0 and np.int64(memory[contacts[i]].implied_rows) & OF_NORMAL != 0
        held = scalars(instant).struck == 0 and contact[i].mode_before == CLOSED and not implied
        at_rest[i] = 1.0 if held or abs(contact[i].gap_rate) <= contact[i].rate_rounding else 0.0
        slow = slow or abs(contact[i].gap_rate) <= PERHAPS_REST * rate_size(workspace, contacts[i])
    scalars(instant).accelerations_known = 0
    return find_free(instant, drive, workspace, scalars(instant).acceleration_scale) if slow else SETTLED


@internal
def find_free(instant: Any, drive: Any, workspace: Any, accelerations: float) -> int:
    """Free accelerations, with zero for what is rounding; gaps that open by less than can be seen are at rest."""
    contact = touching(instant)
    count, n, scale = scalars(instant).count, workspace.n, vec(workspace.scale, workspace.n)
    if call_accelerations(drive.accelerations, workspace) != OK:
        return NO_FREE_ACCELERATIONS
    read_level(
        instant,
        workspace,
        vec(workspace.phidd, workspace.m_ext),
        contact.free_gap_acceleration,
        contact.free_sliding_acceleration,
        contact.free_sliding_acceleration2,
    )
    scalars(instant).accelerations_known = 1
    none = NO_ACCELERATION * max(largest_acceleration(workspace), accelerations, 1e-300)
    scalars(instant).no_acceleration = none
    forces = force_noise(instant, workspace)
    directions, responses = mat(instant.directions, 3 * count, n), mat(instant.responses, 3 * count, n)
    for i in range(3 * count):
        largest, noise, of = 0.0, 0.0, contact.free_gap_acceleration
        for j in range(n):
            largest = max(largest, abs(directions[i, j]) * scale[j])
            noise += abs(responses[i, j]) * forces[j]
        if i < count:
            contact[i].gradient_size = largest
        elif i < 2 * count:
            of = contact.free_sliding_acceleration
        else:
            of = contact.free_sliding_acceleration2
        k = i % count
        of[k] = 0.0 if abs(of[k]) <= max(none * largest, noise) else of[k]
    for i in range(count):
        rate = contact[i].gap_rate
        if (
            0.0
            < rate
            <= unresolved_speed(workspace, ivec(instant.contacts, instant.most)[i], -contact[i].free_gap_acceleration)
        ):
            vec(instant.at_rest, instant.most)[i] = 1.0
    return SETTLED
