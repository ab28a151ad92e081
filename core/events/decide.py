"""What the touching constraint contacts do at an instant: impacts first, then which of them stay, stick or slide."""

import math
from typing import Any

from ..assembly.levels import rate_size
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contact_solvers.complementarity import MANY
from ..rounding import DIRECTION_RANK, UNSOLVED
from ..state.modes import IMPULSE_JUMP, LOSS_JUMP, MEMORY_SIZE, OPEN
from ..state.run_records import CLOCK_SIZE, CROWDED
from ..state.workspace_records import building_at
from .active_set import LOOSEST_RANK, RANK_OF_MANY
from .closing import choose
from .impact import impact
from .mode_switch import report_modes, take_modes
from .reading import largest_acceleration, read_before
from .records import (
    ACCELERATIONS,
    ALONE,
    COUNT,
    FIRMNESS,
    FIRST,
    FLAG,
    KINETIC,
    LEFT,
    MET_LOSS,
    NO_ACCELERATIONS,
    RANK,
    RATE,
    REPEATED_ROWS,
    RESTITUTION,
    RESTS,
    ROUNDING,
    SETTLED,
    SINGULAR_MATRIX,
    SLIDE_RATE,
    SLOW,
    STATIC,
    STOP_IMPULSE,
    STOP_LOSS,
    TOUCHED,
    TOUCHED_IN_SPACE,
    WANT_ROOM,
    WAS,
    call_part,
    col,
    real,
    whole,
)
from .residual_approach import take_away_left
from .touching import find_touching, looks_again, read_rates, read_values


@internal
def decide(ev: Any, dr: Any, ws: Any, ms: Any, lc: Any) -> int:
    """Impacts, forces, and what they mean."""
    if not find_touching(ev, dr, ws):
        return WANT_ROOM
    read_before(ev, dr, ws)
    read_values(ev, ws)
    whole(ev)[TOUCHED], real(ev)[MET_LOSS] = whole(ev)[COUNT], 0.0
    whole(ev)[TOUCHED_IN_SPACE] = 0
    for i in range(whole(ev)[COUNT]):
        whole(ev)[TOUCHED_IN_SPACE] += 1 if in_space(ws, ivec(ev.contacts, ev.most)[i]) else 0
    count, contacts, accelerations = whole(ev)[COUNT], ivec(ev.contacts, ev.most), largest_acceleration(ws)
    crowded = vec(lc.clock, CLOCK_SIZE)[CROWDED] != 0.0
    friction, static = vec(dr.friction, ws.n_contacts), vec(ws.contact_sticking, ws.n_contacts)
    compliance, rows = vec(building_at(ws.building).compliance, ws.m_ext), ivec(ws.contact_rows, ws.n_contacts)
    for i in range(count):
        k = contacts[i]
        col(ev, FIRMNESS)[i] = 1.0 / math.sqrt(compliance[rows[k]])
        col(ev, KINETIC)[i], col(ev, STATIC)[i] = friction[k], static[k]
        col(ev, RESTITUTION)[i] = vec(dr.restitution, ws.n_contacts)[k]
        col(ev, RESTS)[i] = col(ev, FIRST)[i] = col(ev, STOP_IMPULSE)[i] = col(ev, STOP_LOSS)[i] = 0.0
        col(ev, SLOW)[i] = vec(dr.rest_ratio, ws.n_contacts)[k] * rate_size(ws, k) if crowded else 0.0
    whole(ev)[ALONE] = 0
    status = call_part(ev.open_touching, ev, dr, ws, ms)
    if status != SETTLED:
        return status
    read_rates(ev, ws)
    if _approach(ev, ws, ms):
        status = impact(ev, dr, ws, ms)
        if status != SETTLED:
            return status
        for i in range(count):
            col(ev, ROUNDING)[i] *= max(1.0, 2.0 * real(ev)[LEFT])
        accelerations = 0.0
    real(ev)[ACCELERATIONS] = accelerations
    status = call_part(ev.begin_rest, ev, dr, ws, ms)
    if status == SETTLED:
        status = choose(ev, dr, ws, ms)
    if status != SETTLED:
        return status
    _account_stops(ev, ws)
    rank = DIRECTION_RANK if count <= MANY else RANK_OF_MANY
    real(ev)[RANK] = min(rank * 100.0 ** max(looks_again(dr) - 2, 0), LOOSEST_RANK)
    call_part(ev.keep, ev, dr, ws, ms)
    while True:
        status = take_modes(ev, dr, ws, ms)
        repeats = status == REPEATED_ROWS or status == SINGULAR_MATRIX or status == NO_ACCELERATIONS
        # contacts that each can be told from any other repeat each other together
        if not repeats or real(ev)[RANK] >= LOOSEST_RANK or not _any(ev, FLAG):
            break
        real(ev)[RANK] = min(100.0 * real(ev)[RANK], LOOSEST_RANK)
        call_part(ev.keep, ev, dr, ws, ms)
    if status == SETTLED:
        report_modes(ev, dr, ws, ms)
    return status


@internal
def _account_stops(ev: Any, ws: Any) -> None:
    """What stopped without a collision, to the contacts' memories."""
    memory, contacts = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(ev.contacts, ev.most)
    for i in range(whole(ev)[COUNT]):
        memory[contacts[i], IMPULSE_JUMP] += col(ev, STOP_IMPULSE)[i]
        memory[contacts[i], LOSS_JUMP] += col(ev, STOP_LOSS)[i]


@internal
def _any(ev: Any, k: int) -> bool:
    for i in range(whole(ev)[COUNT]):
        if col(ev, k)[i] != 0.0:
            return True
    return False


@internal
def _approach(ev: Any, ws: Any, ms: Any) -> bool:
    """True if a touching contact approaches by more than what rounding leaves."""
    count, rate, rounding, largest = whole(ev)[COUNT], col(ev, RATE), col(ev, ROUNDING), 0.0
    for i in range(count):
        largest = max(largest, abs(rate[i]), abs(col(ev, SLIDE_RATE)[i]))
    found, left = False, False
    for i in range(count):
        # what an impact of many leaves is no reason for another
        if count > MANY and -UNSOLVED * largest <= rate[i] < -rounding[i]:
            rounding[i], left = 2.0 * abs(rate[i]), True
        found = found or (rate[i] < -rounding[i] and (col(ev, WAS)[i] == OPEN or ms.exact != 0))
    if left and not found and ms.exact != 0:
        take_away_left(ev, ws)
    return found
