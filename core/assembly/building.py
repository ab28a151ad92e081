"""Structures, built by compiled code into memory that Python has given.

A structure is the pattern of the matrix [S, Phi_q^T; Phi_q, 0] for one set of closed, acting and sticking contacts:
slots of all entries, row by row and ascending in each, and behind them those of the gradients that are only `listed`
(`entries.py`). All of it follows from the codes of the contacts and the rows that are left out.
"""

from typing import Any

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec
from ..linalg import lu_at
from ..linalg.analyze import words_of
from ..linalg.record import INDEX, SCRATCH, VALUES
from ..state.workspace_records import OF_D, OF_KKT, OK, REALS, WANT_ROOM, WORDS, building_at, partition_at, structure_at
from .entries import list_entries, size_of_entries
from .redundant_reactions import begin_sharing, list_sharing
from .serials import next_serial, same_numbers
from .structure_switch import HELD, STRUCTURE_KINDS, STUCK, STUCK_TWICE, take_structure
from .structure_tables import write_structure


@compiled
def engage_wanted(workspace: Any) -> int:
    """Take the structure of the codes that are `wanted`, built if there is none: OK, or WANT_ROOM with nothing
    changed."""
    b = building_at(workspace.building)
    places = ivec(b.structures, b.n_slots)
    oldest, free = -1, 0
    for i in range(b.n_slots):
        structure = structure_at(places[i])
        if (
            structure.built != 0
            and structure.dropped == b.dropped
            and same_numbers(structure.codes, workspace.wanted, b.n_contacts)
        ):
            take_structure(workspace, places[i])
            structure.used = next_serial(b)
            return OK
        if places[i] == workspace.structure or places[i] == workspace.kept:
            continue
        age = structure.used if structure.built != 0 else -1
        if free == 0 or age < oldest:
            oldest, free = age, places[i]
    structure = structure_at(free)
    structure.built = 0
    status = _build(workspace, b, structure)
    if status == OK:
        structure.used = next_serial(b)
        take_structure(workspace, free)
    return int(status)


@internal
def _build(workspace: Any, b: Any, structure: Any) -> int:
    n, m, scratch, needs = b.n, b.m, ivec(b.scratch, 2), ivec(b.needs, 8)
    raw, table = size_of_entries(workspace, b)
    wide = n + 2 * m + 2
    size = 4 * (m + 1) + 5 * raw + wide
    if size > scratch[1]:
        needs[SCRATCH] = size
        return WANT_ROOM
    at = scratch[0]
    active, matrix_row = ivec(at, m + 1), ivec(at + 8 * (m + 1), m + 1)
    matrix_col, sharing_start = ivec(at + 16 * (m + 1), m + 1), ivec(at + 24 * (m + 1), m + 1)
    at += 32 * (m + 1)
    m_act, m_held, n_implied, left_out = _find_rows(workspace, b, active, matrix_row, matrix_col)
    n_sharing = list_sharing(workspace, b, m_act, n_implied, active, matrix_col, sharing_start, sharing_start, False)
    raw += n_sharing
    size += 6 * n_sharing
    if size > scratch[1]:
        needs[SCRATCH] = size
        return WANT_ROOM
    sharing = ivec(at, n_sharing)
    at += 8 * n_sharing
    row, col = ivec(at, raw), ivec(at + 8 * raw, raw)
    by_col, order, slot = ivec(at + 16 * raw, raw), ivec(at + 24 * raw, raw), ivec(at + 32 * raw, raw)
    count = ivec(at + 40 * raw, wide)
    list_sharing(workspace, b, m_act, n_implied, active, matrix_col, sharing_start, sharing, True)
    full = n + m_act + n_implied
    first = list_entries(workspace, b, matrix_row, matrix_col, row, col)
    for p in range(n_implied):
        for e in range(sharing_start[p], sharing_start[p + 1]):
            row[first + e], col[first + e] = n + m_act + p, n + sharing[e]
    kept = _sort(raw, full, full + m, row, col, by_col, order, count)
    # equal places share a slot
    total, nnz, n_mass, n_jacobian, last_row, last_col = 0, 0, 0, 0, -1, -1
    for p in range(kept):
        e = order[p]
        if row[e] != last_row or col[e] != last_col:
            last_row, last_col = row[e], col[e]
            total += 1
            if last_row < full:
                nnz += 1
                n_mass += 1 if last_row < n and last_col < n else 0
                n_jacobian += 1 if last_row >= n and last_col < n else 0
        slot[e] = total - 1
    words = (
        b.n_contacts + m_act + 3 * n_implied + 1 + 2 * n_sharing + left_out
        + 3 * nnz + b.m_ext + 2 * (total - nnz) + n_mass + m_act + 1 + 3 * n_jacobian
        + table + 2 * words_of(full, nnz)
        + m_act + 9 * n_jacobian + words_of(m_act, n_jacobian) + words_of(m_held, n_jacobian) + 8
    )  # fmt: skip
    reals = total + 1 + 2 * n_sharing + m_act + 6 * full + 3 * m_act + 3 * m_held + 8
    enough = _need(needs, WORDS, words, structure.words_room)
    enough = _need(needs, REALS, reals, structure.reals_room) and enough
    partition, kkt = partition_at(structure.partition), lu_at(structure.kkt)
    lu_d, small = lu_at(partition.lu_d), m_act if m_act <= b.dense_limit else m_held
    if small <= b.dense_limit:
        enough = _need(needs, OF_D + INDEX, 2 * n_jacobian, lu_d.index_room) and enough
        enough = _need(needs, OF_D + VALUES, small * (small + 1), lu_d.room) and enough
    if full <= b.dense_limit:
        enough = _need(needs, OF_KKT + INDEX, 2 * nnz, kkt.index_room) and enough
        enough = _need(needs, OF_KKT + VALUES, full * (full + 1), kkt.room) and enough
    if not enough:
        return WANT_ROOM
    write_structure(
        workspace,
        b,
        structure,
        partition,
        m_act,
        m_held,
        n_implied,
        n_sharing,
        left_out,
        nnz,
        total,
        n_mass,
        n_jacobian,
        kept,
        active,
        row,
        col,
        order,
        slot,
        table,
        sharing_start,
        sharing,
        first,
    )
    begin_sharing(workspace, structure)
    structure.built, structure.serial = 1, next_serial(b)
    return OK


