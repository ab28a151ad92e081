"""Floquet multipliers of a periodic motion, impacts included."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError, SimulationError
from ..rounding import NO_STEP
from ..simulation.simulation import Simulation
from ..tolerances import OfScales
from .variation import Variation

Floats = NDArray[np.float64]

TIGHT = OfScales(1e-12)
"""What atol is unless told otherwise."""


@dataclass(frozen=True)
class FloquetResult:
    """Stability of a periodic motion."""

    multipliers: NDArray[np.complex128]
    """(k,), largest modulus first: eigenvalues of the fundamental matrix over one period."""
    exponents: Floats
    """(k,), 1/s: ln|multiplier|/period, the Lyapunov exponents of the motion."""
    closure: float
    """Largest difference of coordinates or velocities between end and start: zero on a periodic motion."""
    impacts: int
    """Impacts in the period."""


def floquet_multipliers(
    system: Any,
    period: float,
    method: str = "irk",
    rtol: float = 1e-10,
    atol: float | Mapping[str, float] = TIGHT,
    *,
    t0: float = 0.0,
    **options: Any,
) -> FloquetResult:
    """Multipliers of the motion that starts at the system's q0, v0 and comes back after `period` (s).

    Start anywhere on it but at an impact. Whether it comes back is for the caller to judge from `closure`.

    Raises
    ------
    ModelError, SimulationError : as `lyapunov_exponents`; a period in which a contact closes for good has no start to
        come back to.
    """
    if not (isinstance(period, int | float) and math.isfinite(period) and period > 0.0):
        raise ModelError(f"period must be a positive number of seconds, not {period!r}")
    if method == "irk":
        options = {"tableau": "gauss3", **options}
    sim = Simulation(system, method, rtol, atol, t0=t0, **options)
    n, arrays, end = sim.assembly.n, sim.workspace.arrays, t0 + period
    start = np.concatenate([arrays["q"][:n], arrays["v"][:n]])
    variation = Variation(sim, factors=True)
    first = np.vstack([variation.dq, variation.dv])
    product = np.eye(len(variation.exponents))
    while end - sim.t_internal > NO_STEP * abs(end):
        variation.advance(end)
        product = variation.last @ product
    if product.shape != (2 * variation.freedom,) * 2:
        raise SimulationError(
            f"the contacts at the end t = {end:.9g} s are not those at the start: the motion is not periodic",
            t=end,
            loop="variation",
        )
    # start and end are one point of the phase space, with one tangent space
    last = np.vstack([variation.dq, variation.dv]) @ product
    fundamental = np.linalg.lstsq(first, last, rcond=None)[0]
    multipliers = np.linalg.eigvals(fundamental).astype(complex)
    multipliers = multipliers[np.argsort(-np.abs(multipliers), kind="stable")]
    sim.t = end
    layout = sim.table.layout
    sample = sim.sample()
    closure = float(np.max(np.abs(np.concatenate([sample[layout.q], sample[layout.v]]) - start)))
    with np.errstate(divide="ignore"):
        exponents = np.log(np.abs(multipliers)) / period
    return FloquetResult(multipliers, exponents, closure, variation.impacts)
