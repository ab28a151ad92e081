"""The tables of a structure, written into its place (`building.py`)."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at
from ..linalg.analyze import lay_out, words_of
from .entries import write_tables


@internal
def write_structure(
    workspace: Any, b: Any, structure: Any, partition: Any, m_act: int, m_held: int, n_implied: int, n_sharing: int,
    left_out: int, nnz: int,
    total: int, n_mass: int, n_jacobian: int, kept: int, active: Any, row: Any, col: Any, order: Any, slot: Any,
    table: int, sharing_start: Any, sharing: Any, first: int,
) -> None:  # fmt: skip
    """Write the structure of the codes that are wanted: `active` are its rows, of the `kept` entries (`row`, `col`)
    each has a number in `order`, ascending, and a `slot`; its slot
    tables have `table` numbers. Row p of compatibility is of the multipliers `sharing`, from `sharing_start[p]` on;
    the entries of all are listed from `first` on."""
    full, at = b.n + m_act + n_implied, structure.words
    structure.n_values, structure.m_act, structure.n_redundant, structure.nnz = total + 1, m_act, left_out, nnz
    structure.m_held, structure.n_mass, structure.n_jacobian, structure.dropped = m_held, n_mass, n_jacobian, b.dropped
    structure.n_implied, structure.n_sharing = n_implied, n_sharing
    structure.codes, structure.active, structure.redundant = (
        at,
        at + 8 * b.n_contacts,
        at + 8 * (b.n_contacts + m_act + n_implied),
    )
    at += 8 * (b.n_contacts + m_act + n_implied + left_out)
    structure.sharing_start, structure.sharing_color = at, at + 8 * (n_implied + 1)
    structure.sharing = structure.sharing_color + 8 * n_implied
    structure.sharing_slot = structure.sharing + 8 * n_sharing
    at = structure.sharing_slot + 8 * n_sharing
    structure.entry_row, structure.entry_col, everything = at, at + 8 * nnz, at + 16 * nnz
    at += 24 * nnz
    structure.gradient_start, structure.gradient_col = at, at + 8 * b.m_ext
    structure.gradient_slot = structure.gradient_col + 8 * (total - nnz)
    at = structure.gradient_slot + 8 * (total - nnz)
    structure.mass_slot, structure.jacobian_start = at, at + 8 * n_mass
    at += 8 * (n_mass + m_act + 1)
    structure.jacobian_row, structure.jacobian_col = at, at + 8 * n_jacobian
    structure.jacobian_slot, tables = at + 16 * n_jacobian, at + 24 * n_jacobian
    at = tables + 8 * table
    codes, wanted = ivec(structure.codes, b.n_contacts), ivec(workspace.wanted, b.n_contacts)
    for k in range(b.n_contacts):
        codes[k] = wanted[k]
    own, redundant = ivec(structure.active, m_act + n_implied), ivec(structure.redundant, left_out)
    out, count = ivec(b.left_out, b.m_ext), 0
    for i in range(m_act + n_implied):
        own[i] = active[i]
    starts, places, slots = (
        ivec(structure.sharing_start, n_implied + 1),
        ivec(structure.sharing, n_sharing),
        ivec(structure.sharing_slot, n_sharing),
    )
    for p in range(n_implied + 1):
        starts[p] = sharing_start[p]
    for e in range(n_sharing):
        places[e], slots[e] = sharing[e], slot[first + e]
    for i in range(b.m):
        if out[i] != 0:
            redundant[count] = i
            count += 1
    _write_entries(b, structure, full, kept, row, col, order, slot)
    identity = ivec(everything, nnz)
    for e in range(nnz):
        identity[e] = e
    write_tables(workspace, b, structure, tables, total, row, slot)
    reals, many = structure.reals, words_of(full, nnz)
    structure.values, structure.probe = reals, reals + 8 * (total + 1)
    structure.compatibility = reals + 8 * (total + 1 + m_act)
    structure.sharing_kept = structure.compatibility + 8 * n_sharing
    reals += 8 * (total + 1 + m_act + 2 * n_sharing)
    probe = vec(structure.probe, m_act)
    for i in range(m_act):
        probe[i] = 0.0
    dense = full <= b.dense_limit
    lay_out(lu_at(structure.kkt), full, nnz, structure.entry_row, structure.entry_col, everything, dense, at, reals)
    at += 8 * many
    lay_out(
        lu_at(structure.kkt_query),
        full,
        nnz,
        structure.entry_row,
        structure.entry_col,
        everything,
        dense,
        at,
        reals + 24 * full,
    )
    at += 8 * many
    _give_units(b, structure)
    partition.ready, partition.words, partition.reals = 0, at, reals + 48 * full


@internal
def _write_entries(b: Any, structure: Any, full: int, kept: int, row: Any, col: Any, order: Any, slot: Any) -> None:
    n, nnz, m_act = b.n, structure.nnz, structure.m_act
    rows, cols = ivec(structure.entry_row, nnz), ivec(structure.entry_col, nnz)
    beyond = structure.n_values - 1 - nnz
    g_start, g_col, g_slot = (
        ivec(structure.gradient_start, b.m_ext),
        ivec(structure.gradient_col, beyond),
        ivec(structure.gradient_slot, beyond),
    )
    mass, start = ivec(structure.mass_slot, structure.n_mass), ivec(structure.jacobian_start, m_act + 1)
    j_row, j_col = (
        ivec(structure.jacobian_row, structure.n_jacobian),
        ivec(structure.jacobian_col, structure.n_jacobian),
    )
    j_slot = ivec(structure.jacobian_slot, structure.n_jacobian)
    for i in range(b.m_ext):
        g_start[i] = 0
    for i in range(m_act + 1):
        start[i] = 0
    masses, jacobian, last = 0, 0, -1
    for p in range(kept):
        e = order[p]
        k, i, j = slot[e], row[e], col[e]
        if k == last:
            continue
        last = k
        if i >= full:
            g_col[k - nnz], g_slot[k - nnz] = j, k
            g_start[i - full + 1] += 1
            continue
        rows[k], cols[k] = i, j
        if i < n and j < n:
            mass[masses] = k
            masses += 1
        elif j < n:
            j_row[jacobian], j_col[jacobian], j_slot[jacobian] = i - n, j, k
            jacobian += 1
            start[i - n + 1] += 1
    for i in range(b.m):
        g_start[i + 1] += g_start[i]
    for i in range(m_act):
        start[i + 1] += start[i]


@internal
def _give_units(b: Any, structure: Any) -> None:
    n, size, units = b.n, structure.m_act + structure.n_implied, vec(b.units, b.n + b.m_ext)
    active = ivec(structure.active, size)
    for address in (structure.kkt, structure.kkt_query):
        lu = lu_at(address)
        rows, cols = vec(lu.row_unit, n + size), vec(lu.col_unit, n + size)
        for i in range(n + size):
            rows[i] = cols[i] = units[i] if i < n else units[n + active[i - n]]
            if i >= n + structure.m_act:
                # rows of compatibility say something of multipliers, not of motion
                rows[i] = 1.0 / cols[i]
