"""Contacts that touch at one instant: their directions, and how an impulse at one moves the others.

A column of the response is M_b g^T of a direction g (a row of the gaps' or the sliding distances' Jacobian): the
motion that a unit force along it causes with the joints intact, from [M Phi_q^T; Phi_q 0] (x, mu) = (g^T, 0).
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import compiled
from ..errors import SimulationError
from ..linalg import SingularMatrixError, factor, lu_at, solve
from ..stage.accelerations import solve_accelerations
from ..system.evaluate import evaluate_residuals, evaluate_tangent
from ..system.records import OK
from .complementarity import IMMOVABLE, Delassus
from .modes import ACTIVE, CLOSED, MODE, OPEN, RATIO, SLIDE, STICKS

if TYPE_CHECKING:
    from ..integrate.contact_side import ContactSide


NO_JERK = 1e-9
"""Part of its terms below which the rate of a gap's acceleration is none."""


@compiled
def evaluate_joints(ws: Any) -> None:
    """[M Phi_q^T; Phi_q 0] of the present structure at the current point."""
    evaluate_residuals(ws)
    evaluate_tangent(ws, 0.0, 0.0)


@compiled
def factor_joints(ws: Any) -> int:
    """The same matrix as `evaluate_joints`, and its factors with the pivots that the structure has."""
    evaluate_joints(ws)
    return int(factor(lu_at(ws.kkt_query), ws.values))


@compiled
def solve_joints(ws: Any) -> None:
    """rhs -> its solution with the factorised matrix."""
    solve(lu_at(ws.kkt_query), ws.rhs)


