"""New pivots for the present values, compiled: chosen, and taken with the analysis that has been made of them before.

What follows from values and pattern alone, whatever was analysed before: the same values give the same factors.
"""

from typing import Any

import numpy as np

from ..compiled import types
from ..compiled.jit import caller, compiled, internal
from ..compiled.views import ivec, uvec, vec
from .choice import choose_rows
from .record import GROWTH, LU_TYPE, OF_ANALYSIS, OK, WANT_ANALYSIS, WANT_VALUES, analysis_at
from .solve import factor

ANALYZE_SIGNATURE = types.int64(LU_TYPE, types.int64)
call_analyze = caller(ANALYZE_SIGNATURE)
"""call_analyze(address of `analyze`, lu, address of the values)."""
_COPY = "\n".join(f"    lu.{name} = found.{name}" for name in OF_ANALYSIS)
_NAMES: dict[str, Any] = {}
# numba knows the fields of a record by name only
exec(f"def take_fields(lu, found):\n{_COPY}\n", _NAMES)
_take_fields = internal(_NAMES["take_fields"])


@internal
def take_analysis(lu: Any, address: int) -> None:
    """Let the analysis at `address` be the present one, without factors."""
    found = analysis_at(address)
    _take_fields(lu, found)
    lu.analysis = address
    # as a fresh one: nothing is known of how the entries of L may grow
    values, limits = vec(lu.values, found.size), found.nl + found.nu + lu.n
    for i in range(lu.n):
        values[limits + i] = np.inf


@internal
def _same(perm_r: int, wanted: Any) -> bool:
    own = ivec(perm_r, len(wanted))
    for i in range(len(wanted)):
        if own[i] != wanted[i]:
            return False
    return True


@internal
def _find(lu: Any) -> int:
    """Address of the analysis of the wanted pivots; 0 if it is not known."""
    wanted = ivec(lu.wanted, lu.n)
    if lu.analysis != 0 and _same(analysis_at(lu.analysis).perm_r, wanted):
        return int(lu.analysis)
    known = ivec(lu.known, ivec(lu.n_known, 1)[0])
    for k in range(len(known)):
        if _same(analysis_at(known[k]).perm_r, wanted):
            return int(known[k])
    return 0


@compiled
def analyze(lu: Any, values_address: int) -> int:
    """Choose pivots for the source array at `values_address`, and factor with them: OK, NO_PIVOT, WANT_ANALYSIS or
    WANT_ROOM; on the last two Python makes what is wanted (`Factorization.make_wanted`)."""
    if lu.order == 0:
        return int(factor(lu, values_address))
    status, address = WANT_ANALYSIS, 0
    if lu.order > 0:
        status = choose_rows(lu, values_address)
    if status == OK:
        address = _find(lu)
        status = OK if address != 0 and analysis_at(address).size <= lu.room else WANT_ANALYSIS
    if status != OK:
        lu.wants = status if status >= WANT_ANALYSIS else 0
        return int(status)
    take_analysis(lu, address)
    status = factor(lu, values_address)
    if status == OK:
        _set_limits(lu)
    return int(status)


@compiled
def use_analysis(lu: Any, address: int) -> None:
    """`take_analysis`, for Python."""
    take_analysis(lu, address)


@internal
def _set_limits(lu: Any) -> None:
    """How large the entries of L may grow with later values: an entry that is 1 once the rows are balanced does not
    count as growth, whatever the units of the rows."""
    n, nl, nu = lu.n, lu.nl, lu.nu
    values, scale, unit = vec(lu.values, nl + nu + 2 * n), vec(lu.choice_work, n), vec(lu.row_unit, n)
    row_at, l_row, l_col = uvec(lu.row_at, n), uvec(lu.l_row, nl), uvec(lu.l_col, nl)
    limits = nl + nu + n
    for i in range(n):
        values[limits + i] = 0.0
    for p in range(nl):
        j, above, below = l_col[p], row_at[l_col[p]], row_at[l_row[p]]
        own = scale[above] * unit[above] / (scale[below] * unit[below])
        values[limits + j] = max(values[limits + j], own, abs(values[p]))
    for i in range(n):
        values[limits + i] *= GROWTH


@compiled
def follow(lu: Any, other: Any) -> bool:
    """Take analysis and factors of `other`, which has the same entries, slots and units; False if there is no room,
    for which Python is asked."""
    if lu.order == 0:
        own, given = ivec(lu.pivots, lu.n), ivec(other.pivots, lu.n)
        for i in range(lu.n):
            own[i] = given[i]
        size = lu.n * (lu.n + 1)
    else:
        size = analysis_at(other.analysis).size
        if lu.order < 0 or size > lu.room:
            lu.wants = WANT_VALUES
            return False
        if lu.analysis != other.analysis:
            take_analysis(lu, other.analysis)
    values, factors = vec(lu.values, size), vec(other.values, size)
    for p in range(size):
        values[p] = factors[p]
    return True
