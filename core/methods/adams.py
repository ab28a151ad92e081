"""Implicit Adams formulas inside TLISMNI, order p = 2 (trapezoidal rule) to 8, on the actual grid.

y_{n+1} = y_n + h (b y'_{n+1} + sum_j b_j y'_{n-j}), j = 0 ... p - 2: the integral of the interpolant of y'.
Error estimate: Milne's device with the explicit formula of the same order, whose error is C_AB, against C_AM of this
one: C_AM / (C_AB - C_AM) (y_AM - y_AB), both constants for the actual grid (Shampine and Gordon 1975).
"""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal
from ..compiled.views import vec
from ..stage.solver import weighted_norm
from ..state.method_records import CHOICE_SIZE, K
from ..state.workspace_records import OK
from .coefficients import extrapolation_weights
from .history import history_row, history_time
from .multistep import clear, finish_stage, nodes, predict, weight_rows

NODES, IMPLICIT, EXPLICIT, EXTRAPOLATION, CONSTANTS = range(5)
# Gauss-Legendre nodes and weights of [-1, 0], exact for degree 9
_X, _W = np.polynomial.legendre.leggauss(5)
POINTS = 0.5 * (_X - 1.0)
POINT_WEIGHTS = 0.5 * _W


@compiled
def adams_coefficients(s: Any, p: int, implicit: Any, explicit: Any, constants: Any) -> None:
    """Weights of y' in the step from s = -1 to 0 of size 1.

    implicit : b at 0, then b_j at s_j, j < p - 1. explicit : at s_j, j < p. constants : C_AM and C_AB, the integrals
    of the node polynomials.
    """
    for j in range(p):
        implicit[j] = 0.0
        explicit[j] = 0.0
    constants[0], constants[1] = 0.0, 0.0
    for g in range(len(POINTS)):
        x, w = POINTS[g], POINT_WEIGHTS[g]
        product = 1.0
        for j in range(p - 1):
            product *= x - s[j]
        constants[0] += w * product * x
        constants[1] += w * product * (x - s[p - 1])
        at_new = 1.0
        for l in range(p - 1):
            at_new *= (x - s[l]) / -s[l]
        implicit[0] += w * at_new
        for j in range(p):
            basis = 1.0
            for l in range(p - 1):
                if l != j:
                    basis *= (x - s[l]) / (s[j] - s[l])
            if j < p - 1:
                implicit[j + 1] += w * basis * x / s[j]
                basis *= (x - s[p - 1]) / (s[j] - s[p - 1])
            explicit[j] += w * basis


@internal
def adams_step(workspace: Any, method: Any, h: float) -> int:
    p, n = int(vec(method.choice, CHOICE_SIZE)[K]), workspace.n_ext
    table = weight_rows(method)
    implicit, explicit, constants = table[IMPLICIT], table[EXPLICIT], table[CONSTANTS]
    if nodes(method, h, p, table[NODES]):
        adams_coefficients(table[NODES], p, implicit, explicit, constants)
        extrapolation_weights(table[NODES], p, table[EXTRAPOLATION])
    q, v = vec(workspace.q, n), vec(workspace.v, n)
    q_star, v_star = vec(workspace.q_star, n), vec(workspace.v_star, n)
    c_v = h * implicit[0]
    newest = history_row(workspace, method, 0)
    for i in range(n):
        q_star[i], v_star[i] = newest[i], newest[n + i]
    for j in range(p - 1):
        row = history_row(workspace, method, j)
        w = h * implicit[j + 1]
        for i in range(n):
            q_star[i] += w * row[n + i]
            v_star[i] += w * row[2 * n + i]
    for i in range(n):
        q_star[i] += c_v * v_star[i]
    clear(workspace.a, workspace.n)
    clear(workspace.lam, workspace.m_ext)
    predict(workspace, method, table[EXTRAPOLATION], 0, p)
    status = finish_stage(workspace, history_time(method, 0) + h, c_v)
    if status != OK:
        return status
    difference = vec(workspace.rhs, workspace.n)
    norm, of_work = 0.0, 0.0
    weight_v = vec(workspace.weight_v, n)
    for kind in range(2):
        for i in range(workspace.n):
            difference[i] = (v[i] if kind else q[i]) - newest[kind * n + i]
        for j in range(p):
            row = history_row(workspace, method, j)
            for i in range(workspace.n):
                difference[i] -= h * explicit[j] * row[(kind + 1) * n + i]
        norm = max(norm, weighted_norm(difference, weight_v if kind else vec(workspace.weight_q, n), workspace.n))
    for i in range(n - workspace.n_work, n):
        off = v[i] - newest[n + i]
        for j in range(p):
            off -= h * explicit[j] * history_row(workspace, method, j)[2 * n + i]
        of_work = max(of_work, abs(off) / weight_v[i])
    error = vec(method.error, 2)
    error[0] = max(norm, of_work) * abs(constants[0] / (constants[1] - constants[0]))
    error[1] = p
    return OK
