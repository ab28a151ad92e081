"""Which row is the pivot of each column, chosen on the present values: compiled, without allocation.

The columns keep the order of their pattern (`ordering.py`). Rows and columns are balanced first (Curtis and Reid 1972);
then each column is eliminated by those before it (Gilbert and Peierls 1988), and its pivot is the entry on the diagonal
if that is no less than DIAGONAL_PREFERENCE of the largest one left, else that one.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from .record import NO_PIVOT, OK, SCRATCH, WANT_ROOM

DIAGONAL_PREFERENCE = 0.1
SWEEPS = 4
"""Of the balancing."""
NEGLIGIBLE = 1e-6
"""Entries this much smaller than both their row's and their column's largest do not count in the balancing."""
_LARGEST = float(np.finfo(np.float64).max)


@internal
def choice_size(n: int, nnz: int, room: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `choose_rows`, for `room` entries of L."""
    return 12 * n + 2 + 2 * nnz + 2 * room


@internal
def choose_rows(lu: Any, values_address: int) -> int:
    """Place of each row of the matrix in the pivot sequence, to `wanted` (n,): OK; NO_PIVOT for a singular matrix or a
    value that is not finite; WANT_ROOM. The balancing scales of the rows are the first n numbers of the scratch."""
    n, nnz, scratch = lu.n, lu.nnz, ivec(lu.scratch, 2)
    work, room = scratch[0], (scratch[1] - choice_size(n, nnz, 0)) // 2
    if room < nnz + n:
        ivec(lu.needs, 3)[SCRATCH] = choice_size(n, nnz, 2 * (nnz + n))
        return WANT_ROOM
    source, slots = vec(values_address, 1), ivec(lu.column_slot, nnz)
    rows, columns = ivec(lu.column_row, nnz), ivec(lu.column_of, nnz)
    entries, logs = vec(work + 8 * 4 * n, nnz), vec(work + 8 * (4 * n + nnz), nnz)
    row_unit, col_unit = vec(lu.row_unit, n), vec(lu.col_unit, n)
    for e in range(nnz):
        x = source[slots[e]]
        if not abs(x) <= _LARGEST:
            return NO_PIVOT
        entries[e] = x * row_unit[rows[e]] * col_unit[columns[e]]
    _balance(n, nnz, rows, columns, entries, logs, work)
    row_scale, col_scale = vec(work, n), vec(work + 8 * n, n)
    for e in range(nnz):
        entries[e] *= row_scale[rows[e]] * col_scale[columns[e]]
    return _eliminate(lu, entries, work + 8 * (4 * n + 2 * nnz), room)


@internal
def _balance(n: int, nnz: int, rows: Any, columns: Any, entries: Any, logs: Any, work: int) -> None:
    """Scales r (n,), c (n,) that bring the magnitudes r_i |a_ij| c_j near 1, to the first 2 n numbers of `work`:
    alternating least squares on the logarithms."""
    row_log, col_log, row_top, col_top = (
        vec(work, n),
        vec(work + 8 * n, n),
        vec(work + 16 * n, n),
        vec(work + 24 * n, n),
    )
    for i in range(n):
        row_top[i] = col_top[i] = 0.0
    for e in range(nnz):
        size = abs(entries[e])
        row_top[rows[e]] = max(row_top[rows[e]], size)
        col_top[columns[e]] = max(col_top[columns[e]], size)
    for e in range(nnz):
        size, i, j = abs(entries[e]), rows[e], columns[e]
        logs[e] = np.log(size) if size > NEGLIGIBLE * min(row_top[i], col_top[j]) else np.nan
    # now how many entries of each row and column count
    for i in range(n):
        row_top[i] = col_top[i] = row_log[i] = col_log[i] = 0.0
    for e in range(nnz):
        if logs[e] == logs[e]:
            row_top[rows[e]] += 1.0
            col_top[columns[e]] += 1.0
    for _ in range(SWEEPS):
        for i in range(n):
            row_log[i] = 0.0
        for e in range(nnz):
            if logs[e] == logs[e]:
                row_log[rows[e]] -= logs[e] + col_log[columns[e]]
        for i in range(n):
            row_log[i] /= max(row_top[i], 1.0)
            col_log[i] = 0.0
        for e in range(nnz):
            if logs[e] == logs[e]:
                col_log[columns[e]] -= logs[e] + row_log[rows[e]]
        for i in range(n):
            col_log[i] /= max(col_top[i], 1.0)
    for i in range(n):
        row_log[i] = np.exp(min(max(row_log[i], -300.0), 300.0))
        col_log[i] = np.exp(min(max(col_log[i], -300.0), 300.0))


