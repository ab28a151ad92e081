"""Implicit Adams formulas inside TLISMNI, order p = 2 (trapezoidal rule) to 8, on the actual grid.

y_{n+1} = y_n + h (b y'_{n+1} + sum_j b_j y'_{n-j}), j = 0 ... p - 2: the integral of the interpolant of y'.
Error estimate: Milne's device with the explicit formula of the same order, whose error is C_AB, against C_AM of this
one: C_AM / (C_AB - C_AM) (y_AM - y_AB), both constants for the actual grid (Shampine and Gordon 1975).

The constants, 0.03 to 0.1, are those of a smooth y'. Where y' jumps in the step y_AM - y_AB is itself as large as the
error, and no smaller than the same difference for the order p - 1, which in smooth motion is larger by 1/(h omega). The
constants are replaced by the eighth power of the ratio of the two where that is more.
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

NODES, IMPLICIT, EXPLICIT, EXTRAPOLATION, CONSTANTS, LOWER = range(6)
# Gauss-Legendre nodes and weights of [-1, 0], exact for degree 9
_X, _W = np.polynomial.legendre.leggauss(5)
POINTS = 0.5 * (_X - 1.0)
POINT_WEIGHTS = 0.5 * _W
UNCERTAIN = 10.0
"""Differences y_AM - y_AB up to which only the constants count, in error weights: formulas of order 8 make as much of
the tolerances of the inner loop, and of vibrations at their limit of stability."""
SHARP = 8
"""Power of the ratio of differences: 0.7, of vibrations that steps hardly resolve, must not be taken for a jump."""


@compiled
def adams_coefficients(s: Any, p: int, implicit: Any, explicit: Any, lower: Any, constants: Any) -> None:
    """Weights of y' in the step from s = -1 to 0 of size 1.

    implicit : b at 0, then b_j at s_j, j < p - 1. explicit : at s_j, j < p. lower : explicit ones of order p - 1, and 0
    at s_(p-1). constants : C_AM and C_AB, the integrals of the node polynomials.
    """
    for j in range(p):
        implicit[j] = 0.0
        explicit[j] = 0.0
        lower[j] = 0.0
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
                lower[j] += w * basis
                basis *= (x - s[p - 1]) / (s[j] - s[p - 1])
            explicit[j] += w * basis


@internal
def _difference(workspace: Any, method: Any, h: float, weights: Any, p: int, kind: int) -> float:
    """Norm of y_AM - y_AB for coordinates (kind 0), velocities (1) or work accounts (2)."""
    n, first = workspace.n_ext, min(kind, 1) * workspace.n_ext
    begin, end = (n - workspace.n_work, n) if kind == 2 else (0, workspace.n)
    y = vec(workspace.v if kind else workspace.q, n)
    weight, difference = vec(workspace.weight_v if kind else workspace.weight_q, n), vec(workspace.q_star, n)
    newest = history_row(workspace, method, 0)
    for i in range(begin, end):
        difference[i] = y[i] - newest[first + i]
    for j in range(p):
        row, w = history_row(workspace, method, j), h * weights[j]
        for i in range(begin, end):
            difference[i] -= w * row[first + n + i]
    if kind < 2:
        return weighted_norm(difference, weight, end)
    norm = 0.0
    for i in range(begin, end):
        norm = max(norm, abs(difference[i]) / weight[i])
    return norm


@internal
def _error(workspace: Any, method: Any, h: float, p: int) -> float:
    table = weight_rows(method)
    constants, error = table[CONSTANTS], 0.0
    smooth = abs(constants[0] / (constants[1] - constants[0]))
    for kind in range(3):
        difference = _difference(workspace, method, h, table[EXPLICIT], p, kind)
        lower = _difference(workspace, method, h, table[LOWER], p - 1, kind)
        if difference > 0.0:
            ratio = min(difference / lower, 1.0) if lower > 0.0 else 1.0
            error = max(error, smooth * difference, ratio**SHARP * (difference - UNCERTAIN))
    return error


@internal
def adams_step(workspace: Any, method: Any, h: float) -> int:
    p, n = int(vec(method.choice, CHOICE_SIZE)[K]), workspace.n_ext
    table = weight_rows(method)
    implicit, explicit, constants = table[IMPLICIT], table[EXPLICIT], table[CONSTANTS]
    if nodes(method, h, p, table[NODES]):
        adams_coefficients(table[NODES], p, implicit, explicit, table[LOWER], constants)
        extrapolation_weights(table[NODES], p, table[EXTRAPOLATION])
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
    error = vec(method.error, 2)
    error[0], error[1] = _error(workspace, method, h, p), p
    return OK
