"""Order of the columns of a sparse matrix, by its pattern: minimum degree on the columns, compiled.

The graph is that of A^T A, which bounds the fill of any pivots that are chosen later by values (George and Ng 1985). It
is kept as the rows whose columns are all neighbours of each other: to eliminate a column merges all rows that it is in
(Gilbert, Moler and Schreiber 1992; the way to count degrees is that of Davis, Gilbert, Larimore and Ng 2004, COLAMD).
Rows that are nearly full would make all columns neighbours: they are left out.

Measured on the matrices [M Phi^T; Phi 0] of chains, masses from 1e-3 to 1e3, and on spring grids with constraints:
this with pivots from the diagonal down to a tenth of the column's largest gives the lowest fill that is safe. Minimum
degree on A^T + A gives 5 % less for chains, but can give 20-fold fill where the zero block forces pivots off the
diagonal. Full partial pivoting costs 5-30 % more fill, and its pivots go stale sooner: taken on geometry, they vanish
when a body turns. Scaling (Curtis & Reid) keeps most pivots on the diagonal for any mass.

How ties are broken matters: last in, first out, with the columns of the lowest number first at the beginning and those
of a merged row as they stand in it, gives 0.95 of the fill of SuperLU's COLAMD (35 matrices of scenarios, 0.75 to
1.09), other rules 0.94 to 1.0 and for chains 1.05 to 1.18 in place of 1.01. Exact degrees are no better than bounds.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec

# From this size on the factors do not fit into the fast caches, and the order in which they are read counts: neighbours
# stay neighbours (reverse Cuthill-McKee) if the matrix then has a narrow band, and nearly the least fill.
LARGE = 4000
WIDEST_BAND = 50
MORE_FILL = 1.2
DENSE_ROW = 10.0
"""Rows with more than this times sqrt(n) entries, and more than FEW, do not count."""
FEW = 16


@internal
def order_room(n: int, nnz: int) -> int:
    """Numbers in the scratch of `choose_order`."""
    return 13 * n + 4 + 4 * nnz


@internal
def choose_order(n: int, nnz: int, rows: int, cols: int, order: int, work: int) -> None:
    """The column at each place of the pivot sequence, to `order` (n,); `rows`, `cols` (nnz,) are the addresses of the
    places of the entries, none twice, and `work` that of the scratch."""
    least = _eliminate(n, nnz, rows, cols, order, work, False)
    if n < LARGE:
        return
    best, out = ivec(work + 8 * (12 * n + 4 + 4 * nnz), n), ivec(order, n)
    for i in range(n):
        best[i] = out[i]
    if _by_neighbours(n, nnz, rows, cols, order, work) <= WIDEST_BAND:
        if float(_eliminate(n, nnz, rows, cols, order, work, True)) <= MORE_FILL * float(least):
            return
    for i in range(n):
        out[i] = best[i]


@internal
def _eliminate(n: int, nnz: int, rows: int, cols: int, order: int, work: int, given: bool) -> int:
    """Eliminate the columns in the order `given`, or in that of their degrees, which is written down; returns the
    number of entries of all merged rows."""
    row, col, out = ivec(rows, nnz), ivec(cols, nnz), ivec(order, n)
    room = 2 * nnz + n
    # columns with the rows that they are in; rows (and what they merge to) with their columns
    c_start, c_len = ivec(work, n + 1), ivec(work + 8 * (n + 1), n)
    r_start, r_len = ivec(work + 8 * (2 * n + 1), n + 1), ivec(work + 8 * (3 * n + 2), n)
    c_row, r_col = ivec(work + 8 * (4 * n + 2), nnz), ivec(work + 8 * (4 * n + 2 + nnz), room)
    at = work + 8 * (5 * n + 2 + 3 * nnz)
    head, after, before = ivec(at, n), ivec(at + 8 * n, n), ivec(at + 16 * n, n)
    degree, mark, apart = ivec(at + 24 * n, n), ivec(at + 32 * n, n), ivec(at + 40 * n, n)
    _by_rows(n, nnz, row, col, r_start, r_len, r_col)
    most = max(float(FEW), DENSE_ROW * float(n) ** 0.5)
    for i in range(n):
        if r_len[i] > most:
            r_len[i] = 0
        c_len[i] = degree[i] = 0
        head[i] = mark[i] = -1
    for i in range(n):
        for e in range(r_start[i], r_start[i] + r_len[i]):
            c_len[r_col[e]] += 1
    c_start[0] = 0
    for j in range(n):
        c_start[j + 1] = c_start[j] + c_len[j]
        c_len[j] = 0
    for i in range(n):
        for e in range(r_start[i], r_start[i] + r_len[i]):
            j = r_col[e]
            c_row[c_start[j] + c_len[j]] = i
            c_len[j] += 1
    end = r_start[n]
    for k in range(n):
        j, found = n - 1 - k, 0
        for p in range(c_start[j], c_start[j + 1]):
            found += r_len[c_row[p]] - 1
        degree[j] = min(found, n - 1)
        _put(j, degree[j], head, after, before)
    least, entries = 0, 0
    for k in range(n):
        while not given and head[least] < 0:
            least += 1
        pivot = out[k] if given else head[least]
        _take(pivot, degree[pivot], head, after, before)
        out[k] = pivot
        if end + degree[pivot] > room:
            end = _close_up(n, r_start, r_len, r_col, apart, end)
        # all rows that the column is in become one
        mark[pivot] = k
        begin, merged = end, -1
        entries += 1
        for p in range(c_start[pivot], c_start[pivot] + c_len[pivot]):
            i = c_row[p]
            for e in range(r_start[i], r_start[i] + r_len[i]):
                j = r_col[e]
                if mark[j] != k:
                    mark[j] = k
                    r_col[end] = j
                    end += 1
            r_len[i] = 0
            merged = i
        c_len[pivot] = 0
        if merged < 0:
            continue
        r_start[merged], r_len[merged] = begin, end - begin
        entries += end - begin
        for e in range(begin, end):
            j, kept = r_col[e], c_start[r_col[e]]
            for p in range(c_start[j], c_start[j] + c_len[j]):
                i = c_row[p]
                if i != merged and r_len[i] > 0:
                    c_row[kept] = i
                    kept += 1
            c_row[kept] = merged
            c_len[j] = kept + 1 - c_start[j]
            _take(j, degree[j], head, after, before)
        _bound(n, begin, end, merged, c_start, c_len, c_row, r_len, r_col, degree, apart)
        for e in range(begin, end):
            j = r_col[e]
            _put(j, degree[j], head, after, before)
            least = min(least, degree[j])
    return entries


@internal
def _by_rows(n: int, nnz: int, row: Any, col: Any, start: Any, length: Any, columns: Any) -> None:
    for i in range(n):
        length[i] = 0
    for e in range(nnz):
        length[row[e]] += 1
    start[0] = 0
    for i in range(n):
        start[i + 1] = start[i] + length[i]
        length[i] = 0
    for e in range(nnz):
        i = row[e]
        columns[start[i] + length[i]] = col[e]
        length[i] += 1


@internal
def _bound(
    n: int, begin: int, end: int, merged: int,
    c_start: Any, c_len: Any, c_row: Any, r_len: Any, r_col: Any, degree: Any, apart: Any,
) -> None:  # fmt: skip
    """Bounds of the degrees of the columns in the merged row: what each other row has beyond it, added up."""
    for e in range(begin, end):
        j = r_col[e]
        for p in range(c_start[j], c_start[j] + c_len[j]):
            apart[c_row[p]] = r_len[c_row[p]]
    for e in range(begin, end):
        j = r_col[e]
        for p in range(c_start[j], c_start[j] + c_len[j]):
            apart[c_row[p]] -= 1
    for e in range(begin, end):
        j, found = r_col[e], end - begin - 1
        for p in range(c_start[j], c_start[j] + c_len[j]):
            if c_row[p] != merged:
                found += apart[c_row[p]]
        degree[j] = min(found, n - 1)


@internal
def _put(j: int, at: int, head: Any, after: Any, before: Any) -> None:
    after[j], before[j] = head[at], -1
    if head[at] >= 0:
        before[head[at]] = j
    head[at] = j


@internal
def _take(j: int, at: int, head: Any, after: Any, before: Any) -> None:
    if before[j] >= 0:
        after[before[j]] = after[j]
    else:
        head[at] = after[j]
    if after[j] >= 0:
        before[after[j]] = before[j]


@internal
def _close_up(n: int, r_start: Any, r_len: Any, r_col: Any, order: Any, used: int) -> int:
    """Move the rows, in the first `used` places, together; returns where they end."""
    # in the order in which they stand: what stands in the place of a row's first column says whose it is
    for i in range(n):
        if r_len[i] > 0:
            order[i] = r_col[r_start[i]]
            r_col[r_start[i]] = -1 - i
    end, at = 0, 0
    while at < used:
        if r_col[at] >= 0:
            at += 1
            continue
        i = -1 - r_col[at]
        r_col[at] = order[i]
        r_start[i], start = end, at
        for e in range(r_len[i]):
            r_col[end + e] = r_col[start + e]
        end += r_len[i]
        at = start + r_len[i]
    return end


@internal
def _by_neighbours(n: int, nnz: int, rows: int, cols: int, order: int, work: int) -> int:
    """Reverse Cuthill-McKee, to `order` (n,); returns the width of the band."""
    row, col, out = ivec(rows, nnz), ivec(cols, nnz), ivec(order, n)
    start, length, other = ivec(work, n + 1), ivec(work + 8 * (n + 1), n), ivec(work + 8 * (2 * n + 1), 2 * nnz)
    at = work + 8 * (2 * n + 1 + 2 * nnz)
    mark, queue = ivec(at, n), ivec(at + 8 * n, n)
    for i in range(n):
        length[i], mark[i] = 0, -1
    for e in range(nnz):
        if row[e] != col[e]:
            length[row[e]] += 1
            length[col[e]] += 1
    start[0] = 0
    for i in range(n):
        start[i + 1] = start[i] + length[i]
        length[i] = 0
    for e in range(nnz):
        i, j = row[e], col[e]
        if i == j:
            continue
        other[start[i] + length[i]], other[start[j] + length[j]] = j, i
        length[i] += 1
        length[j] += 1
    done, stamp = 0, 0
    for first in range(n):
        if mark[first] == n:
            continue
        # from an end of the component, as far as two searches find one
        root = first
        for _ in range(2):
            stamp += 1
            root = queue[_search(root, -1 - stamp, n, start, length, other, mark, queue) - 1]
        found = _search(root, n, n, start, length, other, mark, queue)
        for k in range(found):
            out[n - 1 - done - k] = queue[k]
        done += found
    for k in range(n):
        mark[out[k]] = k
    band = 0
    for e in range(nnz):
        band = max(band, abs(mark[row[e]] - mark[col[e]]))
    return band


@internal
def _search(root: int, stamp: int, done: int, start: Any, length: Any, other: Any, mark: Any, queue: Any) -> int:
    """The nodes that can be reached from `root`, nearer ones first and of neighbours those with fewer of their own:
    to `queue`; how many."""
    queue[0], mark[root] = root, stamp
    count, at = 1, 0
    while at < count:
        i, begin = queue[at], count
        at += 1
        for e in range(start[i], start[i + 1]):
            j = other[e]
            if mark[j] == stamp or mark[j] == done:
                continue
            mark[j] = stamp
            place = count
            while place > begin and length[queue[place - 1]] > length[j]:
                queue[place] = queue[place - 1]
                place -= 1
            queue[place] = j
            count += 1
    return count
