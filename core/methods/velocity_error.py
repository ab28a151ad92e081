"""What one-stage formulas of order 2 make wrong in velocities, and TLISMNI's in work accounts.

Their accelerations at the last three times span a parabola; its integral over the step (the implicit Adams formula of
order 3, on the actual grid) is one order better than the formula itself. What v_{n+1} - v_n differs from it by is the
local error: h^3/12 of the second derivative of the acceleration for the trapezoidal rule, and so for each formula its
own constant.

What lies along the constraints is left out where velocities do not follow from a partition: there they are not
integrated but given by the constraints (index 2), or off by O(h^2), now more and now less as the step changes, without
effect on what follows (index 3); and accelerations ring. With it steps would shrink to nothing (Petzold and Loetstedt
1986, Numerical solution of nonlinear DAEs with applications to physical problems II).

Why not positions alone: a vibration of small amplitude e and high frequency w on a large motion has positions that no
tolerance sees, and velocities e w that it does.
"""

from typing import Any

from ..assembly.evaluate import evaluate_constraints, evaluate_residuals, evaluate_tangent
from ..assembly.redundant_reactions import factor_equations, solve_equations
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..stage.corotating import enter_frame, recall_point
from ..stage.solver import weighted_norm
from ..state.workspace_records import OK, REANALYZE, counters_at
from .history import history_row, history_time
from .multistep import rows_available

SETTLED = 3
"""Rows of the history from which on a component that rings is taken for stiff: a start may step over a vibration."""
START_CURVATURE = 0.5
"""Without a third point: of the change of the acceleration over the step, as if it had been constant before."""


@internal
def _integral(h: float, shift: float, times: Any, known: bool, a1: float, a0: float, a2: float) -> float:
    """From 0 to h, of the parabola through a1, a0 and, if `known`, a2 at `times`.

    Accelerations that belong to the forces between two times, (1 + shift) F_{n+1} - shift F_n, are on the chord.
    """
    there, here, before = times
    slope = (a1 - a0) / (there - here)
    curvature = START_CURVATURE * slope / h
    if known:
        curvature = (slope - (a0 - a2) / (here - before)) / (there - before)
    of_curvature = h * h * h / 3.0 - 0.5 * (there + here) * h * h + there * here * h
    of_chord = shift * (1.0 + shift) * h * h * h
    return h * a1 + slope * (0.5 * h * h - h * there) + curvature * (of_curvature + of_chord)


@internal
def _find_error(workspace: Any, method: Any, h: float, shift: float) -> float:
    """Local error of the velocities into `rhs`; the largest of the work accounts in units of their weights."""
    n, rows = workspace.n_ext, rows_available(method)
    newest, older = history_row(workspace, method, 0), history_row(workspace, method, 1)
    v, a, error = vec(workspace.v, n), vec(workspace.a, n), vec(workspace.rhs, workspace.n)
    known, last, first = rows > 1, 0.0, 0.0
    if known:
        last = history_time(method, 0) - history_time(method, 1)
    if rows > 2:
        first = history_time(method, 1) - history_time(method, 2)
    times = (h + shift * h, shift * last, shift * first - last)
    of_powers = (h, 0.0, -last)
    for i in range(workspace.n):
        j = 2 * n + i
        error[i] = v[i] - newest[n + i] - _integral(h, shift, times, known, a[i], newest[j], older[j])
    of_work, weight_v = 0.0, vec(workspace.weight_v, n)
    for i in range(n - workspace.n_work, n):
        j = 2 * n + i
        off = v[i] - newest[n + i] - _integral(h, 0.0, of_powers, known, a[i], newest[j], older[j])
        of_work = max(of_work, abs(off) / weight_v[i])
    return of_work


@internal
def _remove_normal_part(workspace: Any) -> None:
    """Take from the velocities in `rhs` their part along the constraints, M^-1 Phi_q^T mu, with the factors of
    `kkt_query`; the residuals of the workspace's point are known before and after."""
    n, active = workspace.n, ivec(workspace.active, workspace.m_act)
    v, phid = vec(workspace.v, n), vec(workspace.phid, workspace.m_ext)
    # what the formula kept in q* and v* is no longer needed
    rhs, error, was = vec(workspace.rhs, n + workspace.m_act), vec(workspace.q_star, n), vec(workspace.v_star, n)
    for i in range(n):
        error[i] = rhs[i]
        v[i] -= error[i]
    for i in range(workspace.m_act):
        was[i] = phid[active[i]]
    evaluate_residuals(workspace)
    for i in range(workspace.m_act):
        # phid is linear in v
        rhs[n + i] = phid[active[i]] - was[i]
    for i in range(n):
        rhs[i] = 0.0
        v[i] += error[i]
    solve_equations(workspace, workspace.kkt_query)
    for i in range(n):
        rhs[i] += error[i]
    evaluate_residuals(workspace)


