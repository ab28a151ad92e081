"""Structures and partitions, built by compiled code into memory that Python has given.

A structure is the pattern of the matrix [S, Phi_q^T; Phi_q, 0] for one set of closed, acting and sticking contacts:
slots of all entries, row by row and ascending in each, and behind them those of the gradients of contacts that are no
constraints now. All of it follows from the codes of the contacts and the rows that are left out.
"""

from typing import Any

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at
from ..linalg.analyze import lay_out, words_of
from ..linalg.record import INDEX, SCRATCH, VALUES
from ..state.workspace_records import (
    OF_D,
    OF_KKT,
    OK,
    REALS,
    WANT_ROOM,
    WORDS,
    building_at,
    partition_at,
    structure_at,
)
from .switch import ENGAGED, HELD, STUCK, STUCK_TWICE, take_partition, take_structure


@compiled
def engage_wanted(ws: Any) -> int:
    """Take the structure of the codes that are `wanted`, built if there is none: OK, or WANT_ROOM with nothing
    changed."""
    b = building_at(ws.building)
    places = ivec(b.structures, b.n_slots)
    oldest, free = -1, 0
    for i in range(b.n_slots):
        st = structure_at(places[i])
        if st.built != 0 and st.dropped == b.dropped and _same(st.codes, ws.wanted, b.n_contacts):
            take_structure(ws, places[i])
            st.used = _next(b)
            return OK
        if places[i] == ws.structure or places[i] == ws.kept:
            continue
        age = st.used if st.built != 0 else -1
        if free == 0 or age < oldest:
            oldest, free = age, places[i]
    st = structure_at(free)
    st.built = 0
    status = _build(ws, b, st)
    if status == OK:
        st.used = _next(b)
        take_structure(ws, free)
    return int(status)


@internal
def _next(b: Any) -> int:
    b.serial += 1
    return int(b.serial)


@internal
def _same(one: int, other: int, count: int) -> bool:
    a, b = ivec(one, count), ivec(other, count)
    for k in range(count):
        if a[k] != b[k]:
            return False
    return True


@internal
def _build(ws: Any, b: Any, st: Any) -> int:
    n, m, scratch, needs = b.n, b.m, ivec(b.scratch, 2), ivec(b.needs, 8)
    raw = n + b.n_s + 2 * b.n_j
    wide = n + 2 * m + 2
    size = 2 * (m + 1) + 5 * raw + wide
    if size > scratch[1]:
        needs[SCRATCH] = size
        return WANT_ROOM
    at = scratch[0]
    active, matrix_row = ivec(at, m + 1), ivec(at + 8 * (m + 1), m + 1)
    at += 16 * (m + 1)
    row, col = ivec(at, raw), ivec(at + 8 * raw, raw)
    by_col, order, slot = ivec(at + 16 * raw, raw), ivec(at + 24 * raw, raw), ivec(at + 32 * raw, raw)
    count = ivec(at + 40 * raw, wide)
    m_act, m_held, left_out = _find_rows(ws, b, active, matrix_row)
    full = n + m_act
    _list_entries(ws, b, full, matrix_row, row, col)
    kept = _sort(raw, n + m_act, full + m, row, col, by_col, order, count)
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
        b.n_contacts + m_act + left_out + 3 * nnz + b.m_ext + 2 * (total - nnz) + n_mass + m_act + 1 + 3 * n_jacobian
        + b.table_size + 2 * words_of(full, nnz)
        + m_act + 9 * n_jacobian + words_of(m_act, n_jacobian) + words_of(m_held, n_jacobian) + 8
    )  # fmt: skip
    reals = total + 1 + m_act + 6 * full + 3 * m_act + 3 * m_held + 8
    enough = _need(needs, WORDS, words, st.words_room)
    enough = _need(needs, REALS, reals, st.reals_room) and enough
    pt, kkt = partition_at(st.partition), lu_at(st.kkt)
    lu_d, small = lu_at(pt.lu_d), m_act if m_act <= b.dense_limit else m_held
    if small <= b.dense_limit:
        enough = _need(needs, OF_D + INDEX, 2 * n_jacobian, lu_d.index_room) and enough
        enough = _need(needs, OF_D + VALUES, small * (small + 1), lu_d.room) and enough
    if full <= b.dense_limit:
        enough = _need(needs, OF_KKT + INDEX, 2 * nnz, kkt.index_room) and enough
        enough = _need(needs, OF_KKT + VALUES, full * (full + 1), kkt.room) and enough
    if not enough:
        return WANT_ROOM
    _write(ws, b, st, pt, m_act, m_held, left_out, nnz, total, n_mass, n_jacobian, kept, active, row, col, order, slot)
    st.built, st.serial = 1, _next(b)
    return OK


