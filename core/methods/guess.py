"""Starting values of the stages of a fully implicit Runge-Kutta method: a pure function of the history."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..state.method_records import CARRIES
from ..state.workspace_records import COUPLED_STAGES
from .coefficients import extrapolation_weights
from .history import history_row, history_time
from .multistep import rows_available, weight_rows
from .stages import A_SQUARED, INVERSE, NODES, VECTORS, A, stage_count, stage_rows

MOST_ROWS = 5
# Sum of the magnitudes of the weights: beyond, extrapolation amplifies errors more than it predicts.
LARGEST_EXTRAPOLATION = 40.0
# Accelerations that would move a coordinate by more of its scale in one step are those of stiff components.
LONGEST_MOVE = 0.25
# how the stages are predicted
FROM_ACCELERATIONS, FROM_VELOCITIES, FROM_REST = range(3)


@internal
def _weights(workspace: Any, method: Any, first: int, t: float, h: float) -> int:
    """Weights in `scratch` that extrapolate rows first, first + 1 ... of the history to t. Returns their number."""
    nodes, weights = vec(workspace.scratch, MOST_ROWS), vec(workspace.scratch + 8 * MOST_ROWS, MOST_ROWS)
    count = min(rows_available(method) - first, MOST_ROWS)
    for j in range(count):
        nodes[j] = (history_time(method, first + j) - t) / h
    while True:
        extrapolation_weights(nodes, count, weights)
        size = 0.0
        for j in range(count):
            size += abs(weights[j])
        if count == 1 or size <= LARGEST_EXTRAPOLATION:
            return count
        count -= 1


@internal
def _pushed(method: Any) -> bool:
    """True if all steps are steps of impulses: accelerations of rows are those of the contacts' mean forces, and `aux`
    of the newest one has those with which the smooth motion goes on."""
    return bool(vec(method.parameters, 8)[CARRIES] != 0.0)


@internal
def best_guess(workspace: Any, method: Any, h: float) -> int:
    """Whether velocities or accelerations would have predicted the newest row better: for stiff components, whose
    accelerations are large and noisy, it is the velocities."""
    if rows_available(method) < 3 or _pushed(method):
        return FROM_ACCELERATIONS
    n = workspace.n_ext
    newest = history_row(workspace, method, 0)
    count = _weights(workspace, method, 1, history_time(method, 0), h)
    weights, weight_v = vec(workspace.scratch + 8 * MOST_ROWS, MOST_ROWS), vec(workspace.weight_v, n)
    of_v, of_a = 0.0, 0.0
    for l in range(workspace.n):
        v, a = newest[n + l], newest[2 * n + l]
        for j in range(count):
            old = history_row(workspace, method, 1 + j)
            v -= weights[j] * old[n + l]
            a -= weights[j] * old[2 * n + l]
        of_v += (v / weight_v[l]) ** 2
        of_a += (h * a / weight_v[l]) ** 2
    return FROM_VELOCITIES if of_v < of_a else FROM_ACCELERATIONS


@internal
def _predict(workspace: Any, method: Any, t: float, h: float, guess: int) -> bool:
    """Accelerations and multipliers of the stages by extrapolation through the history; q and v that belong to them.

    FROM_VELOCITIES: a = A^-1 (V - v_n) / h with extrapolated velocities V of the stages. FROM_REST: a = 0, so that the
    stages stay near the newest row whatever its accelerations are. Returns whether the guess is plausible.
    """
    n = workspace.n_ext
    stages = stage_count(method)
    table, rows = weight_rows(method), stage_rows(workspace)
    weights = vec(workspace.scratch + 8 * MOST_ROWS, MOST_ROWS)
    newest = history_row(workspace, method, 0)
    scale, plausible = vec(workspace.scale, workspace.n), True
    source = n if guess == FROM_VELOCITIES else (3 if _pushed(method) else 2) * n
    for i in range(stages):
        row = rows[i]
        count = 1
        if _pushed(method):
            weights[0] = 1.0
        else:
            count = _weights(workspace, method, 0, t + table[VECTORS, NODES + i] * h, h)
        for l in range(workspace.n):
            found = 0.0
            if guess != FROM_REST:
                for j in range(count):
                    found += weights[j] * history_row(workspace, method, j)[source + l]
            row[3 * n + l] = found
        for l in range(workspace.m_ext):
            found = 0.0
            for j in range(count):
                found += weights[j] * history_row(workspace, method, j)[4 * n + l]
            row[4 * n + l] = found
    for l in range(workspace.n):
        for i in range(stages):
            a = rows[i, 3 * n + l]
            if guess == FROM_VELOCITIES:
                a = 0.0
                for j in range(stages):
                    a += table[INVERSE, COUPLED_STAGES * i + j] * (rows[j, 3 * n + l] - newest[n + l]) / h
            rows[i, 2 * n + l] = a
        for i in range(stages):
            move_q, move_v = 0.0, 0.0
            for j in range(stages):
                a = rows[j, 2 * n + l]
                move_q += table[A_SQUARED, COUPLED_STAGES * i + j] * a
                move_v += table[A, COUPLED_STAGES * i + j] * a
            if abs(h * h * move_q) > LONGEST_MOVE * scale[l]:
                plausible = False
            rows[i, l] = newest[l] + h * (table[VECTORS, NODES + i] * newest[n + l] + h * move_q)
            rows[i, n + l] = newest[n + l] + h * move_v
    return plausible


@internal
def guess_stages(workspace: Any, method: Any, t: float, h: float, guess: int) -> None:
    """Starting values of all stages, by `guess` if that is plausible."""
    if not _predict(workspace, method, t, h, guess):
        _predict(workspace, method, t, h, FROM_REST)