@internal
def velocity_error(workspace: Any, method: Any, h: float) -> float:
    """Weighted norm of the local error of velocities and work accounts, of the step of size h from the newest row to
    the workspace's point, whose velocities meet the constraints by a partition, or whose constraints are none."""
    of_work = _find_error(workspace, method, h, 0.0)
    return max(
        of_work, weighted_norm(vec(workspace.rhs, workspace.n), vec(workspace.weight_v, workspace.n_ext), workspace.n)
    )


@internal
def _filter(workspace: Any, h: float, times: int) -> None:
    """Velocities in `rhs`, multiplied `times` times by [M + c_v D + c_q K, Phi_q^T; Phi_q, 0]^-1 M, the factors of the
    stage whose solution the workspace holds."""
    n = workspace.n
    # what the formula kept in q* and v* is no longer needed
    a, r, rhs = vec(workspace.a, n), vec(workspace.r, n), vec(workspace.rhs, n + workspace.m_act)
    kept, left = vec(workspace.q_star, n), vec(workspace.v_star, n)
    evaluate_residuals(workspace)
    for i in range(n):
        # what is left of r belongs to the rounding of the constraints, too much where forces are stiff
        kept[i], left[i] = a[i], r[i]
    for _ in range(times):
        # r is linear in a
        for i in range(n):
            a[i] = kept[i] + rhs[i] / h
        evaluate_residuals(workspace)
        for i in range(n):
            rhs[i] = h * (r[i] - left[i])
        for i in range(workspace.m_act):
            rhs[n + i] = 0.0
        solve_equations(workspace, workspace.kkt)
    for i in range(n):
        a[i] = kept[i]
    evaluate_constraints(workspace)


@internal
def filtered_velocity_error(workspace: Any, method: Any, h: float, norm: float) -> float:
    """The larger of `norm` and the weighted norm of the local error of velocities and work accounts, without what stiff
    components ring.

    Accelerations of a component of frequency w that rings with velocities e, w h > 1, are w e: their parabola makes of
    it w h e/3, the more the larger the step. The filter (Hairer and Wanner, Solving ordinary differential equations II,
    IV.8) divides by 1 + (w h/2)^2 and leaves alone what a step resolves. Once that leaves 4 e/(3 w h), less for larger
    steps: after one rejected step the smaller ones would be rejected too, down to the component's period. So it is
    done twice; then what rings counts most where w h is about 1, which holds a vibration that has been resolved. In the
    first steps, which may be too large for one that is there, it is done once.
    """
    norm = max(norm, _find_error(workspace, method, h, 0.0))
    rhs, weight_v = vec(workspace.rhs, workspace.n), vec(workspace.weight_v, workspace.n_ext)
    most = weighted_norm(rhs, weight_v, workspace.n)
    if most <= norm:
        return norm
    recall_point(workspace)
    _filter(workspace, h, 1 if rows_available(method) < SETTLED else 2)
    enter_frame(workspace)
    found = weighted_norm(rhs, weight_v, workspace.n)
    # the filter spreads what is not counted (`frames.py`) to what is
    return max(norm, min(found, most) if workspace.n_spins > 0 else found)


@internal
def absolute_velocity_error(workspace: Any, method: Any, h: float, shift: float, factored: bool) -> Any:
    """(status, norm) of the velocities alone for formulas on all coordinates, without what lies along the constraints:
    nor do work accounts count, since the multipliers that ring there are the power and the impulse of contacts.

    `shift`: the accelerations of a step of size h stand for its end plus `shift` h (0, but for HHT on all coordinates);
    those of the row that begins a history, for its own time. `factored`: whether `kkt_query` has the mass matrix of
    (nearly) this point.
    """
    if workspace.m_act > 0 and not factored:
        evaluate_tangent(workspace, 0.0, 0.0)
        if factor_equations(workspace, workspace.kkt_query) != 0:
            return REANALYZE, 0.0
        counters_at(workspace.counters).factorizations += 1
    _find_error(workspace, method, h, shift)
    if workspace.m_act > 0:
        _remove_normal_part(workspace)
    return OK, weighted_norm(vec(workspace.rhs, workspace.n), vec(workspace.weight_v, workspace.n_ext), workspace.n)
