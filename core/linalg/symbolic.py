"""Fill pattern of L and U for fixed pivots, and the list of operations of the refactorisation.

The pattern is structural: an entry that is zero by chance in the values of the day keeps its place.

What is compiled receives its arrays from Python: allocation in compiled code would double its compile time.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import compiled_unlocked

Ints = NDArray[np.int64]
UInts = NDArray[np.uint32]


class Triangle(NamedTuple):
    """Pattern of L or U without its diagonal: columns one after the other, rows ascending in each."""

    start: Ints  # (n + 1,)
    row: Ints  # (entries,)
    col: Ints  # (entries,)

    def find(self, n: int, row: Ints, col: Ints) -> Ints:
        """Positions of entries that are in the pattern."""
        return np.searchsorted(self.col * n + self.row, col * n + row)


class Operations(NamedTuple):
    """Positions in (L, U) of each multiply-subtract, by columns: those of entries, and those of pivots."""

    step_start: UInts  # (n + 1,)
    steps: UInts  # (3, n_steps): to, left, right
    sum_start: UInts  # (n + 1,)
    sums: UInts  # (2, n_sums): left, right


def fill_pattern(n: int, row: Ints, col: Ints) -> tuple[Triangle, Triangle]:
    """Patterns of L and U of the matrix with entries at (row, col), factored without pivoting."""
    given = np.argsort(col, kind="stable")
    start = _starts(n, col)
    space = 2 * len(row) + 2 * n + 16
    while True:
        l_start, u_start = np.zeros(n + 1, np.int64), np.zeros(n + 1, np.int64)
        l_row, u_row = np.empty(space, np.int64), np.empty(space, np.int64)
        marks = np.full((2, n), -1, np.int64)
        stack = np.empty(n, np.int64)
        if _search(n, start, row[given], l_start, l_row, u_start, u_row, marks[0], marks[1], stack):
            return _triangle(n, l_start, l_row), _triangle(n, u_start, u_row)
        space *= 2


def _starts(n: int, col: Ints) -> Ints:
    return np.concatenate(([0], np.cumsum(np.bincount(col, minlength=n)))).astype(np.int64)


def _triangle(n: int, start: Ints, row: Ints) -> Triangle:
    col = np.repeat(np.arange(n), np.diff(start))
    row = row[: start[n]]
    return Triangle(start, row[np.argsort(col * n + row, kind="stable")], col)


@compiled_unlocked
def _search(
    n: int,
    start: Any,
    row: Any,
    l_start: Any,
    l_row: Any,
    u_start: Any,
    u_row: Any,
    mark: Any,
    search_end: Any,
    stack: Any,
) -> bool:
    """Fill in l_start, l_row, u_start, u_row, rows in no order; False if `l_row` or `u_row` is too short.

    Column j is what can be reached from the rows of column j of the matrix along the columns of L (Gilbert &
    Peierls 1988); columns of L are shortened to what later searches need (symmetric pruning, Eisenstat & Liu
    1992), which makes the work nearly linear in the fill.
    """
    nl = 0
    nu = 0
    for j in range(n):
        if nl + n - j > len(l_row) or nu + j > len(u_row):
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


def count_operations(l: Triangle, u: Triangle) -> int:
    """Number of multiply-subtracts of the refactorisation."""
    return int(np.diff(l.start)[u.row].sum())


def operation_list(n: int, l: Triangle, u: Triangle) -> Operations:
    """Write down the refactorisation."""
    # zeros: of what stays unused images of runs would have what memory happened to hold
    steps = np.zeros((3, count_operations(l, u)), np.uint32)
    sums = np.zeros((2, len(u.row)), np.uint32)
    step_start, sum_start = np.zeros(n + 1, np.uint32), np.zeros(n + 1, np.uint32)
    place = np.zeros(n, np.int64)
    _write_operations(n, l.start, l.row, u.start, u.row, step_start, steps, sum_start, sums, place)
    return Operations(step_start, steps[:, : step_start[n]], sum_start, sums[:, : sum_start[n]])


@compiled_unlocked
def _write_operations(
    n: int,
    l_start: Any,
    l_row: Any,
    u_start: Any,
    u_row: Any,
    step_start: Any,
    steps: Any,
    sum_start: Any,
    sums: Any,
    place: Any,
) -> None:
    nl = l_start[n]
    n_steps = 0
    n_sums = 0
    for j in range(n):
        for p in range(u_start[j], u_start[j + 1]):
            place[u_row[p]] = nl + p
        for p in range(l_start[j], l_start[j + 1]):
            place[l_row[p]] = p
        for p in range(u_start[j], u_start[j + 1]):
            k = u_row[p]
            for q in range(l_start[k], l_start[k + 1]):
                if l_row[q] == j:
                    sums[0, n_sums] = q
                    sums[1, n_sums] = nl + p
                    n_sums += 1
                else:
                    steps[0, n_steps] = place[l_row[q]]
                    steps[1, n_steps] = q
                    steps[2, n_steps] = nl + p
                    n_steps += 1
        step_start[j + 1] = n_steps
        sum_start[j + 1] = n_sums