@internal
def _need(needs: Any, k: int, size: int, room: int) -> bool:
    if size > room:
        needs[k] = max(needs[k], size)
    return size <= room


@internal
def _find_rows(ws: Any, b: Any, active: Any, matrix_row: Any) -> tuple[int, int, int]:
    """Active rows, those with a position form first and each part ascending, and the row of the matrix of each row of
    Phi: below it stand those that are only watched, -1 is none. Returns how many are active, how many of these have a
    position form, and how many rows are redundant."""
    codes, out, rate = ivec(ws.wanted, b.n_contacts), ivec(b.left_out, b.m_ext), ivec(b.rate_rows, b.m_ext)
    rows, slides = ivec(b.contact_rows, b.n_contacts), ivec(b.contact_slide_rows, b.n_contacts)
    seconds = ivec(b.contact_second_rows, b.n_contacts)
    replaced, by = ivec(b.replaced_row, b.n_replaced), ivec(b.replaced_contact, b.n_replaced)
    left_out, count, held = 0, 0, 0
    for i in range(b.m):
        matrix_row[i] = 1 if i < b.m_joints and out[i] == 0 else 0
        left_out += 1 if out[i] != 0 else 0
    matrix_row[b.m] = -1
    for e in range(b.n_replaced):
        if codes[by[e]] >= HELD:
            matrix_row[replaced[e]] = 0
    for k in range(b.n_contacts):
        matrix_row[rows[k]] = 1 if codes[k] >= HELD else 2
        if slides[k] >= 0:
            matrix_row[slides[k]] = 1 if codes[k] >= STUCK else 2
        if seconds[k] >= 0:
            matrix_row[seconds[k]] = 1 if codes[k] == STUCK_TWICE else 2
    for of_rates in range(2):
        for i in range(b.m):
            if matrix_row[i] == 1 and rate[i] == of_rates:
                active[count] = i
                count += 1
        if of_rates == 0:
            held = count
    for i in range(b.m):
        if matrix_row[i] == 2:
            matrix_row[i] = b.n + count + i
        elif matrix_row[i] == 0:
            matrix_row[i] = -1
    for place in range(count):
        matrix_row[active[place]] = b.n + place
    return count, held, left_out


@internal
def _list_entries(ws: Any, b: Any, full: int, matrix_row: Any, row: Any, col: Any) -> None:
    """Places of all entries, -1 for those that belong nowhere: the diagonal, S, Phi_q, and Phi_q^T."""
    n, codes = b.n, ivec(ws.wanted, b.n_contacts)
    for i in range(n):
        row[i] = col[i] = i
    s_row, s_col, s_contact = ivec(b.s_row, b.n_s), ivec(b.s_col, b.n_s), ivec(b.s_contact, b.n_s)
    for e in range(b.n_s):
        k = s_contact[e]
        there = k < 0 or codes[k] >= ENGAGED
        row[n + e], col[n + e] = s_row[e] if there else -1, s_col[e]
    j_row, j_col, first, other = ivec(b.j_row, b.n_j), ivec(b.j_col, b.n_j), n + b.n_s, n + b.n_s + b.n_j
    for e in range(b.n_j):
        i = matrix_row[j_row[e]]
        row[first + e], col[first + e] = i, j_col[e]
        # of rows below the matrix there is no transpose
        row[other + e], col[other + e] = j_col[e] if 0 <= i < full else -1, i


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


