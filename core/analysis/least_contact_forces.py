"""Forces of rigid contacts at rest that the equations of equilibrium do not determine.

Where more contacts touch than independent rows hold (a block on four feet), forces are the limit of those of compliant
contacts: of all normal forces that press and balance the loads, those of least sum of c F^2, c the relative compliance
(`docs/load-sharing.md`). This is a least distance problem, which becomes one of nonnegative least squares (Lawson and
Hanson 1974, chapter 23, algorithm LDP).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space, qr
from scipy.optimize import nnls

from ..assembly.evaluate import evaluate_residuals
from ..assembly.numbers import given_compliance
from ..rounding import RANK_TOLERANCE
from ..simulation.simulation import Simulation
from ..state.modes import CLOSED, OF_NORMAL, OPEN
from .at_rest import multiplier_columns, place

Floats = NDArray[np.float64]

SLACK = 1e-9
"""Force below zero, in parts of the largest, that is rounding."""
FEASIBLE = 1e-9
"""Last residual of the least distance problem, 1/(1 + |y|^2), from which on it has a solution y."""


def share_contact_loads(sim: Simulation, held: list[int]) -> bool:
    """Close the contacts `held`, which touch and which closed ones hold, where they carry a part of the loads; False if
    no forces that press balance these. The workspace's point must be at rest.

    Independent contacts stay constraints; the others are closed with a row of compatibility, as those of a run.
    """
    n, memory = sim.assembly.n, sim.memory
    q = sim.workspace.arrays["q"][:n].copy()
    before = [int(k) for k in np.flatnonzero(memory.mode[: len(sim.assembly.contacts)] == CLOSED)]
    every = [*before, *held]
    contact_rows = [sim.assembly.contacts[k].row for k in every]
    memory.mode[held], memory.implied_rows[held] = CLOSED, OF_NORMAL
    sim.use_modes(accelerations=False)
    place(sim, q, np.zeros(len(sim.workspace.structure.active)))
    scale = sim.assembly.coordinate_scale
    load = -sim.workspace.arrays["r"][:n] * scale
    columns = multiplier_columns(sim) * scale[:, None]
    rows = sim.workspace.structure.multiplier_rows.tolist()
    at = [rows.index(row) for row in contact_rows]
    joints, gradients = np.delete(columns, at, axis=1).T, columns[:, at].T
    forces = least_contact_forces(joints, gradients, load, given_compliance(sim.assembly)[contact_rows])
    if not np.all(np.isfinite(forces)):
        return False
    loaded = np.flatnonzero(forces > SLACK * np.max(forces, initial=0.0))
    kept = [int(loaded[i]) for i in independent_contacts(joints, gradients[loaded])]
    # what touches without a force stays a constraint as far as others do not hold it
    idle = [i for i in range(len(before)) if i not in loaded]
    kept += [idle[i] for i in independent_contacts(np.vstack([joints, gradients[kept]]), gradients[idle])]
    for i, k in enumerate(every):
        memory.mode[k] = CLOSED if i in loaded or i in kept else OPEN
        memory.implied_rows[k] = OF_NORMAL if i in loaded and i not in kept else 0.0
    sim.use_modes()
    sim.workspace.arrays["a"][:n] = 0.0
    evaluate_residuals(sim.workspace.record)
    return True


def least_contact_forces(joints: Floats, contacts: Floats, load: Floats, compliance: Floats) -> Floats:
    """Normal forces F (k,) >= 0 of least sum of c F^2 with joints^T lambda + contacts^T F + load = 0.

    Parameters
    ----------
    joints, contacts : gradients of the rows of joints (m, n) and of the gaps (k, n), in coordinates of like scale.
    load : generalised forces without those of joints and contacts (n,).
    compliance : relative compliances (k,), > 0, dimensionless.

    Returns
    -------
    The forces, N; NaN where no forces that press balance the loads.
    """
    motions = _null_basis(joints, len(load))
    root = 1.0 / np.sqrt(compliance)
    balance = (motions.T @ contacts.T) * root
    least = np.linalg.lstsq(balance, -motions.T @ load, rcond=RANK_TOLERANCE)[0]
    size = float(np.max(np.abs(least), initial=0.0))
    if np.all(least >= 0.0):
        return root * least
    # of least |y| with free y >= -least, in parts of the largest force
    free, least = null_space(balance, rcond=RANK_TOLERANCE), least / size
    both = np.vstack([free.T, -(least + SLACK)])
    target = np.concatenate([np.zeros(free.shape[1]), [1.0]])
    residual = target - both @ nnls(both, target)[0]
    if residual[-1] <= FEASIBLE:
        return np.full(len(least), np.nan)
    found = least - free @ (residual[:-1] / residual[-1])
    # without the slack: of the contacts that press, those of least size balance the loads
    presses = found > SLACK
    exact = np.zeros(len(found))
    exact[presses] = np.linalg.lstsq(balance[:, presses], -motions.T @ load, rcond=RANK_TOLERANCE)[0]
    return root * np.maximum(exact, 0.0)


def independent_contacts(joints: Floats, contacts: Floats) -> list[int]:
    """Places, ascending, of a largest set of contacts whose gap gradients (k, n) are independent of each other and of
    the gradients of joints (m, n)."""
    motions = _null_basis(joints, contacts.shape[1])
    triangle, order = qr(motions.T @ contacts.T, mode="r", pivoting=True)
    size = float(np.max(np.linalg.norm(contacts, axis=1), initial=0.0))
    rank = int(np.sum(np.abs(np.diag(triangle)) > RANK_TOLERANCE * size))
    return sorted(int(k) for k in order[:rank])


def _null_basis(jacobian: Floats, n: int) -> Floats:
    """Motions (n, f) that `jacobian` (m, n) lets pass."""
    return np.asarray(null_space(jacobian, rcond=RANK_TOLERANCE)) if len(jacobian) else np.eye(n)
