"""The rows of a step of impulses: of each touching contact its normal, its tangents and the axes that it may turn
about."""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..assembly.redundant_reactions import analyze_equations
from ..assembly.sticking_force import in_space
from ..assembly.structure_switch import engage_modes
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..contact_solvers.contact_blocks import WIDE, block_rates, coupling, move_block
from ..linalg.record import WANT_ROOM
from ..rounding import IMMOVABLE
from ..state.modes import CLOSED, OPEN, memories_at
from ..state.modes import STICKS as STUCK
from ..state.run_records import loop_at
from ..state.workspace_records import OK
from .rates import read_all_rates
from .records import SINGULAR_JOINTS, WANT_MEMORY, clear, scalars, touching
from .row_blocks import blocks_of, find_blocks
from .torques import resist_turning
from .touching import tell_touching
from .turning_rows import TURNING_ROWS
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
    count, contacts, loop = scalars(instant).count, ivec(instant.contacts, instant.most), loop_at(drive.loop)
    memory = memories_at(workspace.memory, workspace.n_contacts)
    for i in range(count):
        k = contacts[i]
        memory[k].mode, memory[k].slide_mode, memory[k].friction_ratio = OPEN, STUCK, 0.0
        memory[k].closed_gap = 0.0
        if in_space(workspace, k):
            # directions and rates are to speak of the same tangents
            memory[k].tangent_axis = 0.0
    if engage_modes(workspace) != OK:
        return WANT_MEMORY
    # the rows of those that slid or stuck now tell both velocities
    evaluate_residuals(workspace)
    resist_turning(instant, workspace, count)
    evaluate_tangent(workspace, 0.0, 0.0)
    read_all_rates(instant, workspace)
    code = analyze_equations(workspace, workspace.kkt_query)
    if code != OK:
        return WANT_MEMORY if code == WANT_ROOM else SINGULAR_JOINTS
    for i in range(count):
        memory[contacts[i]].mode = CLOSED
    tell_touching(instant, workspace, loop)
    rows = rows_of(instant, workspace)
    arms = part(instant, rows, ROW_ARM)
    for r in range(count, 3 * count):
        arms[r] = vec(drive.friction, workspace.n_contacts)[contacts[r % count]]
    status = int(find_blocks(instant, workspace, loop, arms))
    for i in range(count):
        memory[contacts[i]].mode = OPEN
    return status


@internal
def prepare_rows(instant: Any, workspace: Any, h: float) -> None:
    """Inverse masses and rates, and the impulses to begin with: most likely those of the last step, with the motion
    that they cause in `bounced` (n,)."""
    contact, memory = touching(instant), memories_at(workspace.memory, workspace.n_contacts)
    count, rows, n = scalars(instant).count, rows_of(instant, workspace), workspace.n
    contacts, v, x = ivec(instant.contacts, instant.most), vec(workspace.v, workspace.n_ext), vec(instant.bounced, n)
    inverse, takes, rate, off, p = (
        part(instant, rows, ROW_INVERSE),
        part(instant, rows, TAKES),
        part(instant, rows, BEFORE),
        part(instant, rows, OFF),
        part(instant, rows, P),
    )
    scale, contact_rows = vec(workspace.row_scale, workspace.m_ext), ivec(workspace.contact_rows, workspace.n_contacts)
    level, held = near_level(workspace, h), IMMOVABLE * _read_inverse_masses(instant, workspace, inverse)
    wholes, reals = blocks_of(instant)
    rates, steps, largest = np.zeros(WIDE), np.zeros(WIDE), 0.0
    clear(x, n)
    for i in range(count):
        k, of_turning = contacts[i], rows > 3 * count
        touches = contact[i].gap <= level * scale[contact_rows[k]]
        if of_turning:
            block_rates(i, count, wholes, reals, v, rates)
        rates[0], rates[1], rates[2] = contact[i].gap_rate, contact[i].sliding_rate, contact[i].sliding_rate2
        for block in range(rows // count):
            r = block * count + i
            rate[r] = off[r] = rates[block]
            if 0 < block < 3 and inverse[r] <= held:
                # a tangent without friction, or that joints hold
                inverse[r] = 0.0
            # what is near, but does not touch, stands here to be kept from overlapping
            takes[r] = inverse[r] if touches else 0.0
            p[r] = steps[block] = h * memory[k].step_force[block] if takes[r] > 0.0 else 0.0
            if takes[r] > 0.0:
                # (as in `sweep_contacts`)
                largest = max(largest, abs(rate[r]) * (np.sqrt(inverse[i] / inverse[r]) if block > 2 else 1.0))
        move_block(i, count, wholes, reals, steps, x)
    scalars(instant).largest_rate = largest


@internal
def _read_inverse_masses(instant: Any, workspace: Any, inverse: Any) -> float:
    """The rows' inverse masses; the largest one of a normal or a tangent."""
    count, rows, largest = scalars(instant).count, rows_of(instant, workspace), 0.0
    wholes, reals = blocks_of(instant)
    for r in range(rows):
        inverse[r] = coupling(r % count, count, wholes, reals, r // count)
        largest = max(largest, inverse[r] if r < 3 * count else 0.0)
    return largest
