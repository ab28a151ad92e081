"""References for scenarios: minimal coordinates, integrated by DOP853 with rtol 1e-13.

They share nothing with the solver: no constraints, no absolute coordinates, an explicit method.
`chain`, absolute angles: M_ij = m L^2 c_ij cos(a_i - a_j), c_ii = 1/3 + N - i, c_ij = 1/2 + N - max(i, j), i = 1 ... N.
`slider_crank`: the angle of the crank and, with a bushing in the wrist pin, its deflection.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
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


@njit(cache=True)
def _slider_crank(t: float, y: NDArray[np.float64], p: NDArray[np.float64]) -> NDArray[np.float64]:
    """y' for y = (u, u'), u the crank's angle a and, with a spring in the wrist pin, the slider's deflection (dx, dy).

    With phi of the rod, r sin a + l sin phi + dy = 0, x = r cos a + l cos phi + dx, the accelerations of
    w = (a, phi, x) are T u'' + b; T^T (M (T u'' + b) - F) = -k (0, dx, dy). No small differences of large numbers.
    """
    r, l, crank, rod, slider, gravity, stiffness = p
    free = len(y) // 2
    u, rate = np.zeros(3), np.zeros(3)
    u[:free], rate[:free] = y[:free], y[free:]
    sp = -(r * np.sin(u[0]) + u[2]) / l
    c, s, cp = np.cos(u[0]), np.sin(u[0]), np.sqrt(1.0 - sp**2)
    T, b = np.zeros((3, 3)), np.zeros(3)
    T[0, 0], T[2, 1] = 1.0, 1.0
    T[1, 0], T[1, 2] = -r * c / (l * cp), -1.0 / (l * cp)
    turn = T[1, 0] * rate[0] + T[1, 2] * rate[2]
    b[1] = (r * s * rate[0] ** 2 + l * sp * turn**2) / (l * cp)
    b[2] = -r * c * rate[0] ** 2 - l * cp * turn**2 - l * sp * b[1]
    T[2, 0], T[2, 2] = -r * s - l * sp * T[1, 0], -l * sp * T[1, 2]
    coupled = 0.5 * rod * r * l * (c * cp + s * sp)
    mass = np.diag(np.array([(crank / 3.0 + rod) * r**2, rod * l**2 / 3.0, slider]))
    mass[0, 1], mass[1, 0] = coupled, coupled
    bend = 0.5 * rod * r * l * (s * cp - c * sp)
    force = np.zeros(3)
    force[0] = -bend * turn**2 - gravity * (0.5 * crank + rod) * r * c
    force[1] = bend * rate[0] ** 2 - 0.5 * gravity * rod * l * cp
    T = np.ascontiguousarray(T[:, :free])
    rest = T.T @ (force - mass @ b)
    for i in range(1, free):
        rest[i] -= stiffness * u[i]
    return np.concatenate((y[free:], np.linalg.solve(T.T @ mass @ T, rest)))


def slider_crank_reference(
    t: float,
    *,
    lengths: tuple[float, float],
    masses: tuple[float, float, float],
    crank: tuple[float, float],
    gravity: float = 9.81,
    stiffness: float = 0.0,
    deflection: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    rtol: float = 1e-13,
    atol: float = 1e-13,
) -> NDArray[np.float64]:
    """(crank angle in rad, slider's x in m) at `t` (s) of a slider-crank of slender rods that turns freely.

    `lengths` of crank and rod, `masses` of crank, rod and slider, angle and rate of the `crank` at the start. With
    `stiffness` (N/m) in the wrist pin `deflection` are the slider's (x, y, x', y') against the rod's end at the start.
    Raises RuntimeError if scipy does not reach the end.
    """
    r, l = lengths
    p = np.array([r, l, *masses, gravity, stiffness])
    start = [crank[0], *deflection[:2], crank[1], *deflection[2:]] if stiffness else list(crank)
    # scipy's first guess knows nothing of the stiff spring
    first = 0.1 * (min(masses) / stiffness) ** 0.5 if stiffness else None
    run = solve_ivp(
        _slider_crank, (0.0, t), start, "DOP853", t_eval=[t], args=(p,), rtol=rtol, atol=atol, first_step=first
    )
    if not run.success:
        raise RuntimeError(f"the reference stopped at t = {run.t[-1]:g} s: {run.message}")
    end = run.y[:, -1]
    dx, dy = (end[1], end[2]) if stiffness else (0.0, 0.0)
    return np.array([end[0], r * np.cos(end[0]) + np.sqrt(l**2 - (r * np.sin(end[0]) + dy) ** 2) + dx])
