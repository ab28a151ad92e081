"""Linearised models x' = A x + B u, y = C x + D u about a place of rest, from inputs to channels.

The state is that of the independent coordinates, x = (y, y') with q = q0 + N y. A, B and D follow from the exact
tangents of the solver; C and D of nonlinear channels by a central formula of order six along exact directions.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from ..simulation.simulation import Simulation
from ..state.modes import ACTIVE
from .at_rest import Matrices, channel_values, loads, matrices
from .eigenmodes import resting
from .equilibrium import Equilibrium

Floats = NDArray[np.float64]

REACH = 1e-2
"""Reach of the central formula, in parts of what a direction moves against; its error is the sixth power of that."""
SHALLOW = 0.05
"""The same of the penetration of a contact with a force law."""
WEIGHTS = ((1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0))
"""f'(0) h = sum w (f(k h) - f(-k h)), of order six."""


@dataclass(frozen=True)
class StateSpace:
    """A linear model about a place of rest; states, inputs and outputs are differences to their values there.

    Attributes
    ----------
    A, B, C, D : (s, s), (s, inputs), (outputs, s), (outputs, inputs).
    states : names of the independent coordinates, then of their rates (s,).
    inputs, outputs : names of inputs and channels.
    equilibrium : the place of rest.
    """

    A: Floats
    B: Floats
    C: Floats
    D: Floats
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    equilibrium: Equilibrium

    @cached_property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A, 1/s."""
        return np.linalg.eigvals(self.A).astype(complex)

    def transfer(self, frequencies: Any) -> NDArray[np.complex128]:
        """Transfer function (frequencies, outputs, inputs) at frequencies in Hz: C (i w - A)^-1 B + D."""
        omega = 2j * np.pi * np.atleast_1d(np.asarray(frequencies, dtype=float))
        one = np.eye(len(self.A))
        return np.array([self.C @ np.linalg.solve(w * one - self.A, self.B) + self.D for w in omega])

    def to_scipy(self) -> Any:
        """The same as a `scipy.signal.StateSpace`, for step responses, discretisation, regulators."""
        from scipy.signal import StateSpace as Linear

        return Linear(self.A, self.B, self.C, self.D)


def state_space(
    system: Any,
    inputs: Iterable[str] | None = None,
    outputs: Iterable[str] | None = None,
    *,
    settle: bool = True,
    t: float = 0.0,
) -> StateSpace:
    """The linearised model from `inputs` (left out: all) to the channels `outputs` (left out: all) about rest.

    Parameters
    ----------
    system, settle, t : as `eigenmodes`.

    Raises
    ------
    ModelError : for unknown names, for inputs that are motions (what they set is no force), and without mass. Else as
        `static_equilibrium`.
    """
    rest = resting(system, settle, t)
    sim = rest.sim
    names = _chosen("input", inputs, sim.assembly.input_names)
    every = tuple(channel.name for channel in sim.channels)
    wanted = _chosen("channel", outputs, every)
    for motion in sim.assembly.motions:
        led = {sim.assembly.input_names[k] for k in (motion.position, motion.rate) if k >= 0} & set(names)
        if led:
            raise ModelError(
                f"input {sorted(led)} sets a motion, whose acceleration a linear model would have to know: let a force "
                "or a spring between a MovingFrame2D and the mechanism act instead, or leave this input out"
            )
    found, load = matrices(sim), loads(sim, list(names))
    mass, damping, stiffness = found.reduced()
    f = len(mass)
    try:
        inverse = np.linalg.inv(mass)
    except np.linalg.LinAlgError:
        raise ModelError(
            "some motion that the joints allow has no mass: it has no accelerations to be linear"
        ) from None
    by_state = -inverse @ np.hstack([stiffness, damping])
    by_input = inverse @ (found.basis.T @ load)
    zero = np.zeros((f, f))
    a = np.vstack([np.hstack([zero, np.eye(f)]), by_state])
    b = np.vstack([np.zeros((f, len(names))), by_input])
    directions = _Directions(sim, found, load, np.hstack([by_state, by_input]), list(names))
    place = [every.index(name) for name in wanted]
    derivatives = directions.derivatives()[place]
    coordinates = [sim.assembly.coordinate_names[k] for k in found.independent]
    # an internal state of a friction law is a rate without a place
    kept = np.concatenate([~sim.assembly.is_internal[found.independent], np.ones(f, dtype=bool)])
    states = np.array([*coordinates, *(f"{name}'" for name in coordinates)])[kept]
    c, d = derivatives[:, : 2 * f][:, kept], derivatives[:, 2 * f :]
    return StateSpace(a[np.ix_(kept, kept)], b[kept], c, d, tuple(states.tolist()), names, wanted, rest)


def _chosen(what: str, given: Iterable[str] | None, there: Iterable[str]) -> tuple[str, ...]:
    every = tuple(there)
    if given is None:
        return every
    wanted = (given,) if isinstance(given, str) else tuple(given)
    unknown = [name for name in wanted if name not in every]
    if unknown:
        raise ModelError(f"there is no {what} {unknown}; there are {list(every)}")
    return wanted


class _Directions:
    """Derivatives of all channels along (y, y', u), at the workspace's point."""

    def __init__(self, sim: Simulation, found: Matrices, load: Floats, accelerations: Floats, names: list[str]) -> None:
        n, f, arrays = sim.assembly.n, len(found.independent), sim.workspace.arrays
        size = 2 * f + len(names)
        self.sim = sim
        # changes of q, v, a (n, size), of multipliers (m_act, size) and of inputs
        self.q, self.v = np.zeros((n, size)), np.zeros((n, size))
        self.q[:, :f], self.v[:, f : 2 * f] = found.basis, found.basis
        self.a = found.basis @ accelerations
        self.inputs = [sim.assembly.input_names.index(name) for name in names]
        forces = -(found.mass @ self.a + found.damping @ self.v + found.stiffness @ self.q)
        forces[:, 2 * f :] += load
        self.lam = np.linalg.lstsq(found.jacobian.T, forces, rcond=None)[0] if len(found.jacobian) else forces[:0]
        self.rest_q, self.rest_inputs = arrays["q"][:n].copy(), arrays["inputs"].copy()
        self.rest_lam = arrays["lam"][sim.workspace.structure.active].copy()
        self.freedom = f

    def derivatives(self) -> Floats:
        """(channels, size)."""
        size = self.q.shape[1]
        found = np.zeros((len(self.sim.channels), size))
        try:
            for k in range(size):
                reach = self._reach(k)
                for factor, weight in WEIGHTS:
                    for sign in (1.0, -1.0):
                        found[:, k] += sign * weight / reach * self._channels(k, sign * factor * reach)
        finally:
            self._put(0, 0.0)
        # violations and the mode of a contact are what they are at rest
        found[[i for i, c in enumerate(self.sim.channels) if c.name.startswith("residual.") or c.kind != "real"]] = 0.0
        return found

    def _reach(self, k: int) -> float:
        """How far to go along direction k: as far as the sines of angles and the forces of contacts allow."""
        sim, scale = self.sim, self.sim.assembly.coordinate_scale
        along = max(float(np.max(np.abs(self.q[:, k]) / scale, initial=0.0)), 0.0)
        reach = REACH / along if along > 0.0 else 1.0
        self._put(k, 0.0)
        before = [sim.gap(i) for i in range(len(sim.assembly.contacts))]
        self._put(k, reach * 1e-3)
        for i, gap in enumerate(before):
            change = abs(sim.gap(i) - gap) / (reach * 1e-3)
            if sim.memory.mode[i] == ACTIVE and change * reach > SHALLOW * abs(gap):
                reach = SHALLOW * abs(gap) / change
        return reach / WEIGHTS[-1][0]

    def _put(self, k: int, x: float) -> None:
        """The point at x along direction k."""
        from ..assembly.evaluate import evaluate_residuals

        sim, n = self.sim, self.sim.assembly.n
        arrays = sim.workspace.arrays
        arrays["q"][:n] = self.rest_q + x * self.q[:, k]
        arrays["v"][:n], arrays["a"][:n] = x * self.v[:, k], x * self.a[:, k]
        arrays["lam"][sim.workspace.structure.active] = self.rest_lam + x * self.lam[:, k]
        arrays["inputs"][:] = self.rest_inputs
        if k >= 2 * self.freedom:
            arrays["inputs"][self.inputs[k - 2 * self.freedom], 0] += x
        evaluate_residuals(sim.workspace.record)

    def _channels(self, k: int, x: float) -> Floats:
        self._put(k, x)
        return channel_values(self.sim)