@internal
def _eliminate(lu: Any, entries: Any, work: int, room: int) -> int:
    n, place, starts, order = lu.n, ivec(lu.wanted, lu.n), ivec(lu.column_start, lu.n + 1), ivec(lu.order, lu.n)
    rows, x, mark = ivec(lu.column_row, lu.nnz), vec(work, n), ivec(work + 8 * n, n)
    stack, left, found = ivec(work + 16 * n, n), ivec(work + 24 * n, n), ivec(work + 32 * n, n)
    l_start, l_row = ivec(work + 40 * n, n + 1), ivec(work + 8 * (6 * n + 1), room)
    l_value = vec(work + 8 * (6 * n + 1 + room), room)
    for i in range(n):
        place[i] = mark[i] = -1
        x[i] = 0.0
    l_start[0] = 0
    for k in range(n):
        top, end = n, l_start[k]
        if end + n - k > room:
            ivec(lu.needs, 3)[SCRATCH] = choice_size(n, lu.nnz, 4 * room)
            return WANT_ROOM
        for e in range(starts[k], starts[k + 1]):
            if mark[rows[e]] != k:
                top = _reach(rows[e], k, top, mark, stack, left, found, place, l_start, l_row)
            x[rows[e]] = entries[e]
        best, largest = -1, 0.0
        for p in range(top, n):
            i = found[p]
            if place[i] < 0:
                continue
            times = x[i]
            if times != 0.0:
                for q in range(l_start[place[i]], l_start[place[i] + 1]):
                    x[l_row[q]] -= l_value[q] * times
        diagonal = order[k]
        for p in range(top, n):
            i = found[p]
            if place[i] < 0 and abs(x[i]) > largest:
                best, largest = i, abs(x[i])
        if best < 0 or not largest <= _LARGEST:
            return NO_PIVOT
        if mark[diagonal] == k and place[diagonal] < 0 and abs(x[diagonal]) >= DIAGONAL_PREFERENCE * largest:
            best = diagonal
        pivot = x[best]
        place[best] = k
        for p in range(top, n):
            i = found[p]
            if place[i] < 0 and x[i] != 0.0:
                l_row[end], l_value[end] = i, x[i] / pivot
                end += 1
            x[i] = 0.0
        l_start[k + 1] = end
    return OK


@internal
def _reach(
    row: int, k: int, top: int, mark: Any, stack: Any, left: Any, found: Any, place: Any, l_start: Any, l_row: Any
) -> int:
    """Rows that an entry in `row` makes fill in, in an order in which each comes before those that it changes: they are
    put before those found already, from `top` on. Returns the new top."""
    depth = 0
    stack[0], mark[row] = row, k
    left[0] = l_start[place[row]] if place[row] >= 0 else 0
    while depth >= 0:
        i, down = stack[depth], False
        if place[i] >= 0:
            end = l_start[place[i] + 1]
            while left[depth] < end:
                j = l_row[left[depth]]
                left[depth] += 1
                if mark[j] != k:
                    mark[j] = k
                    depth += 1
                    stack[depth] = j
                    left[depth] = l_start[place[j]] if place[j] >= 0 else 0
                    down = True
                    break
        if not down:
            top -= 1
            found[top] = i
            depth -= 1
    return top