@internal
def _write(
    ws: Any, b: Any, st: Any, pt: Any, m_act: int, m_held: int, left_out: int, nnz: int, total: int, n_mass: int, n_jacobian: int,
    kept: int, active: Any, row: Any, col: Any, order: Any, slot: Any,
) -> None:  # fmt: skip
    full, at = b.n + m_act, st.words
    st.n_values, st.m_act, st.n_redundant, st.nnz = total + 1, m_act, left_out, nnz
    st.m_held, st.n_mass, st.n_jacobian, st.dropped = m_held, n_mass, n_jacobian, b.dropped
    st.codes, st.active, st.redundant = at, at + 8 * b.n_contacts, at + 8 * (b.n_contacts + m_act)
    at += 8 * (b.n_contacts + m_act + left_out)
    st.entry_row, st.entry_col, everything = at, at + 8 * nnz, at + 16 * nnz
    at += 24 * nnz
    st.gradient_start, st.gradient_col = at, at + 8 * b.m_ext
    st.gradient_slot = st.gradient_col + 8 * (total - nnz)
    at = st.gradient_slot + 8 * (total - nnz)
    st.mass_slot, st.jacobian_start = at, at + 8 * n_mass
    at += 8 * (n_mass + m_act + 1)
    st.jacobian_row, st.jacobian_col = at, at + 8 * n_jacobian
    st.jacobian_slot, tables = at + 16 * n_jacobian, at + 24 * n_jacobian
    at = tables + 8 * b.table_size
    codes, wanted = ivec(st.codes, b.n_contacts), ivec(ws.wanted, b.n_contacts)
    for k in range(b.n_contacts):
        codes[k] = wanted[k]
    own, redundant, out, count = ivec(st.active, m_act), ivec(st.redundant, left_out), ivec(b.left_out, b.m_ext), 0
    for i in range(m_act):
        own[i] = active[i]
    for i in range(b.m):
        if out[i] != 0:
            redundant[count] = i
            count += 1
    _write_entries(b, st, full, kept, row, col, order, slot)
    identity = ivec(everything, nnz)
    for e in range(nnz):
        identity[e] = e
    _write_tables(b, st, tables, total, row, slot)
    reals, many = st.reals, words_of(full, nnz)
    st.values, st.probe = reals, reals + 8 * (total + 1)
    reals += 8 * (total + 1 + m_act)
    probe = vec(st.probe, m_act)
    for i in range(m_act):
        probe[i] = 0.0
    dense = full <= b.dense_limit
    lay_out(lu_at(st.kkt), full, nnz, st.entry_row, st.entry_col, everything, dense, at, reals)
    at += 8 * many
    lay_out(lu_at(st.kkt_query), full, nnz, st.entry_row, st.entry_col, everything, dense, at, reals + 24 * full)
    at += 8 * many
    _give_units(b, st)
    pt.ready, pt.words, pt.reals = 0, at, reals + 48 * full


@internal
def _write_entries(b: Any, st: Any, full: int, kept: int, row: Any, col: Any, order: Any, slot: Any) -> None:
    n, nnz, m_act = b.n, st.nnz, st.m_act
    rows, cols = ivec(st.entry_row, nnz), ivec(st.entry_col, nnz)
    beyond = st.n_values - 1 - nnz
    g_start, g_col, g_slot = (
        ivec(st.gradient_start, b.m_ext),
        ivec(st.gradient_col, beyond),
        ivec(st.gradient_slot, beyond),
    )
    mass, start = ivec(st.mass_slot, st.n_mass), ivec(st.jacobian_start, m_act + 1)
    j_row, j_col = ivec(st.jacobian_row, st.n_jacobian), ivec(st.jacobian_col, st.n_jacobian)
    j_slot = ivec(st.jacobian_slot, st.n_jacobian)
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
def _write_tables(b: Any, st: Any, tables: int, nowhere: int, row: Any, slot: Any) -> None:
    """Where each entry of each element goes."""
    block, starts, addresses = (
        ivec(tables, b.table_size),
        ivec(b.table_start, 3 * b.n_kernels),
        ivec(st.slots, 3 * b.n_kernels),
    )
    for i in range(3 * b.n_kernels):
        addresses[i] = tables + 8 * starts[i]
    for i in range(b.table_size):
        block[i] = nowhere
    first = b.n
    place = ivec(b.s_place, b.n_s)
    for e in range(b.n_s):
        if row[first + e] >= 0:
            block[place[e]] = slot[first + e]
    first += b.n_s
    place, other = ivec(b.j_place, b.n_j), ivec(b.j_place_t, b.n_j)
    for e in range(b.n_j):
        if row[first + e] >= 0:
            block[place[e]] = slot[first + e]
        if row[first + b.n_j + e] >= 0:
            block[other[e]] = slot[first + b.n_j + e]


