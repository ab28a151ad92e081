"""The way to a place of rest: pseudo-transient continuation, with contacts that close and open (`equilibrium.py`)."""

import numpy as np
from numpy.typing import NDArray

from ..assembly.evaluate import evaluate_residuals
from ..assembly.levels import force_level
from ..assembly.projection import bring_to_rest
from ..errors import ConsistencyError, SimulationError
from ..laws import ForceLaw
from ..simulation.simulation import Simulation
from ..state.modes import ACTIVE, CLOSED, IDLE, OPEN
from .at_rest import place, tangent
from .least_contact_forces import share_contact_loads

Floats = NDArray[np.float64]

MOST_ITERATIONS = 2000
LEAP = 0.1
"""How far one iteration may move a coordinate, in parts of its scale."""
FIRST_MOVE = 0.01
"""The same of the first one."""
GROWTH = 4.0
"""Largest growth of the pseudo time step in one iteration."""
STILL = 1e-12
"""Move of an iteration, in parts of the scales, below which nothing moves any more."""
BALANCED = 1e-9
"""Forces left over, in parts of those that act, that count as balanced."""
ENTRY = 1e-3
"""How deep one iteration may enter a contact with a force law, in parts of its size."""
LONGEST = 1e8
"""Longest pseudo time step, in squares of the model's own time: what nothing holds does not run away by rounding."""
STRAINS = 1e-5
"""Part of |K| |q| that acts at least: forces inside elastic bodies cancel, and leave their rounding."""
ROUNDING = 1e-9
"""Gap below zero, in parts of its size, of a contact that others hold, which is rounding."""
SMALLEST = 1e-40
"""Pseudo time step, relative to the first, at which the search gives up."""


