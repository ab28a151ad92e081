"""Fill pattern of L and U for fixed pivots, and the list of operations of the refactorisation: compiled, written into
the memory of the factorisation.

The pattern is structural: an entry that is zero by chance in the values of the day keeps its place.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, uvec
from .record import BY_COLUMNS, INDEX, OK, PROGRAM, SCRATCH, VALUES, WANT_ROOM


@internal
def write_analysis(lu: Any) -> int:
    """Let the pivots be those of `wanted`, with their fill and operations: OK or WANT_ROOM."""
    n, nnz, needs, scratch = lu.n, lu.nnz, ivec(lu.needs, 3), ivec(lu.scratch, 2)
    lu.ready = 0
    # the first n numbers are the scales with which the pivots were chosen
    at, fixed = scratch[0] + 8 * n, 9 * n + 4 + nnz
    space = (scratch[1] - fixed) // 4
    if space < nnz + 2 * n:
        needs[SCRATCH] = fixed + 8 * (nnz + 2 * n)
        return WANT_ROOM
    l_start, u_start, starts = ivec(at, n + 1), ivec(at + 8 * (n + 1), n + 1), ivec(at + 16 * (n + 1), n + 1)
    at += 24 * (n + 1)
    mark, ends, stack, place = ivec(at, n), ivec(at + 8 * n, n), ivec(at + 16 * n, n), ivec(at + 24 * n, n)
    row = ivec(at + 40 * n, nnz)
    at += 40 * n + 8 * nnz
    l_row, u_row = ivec(at, space), ivec(at + 8 * space, space)
    start, order = ivec(lu.column_start, n + 1), ivec(lu.order, n)
    given, perm, wanted = ivec(lu.column_row, nnz), ivec(lu.perm_r, n), ivec(lu.wanted, n)
    for i in range(n):
        perm[i] = wanted[i]
    for e in range(nnz):
        row[e] = perm[given[e]]
    if not _search(n, start, row, l_start, l_row, u_start, u_row, mark, ends, stack, space):
        needs[SCRATCH] = fixed + 8 * space
        return WANT_ROOM
    nl, nu = l_start[n], u_start[n]
    if nl + nu + n > 2 * space:
        needs[SCRATCH] = fixed + 8 * space
        return WANT_ROOM
    _sort(n, l_start, l_row, starts, place, ivec(at + 16 * space, nl))
    _sort(n, u_start, u_row, starts, place, ivec(at + 16 * space, nu))
    count = 0
    for p in range(nu):
        count += l_start[u_row[p] + 1] - l_start[u_row[p]]
    program = count <= lu.program_limit * (nl + nu + n)
    steps, sums = (count, nu) if program else (0, 0)
    size = 2 * nnz + 6 * n + 4 + 2 * (nl + nu) + 3 * steps + 2 * sums
    if size > lu.index_room or nl + nu + 2 * n > lu.room:
        needs[INDEX], needs[VALUES] = size, nl + nu + 2 * n
        return WANT_ROOM
    _place_tables(lu, nl, nu, steps, sums)
    row_at, col_at = uvec(lu.row_at, n), uvec(lu.col_at, n)
    for i in range(n):
        row_at[perm[i]], col_at[i] = i, order[i]
    _copy_triangle(n, l_start, l_row, uvec(lu.l_start, n + 1), uvec(lu.l_row, nl), uvec(lu.l_col, nl))
    _copy_triangle(n, u_start, u_row, uvec(lu.u_start, n + 1), uvec(lu.u_row, nu), uvec(lu.u_col, nu))
    if program:
        _write_operations(lu, l_start, l_row, u_start, u_row, place)
    _place_entries(lu, start, row, l_start, l_row, u_start, u_row, place, ivec(at + 16 * space, nl + nu + n))
    lu.kind = PROGRAM if program else BY_COLUMNS
    functions = ivec(lu.functions, 2 * lu.kind + 2)
    lu.factor_function, lu.solve_function = functions[2 * lu.kind], functions[2 * lu.kind + 1]
    lu.ready = 1
    return OK


@internal
def _place_tables(lu: Any, nl: int, nu: int, steps: int, sums: int) -> None:
    n, nnz, at = lu.n, lu.nnz, lu.index
    lu.nl, lu.nu, lu.n_steps, lu.n_sums = nl, nu, 0, 0
    lu.entry_to, lu.entry_from = at, at + 4 * nnz
    at += 8 * nnz
    lu.row_at, lu.col_at = at, at + 4 * n
    at += 8 * n
    lu.l_start, lu.u_start, lu.step_start, lu.sum_start = at, at + 4 * (n + 1), at + 8 * (n + 1), at + 12 * (n + 1)
    at += 16 * (n + 1)
    lu.l_row, lu.l_col, lu.u_row, lu.u_col = at, at + 4 * nl, at + 8 * nl, at + 8 * nl + 4 * nu
    at += 8 * (nl + nu)
    lu.step_to, lu.step_left, lu.step_right = at, at + 4 * steps, at + 8 * steps
    at += 12 * steps
    lu.sum_left, lu.sum_right = at, at + 4 * sums


@internal
def _search(
    n: int, start: Any, row: Any, l_start: Any, l_row: Any, u_start: Any, u_row: Any,
    mark: Any, search_end: Any, stack: Any, space: int,
) -> bool:  # fmt: skip
    """Fill in l_start, l_row, u_start, u_row, rows in no order; False if `space` is too little.

    Column j is what can be reached from the rows of column j of the matrix along the columns of L (Gilbert &
    Peierls 1988); columns of L are shortened to what later searches need (symmetric pruning, Eisenstat & Liu
    1992), which makes the work nearly linear in the fill.
    """
    nl = 0
    nu = 0
    l_start[0] = u_start[0] = 0
    for j in range(n):
        mark[j] = search_end[j] = -1
    for j in range(n):
        if nl + n - j > space or nu + j > space:
            return False
        mark[j] = j
        for e in range(start[j], start[j + 1]):
            if mark[row[e]] == j:
                continue
            mark[row[e]] = j
            stack[0] = row[e]
            depth = 1
            while depth > 0:
                depth -= 1
                i = stack[depth]
                if i > j:
                    l_row[nl] = i
                    nl += 1
                    continue
                u_row[nu] = i
                nu += 1
                for p in range(l_start[i], search_end[i] if search_end[i] >= 0 else l_start[i + 1]):
                    k = l_row[p]
                    if mark[k] != j:
                        mark[k] = j
                        stack[depth] = k
                        depth += 1
        l_start[j + 1] = nl
        u_start[j + 1] = nu
        for p in range(u_start[j], nu):
            k = u_row[p]
            if search_end[k] < 0:
                head = l_start[k]
                found = False
                for q in range(l_start[k], l_start[k + 1]):
                    found |= l_row[q] == j
                if found:  # rows below j of column k are reached through column j from now on
                    for q in range(l_start[k], l_start[k + 1]):
                        i = l_row[q]
                        if i <= j:
                            l_row[q] = l_row[head]
                            l_row[head] = i
                            head += 1
                    search_end[k] = head
    return True


@internal
def _sort(n: int, start: Any, row: Any, by_row: Any, at: Any, column: Any) -> None:
    """Rows ascending in each column: by rows first, and back."""
    for i in range(n):
        at[i] = 0
    for p in range(start[n]):
        at[row[p]] += 1
    by_row[0] = 0
    for i in range(n):
        by_row[i + 1] = by_row[i] + at[i]
        at[i] = by_row[i]
    for j in range(n):
        for p in range(start[j], start[j + 1]):
            column[at[row[p]]] = j
            at[row[p]] += 1
    for j in range(n):
        at[j] = start[j]
    for i in range(n):
        for p in range(by_row[i], by_row[i + 1]):
            j = column[p]
            row[at[j]] = i
            at[j] += 1


@internal
def _copy_triangle(n: int, start: Any, row: Any, to_start: Any, to_row: Any, to_col: Any) -> None:
    to_start[0] = 0
    for j in range(n):
        to_start[j + 1] = start[j + 1]
        for p in range(start[j], start[j + 1]):
            to_row[p], to_col[p] = row[p], j


@internal
def _place_entries(
    lu: Any, start: Any, row: Any, l_start: Any, l_row: Any, u_start: Any, u_row: Any, place: Any, source: Any
) -> None:
    """Where each entry goes, in ascending order."""
    n, nl, size, slot = lu.n, lu.nl, lu.nl + lu.nu + lu.n, ivec(lu.column_slot, lu.nnz)
    for p in range(size):
        source[p] = -1
    for j in range(n):
        for p in range(u_start[j], u_start[j + 1]):
            place[u_row[p]] = nl + p
        for p in range(l_start[j], l_start[j + 1]):
            place[l_row[p]] = p
        place[j] = nl + lu.nu + j
        for e in range(start[j], start[j + 1]):
            source[place[row[e]]] = slot[e]
    to, given, count = uvec(lu.entry_to, lu.nnz), uvec(lu.entry_from, lu.nnz), 0
    for p in range(size):
        if source[p] >= 0:
            to[count], given[count] = p, source[p]
            count += 1


@internal
def _write_operations(lu: Any, l_start: Any, l_row: Any, u_start: Any, u_row: Any, place: Any) -> None:
    """Write down the refactorisation: positions in (L, U) of each multiply-subtract, by columns."""
    n, nl = lu.n, l_start[lu.n]
    room = (lu.step_left - lu.step_to) // 4
    to, left, right = uvec(lu.step_to, room), uvec(lu.step_left, room), uvec(lu.step_right, room)
    sum_left, sum_right = uvec(lu.sum_left, lu.nu), uvec(lu.sum_right, lu.nu)
    step_start, sum_start = uvec(lu.step_start, n + 1), uvec(lu.sum_start, n + 1)
    steps, sums = 0, 0
    step_start[0] = sum_start[0] = 0
    for j in range(n):
        for p in range(u_start[j], u_start[j + 1]):
            place[u_row[p]] = nl + p
        for p in range(l_start[j], l_start[j + 1]):
            place[l_row[p]] = p
        for p in range(u_start[j], u_start[j + 1]):
            k = u_row[p]
            for q in range(l_start[k], l_start[k + 1]):
                if l_row[q] == j:
                    sum_left[sums], sum_right[sums] = q, nl + p
                    sums += 1
                else:
                    to[steps], left[steps], right[steps] = place[l_row[q]], q, nl + p
                    steps += 1
        step_start[j + 1], sum_start[j + 1] = steps, sums
    lu.n_steps, lu.n_sums = steps, sums
