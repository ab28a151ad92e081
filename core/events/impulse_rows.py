"""The rows of a step of impulses: of each touching contact its normal, its tangents and the axes that it may turn
about."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import imat, ivec, mat, vec
from ..contact_solvers.contact_blocks import blocks_at, pack_contacts
from ..contact_solvers.row_sweeps import along, list_columns
from ..state.modes import GAP_START, MEMORY_SIZE, PUSHED
from ..state.run_records import loop_at
from .rates import masses
from .records import (
    ALONE,
    COUNT,
    GAP,
    LARGEST,
    RATE,
    SETTLED,
    SLIDE_RATE,
    SWAY_RATE,
    TURNS,
    call_part,
    clear,
    col,
    real,
    whole,
)
from .turning_rows import TURNING_ROWS, find_turning_rows
from .zeno import near_level

INVERSE, TAKES, BEFORE, OFF, P, ARM = range(6)
"""Of each row: its inverse mass, the same or 0 where it takes no impulse, its rate before, that without impulses less
what is wanted, its impulse, and how far that may go, in parts of the normal one."""
ROW_NUMBERS = 6
ROW_ROOM = ROW_NUMBERS + 3
"""Numbers of each row, with those that `press_apart` works with."""


@internal
def part(ev: Any, rows: int, k: int) -> Any:
    """One of the `ROW_NUMBERS` of each row."""
    return vec(ev.sweeps + 8 * rows * k, rows)


@internal
def room(ev: Any, rows: int, n: int) -> Any:
    """To work in."""
    return vec(ev.sweeps + 8 * rows * ROW_NUMBERS, 3 * rows + 2 * n)


@internal
def rows_of(ev: Any, ws: Any) -> int:
    """How many there are."""
    turns = TURNING_ROWS if whole(ev)[TURNS] != 0 else 0
    return int((3 + turns) * whole(ev)[COUNT])


@internal
def open_rows(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Open the touching contacts, and find what impulses at them, and torques against turning, do to the motion."""
    count, contacts = whole(ev)[COUNT], ivec(ev.contacts, ev.most)
    whole(ev)[ALONE] = 1
    status = call_part(ev.open_touching, ev, dr, ws, ms)
    whole(ev)[ALONE] = 0
    if status != SETTLED:
        return int(status)
    for i in range(count):
        mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[contacts[i], GAP_START] = 0.0
    rows = rows_of(ev, ws)
    arms = part(ev, rows, ARM)
    for r in range(count, 3 * count):
        arms[r] = vec(dr.friction, ws.n_contacts)[contacts[r % count]]
    if rows > 3 * count:
        find_turning_rows(ev, ws, loop_at(dr.loop), 3 * count, arms)
    n, directions, responses = ws.n, mat(ev.directions, rows, ws.n), mat(ev.responses, rows, ws.n)
    list_columns(rows, n, directions, responses, ev.columns)
    wholes, reals = blocks_at(ev.block_wholes, ev.block_reals, ev.most, n)
    pack_contacts(
        count, n, rows, directions, responses, imat(ev.columns, rows, n + 1),
        imat(ev.columns + 8 * rows * (n + 1), rows, n + 1), wholes, reals,
    )  # fmt: skip
    return SETTLED


@internal
def prepare_rows(ev: Any, ws: Any, h: float) -> None:
    """Inverse masses and rates, and the impulses to begin with: most likely those of the last step, with the motion
    that they cause in `bounced` (n,)."""
    count, rows, n, v = whole(ev)[COUNT], rows_of(ev, ws), ws.n, vec(ws.v, ws.n_ext)
    directions, responses = mat(ev.directions, rows, n), mat(ev.responses, rows, n)
    contacts, memory, x = ivec(ev.contacts, ev.most), mat(ws.memory, ws.n_contacts, MEMORY_SIZE), vec(ev.bounced, n)
    inverse, takes, rate, p = part(ev, rows, INVERSE), part(ev, rows, TAKES), part(ev, rows, BEFORE), part(ev, rows, P)
    scale, contact_rows = vec(ws.row_scale, ws.m_ext), ivec(ws.contact_rows, ws.n_contacts)
    level, largest = near_level(ws, h), 0.0
    clear(x, n)
    for r in range(rows):
        i, block = r % count, r // count
        k = contacts[i]
        if block == 0:
            rate[r] = col(ev, RATE)[i]
        elif block == 1:
            rate[r] = col(ev, SLIDE_RATE)[i]
        elif block == 2:
            rate[r] = col(ev, SWAY_RATE)[i]
        else:
            rate[r] = along(r, n, rows, ev.columns, directions, v)
        inverse[r] = p[r] = 0.0
        if block > 2 or _moves(ev, ws, count, r):
            inverse[r] = along(r, n, rows, ev.columns, directions, responses[r])
        # what is near, but does not touch, stands here to be kept from overlapping
        takes[r] = inverse[r] if col(ev, GAP)[i] <= level * scale[contact_rows[k]] else 0.0
        if takes[r] > 0.0:
            largest = max(largest, abs(rate[r]))
            p[r] = h * memory[k, PUSHED + block]
            for j in range(n):
                x[j] += p[r] * responses[r, j]
        part(ev, rows, OFF)[r] = rate[r]
    real(ev)[LARGEST] = largest


@internal
def _moves(ev: Any, ws: Any, count: int, r: int) -> bool:
    """False for a tangent without friction, or that joints hold."""
    return bool(masses(ev, count)[r, r] > 0.0)
