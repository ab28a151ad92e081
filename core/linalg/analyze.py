"""Order of the columns, pivots for the present values, and what follows from them: compiled.

All follows from values and pattern alone, whatever was analysed before: the same values give the same factors.
"""

from typing import Any

import numpy as np

from ..compiled import types
from ..compiled.jit import caller, compiled, internal
from ..compiled.views import ivec, uvec, vec
from .choice import choose_rows
from .ordering import choose_order, order_room
from .record import (
    ANALYZE_SPARSE,
    DENSE,
    IN_INDEX,
    INDEX,
    LU_TYPE,
    MOST_PIVOT_GROWTH,
    OK,
    SCRATCH,
    UNREADY,
    VALUES,
    WANT_ROOM,
)
from .solve import factor
from .symbolic import write_analysis

ANALYZE_SIGNATURE = types.int64(LU_TYPE, types.int64)
call_analyze = caller(ANALYZE_SIGNATURE)
"""call_analyze(address of `analyze`, lu, address of the values)."""
_TABLES = "\n".join(f"    lu.{name} = lu.index + (other.{name} - other.index)" for name in IN_INDEX)
_NAMES: dict[str, Any] = {}
# numba knows the fields of a record by name only
exec(f"def point_as(lu, other):\n{_TABLES}\n", _NAMES)
_point_as = internal(_NAMES["point_as"])


@internal
def lay_out(lu: Any, n: int, nnz: int, row: int, col: int, slot: int, dense: bool, words: int, reals: int) -> int:
    """A factorisation of the matrix (n, n) with the nnz entries at the addresses `row`, `col`, which come from the
    places `slot`: OK or WANT_ROOM. `words` and `reals` are addresses of `words_of(n, nnz)` and 3 n numbers."""
    lu.n, lu.nnz, lu.row, lu.col, lu.slot = n, nnz, row, col, slot
    lu.kind, lu.ordered, lu.ready = DENSE if dense else UNREADY, 0, 0
    functions = ivec(lu.functions, 4)
    lu.factor_function, lu.solve_function = functions[2 * lu.kind], functions[2 * lu.kind + 1]
    lu.work, lu.row_unit, lu.col_unit = reals, reals + 8 * n, reals + 16 * n
    lu.order, lu.perm_r, lu.wanted, lu.pivots = words, words + 8 * n, words + 16 * n, words + 24 * n
    words += 32 * n
    lu.column_start, lu.column_row = words, words + 8 * (n + 1)
    words += 8 * (n + 1) + 8 * nnz
    lu.column_of, lu.column_slot = words, words + 8 * nnz
    if not dense:
        return OK
    if 2 * nnz > lu.index_room or n * (n + 1) > lu.room:
        needs = ivec(lu.needs, 3)
        needs[INDEX], needs[VALUES] = 2 * nnz, n * (n + 1)
        return WANT_ROOM
    lu.entry_to, lu.entry_from = lu.index, lu.index + 4 * nnz
    to, given, pivots = uvec(lu.entry_to, nnz), uvec(lu.entry_from, nnz), ivec(lu.pivots, n)
    rows, cols, slots = ivec(row, nnz), ivec(col, nnz), ivec(slot, nnz)
    for e in range(nnz):
        to[e], given[e] = rows[e] * n + cols[e], slots[e]
    for i in range(n):
        pivots[i] = i
    return OK


@internal
def words_of(n: int, nnz: int) -> int:
    """Words that `lay_out` wants."""
    return 5 * n + 1 + 3 * nnz


@compiled
def lay_out_now(
    lu: Any, n: int, nnz: int, row: int, col: int, slot: int, dense: bool, words: int, reals: int
) -> int:  # fmt: skip
    """`lay_out`, for Python."""
    return lay_out(lu, n, nnz, row, col, slot, dense, words, reals)


@internal
def order_columns(lu: Any) -> int:
    """Have the order of the columns: OK or WANT_ROOM."""
    if lu.ordered != 0:
        return OK
    n, nnz, scratch = lu.n, lu.nnz, ivec(lu.scratch, 2)
    if order_room(n, nnz) > scratch[1]:
        ivec(lu.needs, 3)[SCRATCH] = order_room(n, nnz)
        return WANT_ROOM
    choose_order(n, nnz, lu.row, lu.col, lu.order, scratch[0])
    order, place, start = ivec(lu.order, n), ivec(scratch[0], n), ivec(lu.column_start, n + 1)
    at = ivec(scratch[0] + 8 * n, n)
    rows, cols, slots = ivec(lu.row, nnz), ivec(lu.col, nnz), ivec(lu.slot, nnz)
    row, of, slot = ivec(lu.column_row, nnz), ivec(lu.column_of, nnz), ivec(lu.column_slot, nnz)
    for k in range(n):
        place[order[k]], at[k] = k, 0
    for e in range(nnz):
        at[place[cols[e]]] += 1
    start[0] = 0
    for k in range(n):
        start[k + 1] = start[k] + at[k]
        at[k] = start[k]
    for e in range(nnz):
        k = place[cols[e]]
        row[at[k]], of[at[k]], slot[at[k]] = rows[e], cols[e], slots[e]
        at[k] += 1
    lu.ordered = 1
    return OK


