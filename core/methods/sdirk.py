"""SDIRK of order 4, five stages, L-stable, embedded order 3 (Hairer and Wanner, Solving ODEs II, table 6.5).

Self-starting: it gives the multistep formulas their starting values, and is `irk` with the tableau sdirk4.
Each stage has c_v = h gamma, c_q = (h gamma)^2: one matrix for all.

No stage lies before a quarter of the step, so a jump of f there changes no stage and no difference of stages. A second
difference of the same order, which contains f at the start, sees it; the larger of the two is the error estimate.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_power
from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..stage.corotating import use_formula
from ..stage.solver import weighted_norm
from ..state.workspace_records import OK, call_stage
from .history import history_row, history_time

A = np.array(
    [
        [1 / 4, 0, 0, 0, 0],
        [1 / 2, 1 / 4, 0, 0, 0],
        [17 / 50, -1 / 25, 1 / 4, 0, 0],
        [371 / 1360, -137 / 2720, 15 / 544, 1 / 4, 0],
        [25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4],
    ]
)
C = np.array([1 / 4, 3 / 4, 11 / 20, 1 / 2, 1])

DIFFERENCES = np.array(
    [
        [25 / 24 - 59 / 48, -49 / 48 + 17 / 96, 125 / 16 - 225 / 32, 0, 1 / 4, 0],
        [-67 / 160, -163 / 320, 45 / 64, 0, 1 / 10, 1 / 8],
    ]
)
"""Weights of f at the stages and at the start, both of order 3: the embedded difference, and one that contains the
start. With 1/8 a jump just before the first stage is seen with half of its error, and smooth motion seldom with more
than in the first; the multiple of the first that the conditions leave free is near the one that makes the second
smallest."""
STAGES = 5

EQUAL_PARTS = 128
"""More parts of a step than this are not made equal."""
LEAST_PART = 1e-6
"""Of a step: shorter parts are taken as they are."""


@internal
def sdirk_from_base(workspace: Any, t: float, h: float, differences: int) -> Any:
    """One step from (base_q, base_v, base_a) at t. Returns (status, error norm); the result is in the workspace. The
    norm is that of the first of the DIFFERENCES, or the larger one of both."""
    n = workspace.n_ext
    base_q, base_v = vec(workspace.base_q, n), vec(workspace.base_v, n)
    q_star, v_star = vec(workspace.q_star, n), vec(workspace.v_star, n)
    v, a = vec(workspace.v, n), vec(workspace.a, n)
    stage_v, stage_a = mat(workspace.stage_v, 8, n), mat(workspace.stage_a, 8, n)
    c_v = h * A[0, 0]
    first_work = n - workspace.n_work
    for s in range(STAGES):
        for i in range(n):
            p_q, p_v = base_q[i], base_v[i]
            for j in range(s):
                p_q += h * A[s, j] * stage_v[j, i]
                p_v += h * A[s, j] * stage_a[j, i]
            q_star[i] = p_q + c_v * p_v
            v_star[i] = p_v
        status = call_stage(workspace.stage_function, workspace, t + C[s] * h, c_v * c_v, c_v)
        if status != OK:
            return status, 0.0
        if workspace.n_spins == 0:
            evaluate_power(workspace)
        use_formula(workspace, c_v * c_v, c_v)
        for i in range(first_work, n):
            v[i] = v_star[i] + c_v * a[i]
        for i in range(n):
            stage_v[s, i] = v[i]
            stage_a[s, i] = a[i]
    norm, base_a = 0.0, vec(workspace.base_a, n)
    weight_q, weight_v = vec(workspace.weight_q, n), vec(workspace.weight_v, n)
    error_q, error_v = stage_v[STAGES], stage_a[STAGES]
    for kind in range(differences):
        for i in range(n):
            of_v, of_a = DIFFERENCES[kind, STAGES] * base_v[i], DIFFERENCES[kind, STAGES] * base_a[i]
            for j in range(STAGES):
                of_v += DIFFERENCES[kind, j] * stage_v[j, i]
                of_a += DIFFERENCES[kind, j] * stage_a[j, i]
            error_q[i], error_v[i] = h * of_v, h * of_a
        norm = max(norm, weighted_norm(error_q, weight_q, workspace.n), weighted_norm(error_v, weight_v, workspace.n))
        for i in range(first_work, n):
            norm = max(norm, abs(error_v[i]) / weight_v[i])
    return OK, norm


@internal
def base_from_row(workspace: Any, method: Any) -> None:
    """Start from the newest row of history."""
    n = workspace.n_ext
    row = history_row(workspace, method, 0)
    base_q, base_v, base_a = vec(workspace.base_q, n), vec(workspace.base_v, n), vec(workspace.base_a, n)
    a, lam = vec(workspace.a, n), vec(workspace.lam, workspace.m_ext)
    for i in range(n):
        base_q[i] = row[i]
        base_v[i] = row[n + i]
        base_a[i] = a[i] = row[2 * n + i]
    for i in range(workspace.m_ext):
        lam[i] = row[4 * n + i]


@internal
def sdirk_step(workspace: Any, method: Any, h: float) -> int:
    """One step, with the error estimate of the embedded formula."""
    base_from_row(workspace, method)
    status, norm = sdirk_from_base(workspace, history_time(method, 0), h, 2)
    vec(method.error, 2)[0] = norm
    vec(method.error, 2)[1] = 3.0
    return status


@internal
def _take_over(workspace: Any) -> None:
    """The point reached is where the next part begins."""
    n = workspace.n_ext
    q, v, a = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n)
    base_q, base_v, base_a = vec(workspace.base_q, n), vec(workspace.base_v, n), vec(workspace.base_a, n)
    for i in range(n):
        base_q[i] = q[i]
        base_v[i] = v[i]
        base_a[i] = a[i]


@internal
def _in_unequal_parts(workspace: Any, t: float, h: float, parts: int) -> int:
    """A step over a jump, from the base: parts that keep the embedded error below one are short only about there. The
    first is one of so many equal ones."""
    done, size, least = 0.0, h / parts, LEAST_PART * h
    while done < h:
        last = size >= h - done
        part = h - done if last else size
        status, norm = sdirk_from_base(workspace, t + done, part, 1)
        if status != OK:
            return status
        if norm > 1.0 and part > least:
            size = 0.25 * part
            continue
        _take_over(workspace)
        done = h if last else done + part
        if norm < 0.01:
            size = 2.0 * part
    return OK


@internal
def sdirk_fine_step(workspace: Any, method: Any, h: float) -> int:
    """One grid step in as many equal parts as keep the embedded error of each below one: starting values that
    do not spoil the order of a fixed-step multistep method. Where that takes very many, or the error falls more slowly
    than the square of their size, something jumps inside."""
    parts, before, error = 1, 1, np.inf
    while True:
        base_from_row(workspace, method)
        t = history_time(method, 0)
        worst = 0.0
        status = OK
        for part in range(parts):
            status, norm = sdirk_from_base(workspace, t + part * h / parts, h / parts, 1)
            if status != OK:
                return status
            worst = max(worst, norm)
            if worst > 1.0:
                break
            _take_over(workspace)
        if worst <= 1.0:
            break
        jumps = worst * parts**2 > error * before**2
        before, error = parts, worst
        parts = max(2 * parts, int(parts * min(worst, 1e8) ** 0.25) + 1)
        if jumps or parts > EQUAL_PARTS:
            base_from_row(workspace, method)
            status = _in_unequal_parts(workspace, t, h, parts)
            if status != OK:
                return status
            break
    vec(workspace.t, 1)[0] = history_time(method, 0) + h
    vec(method.error, 2)[0] = 0.0
    vec(method.error, 2)[1] = 3.0
    return OK
