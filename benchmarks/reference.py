"""Reference for the `chain` scenario: minimal coordinates (absolute angles), integrated by DOP853 with rtol 1e-13.

M_ij = m L^2 c_ij cos(a_i - a_j), c_ii = 1/3 + N - i, c_ij = 1/2 + N - max(i, j), i = 1 ... N. It shares nothing
with the solver: no constraints, no absolute coordinates, an explicit method.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import solve


@dataclass(frozen=True)
class ChainReference:
    """Angles and their rates (links, times), rad and rad/s; the free end (2, times), m."""

    t: NDArray[np.float64]
    angles: NDArray[np.float64]
    rates: NDArray[np.float64]
    tip: NDArray[np.float64]


def chain_reference(
    links: int,
    times: ArrayLike,
    *,
    length: float = 1.0,
    mass: float = 1.0,
    gravity: float = 9.81,
    rtol: float = 1e-13,
    atol: float = 1e-13,
) -> ChainReference:
    """Motion of the chain that is released horizontally at rest, at ascending `times` (s).

    Raises RuntimeError if scipy does not reach the end.
    """
    number = np.arange(1, links + 1)
    coupling = 0.5 + links - np.maximum.outer(number, number)
    coupling[np.diag_indices(links)] = 1.0 / 3.0 + links - number
    coupling *= mass * length**2
    weight = mass * gravity * length * (0.5 + links - number)

    def motion(t: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        angle, rate = y[:links], y[links:]
        difference = np.subtract.outer(angle, angle)
        force = -(coupling * np.sin(difference)) @ rate**2 - weight * np.cos(angle)
        return np.concatenate((rate, solve(coupling * np.cos(difference), force, assume_a="pos")))

    t = np.asarray(times, dtype=float)
    run = solve_ivp(motion, (0.0, t[-1]), np.zeros(2 * links), "DOP853", t_eval=t, rtol=rtol, atol=atol)
    if not run.success:
        raise RuntimeError(f"the reference stopped at t = {run.t[-1]:g} s: {run.message}")
    angles, rates = run.y[:links], run.y[links:]
    tip = length * np.stack((np.cos(angles).sum(axis=0), np.sin(angles).sum(axis=0)))
    return ChainReference(t, angles, rates, tip)
