"""Where things stand in the matrix of a run's present structure, and the rate of its mass matrix."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..equations.system import EquationSystem
from ..simulation.simulation import Simulation
from .at_rest import refuse_rate_rows
from .linearise import colour_columns, matrix_at, tangent_rate
from .tangent_steps import VARYING

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Layout:
    """The present structure of a run, for dense matrices.

    Attributes
    ----------
    active : rows of Phi that are constraints, (m_act,).
    rows, cols : of the entries of [S, Phi_q^T; Phi_q, 0], in the order of the workspace's values.
    colours : of the columns of Phi_q, (n,); see `colour_columns`.
    scale : of the coordinates, (n,).
    """

    active: Ints
    rows: Ints
    cols: Ints
    colours: Ints
    scale: Floats

    @classmethod
    def of(cls, sim: Simulation) -> "Layout":
        """The layout of the structure that `sim` has now."""
        refuse_rate_rows(sim.assembly)
        structure, n = sim.workspace.structure, sim.assembly.n
        colours = colour_columns(n, structure.rows, structure.cols)
        # another structure may take its place in memory
        own: tuple[Any, ...] = (
            structure.active,
            structure.rows,
            structure.cols,
            colours,
            sim.assembly.coordinate_scale,
        )
        return cls(*(x.copy() for x in own))

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return len(self.scale)

    @property
    def freedom(self) -> int:
        """Number of degrees of freedom f."""
        return self.n - len(self.active)

    def matrices(self, sim: Simulation, c_q: float = 0.0) -> tuple[Floats, Floats]:
        """M + c_q K (n, n) and Phi_q (m_act, n) at the workspace's point."""
        s, phi_q = np.empty((self.n, self.n)), np.zeros((len(self.active), self.n))
        matrix_at(sim.workspace.record, self.rows, self.cols, s, phi_q, c_q)
        return s, phi_q


class Layouts:
    """The layouts of the structures that a run has had: the present one by `now`."""

    def __init__(self, sim: Simulation) -> None:
        self._sim = sim
        self._known: dict[tuple[Any, ...], Layout] = {}

    def now(self) -> Layout:
        """The layout of the present structure."""
        workspace = self._sim.workspace
        key = (workspace.key, workspace.dropped)
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = Layout.of(self._sim)
        return found


def mass_rates(sim: Simulation, layout: Layout, times: Floats, points: Floats, mass: Floats) -> Floats:
    """dM/dt along the motion at `times` (N,), whose states are `points` (N, 2n) and mass matrices `mass` (N, n, n).

    Returns one matrix of zeros (1, n, n) if M does not vary, else (N, n, n).
    """
    n, system = layout.n, sim.system
    if isinstance(system, EquationSystem):
        if system.functions.mass_is_constant:
            return np.zeros((1, n, n))
        return np.array([
            system.functions.mass_rate(float(t), x[:n], x[n:]) for t, x in zip(times, points, strict=True)
        ])  # fmt: skip
    if np.max(np.ptp(mass, axis=0), initial=0.0) <= VARYING * np.max(np.abs(mass), initial=0.0):
        return np.zeros((1, n, n))
    return rates_from_tangents(sim, layout, times)


def rates_from_tangents(sim: Simulation, layout: Layout, times: Floats) -> Floats:
    """dM/dt (N, n, n) along the motion, of a mass matrix that depends on the coordinates alone: (M e_k)_q v."""
    found = np.empty((len(times), layout.n, layout.n))
    tangent_rate(sim.workspace.record, sim._method.record, times, layout.rows, layout.cols, found)
    return found


def mass_by_time(sim: Simulation, t: float, q: Any) -> Floats:
    """M_t (n, n): the part of dM/dt that is no motion's."""
    n = sim.assembly.n
    if isinstance(sim.system, EquationSystem) and not sim.system.functions.mass_is_constant:
        return sim.system.functions.mass_rate(t, q, np.zeros(n))
    return np.zeros((n, n))