@internal
def _need(needs: Any, k: int, size: int, room: int) -> bool:
    if size > room:
        needs[k] = max(needs[k], size)
    return size <= room


@internal
def _find_rows(workspace: Any, b: Any, active: Any, matrix_row: Any, matrix_col: Any) -> tuple[int, int, int, int]:
    """Active rows, those with a position form first and each part ascending, with the implied ones behind them, and the
    row of the matrix of each row of Phi: below it stand those that are only listed, -1 is none; and the column of the
    matrix of its transpose. Returns how many are active, how many of these have a position form, how many are implied,
    and how many of these are of joints."""
    codes, out, rate = ivec(workspace.wanted, b.n_contacts), ivec(b.left_out, b.m_ext), ivec(b.rate_rows, b.m_ext)
    rows, slides = ivec(b.contact_rows, b.n_contacts), ivec(b.contact_slide_rows, b.n_contacts)
    seconds, listed = ivec(b.contact_second_rows, b.n_contacts), ivec(b.listed, b.n_contacts)
    replaced, by = ivec(b.replaced_row, b.n_replaced), ivec(b.replaced_contact, b.n_replaced)
    left_out, count, held = 0, 0, 0
    for i in range(b.m):
        matrix_row[i] = 0 if i >= b.m_joints else (3 if out[i] != 0 else 1)
        left_out += 1 if out[i] != 0 else 0
    matrix_row[b.m] = -1
    for e in range(b.n_replaced):
        if codes[by[e]] >= HELD:
            matrix_row[replaced[e]] = 0
    for k in range(b.n_contacts):
        otherwise, kind, implied = 2 if listed[k] != 0 else 0, codes[k] % STRUCTURE_KINDS, codes[k] // STRUCTURE_KINDS
        matrix_row[rows[k]] = (3 if implied % 2 != 0 else 1) if kind >= HELD else otherwise
        if slides[k] >= 0:
            matrix_row[slides[k]] = (3 if implied // 2 % 2 != 0 else 1) if kind >= STUCK else otherwise
        if seconds[k] >= 0:
            matrix_row[seconds[k]] = (3 if implied // 4 != 0 else 1) if kind == STUCK_TWICE else otherwise
    for of_rates in range(2):
        for i in range(b.m):
            if matrix_row[i] == 1 and rate[i] == of_rates:
                active[count] = i
                count += 1
        if of_rates == 0:
            held = count
    full = count
    for i in range(b.m):
        if matrix_row[i] == 3:
            active[full] = i
            full += 1
    for i in range(b.m + 1):
        matrix_col[i] = -1
    for i in range(b.m):
        # implied ones are listed
        if matrix_row[i] >= 2:
            matrix_row[i] = b.n + full + i
        elif matrix_row[i] == 0:
            matrix_row[i] = -1
    for place in range(full):
        matrix_col[active[place]] = b.n + place
        if place < count:
            matrix_row[active[place]] = b.n + place
    return count, held, full - count, left_out


@internal
def _sort(raw: int, cols: int, rows: int, row: Any, col: Any, by_col: Any, order: Any, count: Any) -> int:
    """Numbers of the entries that there are, row by row and ascending in each, to `order`; how many."""
    for i in range(cols + 1):
        count[i] = 0
    for e in range(raw):
        if row[e] >= 0:
            count[col[e] + 1] += 1
    for i in range(cols):
        count[i + 1] += count[i]
    kept = count[cols]
    for e in range(raw):
        if row[e] >= 0:
            by_col[count[col[e]]] = e
            count[col[e]] += 1
    for i in range(rows + 1):
        count[i] = 0
    for p in range(kept):
        count[row[by_col[p]] + 1] += 1
    for i in range(rows):
        count[i + 1] += count[i]
    for p in range(kept):
        e = by_col[p]
        order[count[row[e]]] = e
        count[row[e]] += 1
    return int(kept)