@compiled
def analyze(lu: Any, values_address: int) -> int:
    """Choose pivots for the source array at `values_address`, and factor with them: OK, NO_PIVOT or WANT_ROOM; on the
    last there must be more room (`needs`) before it is asked again."""
    if lu.kind == DENSE or lu.n == 0:
        return int(factor(lu, values_address))
    return int(call_analyze(ivec(lu.functions, ANALYZE_SPARSE + 1)[ANALYZE_SPARSE], lu, values_address))


@internal
def analyze_sparse(lu: Any, values_address: int) -> int:
    """`analyze` of a matrix that is not dense; without values: take the pivots of `wanted`. (Called by address: small
    systems compile none of it.)"""
    status = order_columns(lu)
    if status == OK and values_address != 0:
        status = choose_rows(lu, values_address)
    if status == OK:
        status = _use_wanted(lu)
    if status != OK:
        return int(status)
    _let_grow(lu)
    if values_address == 0:
        return OK
    status = factor(lu, values_address)
    if status == OK:
        _set_limits(lu)
    return int(status)


@internal
def _use_wanted(lu: Any) -> int:
    if lu.ready != 0 and _same(lu):
        return OK
    return int(write_analysis(lu))


@internal
def _same(lu: Any) -> bool:
    own, wanted = ivec(lu.perm_r, lu.n), ivec(lu.wanted, lu.n)
    for i in range(lu.n):
        if own[i] != wanted[i]:
            return False
    return True


@internal
def _let_grow(lu: Any) -> None:
    """As a fresh one: nothing is known of how the entries of L may grow."""
    limits = lu.nl + lu.nu + lu.n
    values = vec(lu.values, limits + lu.n)
    for i in range(lu.n):
        values[limits + i] = np.inf


@compiled
def use_pivots(lu: Any) -> int:
    """Take the pivots of `wanted`, without values: OK or WANT_ROOM; for Python."""
    if lu.kind == DENSE or lu.n == 0:
        return OK
    return int(call_analyze(ivec(lu.functions, ANALYZE_SPARSE + 1)[ANALYZE_SPARSE], lu, 0))


@internal
def _set_limits(lu: Any) -> None:
    """How large the entries of L may grow with later values: an entry that is 1 once the rows are balanced does not
    count as growth, whatever the units of the rows."""
    n, nl, nu = lu.n, lu.nl, lu.nu
    values, scale, unit = vec(lu.values, nl + nu + 2 * n), vec(ivec(lu.scratch, 2)[0], n), vec(lu.row_unit, n)
    row_at, l_row, l_col = uvec(lu.row_at, n), uvec(lu.l_row, nl), uvec(lu.l_col, nl)
    limits = nl + nu + n
    for i in range(n):
        values[limits + i] = 0.0
    for p in range(nl):
        j, above, below = l_col[p], row_at[l_col[p]], row_at[l_row[p]]
        own = scale[above] * unit[above] / (scale[below] * unit[below])
        values[limits + j] = max(values[limits + j], own, abs(values[p]))
    for i in range(n):
        values[limits + i] *= MOST_PIVOT_GROWTH


@compiled
def follow(lu: Any, other: Any) -> int:
    """Take analysis and factors of `other`, which has the same entries, slots and units: OK or WANT_ROOM."""
    if lu.n == 0:
        return OK
    if lu.kind == DENSE:
        own, given = ivec(lu.pivots, lu.n), ivec(other.pivots, lu.n)
        for i in range(lu.n):
            own[i] = given[i]
        size = lu.n * (lu.n + 1)
    else:
        used = (other.sum_right - other.index) // 4 + other.n_sums
        size = other.nl + other.nu + 2 * lu.n
        if used > lu.index_room or size > lu.room:
            needs = ivec(lu.needs, 3)
            needs[INDEX], needs[VALUES] = used, size
            return WANT_ROOM
        if lu.ready == 0 or not _as_pivots(lu, other):
            own_index, index = uvec(lu.index, used), uvec(other.index, used)
            for i in range(used):
                own_index[i] = index[i]
            _point_as(lu, other)
            lu.nl, lu.nu, lu.n_steps, lu.n_sums = other.nl, other.nu, other.n_steps, other.n_sums
            lu.kind, lu.factor_function, lu.solve_function = other.kind, other.factor_function, other.solve_function
            perm, pivots = ivec(lu.perm_r, lu.n), ivec(other.perm_r, lu.n)
            for i in range(lu.n):
                perm[i] = pivots[i]
            lu.ready = 1
    values, factors = vec(lu.values, size), vec(other.values, size)
    for p in range(size):
        values[p] = factors[p]
    return OK


@internal
def _as_pivots(lu: Any, other: Any) -> bool:
    own, given = ivec(lu.perm_r, lu.n), ivec(other.perm_r, lu.n)
    for i in range(lu.n):
        if own[i] != given[i]:
            return False
    return True
