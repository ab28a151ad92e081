"""Which of the touching contacts are at rest, and which slide, and where to: their rates tell.

What an instant finds out about the direction of sliding is kept as WAY.
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
from ..state.modes import CLOSED, IMPLIED, MEMORY_SIZE, OF_NORMAL
from ..state.modes import SLOW as SLOW_SLIDING
from ..state.run_records import call_accelerations
from ..state.workspace_records import OK
from .rates import read_all_rates, read_level
from .reading import largest_acceleration, unresolved_speed
from .records import (
    ACCELERATIONS,
    AT_REST,
    B_N,
    B_S,
    B_T,
    COS_WAY,
    COUNT,
    KNOWN,
    NO_FREE_ACCELERATIONS,
    NONE,
    RATE,
    READY,
    ROUNDING,
    SETTLED,
    SIN_WAY,
    SIZE,
    SLID,
    SLIDE_RATE,
    SLOW,
    SPIN,
    STATIC,
    STOPS,
    STRUCK,
    SWAY_RATE,
    WAS,
    col,
    real,
    whole,
)
from .spins import brake_by_spins, read_spins
from .three_tangents import size_of
from .touching import force_noise

ENDS_WITH = 2.0
"""Of the sliding speed that has no direction: with less where sliding ends, the contact has stopped."""


@internal
def _look(ev: Any, dr: Any, ws: Any) -> None:
    """Which contacts slide or spin, and where to: 1 in KNOWN, with COS_WAY and SIN_WAY; 0 where friction decides."""
    read_spins(ev, dr, ws)
    contacts, stopped = ivec(ev.contacts, ev.most), 0.0
    for i in range(whole(ev)[COUNT]):
        x, y, none = col(ev, SLIDE_RATE)[i], col(ev, SWAY_RATE)[i], max(col(ev, SLOW)[i], col(ev, ROUNDING)[i])
        speed, z = size_of(ev, i, col(ev, SLIDE_RATE), col(ev, SWAY_RATE)), col(ev, SPIN)[i]
        stood = z != 0.0 and col(ev, WAS)[i] == CLOSED and abs(col(ev, SLID)[i]) != 1.0
        if (stood or col(ev, STOPS)[i] != 0.0) and whole(ev)[STRUCK] == 0:
            # it has gone on in its direction to where error control does not resolve another; or it creeps
            none = max(none, ENDS_WITH * mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[contacts[i], SLOW_SLIDING])
            if not in_space(ws, contacts[i]) and col(ev, SLID)[i] * x >= -none:
                # its sliding velocity has come to zero, as finely as the time of that is known
                none = max(none, speed)
        slides = math.sqrt(speed * speed + z * z) > none and col(ev, STATIC)[i] > 0.0
        col(ev, KNOWN)[i] = 1.0 if slides else 0.0
        col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = (x / speed, y / speed) if slides and speed > 0.0 else (1.0, 0.0)
        if col(ev, STOPS)[i] != 0.0 and not slides:
            stopped = max(stopped, speed)
    # what moves no faster than a contact that stops has stopped with it, as finely as the time of that is known
    for i in range(whole(ev)[COUNT] if whole(ev)[STRUCK] == 0 else 0):
        speed = size_of(ev, i, col(ev, SLIDE_RATE), col(ev, SWAY_RATE))
        if col(ev, SPIN)[i] == 0.0 and speed <= ENDS_WITH * stopped:
            col(ev, KNOWN)[i], col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = 0.0, 1.0, 0.0
    brake_by_spins(ev, dr, ws)


@internal
def begin_rest(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Which contacts neither separate nor approach. `ACCELERATIONS` of the coordinates before, 1/s^2, are given."""
    count, at_rest, contacts = whole(ev)[COUNT], col(ev, AT_REST), ivec(ev.contacts, ev.most)
    # forces that were found to see whether contacts rest may have stopped some
    evaluate_residuals(ws)
    read_all_rates(ev, ws)
    _look(ev, dr, ws)
    slow, memory = whole(ev)[STRUCK] == 0, mat(ws.memory, ws.n_contacts, MEMORY_SIZE)
    for i in range(count):
        implied = ms.exact != 0 and np.int64(memory[contacts[i], IMPLIED]) & OF_NORMAL != 0
        held = whole(ev)[STRUCK] == 0 and col(ev, WAS)[i] == CLOSED and not implied
        at_rest[i] = 1.0 if held or abs(col(ev, RATE)[i]) <= col(ev, ROUNDING)[i] else 0.0
        slow = slow or abs(col(ev, RATE)[i]) <= PERHAPS_REST * rate_size(ws, contacts[i])
    whole(ev)[READY] = 0
    return find_free(ev, dr, ws, real(ev)[ACCELERATIONS]) if slow else SETTLED


@internal
def find_free(ev: Any, dr: Any, ws: Any, accelerations: float) -> int:
    """Free accelerations, with zero for what is rounding; gaps that open by less than can be seen are at rest."""
    count, n, scale = whole(ev)[COUNT], ws.n, vec(ws.scale, ws.n)
    if call_accelerations(dr.accelerations, ws) != OK:
        return NO_FREE_ACCELERATIONS
    read_level(ev, ws, vec(ws.phidd, ws.m_ext), col(ev, B_N), col(ev, B_T), col(ev, B_S))
    whole(ev)[READY] = 1
    none = NO_ACCELERATION * max(largest_acceleration(ws), accelerations, 1e-300)
    real(ev)[NONE] = none
    forces = force_noise(ev, ws)
    directions, responses = mat(ev.directions, 3 * count, n), mat(ev.responses, 3 * count, n)
    for i in range(3 * count):
        largest, noise, of = 0.0, 0.0, col(ev, B_N)
        for j in range(n):
            largest = max(largest, abs(directions[i, j]) * scale[j])
            noise += abs(responses[i, j]) * forces[j]
        if i < count:
            col(ev, SIZE)[i] = largest
        elif i < 2 * count:
            of = col(ev, B_T)
        else:
            of = col(ev, B_S)
        k = i % count
        of[k] = 0.0 if abs(of[k]) <= max(none * largest, noise) else of[k]
    for i in range(count):
        rate = col(ev, RATE)[i]
        if 0.0 < rate <= unresolved_speed(ws, ivec(ev.contacts, ev.most)[i], -col(ev, B_N)[i]):
            col(ev, AT_REST)[i] = 1.0
    return SETTLED
