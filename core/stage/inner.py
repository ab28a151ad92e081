"""The inner loop: dependent coordinates, velocities and accelerations from the constraints.

Newton on Phi with the square sparse matrix Phi_qd; velocities and accelerations use the same factorisation. Velocity-
level rows W v = w come behind those of Phi: their dependent velocities and accelerations are solved for with
[Phi_q; W]_d, the positions of these coordinates stay as the formula integrates them.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import constraint_norm, evaluate_constraints, evaluate_residuals
from ..assembly.levels import acceleration_level, position_level, rate_level
from ..assembly.row_rounding import row_rounding
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at, solve
from ..state.workspace_records import (
    INNER_DIVERGED,
    OK,
    control_at,
    convergence_at,
    counters_at,
)

STRAINED = 8.0  # growth of the condition beyond which the constraints are solved more exactly


@internal
def correct_dependent(workspace: Any, lu_address: int, m: int, residual_address: int, x_address: int) -> None:
    """x_d -= Phi_qd^-1 residual, of the first m active rows."""
    active = ivec(workspace.active, m)
    dependent = ivec(workspace.dependent, m)
    residual = vec(residual_address, workspace.m_ext)
    rhs = vec(workspace.rhs, m)
    for i in range(m):
        rhs[i] = residual[active[i]]
    solve(lu_at(lu_address), workspace.rhs)
    x = vec(x_address, workspace.n_ext)
    for i in range(m):
        x[dependent[i]] -= rhs[i]


@internal
def inner_loop(workspace: Any, lu_address: int, slack: float, acceleration_slack: float, part: bool = False) -> int:
    """Correct q_d, v_d, a_d until the constraints hold to the tolerances times `slack`.

    `acceleration_slack` is that of a_d: infinite while the outer loop still moves the accelerations.

    Expects the residuals of the current point, or if `part` only what `evaluate_constraints` leaves; leaves the
    residuals of the corrected one. The tolerances are parts of the levels of q, v, a (`assembly/levels.py`).
    """
    before = counters_at(workspace.counters).inner
    status = OK if workspace.m_act == 0 else _meet(workspace, lu_address, slack, acceleration_slack)
    if workspace.part_first != 0 and (part or counters_at(workspace.counters).inner > before):
        evaluate_residuals(workspace)
    return status


@internal
def _meet(workspace: Any, lu_address: int, slack: float, acceleration_slack: float) -> int:
    """The corrections; leaves what `evaluate_constraints` does."""
    control = control_at(workspace.control)
    counters = counters_at(workspace.counters)
    enough_p = slack * control.position_tolerance * position_level(workspace)
    enough_v = slack * control.velocity_tolerance * rate_level(workspace)
    enough_a = acceleration_slack * control.acceleration_tolerance * acceleration_level(workspace)
    # near a singular position a violation of Phi moves q by condition, v by condition^2 times as much: there the
    # constraints are solved down to rounding, whatever the units
    rate = convergence_at(workspace.rate)
    tight = control.exactness if slack == 1.0 else 1.0
    if rate.condition > STRAINED * rate.least_condition:
        tight = 0.0
    tol_p, tol_v, tol_a = tight * enough_p, tight * enough_v, tight * enough_a
    if acceleration_slack == np.inf:
        tol_a = np.inf
    last_p, last_v, last_a = np.inf, np.inf, np.inf
    for _ in range(int(control.max_inner)):
        p = constraint_norm(workspace, workspace.phi)
        v = constraint_norm(workspace, workspace.phid)
        a = constraint_norm(workspace, workspace.phidd)
        # what no longer halves is rounding where the row's terms are so large (`row_rounding`), and enough;
        # a level is judged once those above it hold: correcting q moves the residuals of v and a
        correct_p = p > tol_p and not enough_p >= p >= 0.5 * last_p
        correct_v = v > tol_v and not enough_v >= v >= 0.5 * last_v
        correct_a = a > tol_a and not enough_a >= a >= 0.5 * last_a
        if correct_p:
            if not p < 0.5 * last_p:
                if not p <= row_rounding(workspace, workspace.q, False):
                    return INNER_DIVERGED
                enough_p = tol_p = p
                continue
            last_p, last_v, last_a = p, np.inf, np.inf
        elif correct_v:
            if not v < 0.5 * last_v:
                if not v <= row_rounding(workspace, workspace.v, False):
                    return INNER_DIVERGED
                enough_v = tol_v = v
                continue
            last_v, last_a = v, np.inf
        elif correct_a:
            if not a < 0.5 * last_a:
                if not a <= row_rounding(workspace, workspace.a, True):
                    return INNER_DIVERGED
                enough_a = tol_a = a
                continue
            last_a = a
        else:
            return OK
        counters.inner += 1
        if correct_p:
            correct_dependent(workspace, workspace.lu_p, workspace.m_held, workspace.phi, workspace.q)
        if correct_v:
            correct_dependent(workspace, lu_address, workspace.m_act, workspace.phid, workspace.v)
        if correct_a:
            correct_dependent(workspace, lu_address, workspace.m_act, workspace.phidd, workspace.a)
        evaluate_constraints(workspace)
    met = (
        constraint_norm(workspace, workspace.phi) <= enough_p and constraint_norm(workspace, workspace.phid) <= enough_v
    )
    if met and constraint_norm(workspace, workspace.phidd) <= enough_a:
        return OK
    return INNER_DIVERGED
