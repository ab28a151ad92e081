"""The matrices of TLISMNI's stages: factors of [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] and of Phi_qd, and what they tell
about the constraints: how sensitive the dependent coordinates are, how near a singular position is."""

from typing import Any

import numpy as np

from ..assembly.compatibility import factor_equations, solve_equations
from ..assembly.evaluate import evaluate_tangent
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..linalg import factor, lu_at, solve
from ..state.workspace_records import (
    CHOICE_CONDITION,
    CONDITION,
    COUNTERS_SIZE,
    FACTOR_AGE,
    FACTOR_CV,
    FACTORIZATIONS,
    FIRST_SENSITIVITY,
    LAST_INNER,
    LAST_OUTER,
    LEAST_CONDITION,
    OK,
    OUTER_RATE,
    RATE_SIZE,
    REANALYZE,
    SENSITIVITY,
    SINGULAR,
    WORST_CONDITION,
)

# Growth of the condition after which other redundant rows may be the better ones to leave out.
CHOICE_GROWTH = 3.0


@internal
def refactor(ws: Any, c_q: float, c_v: float) -> int:
    """New matrices at the current point: [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] and Phi_qd; of positions alone too,
    where they have dependent coordinates of their own."""
    rate = vec(ws.rate, RATE_SIZE)
    evaluate_tangent(ws, c_q, c_v)
    rate[FACTOR_AGE] = -1.0
    for k in range(3):
        address, size = ws.kkt, ws.n
        if k > 0:
            address, size = (ws.lu_d, ws.m_act) if k == 1 else (ws.lu_p, ws.m_held)
        # without velocity-level rows the third is the second
        if size == 0 or (k == 2 and ws.m_held == ws.m_act):
            continue
        status = factor_equations(ws, address) if k == 0 else factor(lu_at(address), ws.values)
        if status == 2:
            return REANALYZE
        if status != 0:
            return SINGULAR
    _measure_sensitivity(ws)
    _measure_condition(ws)
    ivec(ws.counters, COUNTERS_SIZE)[FACTORIZATIONS] += 1
    rate[FACTOR_AGE], rate[FACTOR_CV] = 0.0, c_v
    rate[OUTER_RATE], rate[LAST_OUTER], rate[LAST_INNER] = 1.0, 0.0, 0.0
    return OK


@internal
def _measure_sensitivity(ws: Any) -> None:
    """How much the dependent coordinates move (scaled) for one move of all independent ones: |Phi_qd^-1 Phi_qi x|."""
    rate = vec(ws.rate, RATE_SIZE)
    if ws.m_act == 0 or ws.m_act == ws.n:
        return
    scale = vec(ws.scale, ws.n)
    values = vec(ws.values, ws.n_values)
    row, col, slot = ivec(ws.free_row, ws.n_free), ivec(ws.free_col, ws.n_free), ivec(ws.free_slot, ws.n_free)
    dependent = ivec(ws.dependent, ws.m_act)
    rhs = vec(ws.rhs, ws.m_act)
    for i in range(ws.m_act):
        rhs[i] = 0.0
    for e in range(ws.n_free):
        # weights between 1/2 and 3/2 in no simple ratio, so that the columns do not cancel
        golden = 0.6180339887498949 * col[e]
        rhs[row[e]] += values[slot[e]] * scale[col[e]] * (0.5 + golden - np.floor(golden))
    solve(lu_at(ws.lu_d), ws.rhs)
    largest = 0.0
    for i in range(ws.m_act):
        largest = max(largest, abs(rhs[i]) / scale[dependent[i]])
    rate[SENSITIVITY] = largest
    if rate[FIRST_SENSITIVITY] < 0.0:
        rate[FIRST_SENSITIVITY] = largest


@internal
def _dependent_move(ws: Any) -> float:
    """How far (scaled) the dependent coordinates move to mend the same violation, the others being held."""
    rhs = vec(ws.rhs, ws.m_act)
    probe, scale = vec(ws.probe, ws.m_act), vec(ws.scale, ws.n)
    dependent = ivec(ws.dependent, ws.m_act)
    for i in range(ws.m_act):
        rhs[i] = probe[i]
    solve(lu_at(ws.lu_d), ws.rhs)
    largest = 0.0
    for i in range(ws.m_act):
        largest = max(largest, abs(rhs[i]) / scale[dependent[i]])
    return largest


@internal
def _measure_condition(ws: Any) -> None:
    """How far (scaled) the coordinates must move, at least, to mend one pseudo-random violation of size 1 of all rows:
    about the inverse of the distance to a singular position, whatever the partition.

    What is found is the move of least mass, which need not be the smallest: light parts turn far where many heavy ones
    would have to shift a little. In a straight chain of 1000 rods it grows to 27 times what it was as the chain bends,
    far from any singular position. So where it has grown, it counts only if the dependent coordinates alone, whose
    move is no smaller than the smallest either, do not mend the violation by less than ever before.
    """
    if ws.m_act == 0:
        return
    rate = vec(ws.rate, RATE_SIZE)
    rhs = vec(ws.rhs, ws.n + ws.m_act)
    probe, scale = vec(ws.probe, ws.m_act), vec(ws.scale, ws.n)
    for i in range(ws.n):
        rhs[i] = 0.0
    for i in range(ws.m_act):
        rhs[ws.n + i] = probe[i]
    solve_equations(ws, ws.kkt)
    largest = 0.0
    for i in range(ws.n):
        largest = max(largest, abs(rhs[i]) / scale[i])
    least = rate[LEAST_CONDITION]
    if largest > CHOICE_GROWTH * least > 0.0 and _dependent_move(ws) <= least:
        largest = least
    rate[CONDITION] = largest
    rate[WORST_CONDITION] = max(rate[WORST_CONDITION], largest)
    if least > CHOICE_GROWTH * largest > CHOICE_GROWTH**2 * _dependent_move(ws):
        # the first ones of a structure, at guesses far away, were such moves: what they were is no growth
        rate[WORST_CONDITION] = largest
    if rate[CHOICE_CONDITION] == 0.0 or CHOICE_GROWTH * largest < rate[CHOICE_CONDITION]:
        rate[CHOICE_CONDITION] = largest
    if rate[LEAST_CONDITION] == 0.0 or largest < rate[LEAST_CONDITION]:
        rate[LEAST_CONDITION] = largest
