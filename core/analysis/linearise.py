"""The system linearised at points of a run: M, K, D, Phi_q and the rate of Phi_q along the motion.

K and D are the derivatives of M a + Phi_q^T lambda - Q by q and v. The compiled tangent is affine in (c_q, c_v), so
that three of them give M, K and D. The constraints at acceleration level,

    phidd(v) = Phi_q a + v^T Phi_qq v + 2 Phi_qt v + Phi_tt,

are a quadratic form in v: its polar form (phidd(v + w) - phidd(v - w))/4 is the rate of Phi_q along the motion times w,
B w = (Phi_q v + Phi_t)_q w. That is an identity, not a difference quotient: no step size, exact to rounding.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..compiled.jit import compiled, internal
from ..compiled.kernels import RESIDUAL
from ..compiled.views import ivec, vec
from ..event_detection.dense_output import query
from ..state.workspace_records import OK, call_evaluate


@internal
def speed_scale(v: Any, n: int) -> float:
    """Largest speed, at least 1: size of the velocities with which the quadratic form is probed."""
    largest = 1.0
    for i in range(n):
        largest = max(largest, abs(v[i]))
    return largest


@internal
def scatter(workspace: Any, rows: Any, cols: Any, s: Any, jacobian: Any, factor: float) -> None:
    """s += factor (upper left block of the matrix last evaluated); jacobian = Phi_q."""
    n = workspace.n
    values = vec(workspace.values, workspace.n_values)
    for e in range(len(rows)):
        i, j = rows[e], cols[e]
        if i < n and j < n:
            s[i, j] += factor * values[e]
        elif j < n:
            jacobian[i - n, j] = values[e]


@internal
def jacobian_rates(workspace: Any, rows: Any, cols: Any, colours: Any, rate: Any) -> None:
    """B = (Phi_q v + Phi_t)_q at the current point, in the pattern of Phi_q (m_act, n).

    Columns of one colour share no row, so that one probe serves them all.
    """
    n, m = workspace.n, workspace.m_act
    v, a, phidd = vec(workspace.v, n), vec(workspace.a, n), vec(workspace.phidd, workspace.m_ext)
    active, seed = ivec(workspace.active, m), vec(workspace.rhs, n)
    size = speed_scale(v, n)
    for i in range(n):
        seed[i], a[i] = v[i], 0.0
    rate[:, :] = 0.0
    count = 0
    for j in range(n):
        count = max(count, colours[j] + 1)
    for c in range(count):
        for sign in range(2):
            for j in range(n):
                if colours[j] == c:
                    v[j] = seed[j] + (size if sign == 0 else -size)
            call_evaluate(workspace.evaluate_function, workspace, RESIDUAL)
            for e in range(len(rows)):
                i, j = rows[e] - n, cols[e]
                if i >= 0 and j < n and colours[j] == c:
                    rate[i, j] += (0.25 if sign == 0 else -0.25) * phidd[active[i]] / size
        for j in range(n):
            v[j] = seed[j]


@compiled
def linearise(
    workspace: Any, method: Any, times: Any, rows: Any, cols: Any, colours: Any, mass: Any, k: Any, d: Any,
    phi_q: Any, rate: Any,
    points: Any,
) -> int:  # fmt: skip
    """The system at `times` (N,) within the newest step of the run.

    Writes mass, k, d (N, n, n), phi_q, rate (N, m_act, n) and points (N, 2n), the coordinates and velocities there.
    Returns 0, or 1 + the number of the point that could not be projected onto the constraints.
    """
    n = workspace.n
    q, v = vec(workspace.q, n), vec(workspace.v, n)
    for l in range(len(times)):
        if query(workspace, method, times[l]) != OK:
            return l + 1
        for i in range(n):
            points[l, i], points[l, n + i] = q[i], v[i]
        mass[l], k[l], d[l] = 0.0, 0.0, 0.0
        evaluate_tangent(workspace, 0.0, 0.0)
        scatter(workspace, rows, cols, mass[l], phi_q[l], 1.0)
        evaluate_tangent(workspace, 1.0, 0.0)
        scatter(workspace, rows, cols, k[l], phi_q[l], 1.0)
        evaluate_tangent(workspace, 0.0, 1.0)
        scatter(workspace, rows, cols, d[l], phi_q[l], 1.0)
        for i in range(n):
            for j in range(n):
                k[l, i, j] -= mass[l, i, j]
                d[l, i, j] -= mass[l, i, j]
        jacobian_rates(workspace, rows, cols, colours, rate[l])
    return 0


@compiled
def all_rows(workspace: Any, jacobian: Any, rate: Any, remainder: Any) -> None:
    """Every row of the constraints, those of open contacts too, at the current point; a is set to zero.

    Writes jacobian (m, n), rate B (m, n) and remainder (m,): the derivative of phid = Phi_q v + Phi_t by t alone,
    phidd - B v with a = 0.
    """
    n, m = workspace.n, workspace.m_ext - 1
    v, a = vec(workspace.v, n), vec(workspace.a, n)
    phid, phidd = vec(workspace.phid, workspace.m_ext), vec(workspace.phidd, workspace.m_ext)
    size = speed_scale(v, n)
    for i in range(n):
        a[i] = 0.0
    for j in range(n):
        kept = v[j]
        for sign in range(2):
            factor = 1.0 if sign == 0 else -1.0
            v[j] = kept + factor * size
            call_evaluate(workspace.evaluate_function, workspace, RESIDUAL)
            for i in range(m):
                if sign == 0:
                    jacobian[i, j] = rate[i, j] = 0.0
                jacobian[i, j] += 0.5 * factor * phid[i] / size
                rate[i, j] += 0.25 * factor * phidd[i] / size
        v[j] = kept
    evaluate_residuals(workspace)
    for i in range(m):
        remainder[i] = phidd[i]
        for j in range(n):
            remainder[i] -= rate[i, j] * v[j]


@compiled
def gap_hessian(workspace: Any, row: int, support: Any, hessian: Any) -> None:
    """Second derivative by q (n, n) of Phi's `row`, whose coordinates are `support`: polar form of phidd; v and a are
    set to zero."""
    n = workspace.n
    v, a, phidd = vec(workspace.v, n), vec(workspace.a, n), vec(workspace.phidd, workspace.m_ext)
    for i in range(n):
        v[i], a[i] = 0.0, 0.0
    for p in range(len(support)):
        for r in range(p + 1):
            i, j = support[p], support[r]
            total = 0.0
            # even part of the form: 2 Phi_qt v falls out between v and -v, Phi_tt between sum and difference
            for turn in range(4):
                sign = 1.0 if turn < 2 else -1.0
                v[i] += 1.0 if turn % 2 == 0 else -1.0
                v[j] += sign if turn % 2 == 0 else -sign
                call_evaluate(workspace.evaluate_function, workspace, RESIDUAL)
                total += sign * phidd[row]
                v[i], v[j] = 0.0, 0.0
            hessian[i, j] = hessian[j, i] = 0.125 * total


@compiled
def matrix_at(workspace: Any, rows: Any, cols: Any, s: Any, phi_q: Any, c_q: float) -> None:
    """Dense blocks M + c_q K (n, n) and Phi_q (m_act, n) at the current point."""
    s[:, :] = 0.0
    evaluate_tangent(workspace, c_q, 0.0)
    scatter(workspace, rows, cols, s, phi_q, 1.0)


@compiled
def tangent_rate(workspace: Any, method: Any, times: Any, rows: Any, cols: Any, out: Any) -> None:
    """(M e_k)_q v as the columns of out (N, n, n) at `times` (N,): K is affine in the accelerations."""
    n = workspace.n
    v, a = vec(workspace.v, n), vec(workspace.a, n)
    for l in range(len(times)):
        query(workspace, method, times[l])
        out[l] = 0.0
        for column in range(n):
            for turn in range(2):
                for i in range(n):
                    a[i] = 0.0
                a[column] = 1.0 - turn
                evaluate_tangent(workspace, 1.0, 0.0)
                values = vec(workspace.values, workspace.n_values)
                for e in range(len(rows)):
                    if rows[e] < n and cols[e] < n:
                        out[l, rows[e], column] += (1.0 - 2.0 * turn) * values[e] * v[cols[e]]


def colour_columns(n: int, rows: Any, cols: Any) -> Any:
    """Colours (n,) of the columns of Phi_q such that columns of one colour share no row (greedy; Curtis, Powell and
    Reid, 1974)."""
    here = rows >= n
    taken: list[set[int]] = []
    colours = np.zeros(n, dtype=np.int64)
    for j in range(n):
        mine = set(rows[here & (cols == j)].tolist())
        colours[j] = next((c for c, used in enumerate(taken) if not used & mine), len(taken))
        if colours[j] == len(taken):
            taken.append(set())
        taken[colours[j]] |= mine
    return colours
