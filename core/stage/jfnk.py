"""Outer loop `jfnk`: Jacobian-free Newton-Krylov (Knoll and Keyes 2004) on the accelerations of a stage.

Newton needs the increment of [S, Phi_q^T; Phi_q, 0] with S = M + c_v D + c_q K at the present point. Here S is never
formed there: GMRES (Saad and Schultz 1986) gets S w as the difference quotient of the residual along the motion that
w means (q + eps c_q w, v + eps c_v w, a + eps w), preconditioned from the left by the factors that the simulation
has, however old. They are renewed only if GMRES gets slow. Multipliers enter linearly and with the true Phi_q, so that
the Krylov vectors are accelerations alone, in error weights.
Forcing terms: Eisenstat and Walker (1996), choice 2, eta = 0.9 (|g_k| / |g_k-1|)^2.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals
from ..assembly.redundant_reactions import solve_equations
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..state.workspace_records import (
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_SLOW,
    control_at,
    convergence_at,
    counters_at,
)
from .inner import inner_loop
from .solver import (
    LEAST_RATE,
    RATE_GROWTH,
    add_increment,
    begin_stage,
    increment_norm,
    inner_slack,
    prepare_attempt,
    solve_increment,
)

MOST_VECTORS = 30
SLOW_KRYLOV = 12  # vectors that a stage may take before the preconditioner is renewed at the next
# rows of `basis`: the point (q, v, a), residuals there, the solution, then the Krylov vectors
POINT_Q, POINT_V, POINT_A, POINT_R, POINT_C, SOLUTION, FIRST = range(7)
BASIS_ROWS = FIRST + MOST_VECTORS + 1
LEAST_FORCING, MOST_FORCING = 1e-4, 0.1
# of the tolerance: a preconditioned residual below this is solved for without Krylov vectors
HIDDEN = 0.01
# of the size of the coordinates: the square root of their rounding
PROBE = 1e-7


@internal
def _apply(workspace: Any, w: Any, c_q: float, c_v: float) -> None:
    """rhs = preconditioner^-1 (S w, Phi_q w) by a difference quotient at the stored point; the point stays."""
    n = workspace.n
    basis = mat(workspace.basis, workspace.n_basis, workspace.n_ext)
    q, v, a = vec(workspace.q, workspace.n_ext), vec(workspace.v, workspace.n_ext), vec(workspace.a, workspace.n_ext)
    r, phidd = vec(workspace.r, workspace.n_ext), vec(workspace.phidd, workspace.m_ext)
    scale = vec(workspace.scale, n)
    active = ivec(workspace.active, workspace.m_act)
    move, speed_move, speed = 0.0, 0.0, 0.0
    for i in range(n):
        move = max(move, abs(w[i]) / scale[i])
        speed = max(speed, abs(basis[POINT_V, i]) / scale[i])
    speed_move = c_v * move
    move *= c_q
    size = np.inf
    if move > 0.0:
        size = PROBE / move
    if speed_move > 0.0:
        size = min(size, PROBE * (1.0 + speed) / speed_move)
    rhs = vec(workspace.rhs, n + workspace.m_act)
    for i in range(n + workspace.m_act):
        rhs[i] = 0.0
    if not np.isfinite(size):
        return
    for i in range(n):
        q[i] = basis[POINT_Q, i] + size * c_q * w[i]
        v[i] = basis[POINT_V, i] + size * c_v * w[i]
        a[i] = basis[POINT_A, i] + size * w[i]
    evaluate_residuals(workspace)
    for i in range(n):
        rhs[i] = (r[i] - basis[POINT_R, i]) / size
    for i in range(workspace.m_act):
        rhs[n + i] = (
            phidd[active[i]] - vec(workspace.basis + 8 * POINT_C * workspace.n_ext, workspace.m_act)[i]
        ) / size
    solve_equations(workspace, workspace.kkt)


@internal
def _gmres(workspace: Any, c_q: float, c_v: float, forcing: float, hessenberg: Any) -> Any:
    """Solve for the accelerations' increment; the right-hand side stands in row FIRST, weighted, with norm in
    hessenberg[0, -1]. Returns (vectors used, relative residual); the solution is in row SOLUTION."""
    n = workspace.n
    basis = mat(workspace.basis, workspace.n_basis, workspace.n_ext)
    weight = vec(workspace.weight_v, workspace.n_ext)
    increment = vec(workspace.rhs, n + workspace.m_act)
    cosine, sine, g = hessenberg[MOST_VECTORS + 1], hessenberg[MOST_VECTORS + 2], hessenberg[MOST_VECTORS + 3]
    beta = 0.0
    for i in range(n):
        beta += basis[FIRST, i] ** 2
    beta = np.sqrt(beta)
    solution = basis[SOLUTION]
    for i in range(n):
        solution[i] = 0.0
    if beta == 0.0:
        return 0, 0.0
    for i in range(n):
        basis[FIRST, i] /= beta
    g[0] = beta
    used = 0
    probe = solution
    for j in range(min(MOST_VECTORS, n)):
        for i in range(n):
            probe[i] = basis[FIRST + j, i] * weight[i]
        _apply(workspace, probe, c_q, c_v)
        new = basis[FIRST + j + 1]
        for i in range(n):
            new[i] = increment[i] / weight[i]
        before = 0.0
        for i in range(n):
            before += new[i] * new[i]
        for l in range(j + 1):
            hessenberg[l, j] = 0.0
        for _ in range(2):
            for l in range(j + 1):
                along = 0.0
                for i in range(n):
                    along += basis[FIRST + l, i] * new[i]
                hessenberg[l, j] += along
                for i in range(n):
                    new[i] -= along * basis[FIRST + l, i]
        length = 0.0
        for i in range(n):
            length += new[i] * new[i]
        length = np.sqrt(length)
        if length > 1e-12 * np.sqrt(before):
            for i in range(n):
                new[i] /= length
        else:
            length = 0.0
        for l in range(j):
            upper = cosine[l] * hessenberg[l, j] + sine[l] * hessenberg[l + 1, j]
            hessenberg[l + 1, j] = -sine[l] * hessenberg[l, j] + cosine[l] * hessenberg[l + 1, j]
            hessenberg[l, j] = upper
        radius = np.hypot(hessenberg[j, j], length)
        if radius == 0.0:
            break
        cosine[j], sine[j] = hessenberg[j, j] / radius, length / radius
        hessenberg[j, j] = radius
        g[j + 1] = -sine[j] * g[j]
        g[j] *= cosine[j]
        used = j + 1
        if abs(g[j + 1]) <= forcing * beta or length == 0.0:
            break
    for i in range(n):
        solution[i] = 0.0
    for j in range(used - 1, -1, -1):
        y = g[j]
        for l in range(j + 1, used):
            y -= hessenberg[j, l] * g[l]
        g[j] = y / hessenberg[j, j]
    for j in range(used):
        for i in range(n):
            solution[i] += g[j] * basis[FIRST + j, i] * weight[i]
    return used, abs(g[used]) / beta if used > 0 else 1.0


@internal
def _remember(workspace: Any) -> None:
    """Store the present point and its residuals."""
    n = workspace.n
    basis = mat(workspace.basis, workspace.n_basis, workspace.n_ext)
    q, v, a, r = (
        vec(workspace.q, workspace.n_ext),
        vec(workspace.v, workspace.n_ext),
        vec(workspace.a, workspace.n_ext),
        vec(workspace.r, workspace.n_ext),
    )
    phidd, active = vec(workspace.phidd, workspace.m_ext), ivec(workspace.active, workspace.m_act)
    constraints = vec(workspace.basis + 8 * POINT_C * workspace.n_ext, workspace.m_act)
    for i in range(n):
        basis[POINT_Q, i], basis[POINT_V, i], basis[POINT_A, i], basis[POINT_R, i] = q[i], v[i], a[i], r[i]
    for i in range(workspace.m_act):
        constraints[i] = phidd[active[i]]


@internal
def _return(workspace: Any) -> None:
    """Back to the stored point."""
    basis = mat(workspace.basis, workspace.n_basis, workspace.n_ext)
    q, v, a = vec(workspace.q, workspace.n_ext), vec(workspace.v, workspace.n_ext), vec(workspace.a, workspace.n_ext)
    for i in range(workspace.n):
        q[i], v[i], a[i] = basis[POINT_Q, i], basis[POINT_V, i], basis[POINT_A, i]


@internal
def solve_jfnk_stage(workspace: Any, t: float, c_q: float, c_v: float) -> int:
    """Solve one stage from the predicted a, lambda in the workspace; with a new preconditioner if an old one fails."""
    begin_stage(workspace, t, c_q, c_v)
    status = OK
    for attempt in range(2):
        status = prepare_attempt(workspace, c_q, c_v, attempt, SLOW_KRYLOV)
        if status != OK:
            return status
        fresh = convergence_at(workspace.rate).factor_age == 1.0
        status = _iterate(workspace, c_q, c_v)
        if status == OK or fresh:
            break
    return status


@internal
def _iterate(workspace: Any, c_q: float, c_v: float) -> int:
    """The inexact Newton iteration."""
    control, counters, rate = (
        control_at(workspace.control), counters_at(workspace.counters), convergence_at(workspace.rate),
    )  # fmt: skip
    n, rows = workspace.n, workspace.m_act + workspace.n_implied
    basis = mat(workspace.basis, workspace.n_basis, workspace.n_ext)
    weight = vec(workspace.weight_v, workspace.n_ext)
    increment = vec(workspace.rhs, n + rows)
    lam, active = vec(workspace.lam, workspace.m_ext), ivec(workspace.active, rows)
    hessenberg = np.zeros((MOST_VECTORS + 4, MOST_VECTORS + 1))
    tolerance, slack = control.newton_tolerance, inner_slack(control)
    start_inner = counters.inner
    previous, vectors, forcing = np.inf, 0, MOST_FORCING
    status = OUTER_SLOW
    for k in range(int(control.max_outer)):
        status = inner_loop(workspace, workspace.lu_d, slack, np.inf)
        if status != OK:
            return status
        solve_increment(workspace, workspace.kkt)
        counters.outer += 1
        norm = increment_norm(workspace, c_q, c_v)
        if not np.isfinite(norm):
            return NOT_FINITE
        for i in range(rows):
            lam[active[i]] += increment[n + i]
        known = min(rate.outer_rate * RATE_GROWTH, 0.99)
        # an old preconditioner may hide some of the increment, but not all of it
        if norm > HIDDEN * tolerance:
            for i in range(n):
                basis[FIRST, i] = increment[i] / weight[i]
            # what stays in the linear system need not be far below the tolerance either
            wanted = max(forcing, min(MOST_FORCING, 0.05 * tolerance / norm))
            # the multipliers have moved: so has the reference of the difference quotients
            evaluate_residuals(workspace)
            _remember(workspace)
            used, left = _gmres(workspace, c_q, c_v, wanted, hessenberg)
            counters.krylov += used
            vectors = max(vectors, used)
            _return(workspace)
            if left > 0.5:
                return OUTER_SLOW
            for i in range(n):
                increment[i] = basis[SOLUTION, i]
            norm = increment_norm(workspace, c_q, c_v)
            known = max(known, left)
        if k > 0:
            contraction = norm / previous
            known = min(max(contraction, LEAST_RATE), 0.99)
            rate.outer_rate = known
            if contraction > 0.9 and norm > tolerance:
                rate.failed_norm = contraction
                return OUTER_DIVERGED
            forcing = min(MOST_FORCING, max(LEAST_FORCING, 0.9 * contraction * contraction))
        previous = norm
        for i in range(rows):
            increment[n + i] = 0.0
        add_increment(workspace, c_q, c_v)
        evaluate_residuals(workspace)
        status = OUTER_SLOW
        if norm * known / (1.0 - known) <= tolerance:
            status = OK
            rate.outer_rate = known
            rate.last_outer = float(vectors)
            break
    if status != OK:
        return status
    status = inner_loop(workspace, workspace.lu_d, 1.0, 1.0)
    rate.last_inner = counters.inner - start_inner
    return status
