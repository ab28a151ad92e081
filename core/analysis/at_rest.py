"""A system at rest as dense matrices: what equilibria, modes and linearised models are computed from."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..assembly.partition import choose_dependent
from ..errors import ModelError
from ..methods.default import FIXED_STEPS_METHOD
from ..multibody_model import Model
from ..simulation.simulation import Simulation
from ..time_loop.sample import write_sample

Floats = NDArray[np.float64]

MOST_COORDINATES = 3000
"""Larger systems would need sparse eigenvalue solvers: matrices are dense here (72 MB each at this size)."""
RANK = 1e-10
"""Singular value of Phi_q, relative to the largest, that counts as zero."""


@dataclass(frozen=True)
class Matrices:
    """The equations M a + Phi_q^T lambda = Q at rest, by small changes: M da + D dv + K dq + Phi_q^T dlambda = L du.

    Attributes
    ----------
    mass, damping, stiffness : (n, n). K holds the multipliers' part (Phi_q^T lambda)_q.
    jacobian : Phi_q of the rows that are constraints now, (m_act, n).
    basis : N (n, f), Phi_q N = 0: unit motions of the independent coordinates.
    independent : their numbers, (f,).
    """

    mass: Floats
    damping: Floats
    stiffness: Floats
    jacobian: Floats
    basis: Floats
    independent: NDArray[np.int64]

    def reduced(self) -> tuple[Floats, Floats, Floats]:
        """M, D and K (f, f) of the independent coordinates."""
        basis = self.basis
        return basis.T @ self.mass @ basis, basis.T @ self.damping @ basis, basis.T @ self.stiffness @ basis


def refuse_rate_rows(assembly: Assembly, idle: frozenset[str] = frozenset()) -> None:
    """Raise ModelError for a model with velocity-level rows: its positions have more freedom than its velocities.

    `idle` names contacts whose friction has no part in the analysis: their rows are left out of it.
    """
    names = sorted({assembly.row_names[row] for row in assembly.rate_rows} - idle)
    if names:
        raise ModelError(
            f"{', '.join(repr(name) for name in names)} hold velocities without holding positions (nonholonomic): "
            "analyses of small motions take constraints that hold positions. Replace them by a joint or a force with "
            "friction for this analysis, or simulate"
        )


def run_of(system: Any, t0: float = 0.0, rate_rows: bool = False, **settings: Any) -> Simulation:
    """A run of `system` that has not left its start; `rate_rows`: also of one with velocity-level rows.

    Raises
    ------
    ModelError : beyond MOST_COORDINATES; ConsistencyError : for a start that does not meet the constraints.
    """
    # nothing is integrated: any formula, without measuring which
    sim = Simulation(system, FIXED_STEPS_METHOD, t0=t0, **settings)
    if not rate_rows:
        refuse_rate_rows(sim.assembly, _idle_friction(system, sim))
    if sim.assembly.n > MOST_COORDINATES:
        raise ModelError(
            f"the system has {sim.assembly.n} coordinates; analyses at rest use dense matrices, up to "
            f"{MOST_COORDINATES}: use a coarser mesh, or a ReducedBody2D"
        )
    return sim


def _idle_friction(system: Any, sim: Simulation) -> frozenset[str]:
    """Names of the contacts whose friction holds nothing at rest: of all but those whose surface moves, which pulls."""
    moving = {c.name for c in system.contacts if c.surface_speed is not None} if isinstance(system, Model) else set()
    return frozenset({contact.name for contact in sim.assembly.contacts} - moving)


def place(sim: Simulation, q: Floats, lam: Floats) -> None:
    """Make coordinates q (n,), without velocities and accelerations, and multipliers (m_act,) the workspace's point."""
    arrays, n = sim.workspace.arrays, sim.assembly.n
    arrays["q"][:n], arrays["v"][:n], arrays["a"][:n] = q, 0.0, 0.0
    arrays["lam"][:] = 0.0
    arrays["lam"][sim.workspace.structure.active] = lam
    evaluate_residuals(sim.workspace.record)


def tangent(sim: Simulation, c_q: float, c_v: float) -> tuple[Floats, Floats]:
    """M + c_v D + c_q K (n, n) and Phi_q (m_act, n) at the workspace's point."""
    full, n = _dense_tangent(sim, c_q, c_v), sim.assembly.n
    return full[:n, :n], full[n : n + sim.workspace.structure.m_act, :n]


def multiplier_columns(sim: Simulation) -> Floats:
    """Phi_q^T (n, multipliers) at the workspace's point, of all `structure.multiplier_rows`: of implied rows too."""
    return _dense_tangent(sim, 0.0, 0.0)[: sim.assembly.n, sim.assembly.n :]


def _dense_tangent(sim: Simulation, c_q: float, c_v: float) -> Floats:
    workspace = sim.workspace
    evaluate_tangent(workspace.record, c_q, c_v)
    structure = workspace.structure
    size = sim.assembly.n + len(structure.multiplier_rows)
    full = np.zeros((size, size))
    np.add.at(full, (structure.rows, structure.cols), workspace.arrays["values"][: structure.nnz])
    return full


def matrices(sim: Simulation) -> Matrices:
    """The matrices at the workspace's point, which must be at rest."""
    mass, jacobian = tangent(sim, 0.0, 0.0)
    stiffness, damping = tangent(sim, 1.0, 0.0)[0] - mass, tangent(sim, 0.0, 1.0)[0] - mass
    return Matrices(mass, damping, stiffness, jacobian, *null_basis(sim, jacobian))


def null_basis(sim: Simulation, jacobian: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """N (n, f) with Phi_q N = 0 and the identity in the rows of the independent coordinates, and their numbers (f,).

    `jacobian` is Phi_q (m_act, n) as the workspace's matrix has it now. The partition is chosen here: that of the run
    is as old as its last change, and on the way to rest bodies may have turned by any angle.
    """
    dependent, n = choose_dependent(sim.workspace), sim.assembly.n
    independent = np.setdiff1d(np.arange(n), dependent)
    basis = np.zeros((n, len(independent)))
    basis[independent] = np.eye(len(independent))
    basis[dependent] = -np.linalg.solve(jacobian[:, dependent], jacobian[:, independent])
    return basis, independent


def loads(sim: Simulation, names: list[str]) -> Floats:
    """L (n, inputs): generalised forces of unit inputs at the workspace's point. The residual is affine in them."""
    arrays, n = sim.workspace.arrays, sim.assembly.n
    every, found = sim.assembly.input_names, np.zeros((n, len(names)))
    kept = arrays["inputs"].copy()
    evaluate_residuals(sim.workspace.record)
    before = arrays["r"][:n].copy()
    for k, name in enumerate(names):
        arrays["inputs"][every.index(name), 0] += 1.0
        evaluate_residuals(sim.workspace.record)
        found[:, k] = before - arrays["r"][:n]
        arrays["inputs"][:] = kept
    evaluate_residuals(sim.workspace.record)
    return found


def channel_values(sim: Simulation) -> Floats:
    """All channels (channels,) of the workspace's point as it stands."""
    evaluate_residuals(sim.workspace.record)
    row = np.zeros(sim.buffer.shape[1])
    write_sample(sim.workspace.record, row)
    return sim.table.values(row)


def coordinate_names(sim: Simulation) -> tuple[str, ...]:
    """Names of all coordinates ("rod.angle"), in their order."""
    return tuple(sim.assembly.coordinate_names)
