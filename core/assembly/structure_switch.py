"""Compiled code takes another structure when contacts close, open, begin to slide or to stick.

A run keeps the structures that it has met last (`slots.py`), as records whose addresses the workspace knows. Which one
fits the modes of the contacts is found by comparing codes; one that is not there is built (`building.py`).
"""

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import internal
from ..compiled.kernels import batch_at
from ..compiled.views import ivec, vec
from ..state.modes import ACTIVE, AT_LIMIT, CLOSED, OF_FIRST, OF_NORMAL, OF_SECOND, STICKS, memories_at
from ..state.workspace_records import (
    OK,
    call_engage,
    convergence_at,
    partition_at,
    structure_at,
)

APART, ENGAGED, HELD, STUCK, STUCK_TWICE = range(5)
"""A contact takes no part; its force has a place in the matrix; its gap is a constraint; its sliding distance too; in
space its sliding along both tangents."""
STRUCTURE_KINDS = 8
"""A code is one of these, plus STRUCTURE_KINDS times `implied_rows` of the contact's memory."""
CODES = STRUCTURE_KINDS * (OF_NORMAL + OF_FIRST + OF_SECOND + 1)


def codes_of(
    count: int,
    closed: Collection[int],
    engaged: Collection[int],
    sticking: Collection[int],
    implied: Collection[int] = (),
) -> NDArray[np.int64]:
    """Codes of `count` contacts, (max(count, 1),); k + count in `sticking`: k sticks along its second tangent too;
    `implied`: k, k + count, k + 2 count where other constraints imply the row of its normal, first, second tangent."""
    codes = np.full(max(count, 1), APART, dtype=np.int64)
    first, second = [k for k in sticking if k < count], [k - count for k in sticking if k >= count]
    for contacts, code in ((engaged, ENGAGED), (closed, HELD), (first, STUCK), (second, STUCK_TWICE)):
        codes[list(contacts)] = code
    for row in implied:
        codes[row % count] += STRUCTURE_KINDS * (OF_NORMAL, OF_FIRST, OF_SECOND)[row // count]
    return codes


Key = tuple[frozenset[int], frozenset[int], frozenset[int], frozenset[int]]


def key_of(codes: NDArray[np.int64]) -> Key:
    """Contacts closed, engaged (closed or acting), sticking, and implied rows, as `codes_of` takes them."""
    closed, engaged, sticking, twice = (
        frozenset(int(k) for k in np.flatnonzero(codes % STRUCTURE_KINDS >= least))
        for least in (HELD, ENGAGED, STUCK, STUCK_TWICE)
    )
    count = len(codes)
    implied = {
        int(k) + of * count
        for of, bit in enumerate((OF_NORMAL, OF_FIRST, OF_SECOND))
        for k in np.flatnonzero(codes // STRUCTURE_KINDS & bit)
    }
    return closed, engaged, sticking | {k + count for k in twice}, frozenset(implied)


@internal
def want(workspace: Any) -> None:
    """Ask for the structure of the contacts' present modes."""
    wanted, memory = ivec(workspace.wanted, workspace.n_contacts), memories_at(workspace.memory, workspace.n_contacts)
    slides, seconds = (
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
        ivec(workspace.contact_second_rows, workspace.n_contacts),
    )
    companion = ivec(workspace.contact_companion, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        mode = memory[k].mode
        wanted[k] = ENGAGED if mode == ACTIVE else APART
        if mode == CLOSED:
            wanted[k] = HELD
            if slides[k] >= 0 and memory[k].slide_mode == STICKS:
                # (a companion's second tangent does not move)
                wanted[k] = STUCK if seconds[k] < 0 or companion[k] < 0 else STUCK_TWICE
            elif memory[k].slide_mode == AT_LIMIT:
                wanted[k] = STUCK
            wanted[k] += STRUCTURE_KINDS * np.int64(memory[k].implied_rows)


@internal
def take_structure(workspace: Any, address: int) -> None:
    """Let the structure at `address` be the present one."""
    structure = structure_at(address)
    workspace.structure = address
    workspace.n_values, workspace.values = structure.n_values, structure.values
    workspace.m_act, workspace.active, workspace.n_redundant, workspace.redundant = (
        structure.m_act,
        structure.active,
        structure.n_redundant,
        structure.redundant,
    )
    workspace.m_held, workspace.n_implied = structure.m_held, structure.n_implied
    workspace.probe, workspace.entry_row, workspace.entry_col = (
        structure.probe,
        structure.entry_row,
        structure.entry_col,
    )
    workspace.gradient_start, workspace.gradient_col, workspace.gradient_slot = (
        structure.gradient_start,
        structure.gradient_col,
        structure.gradient_slot,
    )
    workspace.n_mass, workspace.mass_slot, workspace.kkt, workspace.kkt_query = (
        structure.n_mass,
        structure.mass_slot,
        structure.kkt,
        structure.kkt_query,
    )
    batches, slots = ivec(workspace.batches, workspace.n_kernels), ivec(structure.slots, 4 * workspace.n_kernels)
    for k in range(workspace.n_kernels):
        batch = batch_at(batches[k])
        batch.slot_s, batch.slot_j, batch.slot_jt = slots[4 * k], slots[4 * k + 1], slots[4 * k + 2]
        batch.line = slots[4 * k + 3]
        batch.values, batch.n_values = structure.values, structure.n_values
    values = vec(structure.values, structure.n_values)
    for i in range(structure.n_values):
        values[i] = 0.0
    # what is known of the matrices' factors and of the constraints' condition holds no more
    rate = convergence_at(workspace.rate)
    rate.factor_age = -1.0
    rate.condition = rate.least_condition = rate.worst_condition = 0.0
    rate.choice_condition = rate.looked_condition = 0.0
    if partition_at(structure.partition).ready != 0:
        take_partition(workspace, structure.partition)


@internal
def take_partition(workspace: Any, address: int) -> None:
    """Let the partition at `address` be that of the present structure."""
    partition = partition_at(address)
    workspace.dependent, workspace.lu_d, workspace.lu_p = partition.dependent, partition.lu_d, partition.used_p
    workspace.n_free, workspace.free_row, workspace.free_col, workspace.free_slot = (
        partition.n_free,
        partition.free_row,
        partition.free_col,
        partition.free_slot,
    )
    convergence_at(workspace.rate).factor_age = -1.0


@internal
def engage_modes(workspace: Any) -> int:
    """Take the structure of the contacts' present modes: OK, or WANT_ROOM with the same structure as before."""
    want(workspace)
    codes, wanted, same = (
        ivec(structure_at(workspace.structure).codes, workspace.n_contacts),
        ivec(workspace.wanted, workspace.n_contacts),
        True,
    )
    for k in range(workspace.n_contacts):
        same = same and codes[k] == wanted[k]
    return OK if same else int(call_engage(workspace.engage, workspace))
