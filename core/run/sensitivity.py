"""Derivatives of all channels with respect to inputs at the present time, through the augmented system.

At given coordinates, velocities and contact modes the residual r(a, lambda, u) = M a + Phi_q^T lambda - Q(u), the
constraints' accelerations and all channels are affine in accelerations, multipliers and inputs u: closed contacts are
rows of Phi, friction of sliding ones is proportional to their multipliers, force laws do not depend on either. So

    [M Phi_q^T; Phi_q 0] (a', lambda') = (-r_u u', 0)

gives the change along u', and a channel's is its difference between (s a', s lambda', s u') and zero, over s. The size
s is a power of two so large that what does not depend on them is rounding beside it: no truncation enters, and the
result is exact to rounding. A motion does not show here: a position or velocity that is set changes nothing at once
(`tlismni.core.model.motion`).
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from ..linalg import SingularMatrixError
from ..loop.sample import write_sample
from ..rounding import SENSITIVITY_SOLVED
from ..stage.joints import evaluate_joints, factor_joints, solve_joints
from ..tables.evaluate import evaluate_residuals

if TYPE_CHECKING:
    from .simulation import Simulation

Vector = NDArray[np.float64]
LARGE = 2.0**40
"""s relative to what the residual holds without the change: its rounding is 2^-40 of itself beside the change."""
REFINEMENTS = 2


def input_derivatives(sim: "Simulation", direction: Mapping[str, float]) -> Vector:
    """Derivatives (channels,) of all channels along `direction`, by input name; the simulation stays as it is.

    Raises
    ------
    SimulationError : if the augmented system is singular at the present point.
    """
    names = sim.assembly.input_names
    seed = np.zeros(len(sim.workspace.arrays["inputs"]))
    for name, x in direction.items():
        seed[names.index(name)] += x
    largest = float(np.max(np.abs(seed), initial=0.0))
    if largest == 0.0:
        return np.zeros(len(sim.channels))
    before = sim.state()
    try:
        return _along(sim, seed / largest) * largest
    finally:
        sim.restore(before)


def _along(sim: "Simulation", seed: Vector) -> Vector:
    arrays, n = sim.workspace.arrays, sim.assembly.n
    sim.sample()  # the present time becomes the workspace's point
    active = sim.workspace.structure.active
    a, lam, inputs = arrays["a"], arrays["lam"], arrays["inputs"]
    led = np.flatnonzero(seed)
    inputs[led, :3] = 0.0
    a[:n], lam[:] = 0.0, 0.0
    evaluate_residuals(sim.workspace.record)
    at_rest = arrays["r"][:n].copy()
    size = 2.0 ** np.ceil(np.log2(1.0 + np.max(np.abs(at_rest), initial=0.0))) * LARGE
    resting = _channels(sim)
    inputs[led, 0] = size * seed[led]
    evaluate_residuals(sim.workspace.record)
    load = (arrays["r"][:n] - at_rest) / size
    change = _solve(sim, load)
    a[:n], lam[active] = size * change[:n], size * change[n:]
    found = (_channels(sim) - resting) / size
    # violations are zero for all inputs
    found[[sim.table.index[f"residual.{level}"] for level in ("position", "velocity", "acceleration")]] = 0.0
    return np.asarray(found)


def _channels(sim: "Simulation") -> Vector:
    """All channels of the workspace's point as it stands."""
    evaluate_residuals(sim.workspace.record)
    row = np.zeros(sim.buffer.shape[1])
    write_sample(sim.workspace.record, row)
    return sim.table.values(row)


def _solve(sim: "Simulation", load: Vector) -> Vector:
    """[M Phi_q^T; Phi_q 0] x = (-load, 0) at the workspace's point, (n + m_act,)."""
    workspace, n = sim.workspace, sim.assembly.n
    structure, arrays = workspace.structure, workspace.arrays
    if factor_joints(workspace.record) != 0:
        evaluate_joints(workspace.record)
        try:
            structure.kkt_query.analyze(arrays["values"])
        except SingularMatrixError as error:
            raise SimulationError(
                f"no derivatives at t = {sim.t:.9g} s: the matrix [M Phi_q^T; Phi_q 0] is singular there",
                t=sim.t,
                loop="outer",
            ) from error
    size = n + len(structure.active)
    rows, cols, values = structure.rows, structure.cols, arrays["values"][: structure.nnz].copy()
    wanted, x = np.zeros(size), np.zeros(size)
    wanted[:n] = -load
    for _ in range(1 + REFINEMENTS):
        arrays["rhs"][:size] = wanted - np.bincount(rows, values * x[cols], size)
        solve_joints(workspace.record)
        x = x + arrays["rhs"][:size]
    terms = values * x[cols]
    left = np.abs(wanted - np.bincount(rows, terms, size))
    if not np.all(
        left <= SENSITIVITY_SOLVED * (np.max(np.abs(load), initial=0.0) + np.bincount(rows, np.abs(terms), size))
    ):
        raise SimulationError(
            f"no derivatives at t = {sim.t:.9g} s: the mechanism is too near a singular position, or a value is not "
            "finite",
            t=sim.t,
            loop="outer",
        )
    return np.asarray(x)