@internal
def _give_units(b: Any, st: Any) -> None:
    n, m_act, units, active = b.n, st.m_act, vec(b.units, b.n + b.m_ext), ivec(st.active, st.m_act)
    for address in (st.kkt, st.kkt_query):
        lu = lu_at(address)
        rows, cols = vec(lu.row_unit, n + m_act), vec(lu.col_unit, n + m_act)
        for i in range(n + m_act):
            rows[i] = cols[i] = units[i] if i < n else units[n + active[i - n]]


@compiled
def partition_wanted(ws: Any) -> None:
    """Take the partition with the dependent coordinates that are `wanted_dependent`, built if it is not the last one of
    the structure."""
    b, st = building_at(ws.building), structure_at(ws.structure)
    pt, m_act = partition_at(st.partition), st.m_act
    if pt.ready == 0 or not _same(pt.dependent, ws.wanted_dependent, m_act):
        _build_partition(ws, b, st, pt)
    take_partition(ws, st.partition)


@internal
def _build_partition(ws: Any, b: Any, st: Any, pt: Any) -> None:
    n, m_act, count = b.n, st.m_act, st.n_jacobian
    position, at = ivec(ivec(b.scratch, 2)[0], n), pt.words
    pt.dependent, pt.free_row, pt.free_col = at, at + 8 * m_act, at + 8 * (m_act + count)
    pt.free_slot = at + 8 * (m_act + 2 * count)
    at += 8 * (m_act + 3 * count)
    rows, cols, slots = ivec(at, count), ivec(at + 8 * count, count), ivec(at + 16 * count, count)
    dependent, wanted = ivec(pt.dependent, m_act), ivec(ws.wanted_dependent, m_act)
    for i in range(n):
        position[i] = -1
    for i in range(m_act):
        dependent[i] = wanted[i]
        position[wanted[i]] = i
    j_row, j_col, j_slot = ivec(st.jacobian_row, count), ivec(st.jacobian_col, count), ivec(st.jacobian_slot, count)
    f_row, f_col, f_slot = ivec(pt.free_row, count), ivec(pt.free_col, count), ivec(pt.free_slot, count)
    free, bound = 0, 0
    for e in range(count):
        if position[j_col[e]] < 0:
            f_row[free], f_col[free], f_slot[free] = j_row[e], j_col[e], j_slot[e]
            free += 1
        else:
            rows[bound], cols[bound], slots[bound] = j_row[e], position[j_col[e]], j_slot[e]
            bound += 1
    pt.n_free, pt.ready, pt.serial = free, 1, _next(b)
    words, reals = at + 24 * count, pt.reals
    _lay_out_part(b, st, pt.lu_d, m_act, bound, at, count, words, reals, wanted)
    if b.two_partitions == 0 or st.m_held == m_act:
        pt.used_p = pt.lu_d
        return
    # dependent positions alone: the rows with a position form, which come first
    pt.used_p = pt.lu_p
    words, reals = words + 8 * words_of(m_act, count), reals + 24 * m_act
    some, held = 0, st.m_held
    held_rows, held_cols = ivec(words, count), ivec(words + 8 * count, count)
    held_slots = ivec(words + 16 * count, count)
    for e in range(bound):
        if rows[e] < held and cols[e] < held:
            held_rows[some], held_cols[some], held_slots[some] = rows[e], cols[e], slots[e]
            some += 1
    _lay_out_part(b, st, pt.lu_p, held, some, words, count, words + 24 * count, reals, wanted)


@internal
def _lay_out_part(
    b: Any, st: Any, address: int, size: int, bound: int, at: int, count: int, words: int, reals: int, wanted: Any
) -> None:
    """The factorisation at `address` of the first `size` rows in their dependent columns, whose entries are listed at
    `at`, `count` words apart."""
    lu = lu_at(address)
    lay_out(lu, size, bound, at, at + 8 * count, at + 16 * count, size <= b.dense_limit, words, reals)
    units, active = vec(b.units, b.n + b.m_ext), ivec(st.active, st.m_act)
    row_unit, col_unit = vec(lu.row_unit, size), vec(lu.col_unit, size)
    for i in range(size):
        row_unit[i], col_unit[i] = units[b.n + active[i]], units[wanted[i]]
