"""Partitions of the present structure, built by compiled code into its place.

With velocity-level rows W v = w there are two: dependent velocities, one for each row, from [Phi_q; W], and dependent
positions from Phi_q alone, the pivots of its rows, which come first. All other positions are integrated.
"""

from typing import Any

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at
from ..linalg.analyze import lay_out, words_of
from ..state.workspace_records import building_at, partition_at, structure_at
from .serials import next_serial, same_numbers
from .structure_switch import take_partition


@compiled
def partition_wanted(workspace: Any) -> None:
    """Take the partition with the dependent coordinates that are `wanted_dependent`, built if it is not the last one of
    the structure."""
    b, structure = building_at(workspace.building), structure_at(workspace.structure)
    partition, m_act = partition_at(structure.partition), structure.m_act
    if partition.ready == 0 or not same_numbers(partition.dependent, workspace.wanted_dependent, m_act):
        _build_partition(workspace, b, structure, partition)
    take_partition(workspace, structure.partition)


@internal
def _build_partition(workspace: Any, b: Any, structure: Any, partition: Any) -> None:
    n, m_act, count = b.n, structure.m_act, structure.n_jacobian
    position, at = ivec(ivec(b.scratch, 2)[0], n), partition.words
    partition.dependent, partition.free_row, partition.free_col = at, at + 8 * m_act, at + 8 * (m_act + count)
    partition.free_slot = at + 8 * (m_act + 2 * count)
    at += 8 * (m_act + 3 * count)
    rows, cols, slots = ivec(at, count), ivec(at + 8 * count, count), ivec(at + 16 * count, count)
    dependent, wanted = ivec(partition.dependent, m_act), ivec(workspace.wanted_dependent, m_act)
    for i in range(n):
        position[i] = -1
    for i in range(m_act):
        dependent[i] = wanted[i]
        position[wanted[i]] = i
    j_row, j_col, j_slot = (
        ivec(structure.jacobian_row, count),
        ivec(structure.jacobian_col, count),
        ivec(structure.jacobian_slot, count),
    )
    f_row, f_col, f_slot = (
        ivec(partition.free_row, count),
        ivec(partition.free_col, count),
        ivec(partition.free_slot, count),
    )
    free, bound = 0, 0
    for e in range(count):
        if position[j_col[e]] < 0:
            f_row[free], f_col[free], f_slot[free] = j_row[e], j_col[e], j_slot[e]
            free += 1
        else:
            rows[bound], cols[bound], slots[bound] = j_row[e], position[j_col[e]], j_slot[e]
            bound += 1
    partition.n_free, partition.ready, partition.serial = free, 1, next_serial(b)
    words, reals = at + 24 * count, partition.reals
    _lay_out_part(b, structure, partition.lu_d, m_act, bound, at, count, words, reals, wanted)
    words, reals = words + 8 * words_of(m_act, count), reals + 24 * m_act
    if b.two_partitions == 0 or structure.m_held == m_act:
        # one does for both
        lay_out(lu_at(partition.lu_p), 0, 0, at, at, at, True, words, reals)
        partition.used_p = partition.lu_d
        return
    # dependent positions alone: the rows with a position form, which come first
    partition.used_p = partition.lu_p
    some, held = 0, structure.m_held
    held_rows, held_cols = ivec(words, count), ivec(words + 8 * count, count)
    held_slots = ivec(words + 16 * count, count)
    for e in range(bound):
        if rows[e] < held and cols[e] < held:
            held_rows[some], held_cols[some], held_slots[some] = rows[e], cols[e], slots[e]
            some += 1
    _lay_out_part(b, structure, partition.lu_p, held, some, words, count, words + 24 * count, reals, wanted)


@internal
def _lay_out_part(
    b: Any,
    structure: Any,
    address: int,
    size: int,
    bound: int,
    at: int,
    count: int,
    words: int,
    reals: int,
    wanted: Any,
) -> None:
    """The factorisation at `address` of the first `size` rows in their dependent columns, whose entries are listed at
    `at`, `count` words apart."""
    lu = lu_at(address)
    lay_out(lu, size, bound, at, at + 8 * count, at + 16 * count, size <= b.dense_limit, words, reals)
    units, active = vec(b.units, b.n + b.m_ext), ivec(structure.active, structure.m_act)
    row_unit, col_unit = vec(lu.row_unit, size), vec(lu.col_unit, size)
    for i in range(size):
        row_unit[i], col_unit[i] = units[b.n + active[i]], units[wanted[i]]