class Touching:
    """The contacts `contacts` (numbers) at the workspace's current point.

    Building it leaves them open, and the workspace in the structure for that: the caller sets their modes and calls
    `use_modes`. Closed contacts in `held` count as joints.

    Attributes
    ----------
    a : inverse effective masses (Delassus blocks) of the contacts, joints included, 1/kg.
    normal, tangential : rows of the Jacobians of gaps and sliding distances, (contacts, n); without friction: zeros.
    """

    def __init__(self, sim: "ContactSide", contacts: list[int], held: frozenset[int] = frozenset()) -> None:
        self.sim, self.contacts = sim, contacts
        self.infos = [sim.assembly.contacts[k] for k in contacts]
        workspace, memory = sim.workspace, sim.memory
        modes = memory[: len(sim.assembly.contacts), MODE]
        acting = frozenset(int(k) for k in np.flatnonzero(modes == ACTIVE))
        closed = frozenset(contacts)
        sliding = frozenset(k for k, c in zip(contacts, self.infos, strict=True) if c.slide_row >= 0)
        memory[contacts, MODE], memory[contacts, SLIDE], memory[contacts, RATIO] = CLOSED, STICKS, 0.0
        stuck = frozenset(
            k for k in held if sim.assembly.contacts[k].coulomb is not None and memory[k, SLIDE] == STICKS
        )
        workspace.engage(closed | held, acting, sliding | stuck)
        evaluate_residuals(workspace.record)
        evaluate_tangent(workspace.record, 0.0, 0.0)
        self._read_rows()
        memory[contacts, MODE] = OPEN
        workspace.engage(held, acting, stuck)
        self._factor()
        count, n = len(contacts), workspace.assembly.n
        directions = np.vstack([self.normal, self.tangential])
        self._response = np.zeros((2 * count, n))
        self._joint_response = np.zeros((2 * count, len(workspace.structure.active)))
        for i, direction in enumerate(directions):
            if np.any(direction):
                self._response[i], self._joint_response[i] = self._solve(direction)
        a = directions @ self._response.T
        a = 0.5 * (a + a.T)
        self.a = Delassus(a[:count, :count], a[:count, count:], a[count:, count:], directions, self._response)
        self._refuse_immovable()

    def _read_rows(self) -> None:
        workspace = self.sim.workspace
        rows, cols, values = workspace.jacobian()
        rows = workspace.structure.active[rows]
        shape = (len(self.contacts), workspace.assembly.n)
        self.normal, self.tangential = np.zeros(shape), np.zeros(shape)
        for matrix, wanted in (
            (self.normal, [c.row for c in self.infos]),
            (self.tangential, [c.slide_row for c in self.infos]),
        ):
            for i, row in enumerate(wanted):
                here = rows == row
                matrix[i, cols[here]] = values[here]

    def _factor(self) -> None:
        workspace = self.sim.workspace
        evaluate_joints(workspace.record)
        try:
            # pivots of an earlier visit to this structure would be a state that no State holds
            workspace.structure.kkt_query.analyze(workspace.arrays["values"])
        except SingularMatrixError as error:
            names = ", ".join(f"'{c.name}'" for c in self.infos)
            raise SimulationError(
                f"contact {names}, t = {self.sim.t_internal:.9g} s: the matrix [M Phi_q^T; Phi_q 0] of the joints is "
                "singular there (a coordinate without mass, or a singular position): impulses cannot be computed",
                t=self.sim.t_internal,
                loop="impact",
            ) from error

    def _solve(self, direction: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        workspace, n = self.sim.workspace, len(direction)
        size = n + len(workspace.structure.active)
        rhs = workspace.arrays["rhs"]
        rhs[:n], rhs[n:size] = direction, 0.0
        solve_joints(workspace.record)
        return rhs[:n].copy(), rhs[n:size].copy()

    def _refuse_immovable(self) -> None:
        structure, values = self.sim.workspace.structure, self.sim.workspace.arrays["values"]
        n = self.sim.assembly.n
        mass = np.flatnonzero((structure.rows < n) & (structure.cols < n))
        largest = float(np.max(values[mass[structure.rows[mass] == structure.cols[mass]]], initial=0.0))
        for contact, g, inverse in zip(self.infos, self.normal, np.diag(self.a.nn), strict=True):
            mass_g = np.bincount(structure.rows[mass], values[mass] * g[structure.cols[mass]], n)
            # without joints it is at least this (Cauchy and Schwarz)
            # (a frame without mass of its own counts as the heaviest)
            free = float(g @ g) ** 2 / (float(g @ mass_g) or largest * float(g @ g))
            if not inverse > IMMOVABLE * free:
                raise SimulationError(
                    f"contact '{contact.name}', t = {self.sim.t_internal:.9g} s: joints and drivers hold both shapes, "
                    "so that no impulse can keep them apart. Give one of them a force instead of a prescribed motion",
                    t=self.sim.t_internal,
                    loop="impact",
                )

    # ---- motion -----------------------------------------------------------------------------------------------------

    def rates(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Rates of gap and sliding distance at the current velocities, each (contacts,), m/s."""
        evaluate_residuals(self.sim.workspace.record)
        return self._rows("phid")

    def free_accelerations(self, ahead: float = 0.0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Their accelerations without contact forces, each (contacts,), m/s^2; `ahead`: as they are so many seconds
        later if the velocities stay."""
        if ahead > 0.0:
            arrays, n = self.sim.workspace.arrays, self.sim.assembly.n
            here = arrays["q"][:n].copy()
            arrays["q"][:n] += ahead * arrays["v"][:n]
            found = self.free_accelerations()
            arrays["q"][:n] = here
            self.free_accelerations()
            return found
        status = solve_accelerations(self.sim.workspace.record)
        if status != OK:
            raise SimulationError(
                f"no accelerations at t = {self.sim.t_internal:.9g} s: a force is not finite there",
                t=self.sim.t_internal,
                loop="impact",
            )
        return self._rows("phidd")

    def motion_noise(self, forces: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The most that errors (n,) of the forces change the free accelerations, each (contacts,), m/s^2."""
        noise = np.abs(self._response) @ forces
        count = len(self.contacts)
        return noise[:count], noise[count:]

    def free_jerks(self) -> NDArray[np.float64]:
        """Rates of the gaps' free accelerations (contacts,), m/s^3, as the forces' dependence on the motion makes them:
        M a' = -(K v + D a). What is not more than rounding is zero."""
        sim, arrays = self.sim, self.sim.workspace.arrays
        response = self._response[: len(self.contacts)]
        by_v, sizes_v = sim.tangent_product(1.0, 0.0, arrays["v"])
        by_a, sizes_a = sim.tangent_product(0.0, 1.0, arrays["a"])
        jerks, sizes = -response @ (by_v + by_a), np.abs(response) @ (sizes_v + sizes_a)
        return np.where(np.abs(jerks) <= NO_JERK * sizes, 0.0, jerks)

    def _rows(self, level: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        x = self.sim.workspace.arrays[level]
        return (
            x[[c.row for c in self.infos]],
            np.array([x[c.slide_row] if c.slide_row >= 0 else 0.0 for c in self.infos]),
        )

    def push(self, normal: NDArray[np.float64], tangential: NDArray[np.float64]) -> None:
        """Add the velocities that impulses (contacts,) in N s cause to the current ones."""
        arrays, n = self.sim.workspace.arrays, self.sim.assembly.n
        arrays["v"][:n] += np.concatenate([normal, tangential]) @ self._response
        evaluate_residuals(self.sim.workspace.record)
