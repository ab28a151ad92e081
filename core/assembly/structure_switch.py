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
from ..compiled.views import ivec, mat, vec
from ..state.modes import (
    ACTIVE,
    AT_LIMIT,
    CLOSED,
    IMPLIED,
    MEMORY_SIZE,
    MODE,
    OF_FIRST,
    OF_NORMAL,
    OF_SECOND,
    SLIDE,
    STICKS,
)
from ..state.workspace_records import CONDITION, FACTOR_AGE, OK, RATE_SIZE, call_engage, partition_at, structure_at

APART, ENGAGED, HELD, STUCK, STUCK_TWICE = range(5)
"""A contact takes no part; its force has a place in the matrix; its gap is a constraint; its sliding distance too; in
space its sliding along both tangents."""
KINDS = 8
"""A code is one of these, plus KINDS times IMPLIED of the contact's memory."""
CODES = KINDS * (OF_NORMAL + OF_FIRST + OF_SECOND + 1)


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
        codes[row % count] += KINDS * (OF_NORMAL, OF_FIRST, OF_SECOND)[row // count]
    return codes


Key = tuple[frozenset[int], frozenset[int], frozenset[int], frozenset[int]]


def key_of(codes: NDArray[np.int64]) -> Key:
    """Contacts closed, engaged (closed or acting), sticking, and implied rows, as `codes_of` takes them."""
    closed, engaged, sticking, twice = (
        frozenset(int(k) for k in np.flatnonzero(codes % KINDS >= least))
        for least in (HELD, ENGAGED, STUCK, STUCK_TWICE)
    )
    count = len(codes)
    implied = {
        int(k) + of * count
        for of, bit in enumerate((OF_NORMAL, OF_FIRST, OF_SECOND))
        for k in np.flatnonzero(codes // KINDS & bit)
    }
    return closed, engaged, sticking | {k + count for k in twice}, frozenset(implied)


@internal
def want(ws: Any) -> None:
    """Ask for the structure of the contacts' present modes."""
    wanted, memory = ivec(ws.wanted, ws.n_contacts), mat(ws.memory, ws.n_contacts, MEMORY_SIZE)
    slides, seconds = ivec(ws.contact_slide_rows, ws.n_contacts), ivec(ws.contact_second_rows, ws.n_contacts)
    companion = ivec(ws.contact_companion, ws.n_contacts)
    for k in range(ws.n_contacts):
        mode = memory[k, MODE]
        wanted[k] = ENGAGED if mode == ACTIVE else APART
        if mode == CLOSED:
            wanted[k] = HELD
            if slides[k] >= 0 and memory[k, SLIDE] == STICKS:
                # (a companion's second tangent does not move)
                wanted[k] = STUCK if seconds[k] < 0 or companion[k] < 0 else STUCK_TWICE
            elif memory[k, SLIDE] == AT_LIMIT:
                wanted[k] = STUCK
            wanted[k] += KINDS * np.int64(memory[k, IMPLIED])


@internal
def take_structure(ws: Any, address: int) -> None:
    """Let the structure at `address` be the present one."""
    st = structure_at(address)
    ws.structure = address
    ws.n_values, ws.values = st.n_values, st.values
    ws.m_act, ws.active, ws.n_redundant, ws.redundant = st.m_act, st.active, st.n_redundant, st.redundant
    ws.m_held, ws.n_implied = st.m_held, st.n_implied
    ws.probe, ws.entry_row, ws.entry_col = st.probe, st.entry_row, st.entry_col
    ws.gradient_start, ws.gradient_col, ws.gradient_slot = st.gradient_start, st.gradient_col, st.gradient_slot
    ws.n_mass, ws.mass_slot, ws.kkt, ws.kkt_query = st.n_mass, st.mass_slot, st.kkt, st.kkt_query
    batches, slots = ivec(ws.batches, ws.n_kernels), ivec(st.slots, 4 * ws.n_kernels)
    for k in range(ws.n_kernels):
        batch = batch_at(batches[k])
        batch.slot_s, batch.slot_j, batch.slot_jt = slots[4 * k], slots[4 * k + 1], slots[4 * k + 2]
        batch.line = slots[4 * k + 3]
        batch.values, batch.n_values = st.values, st.n_values
    values = vec(st.values, st.n_values)
    for i in range(st.n_values):
        values[i] = 0.0
    # what is known of the matrices' factors and of the constraints' condition holds no more
    rate = vec(ws.rate, RATE_SIZE)
    rate[FACTOR_AGE] = -1.0
    for i in range(CONDITION, RATE_SIZE):
        rate[i] = 0.0
    if partition_at(st.partition).ready != 0:
        take_partition(ws, st.partition)


@internal
def take_partition(ws: Any, address: int) -> None:
    """Let the partition at `address` be that of the present structure."""
    pt = partition_at(address)
    ws.dependent, ws.lu_d, ws.lu_p = pt.dependent, pt.lu_d, pt.used_p
    ws.n_free, ws.free_row, ws.free_col, ws.free_slot = pt.n_free, pt.free_row, pt.free_col, pt.free_slot
    vec(ws.rate, RATE_SIZE)[FACTOR_AGE] = -1.0


@internal
def engage_modes(ws: Any) -> int:
    """Take the structure of the contacts' present modes: OK, or WANT_ROOM with the same structure as before."""
    want(ws)
    codes, wanted, same = ivec(structure_at(ws.structure).codes, ws.n_contacts), ivec(ws.wanted, ws.n_contacts), True
    for k in range(ws.n_contacts):
        same = same and codes[k] == wanted[k]
    return OK if same else int(call_engage(ws.engage, ws))
