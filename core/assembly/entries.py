"""The entries of S and Phi_q of a structure, listed one after another.

Elements that are contacts take part only where the structure has a place for their force: an open contact has no entry,
so a structure is as large as what touches, however many pairs there are. The gradients of open contacts that touch are
asked of the contact alone (`event_detection/contact_evaluation.py`), but those of contacts that cannot be evaluated
alone, which are always `listed`.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.kernels import batch_at
from ..compiled.views import imat, ivec
from .structure_switch import ENGAGED


@internal
def takes_part(codes: Any, listed: Any, k: int) -> bool:
    """True if elements of contact k (-1: none) have entries."""
    return k < 0 or codes[k] >= ENGAGED or listed[k] != 0


@internal
def lines_of(workspace: Any, b: Any, x: int) -> int:
    """How many elements of batch x take part."""
    start = ivec(b.element_start, b.n_kernels + 1)
    codes, listed, count = ivec(workspace.wanted, b.n_contacts), ivec(b.listed, b.n_contacts), 0
    if ivec(b.of_contacts, b.n_kernels)[x] == 0:
        return int(start[x + 1] - start[x])
    contact = ivec(b.element_contact, start[x + 1])
    for e in range(start[x], start[x + 1]):
        count += 1 if takes_part(codes, listed, contact[e]) else 0
    return count


@internal
def size_of_entries(workspace: Any, b: Any) -> tuple[int, int]:
    """(entries with the diagonal, numbers in the slot tables)."""
    s_start, j_start = ivec(b.s_start, b.n_kernels + 1), ivec(b.j_start, b.n_kernels + 1)
    batches, entries, table = ivec(workspace.batches, b.n_kernels), b.n, 0
    for x in range(b.n_kernels):
        batch, lines = batch_at(batches[x]), lines_of(workspace, b, x)
        entries += lines * (s_start[x + 1] - s_start[x] + 2 * (j_start[x + 1] - j_start[x]))
        if ivec(b.of_contacts, b.n_kernels)[x] != 0:
            # the first line is of those that take no part, and each element says which is its own
            lines += 1
            table += batch.count
        table += lines * batch.ncoord * (batch.ncoord + 2 * max(batch.nrow, 1))
    return entries, table


@internal
def list_entries(workspace: Any, b: Any, matrix_row: Any, matrix_col: Any, row: Any, col: Any) -> int:
    """Places of all entries, -1 for those that belong nowhere: the diagonal, then by element S, and Phi_q with its
    transpose in turn; how many. `matrix_row`: of each row of Phi; `matrix_col`: of its transpose."""
    n, codes, listed = b.n, ivec(workspace.wanted, b.n_contacts), ivec(b.listed, b.n_contacts)
    for i in range(n):
        row[i] = col[i] = i
    batches, start = ivec(workspace.batches, b.n_kernels), ivec(b.element_start, b.n_kernels + 1)
    s_start, j_start, at = ivec(b.s_start, b.n_kernels + 1), ivec(b.j_start, b.n_kernels + 1), n
    contact = ivec(b.element_contact, start[b.n_kernels])
    s_pattern, j_pattern = imat(b.s_pattern, s_start[b.n_kernels], 2), imat(b.j_pattern, j_start[b.n_kernels], 2)
    for x in range(b.n_kernels):
        batch = batch_at(batches[x])
        coords, rows = imat(batch.coord, batch.count, batch.ncoord), imat(batch.row, batch.count, batch.nrow)
        for e in range(batch.count):
            k = contact[start[x] + e]
            if not takes_part(codes, listed, k):
                continue
            coord, acts = coords[e], k < 0 or codes[k] >= ENGAGED
            for p in range(s_start[x], s_start[x + 1]):
                i, j = coord[s_pattern[p, 0]], coord[s_pattern[p, 1]]
                row[at], col[at] = i if acts and i < n and j < n else -1, j
                at += 1
            for p in range(j_start[x], j_start[x + 1]):
                i, j = rows[e, j_pattern[p, 0]], coord[j_pattern[p, 1]]
                i = i if i >= 0 and j < n else b.m
                row[at], col[at] = matrix_row[i], j
                row[at + 1], col[at + 1] = j if matrix_col[i] >= 0 else -1, matrix_col[i]
                at += 2
    return at


@internal
def write_tables(workspace: Any, b: Any, structure: Any, tables: int, nowhere: int, row: Any, slot: Any) -> None:
    """Where each entry of each element goes: slot tables at the address `tables`; `row`, `slot` of the entries in the
    order of `list_entries`."""
    codes, listed = ivec(workspace.wanted, b.n_contacts), ivec(b.listed, b.n_contacts)
    batches, start = ivec(workspace.batches, b.n_kernels), ivec(b.element_start, b.n_kernels + 1)
    s_start, j_start, at = ivec(b.s_start, b.n_kernels + 1), ivec(b.j_start, b.n_kernels + 1), b.n
    contact = ivec(b.element_contact, start[b.n_kernels])
    s_pattern, j_pattern = imat(b.s_pattern, s_start[b.n_kernels], 2), imat(b.j_pattern, j_start[b.n_kernels], 2)
    addresses = ivec(structure.slots, 4 * b.n_kernels)
    for x in range(b.n_kernels):
        batch, some = batch_at(batches[x]), ivec(b.of_contacts, b.n_kernels)[x] != 0
        width, both = batch.ncoord, batch.ncoord * max(batch.nrow, 1)
        lines = lines_of(workspace, b, x) + (1 if some else 0)
        of_s, of_j, of_jt = tables, tables + 8 * lines * width * width, tables + 8 * lines * (width * width + both)
        size = lines * (width * width + 2 * both)
        of_lines = tables + 8 * size
        block = ivec(tables, size)
        for p in range(size):
            block[p] = nowhere
        addresses[4 * x], addresses[4 * x + 1], addresses[4 * x + 2] = of_s, of_j, of_jt
        addresses[4 * x + 3] = of_lines if some else 0
        own, line = ivec(of_lines, batch.count), 1 if some else 0
        for e in range(batch.count):
            if not takes_part(codes, listed, contact[start[x] + e]):
                own[e] = 0
                continue
            table = ivec(of_s + 8 * line * width * width, width * width)
            for p in range(s_start[x], s_start[x + 1]):
                if row[at] >= 0:
                    table[s_pattern[p, 0] * width + s_pattern[p, 1]] = slot[at]
                at += 1
            table, other = ivec(of_j + 8 * line * both, both), ivec(of_jt + 8 * line * both, both)
            for p in range(j_start[x], j_start[x + 1]):
                place = j_pattern[p, 0] * width + j_pattern[p, 1]
                if row[at] >= 0:
                    table[place] = slot[at]
                if row[at + 1] >= 0:
                    other[place] = slot[at + 1]
                at += 2
            if some:
                own[e] = line
            line += 1
        tables = of_lines + (8 * batch.count if some else 0)
