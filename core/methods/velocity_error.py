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

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..linalg import factor, lu_at, solve
from ..stage.solver import weighted_norm
from ..system.evaluate import evaluate_residuals, evaluate_tangent
from ..system.records import COUNTERS_SIZE, FACTORIZATIONS, OK, REANALYZE
from .history import history_row, history_time
from .multistep import rows_available

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
def _find_error(ws: Any, ms: Any, h: float, shift: float) -> float:
    """Local error of the velocities into `rhs`; the largest of the work accounts in units of their weights."""
    n, rows = ws.n_ext, rows_available(ms)
    newest, older = history_row(ws, ms, 0), history_row(ws, ms, 1)
    v, a, error = vec(ws.v, n), vec(ws.a, n), vec(ws.rhs, ws.n)
    known, last, first = rows > 1, 0.0, 0.0
    if known:
        last = history_time(ms, 0) - history_time(ms, 1)
    if rows > 2:
        first = history_time(ms, 1) - history_time(ms, 2)
    times = (h + shift * h, shift * last, shift * first - last)
    of_powers = (h, 0.0, -last)
    for i in range(ws.n):
        j = 2 * n + i
        error[i] = v[i] - newest[n + i] - _integral(h, shift, times, known, a[i], newest[j], older[j])
    of_work, weight_v = 0.0, vec(ws.weight_v, n)
    for i in range(n - ws.n_work, n):
        j = 2 * n + i
        off = v[i] - newest[n + i] - _integral(h, 0.0, of_powers, known, a[i], newest[j], older[j])
        of_work = max(of_work, abs(off) / weight_v[i])
    return of_work


@internal
def _remove_normal_part(ws: Any) -> None:
    """Take from the velocities in `rhs` their part along the constraints, M^-1 Phi_q^T mu, with the factors of
    `kkt_query`; the residuals of the workspace's point are known before and after."""
    n, active = ws.n, ivec(ws.active, ws.m_act)
    v, phid = vec(ws.v, n), vec(ws.phid, ws.m_ext)
    # what the formula kept in q* and v* is no longer needed
    rhs, error, was = vec(ws.rhs, n + ws.m_act), vec(ws.q_star, n), vec(ws.v_star, n)
    for i in range(n):
        error[i] = rhs[i]
        v[i] -= error[i]
    for i in range(ws.m_act):
        was[i] = phid[active[i]]
    evaluate_residuals(ws)
    for i in range(ws.m_act):
        # phid is linear in v
        rhs[n + i] = phid[active[i]] - was[i]
    for i in range(n):
        rhs[i] = 0.0
        v[i] += error[i]
    solve(lu_at(ws.kkt_query), ws.rhs)
    for i in range(n):
        rhs[i] += error[i]
    evaluate_residuals(ws)


@internal
def velocity_error(ws: Any, ms: Any, h: float) -> float:
    """Weighted norm of the local error of velocities and work accounts, of the step of size h from the newest row to
    the workspace's point, whose velocities meet the constraints by a partition, or whose constraints are none."""
    of_work = _find_error(ws, ms, h, 0.0)
    return max(of_work, weighted_norm(vec(ws.rhs, ws.n), vec(ws.weight_v, ws.n_ext), ws.n))


@internal
def work_error(ws: Any, ms: Any, h: float) -> float:
    """The largest local error of the work accounts alone, in units of their weights."""
    return _find_error(ws, ms, h, 0.0)


@internal
def absolute_velocity_error(ws: Any, ms: Any, h: float, shift: float, factored: bool) -> Any:
    """(status, norm) of the velocities alone for formulas on all coordinates, without what lies along the constraints:
    nor do work accounts count, since the multipliers that ring there are the power and the impulse of contacts.

    `shift`: the accelerations of a step of size h stand for its end plus `shift` h (0, but for HHT on all coordinates);
    those of the row that begins a history, for its own time. `factored`: whether `kkt_query` has the mass matrix of
    (nearly) this point.
    """
    if ws.m_act > 0 and not factored:
        evaluate_tangent(ws, 0.0, 0.0)
        if factor(lu_at(ws.kkt_query), ws.values) != 0:
            return REANALYZE, 0.0
        ivec(ws.counters, COUNTERS_SIZE)[FACTORIZATIONS] += 1
    _find_error(ws, ms, h, shift)
    if ws.m_act > 0:
        _remove_normal_part(ws)
    return OK, weighted_norm(vec(ws.rhs, ws.n), vec(ws.weight_v, ws.n_ext), ws.n)
