"""The matrices of TLISMNI's stages: factors of [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] and of Phi_qd, and what they tell
about the constraints: how sensitive the dependent coordinates are, how near a singular position is."""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_tangent
from ..assembly.redundant_reactions import factor_equations, solve_equations
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..linalg import factor, lu_at, solve
from ..state.workspace_records import (
    OK,
    REANALYZE,
    SINGULAR,
    convergence_at,
    counters_at,
)

# Growth of the condition after which other redundant rows may be the better ones to leave out.
CHOICE_GROWTH = 3.0


@internal
def refactor(workspace: Any, c_q: float, c_v: float) -> int:
    """New matrices at the current point: [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] and Phi_qd; of positions alone too,
    where they have dependent coordinates of their own."""
    rate = convergence_at(workspace.rate)
    evaluate_tangent(workspace, c_q, c_v)
    rate.factor_age = -1.0
    for k in range(3):
        address, size = workspace.kkt, workspace.n
        if k > 0:
            address, size = (workspace.lu_d, workspace.m_act) if k == 1 else (workspace.lu_p, workspace.m_held)
        # without velocity-level rows the third is the second
        if size == 0 or (k == 2 and workspace.m_held == workspace.m_act):
            continue
        status = factor_equations(workspace, address) if k == 0 else factor(lu_at(address), workspace.values)
        if status == 2:
            return REANALYZE
        if status != 0:
            return SINGULAR
    _measure_sensitivity(workspace)
    _measure_condition(workspace)
    counters_at(workspace.counters).factorizations += 1
    rate.factor_age, rate.factor_cv = 0.0, c_v
    rate.outer_rate, rate.last_outer, rate.last_inner = 1.0, 0.0, 0.0
    return OK


@internal
def _measure_sensitivity(workspace: Any) -> None:
    """How much the dependent coordinates move (scaled) for one move of all independent ones: |Phi_qd^-1 Phi_qi x|."""
    rate = convergence_at(workspace.rate)
    if workspace.m_act == 0 or workspace.m_act == workspace.n:
        return
    scale = vec(workspace.scale, workspace.n)
    values = vec(workspace.values, workspace.n_values)
    row, col, slot = (
        ivec(workspace.free_row, workspace.n_free),
        ivec(workspace.free_col, workspace.n_free),
        ivec(workspace.free_slot, workspace.n_free),
    )
    dependent = ivec(workspace.dependent, workspace.m_act)
    rhs = vec(workspace.rhs, workspace.m_act)
    for i in range(workspace.m_act):
        rhs[i] = 0.0
    for e in range(workspace.n_free):
        # weights between 1/2 and 3/2 in no simple ratio, so that the columns do not cancel
        golden = 0.6180339887498949 * col[e]
        rhs[row[e]] += values[slot[e]] * scale[col[e]] * (0.5 + golden - np.floor(golden))
    solve(lu_at(workspace.lu_d), workspace.rhs)
    largest = 0.0
    for i in range(workspace.m_act):
        largest = max(largest, abs(rhs[i]) / scale[dependent[i]])
    rate.sensitivity = largest
    if rate.first_sensitivity < 0.0:
        rate.first_sensitivity = largest


@internal
def _dependent_move(workspace: Any) -> float:
    """How far (scaled) the dependent coordinates move to mend the same violation, the others being held."""
    rhs = vec(workspace.rhs, workspace.m_act)
    probe, scale = vec(workspace.probe, workspace.m_act), vec(workspace.scale, workspace.n)
    dependent = ivec(workspace.dependent, workspace.m_act)
    for i in range(workspace.m_act):
        rhs[i] = probe[i]
    solve(lu_at(workspace.lu_d), workspace.rhs)
    largest = 0.0
    for i in range(workspace.m_act):
        largest = max(largest, abs(rhs[i]) / scale[dependent[i]])
    return largest


@internal
def _measure_condition(workspace: Any) -> None:
    """How far (scaled) the coordinates must move, at least, to mend one pseudo-random violation of size 1 of all rows:
    about the inverse of the distance to a singular position, whatever the partition.

    What is found is the move of least mass, which need not be the smallest: light parts turn far where many heavy ones
    would have to shift a little. In a straight chain of 1000 rods it grows to 27 times what it was as the chain bends,
    far from any singular position. So where it has grown, it counts only if the dependent coordinates alone, whose
    move is no smaller than the smallest either, do not mend the violation by less than ever before.
    """
    if workspace.m_act == 0:
        return
    rate = convergence_at(workspace.rate)
    rhs = vec(workspace.rhs, workspace.n + workspace.m_act)
    probe, scale = vec(workspace.probe, workspace.m_act), vec(workspace.scale, workspace.n)
    for i in range(workspace.n):
        rhs[i] = 0.0
    for i in range(workspace.m_act):
        rhs[workspace.n + i] = probe[i]
    solve_equations(workspace, workspace.kkt)
    largest = 0.0
    for i in range(workspace.n):
        largest = max(largest, abs(rhs[i]) / scale[i])
    least = rate.least_condition
    if largest > CHOICE_GROWTH * least > 0.0 and _dependent_move(workspace) <= least:
        largest = least
    rate.condition = largest
    rate.worst_condition = max(rate.worst_condition, largest)
    if least > CHOICE_GROWTH * largest > CHOICE_GROWTH**2 * _dependent_move(workspace):
        # the first ones of a structure, at guesses far away, were such moves: what they were is no growth
        rate.worst_condition = largest
    if rate.choice_condition == 0.0 or CHOICE_GROWTH * largest < rate.choice_condition:
        rate.choice_condition = largest
    if rate.least_condition == 0.0 or largest < rate.least_condition:
        rate.least_condition = largest
