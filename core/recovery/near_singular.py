"""Samples between steps next to a singular position.

There rounding is multiplied by 1/d^3 in the accelerations and multipliers that the augmented system gives, d being the
distance to the position; at the position itself they are not determined at all. They are smooth functions of time,
though, and the steps keep a distance: so they are interpolated through the newest steps.
"""

from typing import TYPE_CHECKING

import numpy as np

from ..assembly.evaluate import evaluate_power, evaluate_residuals
from ..assembly.singular_values import least_singular_value
from ..event_detection.dense_output import interpolate
from ..state.workspace_records import OK, convergence_of

if TYPE_CHECKING:
    from ..simulation.engine import Engine

STRAINED_GROWTH = 8.0
"""Growth of the condition of the constraints in the last step beyond which samples are looked at."""
NOISY = 1.5e-3
"""Least singular value of the scaled Phi_q below which rounding reaches 1e-7 of the accelerations."""
NODES = 4


def strained(sim: "Engine") -> bool:
    """True if the newest step came near a singular position and `t` lies within it."""
    rate, ring, times = (
        convergence_of(sim.workspace.arrays["rate"]),
        sim.method_arrays["ring"],
        sim.method_arrays["times"],
    )
    newest, bridge = int(ring[0]), int(ring[2])
    if bridge > 0:
        return bool(times[(newest - bridge + 1) % len(times)] < sim.t < times[newest])
    return bool(
        rate.worst_condition > STRAINED_GROWTH * rate.least_condition > 0.0
        and ring[1] > 1
        and times[newest - 1] < sim.t < times[newest]
    )


def smooth_query(sim: "Engine", status: int) -> int:
    """Replace what the query at `t` gave, and its `status`, if the point is too near a singular position."""
    # importing scipy costs more than most runs: only who needs it pays
    from scipy.interpolate import BarycentricInterpolator, KroghInterpolator

    from .collocation import interpolation_matrix

    workspace, n, n_ext = sim.workspace, sim.assembly.n, sim.assembly.n_extended
    arrays = workspace.arrays
    if status != OK:
        interpolate(workspace.record, sim._method.record, sim.t)
    if status == OK and least_singular_value(workspace) > NOISY:
        return OK
    ring, times, history = (sim.method_arrays[name] for name in ("ring", "times", "history"))
    if ring[2] > 0:
        # the points of a long step: its polynomials are the smooth functions
        rows = [int(ring[0] - back) % len(times) for back in range(int(ring[2]))]
        values = history[rows].T @ interpolation_matrix(times[rows], sim.t)[0]
        arrays["a"][:n], arrays["lam"][:] = values[2 * n_ext : 2 * n_ext + n], values[4 * n_ext :]
        evaluate_residuals(workspace.record)
        evaluate_power(workspace.record)
        return OK
    rows = [int(ring[0] - back) % len(times) for back in range(min(int(ring[1]), NODES))]
    nodes, states = times[rows] - sim.t, history[rows]
    velocities = KroghInterpolator(
        np.repeat(nodes, 2),
        np.stack([states[:, n_ext : n_ext + n], states[:, 2 * n_ext : 2 * n_ext + n]], 1).reshape(-1, n),
    )
    arrays["a"][:n] = velocities.derivative(0.0)
    arrays["lam"][:] = BarycentricInterpolator(nodes, states[:, 4 * n_ext :])(0.0)
    arrays["lam"][sorted(workspace.dropped)] = 0.0
    evaluate_residuals(workspace.record)
    evaluate_power(workspace.record)
    return OK