class Creep:
    """The iteration, at the workspace's point of a run that is used for nothing else."""

    def __init__(self, sim: Simulation) -> None:
        self.sim, self.scale = sim, sim.assembly.coordinate_scale
        self.iterations, self.unbalanced = 0, np.inf
        arrays, n = sim.workspace.arrays, sim.assembly.n
        # from rest: forces that depend on speeds, and what impacts did at the start, have no part in this
        sim.memory.mode, sim.memory.slide_mode, sim.memory.friction_ratio = OPEN, IDLE, 0.0
        sim.memory.implied_rows = 0.0
        self.released: dict[int, int] = {}
        q = arrays["q"][:n].copy()
        sim.use_modes(accelerations=False)
        place(sim, q, np.zeros(len(sim.workspace.structure.active)))
        self._choose(self._touching())

    def run(self) -> None:
        """Iterate until nothing moves and no contact wants to change."""
        step = first = 0.0
        forces = moved = before = np.inf
        while self.iterations < MOST_ITERATIONS:
            self.iterations += 1
            q = self._point()[0]
            acceleration, balanced = self._accelerations()
            # what nothing holds moves with the rounding of forces: there, no longer smaller is balanced too
            if balanced <= BALANCED and (moved <= STILL or balanced >= 0.5 * before or balanced == 0.0):
                if self._let_go():
                    step, before = 0.0, np.inf
                    continue
                self._check_gaps()
                self._share_loads()
                self.unbalanced = balanced
                return
            size = float(np.max(np.abs(acceleration) / self.scale, initial=0.0))
            if step == 0.0:
                step = first = FIRST_MOVE / max(size, 1e-300)
            else:
                step *= min(max(2.0 * forces / max(size, 1e-300), 0.5), GROWTH)
            step = min(step, LONGEST / self.sim.scales.rate**2)
            forces, before = size, balanced
            moved = self._move(step, q, acceleration)
            while moved < 0.0:
                step /= GROWTH
                if step < SMALLEST * first:
                    if balanced > BALANCED:
                        raise self._lost("no way leads downhill")
                    # contacts have just balanced all forces: what is left is rounding, in any direction
                    moved = step = 0.0
                    break
                moved = self._move(step, q, acceleration)
            if self._choose(self._touching()):
                step, moved, before = 0.0, np.inf, np.inf
        raise self._lost(f"after {MOST_ITERATIONS} iterations it still moves")

    def _point(self) -> tuple[Floats, Floats]:
        arrays, workspace = self.sim.workspace.arrays, self.sim.workspace
        return arrays["q"][: self.sim.assembly.n].copy(), arrays["lam"][workspace.structure.active].copy()

    def _accelerations(self) -> tuple[Floats, float]:
        """Those with which the system would leave this point, (n,); and the largest force left over, relative to those
        that act. Their multipliers become the point's; its matrices are kept for `_move`."""
        sim, n = self.sim, self.sim.assembly.n
        q, lam = self._point()
        place(sim, q, np.zeros_like(lam))
        load = -sim.workspace.arrays["r"][:n]
        mass, jacobian = tangent(sim, 0.0, 0.0)
        found = _augmented(mass, jacobian, np.concatenate([load, np.zeros(len(lam))]))
        place(sim, q, found[n:])
        self.lam, self.jacobian = found[n:], jacobian
        self.residual = sim.workspace.arrays["r"][:n].copy()
        largest = np.maximum(np.abs(load), np.abs(jacobian).T @ np.abs(found[n:]))
        # as work over the scales, so that forces and torques compare
        left = float(np.max(np.abs(mass @ found[:n]) * self.scale, initial=0.0))
        self.mass, self.stiffness = mass, tangent(sim, 1.0, 0.0)[0] - mass
        # forces that balance each other on one body cancel in `load`: the model's own energy is the least measure
        largest = np.maximum(largest, STRAINS * np.abs(self.stiffness) @ np.abs(q))
        acting = max(float(np.max(largest * self.scale, initial=0.0)), float(force_level(sim.workspace.record)))
        return found[:n], left / acting if acting > 0.0 else 0.0

    def _move(self, step: float, q: Floats, acceleration: Floats) -> float:
        """One move with pseudo time step `step`; its size in parts of the scales, or -1 if it is none to make."""
        sim, n = self.sim, self.sim.assembly.n
        matrix = self.stiffness + self.mass / step
        residual, jacobian = self.residual, self.jacobian
        change = _augmented(matrix, jacobian, np.concatenate([-residual, np.zeros(len(jacobian))]))[:n]
        moved = float(np.max(np.abs(change) / self.scale, initial=0.0))
        # a matrix that is not positive leads uphill: a smaller step makes it so
        downhill = float(change @ (self.mass @ acceleration)) >= -1e-12 * float(np.abs(change) @ np.abs(residual))
        if not moved <= LEAP or not downhill:
            return -1.0
        lam = self.lam
        place(sim, q + change, lam)
        if not bring_to_rest(sim.workspace, "phi", "q"):
            try:
                place(sim, q + change, lam)
                sim.use_modes(accelerations=False)
                met = bring_to_rest(sim.workspace, "phi", "q")
            except ConsistencyError:
                met = False
            if not met:
                place(sim, q, lam)
                return -1.0
        if self._too_deep():
            place(sim, q, lam)
            return -1.0
        return moved

    def _too_deep(self) -> bool:
        """True if a contact with a force law that does not act yet is entered by much: deep inside a body the way out
        may be another."""
        sim = self.sim
        for k, contact in enumerate(sim.assembly.contacts):
            if sim.memory.mode[k] == OPEN and isinstance(contact.law, ForceLaw):
                size = float(sim.workspace.arrays["row_scale"][contact.row])
                if sim.gap(k) < -ENTRY * size:
                    return True
        return False

    def _touching(self) -> list[int]:
        """Contacts that are open and whose shapes overlap."""
        sim = self.sim
        evaluate_residuals(sim.workspace.record)
        every = range(len(sim.assembly.contacts))
        return [k for k in every if sim.memory.mode[k] == OPEN and sim.gap(k) < 0.0]

    def _choose(self, closing: list[int]) -> bool:
        """Let these contacts act; those of force laws whose shapes have come apart act no more."""
        sim, before = self.sim, self.sim.memory.mode.copy()
        for k in closing:
            law = sim.assembly.contacts[k].law
            sim.memory.mode[k] = ACTIVE if isinstance(law, ForceLaw) else CLOSED
            size = float(sim.workspace.arrays["row_scale"][sim.assembly.contacts[k].row])
            if isinstance(law, ForceLaw):
                sim.memory.approach_speed[k] = law.least_approach_speed(sim.scales.rate * size)
        for k in range(len(sim.assembly.contacts)):
            if sim.memory.mode[k] == ACTIVE and sim.gap(k) > 0.0:
                sim.memory.mode[k] = OPEN
        if np.array_equal(before, sim.memory.mode):
            return False
        q = self._point()[0]
        if not self._take_on(closing) and np.array_equal(before, sim.memory.mode):
            place(sim, q, np.zeros(len(sim.workspace.structure.active)))
            return False
        place(sim, q, np.zeros(len(sim.workspace.structure.active)))
        if not bring_to_rest(sim.workspace, "phi", "q"):
            raise self._lost("contacts that have closed cannot be met together with the joints")
        return True

    def _take_on(self, closing: list[int]) -> bool:
        """Make what is closed constraints. Of the contacts that close, those whose equations others say already stay
        open, held by the others: a box lies on three of its corners. False if there are such."""
        sim = self.sim
        try:
            sim.use_modes(accelerations=False)
            return True
        except ConsistencyError:
            if not closing:
                raise
        modes = sim.memory.mode[closing].copy()
        sim.memory.mode[closing] = OPEN
        for k, mode in sorted(zip(closing, modes, strict=True), key=lambda pair: sim.gap(pair[0])):
            sim.memory.mode[k] = mode
            try:
                sim.use_modes(accelerations=False)
            except ConsistencyError:
                sim.memory.mode[k] = OPEN
        sim.use_modes(accelerations=False)
        return False

    def _let_go(self) -> bool:
        """Open the contact that pulls most, if one does."""
        sim, monitor = self.sim, self.sim.workspace.arrays["monitor"]
        evaluate_residuals(sim.workspace.record)
        largest = float(np.max(np.abs(monitor), initial=0.0))
        pulls = [
            (float(monitor[k]), k)
            for k in range(len(sim.assembly.contacts))
            if sim.memory.mode[k] == CLOSED and monitor[k] < -BALANCED * largest
        ]
        if not pulls:
            return False
        k = min(pulls)[1]
        self.released[k] = self.released.get(k, 0) + 1
        if self.released[k] > len(sim.assembly.contacts) + 3:
            raise self._lost(f"contact '{sim.assembly.contacts[k].name}' closes and opens for ever")
        sim.memory.mode[k] = OPEN
        q = self._point()[0]
        sim.use_modes(accelerations=False)
        place(sim, q, np.zeros(len(sim.workspace.structure.active)))
        return True

    def _check_gaps(self) -> None:
        """Raise SimulationError where a contact that others should hold is entered all the same."""
        sim = self.sim
        for k in self._touching():
            contact = sim.assembly.contacts[k]
            if sim.gap(k) < -ROUNDING * float(sim.workspace.arrays["row_scale"][contact.row]):
                raise self._lost(f"contact '{contact.name}' cannot be met together with the joints and contacts there")

    def _share_loads(self) -> None:
        """Let the contacts that touch and stay open, held by others, carry their part of the loads."""
        sim, size = self.sim, self.sim.workspace.arrays["row_scale"]
        held = [
            k
            for k, contact in enumerate(sim.assembly.contacts)
            if not isinstance(contact.law, ForceLaw)
            and sim.memory.mode[k] == OPEN
            and sim.gap(k) <= ROUNDING * float(size[contact.row])
        ]
        if held and not share_contact_loads(sim, held):
            raise self._lost("contacts that touch balance the loads only if one of them pulls")

    def _lost(self, why: str) -> SimulationError:
        sim = self.sim
        acceleration = self._accelerations()[0] / self.scale
        worst = int(np.argmax(np.abs(acceleration))) if len(acceleration) else 0
        return SimulationError(
            f"no static equilibrium was found: {why}, most of all in '{sim.assembly.coordinate_names[worst]}' = "
            f"{sim.workspace.arrays['q'][worst]:.6g}. Hold what nothing holds (a spring, a joint, a contact), or start "
            "nearer to the place of rest",
            t=sim.t,
            loop="equilibrium",
        )


def _augmented(matrix: Floats, jacobian: Floats, right: Floats) -> Floats:
    """Solution (n + m,) of [matrix, jacobian^T; jacobian, 0] x = right."""
    n, m = len(matrix), len(jacobian)
    full = np.zeros((n + m, n + m))
    full[:n, :n], full[n:, :n], full[:n, n:] = matrix, jacobian, jacobian.T
    # rows of very different sizes (mass in kg, Phi in m) are solved as well as their scales allow
    size = np.sqrt(np.maximum(np.max(np.abs(full), axis=1), 1e-300))
    try:
        return np.asarray(np.linalg.solve(full / size[:, None] / size, right / size) / size)
    except np.linalg.LinAlgError:
        return np.full(n + m, np.nan)
