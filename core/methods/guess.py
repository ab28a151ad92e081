"""Starting values of the stages of a fully implicit Runge-Kutta method: a pure function of the history."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import vec
from ..system.records import COUPLED_STAGES
from .coefficients import extrapolation_weights
from .history import history_row, history_time
from .multistep import rows_available, weight_rows
from .stages import A2, INVERSE, NODES, VECTORS, A, stage_count, stage_rows

MOST_ROWS = 4
LARGEST_EXTRAPOLATION = 20.0  # sum of the magnitudes of the weights: beyond, it amplifies more than it predicts
# how the stages are predicted
BY_ACCELERATIONS, BY_VELOCITIES, AT_REST = range(3)


@internal
def _weights(ws: Any, ms: Any, first: int, t: float, h: float) -> int:
    """Weights in `scratch` that extrapolate rows first, first + 1 ... of the history to t. Returns their number."""
    nodes, weights = vec(ws.scratch, MOST_ROWS), vec(ws.scratch + 8 * MOST_ROWS, MOST_ROWS)
    count = min(rows_available(ms) - first, MOST_ROWS)
    for j in range(count):
        nodes[j] = (history_time(ms, first + j) - t) / h
    while True:
        extrapolation_weights(nodes, count, weights)
        size = 0.0
        for j in range(count):
            size += abs(weights[j])
        if count == 1 or size <= LARGEST_EXTRAPOLATION:
            return count
        count -= 1


@internal
def best_guess(ws: Any, ms: Any, h: float) -> int:
    """Whether velocities or accelerations would have predicted the newest row better: for stiff components, whose
    accelerations are large and noisy, it is the velocities. Accelerations that would move the mechanism by more than
    its size in one step come from stiff components too: then neither."""
    n = ws.n_ext
    newest, scale = history_row(ws, ms, 0), vec(ws.scale, ws.n)
    of_v, of_a = np.inf, 0.0
    if rows_available(ms) > 2:
        of_v = 0.0
        count = _weights(ws, ms, 1, history_time(ms, 0), h)
        weights, weight_v = vec(ws.scratch + 8 * MOST_ROWS, MOST_ROWS), vec(ws.weight_v, n)
        for l in range(ws.n):
            v, a = newest[n + l], newest[2 * n + l]
            for j in range(count):
                old = history_row(ws, ms, 1 + j)
                v -= weights[j] * old[n + l]
                a -= weights[j] * old[2 * n + l]
            of_v += (v / weight_v[l]) ** 2
            of_a += (h * a / weight_v[l]) ** 2
    if of_v < of_a:
        return BY_VELOCITIES
    for l in range(ws.n):
        if h * h * abs(newest[2 * n + l]) > scale[l]:
            return AT_REST
    return BY_ACCELERATIONS


@internal
def predict_stages(ws: Any, ms: Any, t: float, h: float, guess: int) -> None:
    """Accelerations and multipliers of the stages by extrapolation through the history; q and v that belong to them.

    BY_VELOCITIES: a = A^-1 (V - v_n) / h with extrapolated velocities V of the stages. AT_REST: a = 0, so that the
    stages stay near the newest row whatever its accelerations are.
    """
    n = ws.n_ext
    stages = stage_count(ms)
    table, rows = weight_rows(ms), stage_rows(ws)
    weights = vec(ws.scratch + 8 * MOST_ROWS, MOST_ROWS)
    newest = history_row(ws, ms, 0)
    source = n if guess == BY_VELOCITIES else 2 * n
    for i in range(stages):
        row = rows[i]
        count = _weights(ws, ms, 0, t + table[VECTORS, NODES + i] * h, h)
        for l in range(ws.n):
            found = 0.0
            if guess != AT_REST:
                for j in range(count):
                    found += weights[j] * history_row(ws, ms, j)[source + l]
            row[3 * n + l] = found
        for l in range(ws.m_ext):
            found = 0.0
            for j in range(count):
                found += weights[j] * history_row(ws, ms, j)[4 * n + l]
            row[4 * n + l] = found
    for l in range(ws.n):
        for i in range(stages):
            a = rows[i, 3 * n + l]
            if guess == BY_VELOCITIES:
                a = 0.0
                for j in range(stages):
                    a += table[INVERSE, COUPLED_STAGES * i + j] * (rows[j, 3 * n + l] - newest[n + l]) / h
            rows[i, 2 * n + l] = a
        for i in range(stages):
            move_q, move_v = 0.0, 0.0
            for j in range(stages):
                a = rows[j, 2 * n + l]
                move_q += table[A2, COUPLED_STAGES * i + j] * a
                move_v += table[A, COUPLED_STAGES * i + j] * a
            rows[i, l] = newest[l] + h * (table[VECTORS, NODES + i] * newest[n + l] + h * move_q)
            rows[i, n + l] = newest[n + l] + h * move_v
