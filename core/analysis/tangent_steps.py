"""Many steps of a run with its variations, without returning to Python between them."""

import math
from typing import Any

import numpy as np

from ..compiled.jit import compiled_unlocked, internal
from ..methods.history import history_time
from ..state.run_records import CHUNK
from ..time_loop.time_loop import run
from .linearise import linearise
from .variational_equation import GAUSS_NODES, GAUSS_STAGES, carry

SUBSTEP = 0.2
"""Largest substep times the highest frequency: the relative error of Gauss' formula is then below 1e-9 a radian."""
VARYING = 1e-13
"""Relative change of the mass matrix within a step that is more than rounding."""
STEP_LEFT = 1000
"""Returned when the newest step has been made but the variations could not be carried over it here."""


@internal
def _times(t0: float, t1: float, substeps: int, times: Any) -> None:
    """Start, Gauss nodes of the substeps, end."""
    h = (t1 - t0) / substeps
    times[0] = t0
    for s in range(substeps):
        for i in range(GAUSS_STAGES):
            times[1 + GAUSS_STAGES * s + i] = t0 + h * (s + GAUSS_NODES[i])
    times[GAUSS_STAGES * substeps + 1] = t1


@internal
def _varies(mass: Any) -> bool:
    """True if the mass matrix is another one at some of the points."""
    largest, change = 0.0, 0.0
    for l in range(mass.shape[0]):
        for i in range(mass.shape[1]):
            for j in range(mass.shape[2]):
                largest = max(largest, abs(mass[l, i, j]))
                change = max(change, abs(mass[l, i, j] - mass[0, i, j]))
    return change > VARYING * largest


@compiled_unlocked
def fly(
    workspace: Any,
    method: Any,
    loop: Any,
    most: int,
    layout: Any,
    room: Any,
    work: Any,
    dq: Any,
    dv: Any,
    growth: Any,
    totals: Any,
) -> int:
    """Up to `most` steps, as `run` makes them, and the variations carried over each.

    layout : (rows, cols, colours, scale). room : (times, M, K, D, Phi_q, B, points, zeros, r, old dq,
    old dv) for as many points as there is room for. growth (columns,) += logarithms of the lengths. totals : highest
    frequency of the newest step, integral of the divergence so far.

    Returns
    -------
    What `run` returns; or STEP_LEFT.
    """
    rows, cols, colours, scale = layout
    times, mass, k, d, phi_q, rate, points, zeros, r, old_dq, old_dv = room
    capacity = (len(times) - 2) // GAUSS_STAGES
    n, columns = dq.shape
    for _ in range(most):
        t0 = history_time(method, 0)
        code = run(workspace, method, loop, 1)
        t1 = history_time(method, 0)
        if t1 > t0:
            for i in range(n):
                for c in range(columns):
                    old_dq[i, c], old_dv[i, c] = dq[i, c], dv[i, c]
            while True:
                substeps = max(1, math.ceil((t1 - t0) * totals[0] / SUBSTEP))
                if substeps > capacity:
                    return STEP_LEFT
                count = GAUSS_STAGES * substeps + 2
                _times(t0, t1, substeps, times)
                failed = linearise(
                    workspace, method, times[:count], rows, cols, colours, mass[:count], k[:count], d[:count],
                    phi_q[:count],
                    rate[:count], points[:count],
                )  # fmt: skip
                if failed != 0 or _varies(mass[:count]):
                    return STEP_LEFT
                frequency, divergence = carry(
                    t1 - t0, mass[:count], k[:count], d[:count], zeros, phi_q[:count], rate[:count], scale, dq, dv,
                    r, work,
                )  # fmt: skip
                totals[0] = frequency
                if (t1 - t0) * frequency <= 1.5 * SUBSTEP * substeps:
                    break
                for i in range(n):
                    for c in range(columns):
                        dq[i, c], dv[i, c] = old_dq[i, c], old_dv[i, c]
            totals[1] += divergence
            for c in range(columns):
                growth[c] += np.log(r[c, c])
        if code != CHUNK:
            return code
    return CHUNK
