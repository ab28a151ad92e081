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
from ..stage.joints import evaluate_joints
from .slopes import SLOPES_UNSOLVED, along_inputs

if TYPE_CHECKING:
    from .simulation import Simulation

Vector = NDArray[np.float64]


def input_derivatives(sim: "Simulation", direction: Mapping[str, float]) -> Vector:
    """Derivatives (channels,) of all channels along `direction`, by input name; the simulation stays as it is.

    Raises
    ------
    SimulationError : if the augmented system is singular at the present point.
    """
    names = sim.assembly.input_names
    seed, found = np.zeros(len(names)), np.zeros(len(sim.channels))
    for name, x in direction.items():
        seed[names.index(name)] += x
    largest = float(np.max(np.abs(seed), initial=0.0))
    if largest == 0.0:
        return found
    before = sim.state()
    try:
        _along(sim, seed / largest, found)
        return found * largest
    finally:
        sim.restore(before)


def _along(sim: "Simulation", seed: Vector, found: Vector) -> None:
    sim.sample()  # the present time becomes the workspace's point
    exchange = sim.outside.record
    status = along_inputs(exchange, seed, found)
    if status not in (0, SLOPES_UNSOLVED):
        evaluate_joints(sim.workspace.record)
        try:
            sim.workspace.structure.kkt_query.analyze(sim.workspace.arrays["values"])
        except SingularMatrixError as error:
            raise SimulationError(
                f"no derivatives at t = {sim.t:.9g} s: the matrix [M Phi_q^T; Phi_q 0] is singular there",
                t=sim.t,
                loop="outer",
            ) from error
        sim.sample()
        status = along_inputs(exchange, seed, found)
    if status != 0:
        raise SimulationError(
            f"no derivatives at t = {sim.t:.9g} s: the mechanism is too near a singular position, or a value is not "
            "finite",
            t=sim.t,
            loop="outer",
        )
