"""The rows of a step of impulses: of each touching contact its normal, its tangents and the axes that it may turn
about."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import imat, ivec, mat, vec
from ..contact_solvers.contact_blocks import blocks_at, pack_contacts
from ..contact_solvers.row_sweeps import along, list_columns
from ..state.modes import memories_at
from ..state.run_records import loop_at
from .rates import masses
from .records import SETTLED, call_part, clear, scalars, touching
from .turning_rows import TURNING_ROWS, find_turning_rows
from .zeno import near_level

ROW_INVERSE, TAKES, BEFORE, OFF, P, ROW_ARM = range(6)
"""Of each row: its inverse mass, the same or 0 where it takes no impulse, its rate before, that without impulses less
what is wanted, its impulse, and how far that may go, in parts of the normal one."""
ROW_NUMBERS = 6
ROW_ROOM = ROW_NUMBERS + 3
"""Numbers of each row, with those that `press_apart` works with."""


@internal
def part(instant: Any, rows: int, k: int) -> Any:
    """One of the `ROW_NUMBERS` of each row."""
    return vec(instant.sweeps + 8 * rows * k, rows)


@internal
def room(instant: Any, rows: int, n: int) -> Any:
    """To work in."""
    return vec(instant.sweeps + 8 * rows * ROW_NUMBERS, 3 * rows + 2 * n)


@internal
def rows_of(instant: Any, workspace: Any) -> int:
    """How many there are."""
    turns = TURNING_ROWS if scalars(instant).contact_torques != 0 else 0
    return int((3 + turns) * scalars(instant).count)


@internal
def open_rows(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Open the touching contacts, and find what impulses at them, and torques against turning, do to the motion."""
    count, contacts = scalars(instant).count, ivec(instant.contacts, instant.most)
    scalars(instant).diagonal_only = 1
    status = call_part(instant.open_touching, instant, drive, workspace, method)
    scalars(instant).diagonal_only = 0
    if status != SETTLED:
        return int(status)
    for i in range(count):
        memories_at(workspace.memory, workspace.n_contacts)[contacts[i]].closed_gap = 0.0
    rows = rows_of(instant, workspace)
    arms = part(instant, rows, ROW_ARM)
    for r in range(count, 3 * count):
        arms[r] = vec(drive.friction, workspace.n_contacts)[contacts[r % count]]
    if rows > 3 * count:
        find_turning_rows(instant, workspace, loop_at(drive.loop), 3 * count, arms)
    n, directions, responses = (
        workspace.n,
        mat(instant.directions, rows, workspace.n),
        mat(instant.responses, rows, workspace.n),
    )
    list_columns(rows, n, directions, responses, instant.columns)
    wholes, reals = blocks_at(instant.block_wholes, instant.block_reals, instant.most, n)
    pack_contacts(
        count, n, rows, directions, responses, imat(instant.columns, rows, n + 1),
        imat(instant.columns + 8 * rows * (n + 1), rows, n + 1), wholes, reals,
    )  # fmt: skip
    return SETTLED


@internal
def prepare_rows(instant: Any, workspace: Any, h: float) -> None:
    """Inverse masses and rates, and the impulses to begin with: most likely those of the last step, with the motion
    that they cause in `bounced` (n,)."""
    contact = touching(instant)
    count, rows, n, v = (
        scalars(instant).count,
        rows_of(instant, workspace),
        workspace.n,
        vec(workspace.v, workspace.n_ext),
    )
    directions, responses = mat(instant.directions, rows, n), mat(instant.responses, rows, n)
    contacts, memory, x = (
        ivec(instant.contacts, instant.most),
        memories_at(workspace.memory, workspace.n_contacts),
        vec(instant.bounced, n),
    )
    inverse, takes, rate, p = (
        part(instant, rows, ROW_INVERSE),
        part(instant, rows, TAKES),
        part(instant, rows, BEFORE),
        part(instant, rows, P),
    )
    scale, contact_rows = vec(workspace.row_scale, workspace.m_ext), ivec(workspace.contact_rows, workspace.n_contacts)
    level, largest = near_level(workspace, h), 0.0
    clear(x, n)
    for r in range(rows):
        i, block = r % count, r // count
        k = contacts[i]
        if block == 0:
            rate[r] = contact[i].gap_rate
        elif block == 1:
            rate[r] = contact[i].sliding_rate
        elif block == 2:
            rate[r] = contact[i].sliding_rate2
        else:
            rate[r] = along(r, n, rows, instant.columns, directions, v)
        inverse[r] = p[r] = 0.0
        if block > 2 or _moves(instant, workspace, count, r):
            inverse[r] = along(r, n, rows, instant.columns, directions, responses[r])
        # what is near, but does not touch, stands here to be kept from overlapping
        takes[r] = inverse[r] if contact[i].gap <= level * scale[contact_rows[k]] else 0.0
        if takes[r] > 0.0:
            largest = max(largest, abs(rate[r]))
            p[r] = h * memory[k].step_force[block]
            for j in range(n):
                x[j] += p[r] * responses[r, j]
        part(instant, rows, OFF)[r] = rate[r]
    scalars(instant).largest_rate = largest


@internal
def _moves(instant: Any, workspace: Any, count: int, r: int) -> bool:
    """False for a tangent without friction, or that joints hold."""
    return bool(masses(instant, count)[r, r] > 0.0)
