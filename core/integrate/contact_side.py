"""What the contact state machine may ask of a run and do with it, at the workspace's current point."""

import logging
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..contact.laws import ForceLaw
from ..contact.modes import ACTIVE, CLOSED, GAP_START, LOSS_JUMP, MODE, SLIDE, SLIDE_START, STICKS
from ..contact.settling import comes_back
from ..contact.touching import Touching
from ..errors import ConsistencyError, SimulationError
from ..events import Event
from ..methods.registry import Formula
from ..rounding import COORDINATE_NOISE, FIRST_TOUCH, FORCE_ROUNDING, GAP_ROUNDING, RATE_ROUNDING, SLIP_EXCESS
from ..stage.accelerations import solve_accelerations
from ..system.assembly import Assembly
from ..system.evaluate import evaluate_energy, evaluate_power, evaluate_residuals, evaluate_tangent
from ..system.levels import force_level, position_level, rate_level
from ..system.partition import prepare
from ..system.projection import bring_to_rest
from ..system.records import OK
from ..system.redundancy import RedundantRow, choose_rows, describe
from ..system.scales import Scales
from ..system.workspace import Workspace
from .drive import Drive
from .records import HANDLED, HERE, MAX_STEP, STEP_SIZE
from .settings import Settings

logger = logging.getLogger(__name__)


class ContactSide:
    """The part of `Engine` that event handling is made of."""

    settings: Settings
    formula: Formula
    assembly: Assembly
    workspace: Workspace
    events: list[Event]
    redundant: tuple[RedundantRow, ...]
    method_arrays: dict[str, NDArray[Any]]
    clock: NDArray[np.float64]
    drive: Drive
    scales: Scales

    @property
    def memory(self) -> NDArray[np.float64]:
        """Contact memories, one row a contact."""
        return self.workspace.arrays["memory"]

    @property
    def t_internal(self) -> float:
        """Time of the newest accepted step, which may be beyond `t`."""
        arrays = self.method_arrays
        return float(arrays["times"].item(arrays["ring"].item(0)))  # `item` takes half the time of an index

    def gap(self, k: int) -> float:
        """Gap of contact k at the workspace's point, m."""
        return float(self.workspace.arrays["phi"][self.assembly.contacts[k].row])

    def gap_rate(self, k: int) -> float:
        """Its rate, m/s."""
        return float(self.workspace.arrays["phid"][self.assembly.contacts[k].row])

    def kinetic_energy(self) -> float:
        """Kinetic energy at the workspace's point, J."""
        evaluate_energy(self.workspace.record)
        return float(self.workspace.arrays["energy"][0])

    def add_input_work(self, work: float) -> None:
        """Work that driven constraints did during an impact, to its account."""
        if "input" in self.assembly.work_names:
            self.workspace.arrays["v"][self.assembly.work_index("input")] += work

    def contact_accounts(self, k: int) -> tuple[float, float]:
        """Impulse (N s) and dissipation (J) of contact k so far."""
        contact, v = self.assembly.contacts[k], self.workspace.arrays["v"]
        return (
            float(v[contact.impulse_account]),
            float(v[contact.dissipation_account] + self.memory[k, LOSS_JUMP]),
        )

    def elastic_energy(self, k: int, contact: Any) -> float:
        """Elastic energy that the force law of contact k holds, J."""
        return float(contact.law.elastic_energy(max(-self.gap(k), 0.0)))

    def effective_mass(self, k: int) -> float:
        """Mass that contact k feels: normal impulse for a unit change of the gap's rate, joints included, kg."""
        before = self.memory[k].copy()
        closed = np.flatnonzero(self.memory[: len(self.assembly.contacts), MODE] == CLOSED)
        try:
            return 1.0 / float(Touching(self, [k], frozenset(int(j) for j in closed)).a.nn[0, 0])
        finally:
            self.memory[k] = before
            self.use_modes()

    def unsettled_since(self, was: NDArray[np.float64]) -> list[int]:
        """Contacts whose mode does not fit their force. `was`: the modes before this instant was settled.

        Left out are those that have just closed because they would open by less than can be told from zero: they pull
        by what the errors of the steps have left in the waves of an elastic body, and would open and close for ever.
        """
        found = self.unsettled()
        new = [k for k in found if was[k] != CLOSED and k not in self.assembly.massless_contacts]
        settled = {k for k in new if self.returns_at_once(k)}
        return [k for k in found if k not in settled]

    def returns_at_once(self, k: int) -> bool:
        """True if contact k, closed, pulls by no more than lets its gap open by what could not be told from zero before
        it closes again (`comes_back`). The next step then goes beyond that."""
        before = self.memory[k].copy()
        others = np.flatnonzero(self.memory[: len(self.assembly.contacts), MODE] == CLOSED)
        try:
            touching = Touching(self, [k], frozenset(int(j) for j in others if j != k))
            motion, jerks = touching.free_accelerations()[0], touching.free_jerks()
        except SimulationError:
            # the others hold it, with the friction of those that slide: which of them stay is for all to settle
            return False
        finally:
            self.memory[k] = before
            self.use_modes()
        # one that presses is unsettled by its friction, which is for the stick and slip to settle
        if not motion[0] > 0.0 or not comes_back(self, [k], jerks, motion)[0]:
            return False
        # b + j t, the acceleration of the open gap, has turned well before this
        beyond = min(4.0 * float(motion[0]) / -float(jerks[0]), float(self.clock[MAX_STEP]))
        self.clock[STEP_SIZE] = max(self.clock[STEP_SIZE], beyond)
        return True

    def start_small(self, k: int, speed: float) -> None:
        """Begin contact k with a step in which it closes by FIRST_TOUCH of its size, so that the error control sees the
        force grow: a step over the whole contact would find no force at its stages."""
        size = float(self.workspace.arrays["row_scale"][self.assembly.contacts[k].row])
        self.clock[STEP_SIZE] = min(self.clock[STEP_SIZE], FIRST_TOUCH * size / speed)

    def add_event(self, event: Event) -> None:
        """Record an event."""
        logger.debug("%s", event)
        self.events.append(event)

    def use_modes(self, accelerations: bool = True) -> None:
        """Take the structure of the present modes; solve for (a, lam) unless told not to."""
        modes = self.memory[: len(self.assembly.contacts), MODE]
        closed = frozenset(int(k) for k in np.flatnonzero(modes == CLOSED))
        engaged = closed | {int(k) for k in np.flatnonzero(modes == ACTIVE)}
        sticking = frozenset(
            k for k in closed if self.assembly.contacts[k].coulomb is not None and self.memory[k, SLIDE] == STICKS
        )
        if self.workspace.key != (closed, engaged, sticking):
            self.workspace.engage(closed, engaged, sticking)
        if choose_rows(self.workspace):
            self.note_redundant()
        prepare(self.workspace)
        if accelerations:
            self.solve_accelerations()

    def note_redundant(self) -> None:
        """Other rows are left out than before: add them to what the result tells."""
        found = describe(self.workspace)
        logger.info("at t = %.9g s other redundant rows are left out of the equations: %s", self.t_internal, found)
        self.redundant += tuple(row for row in found if row not in self.redundant)

    def solve_accelerations(self) -> None:
        """Accelerations, multipliers and the rates of the work accounts at the workspace's point."""
        arrays = self.workspace.arrays
        if solve_accelerations(self.workspace.record) != OK:
            raise ConsistencyError(
                f"no accelerations and multipliers at t = {arrays['t'][0]:.9g} s: the augmented system "
                "[M Phi_q^T; Phi_q 0] is singular or a force is not finite there"
            )
        self.begin_rates()

    def begin_rates(self) -> None:
        """Rates of the work accounts at the workspace's point, and what Newmark's formula starts from."""
        arrays = self.workspace.arrays
        evaluate_power(self.workspace.record)
        # with the rates of the work accounts: Newmark's formula integrates them from here
        arrays["aux"][:] = arrays["a"]

    # ---- constraint contacts ------------------------------------------------------------------------------------

    def touching(self, pending: list[int]) -> list[int]:
        """Constraint contacts without a gap at the workspace's point: closed ones, `pending`, and others that touch.
        Those at massless ends are left out: they take no impulse."""
        none = GAP_ROUNDING * self.gap_size(range(len(self.assembly.contacts)))
        return [
            k
            for k, contact in enumerate(self.assembly.contacts)
            if not isinstance(contact.law, ForceLaw)
            and k not in self.assembly.massless_contacts
            and (k in pending or self.memory[k, MODE] == CLOSED or abs(self.gap(k)) <= none[k])
        ]

    def held(self) -> frozenset[int]:
        """Closed contacts at massless ends: to impacts of others they are joints."""
        return frozenset(k for k in self.assembly.massless_contacts if self.memory[k, MODE] == CLOSED)

    def slide_values(self, contacts: list[int]) -> dict[int, float]:
        """Sliding distances of those contacts that have friction, m."""
        found = {}
        for k in contacts:
            row, memory = self.assembly.contacts[k].slide_row, self.memory[k]
            if row >= 0:
                sticks = memory[MODE] == CLOSED and memory[SLIDE] == STICKS
                found[k] = float(self.workspace.arrays["phi"][row] + (memory[SLIDE_START] if sticks else 0.0))
        return found

    def gap_values(self, contacts: list[int]) -> NDArray[np.float64]:
        """Gaps of those contacts, (contacts,), m: of closed ones what rounding has left them."""
        memory = self.memory[contacts]
        held = np.where(memory[:, MODE] == CLOSED, memory[:, GAP_START], 0.0)
        return np.asarray(self.workspace.arrays["phi"][[self.assembly.contacts[k].row for k in contacts]] + held)

    def gap_size(self, contacts: Sequence[int]) -> NDArray[np.float64]:
        """What the gaps of these contacts are small or large against at the workspace's point, (contacts,), m."""
        return position_level(self.workspace.record) * self._row_scale(contacts)

    def rate_size(self, contacts: Sequence[int]) -> NDArray[np.float64]:
        """The same of the rates of their gaps and sliding distances, (contacts,), m/s."""
        scale, rows = self.workspace.arrays["row_scale"], self.workspace.arrays["contact_slide_rows"][list(contacts)]
        along = np.where(rows >= 0, scale[rows], 0.0)
        return rate_level(self.workspace.record) * np.maximum(self._row_scale(contacts), along)

    def force_size(self, contacts: Sequence[int]) -> NDArray[np.float64]:
        """The same of their normal forces, (contacts,), N."""
        return force_level(self.workspace.record) / self._row_scale(contacts)

    def _row_scale(self, contacts: Sequence[int]) -> NDArray[np.float64]:
        arrays = self.workspace.arrays
        return np.asarray(arrays["row_scale"][arrays["contact_rows"][list(contacts)]])

    def rate_rounding(self, contacts: Sequence[int]) -> NDArray[np.float64]:
        """Rates of their gaps and sliding distances below which these are at rest, (contacts,), m/s."""
        return RATE_ROUNDING * self.rate_size(contacts)

    @property
    def started(self) -> bool:
        """True once a step has been made."""
        return self.t_internal > self.settings.t0

    @property
    def events_here(self) -> int:
        """How often events have been handled at the present instant, without progress in time."""
        return int(self.drive.counts[HERE])

    @property
    def events_handled(self) -> int:
        """Instants with events so far."""
        return int(self.drive.counts[HANDLED])

    def meet_constraints(self) -> None:
        """Bring positions and velocities onto the constraints of the present structure, by rounding's worth."""
        for residual, x in (("phi", "q"), ("phid", "v")):
            evaluate_residuals(self.workspace.record)
            if not bring_to_rest(self.workspace, residual, x):
                raise SimulationError(
                    f"at t = {self.t_internal:.9g} s the closed contacts cannot be met together with the joints",
                    t=self.t_internal,
                    loop="contact",
                )
        evaluate_residuals(self.workspace.record)

    def unsettled(self) -> list[int]:
        """Closed contacts whose mode does not fit the forces at the workspace's point: they pull, or are held beyond
        their friction."""
        arrays, none = self.workspace.arrays, self.no_force(range(len(self.assembly.contacts)))
        found = []
        for k, contact in enumerate(self.assembly.contacts):
            if self.memory[k, MODE] != CLOSED:
                continue
            force, tolerance = -arrays["lam"][contact.row], float(none[k])
            if force < -tolerance and force < -self._contact_noise(contact.row):
                found.append(k)
            elif contact.coulomb is not None and self.memory[k, SLIDE] == STICKS:
                limit = contact.coulomb.sticking_coefficient * force
                if abs(arrays["lam"][contact.slide_row]) > limit * (1.0 + SLIP_EXCESS) + tolerance:
                    found.append(k)
        return found

    def _contact_noise(self, row: int) -> float:
        """What rounding of the coordinates leaves in the force of the closed contact with this row, N."""
        noise = self.force_noise()
        rows, cols, values = self.workspace.jacobian()
        here = np.flatnonzero((self.workspace.structure.active[rows] == row) & (values != 0.0))
        if not np.any(noise[cols[here]]):
            # on frames without stiffness of their own, which hand on the forces of others
            work = float(np.max(noise * self.assembly.coordinate_scale, initial=0.0))
            return work / float(self.workspace.arrays["row_scale"][row])
        return float(np.max(noise[cols[here]] / np.abs(values[here]), initial=0.0))

    def no_force(self, contacts: Sequence[int]) -> NDArray[np.float64]:
        """Rounding of the multipliers: forces of these contacts below this are none, (contacts,), N."""
        return FORCE_ROUNDING * self.force_size(contacts)

    def tangent_product(self, c_q: float, c_v: float, x: NDArray[np.float64]) -> tuple[Any, Any]:
        """(c_v D + c_q K) x (n,), without the mass matrix, and the same of the magnitudes of all terms."""
        workspace, n = self.workspace, self.assembly.n
        rows, cols = workspace.structure.rows, workspace.structure.cols
        evaluate_tangent(workspace.record, c_q, c_v)
        values = workspace.arrays["values"].copy()
        evaluate_tangent(workspace.record, 0.0, 0.0)
        here = np.flatnonzero((rows < n) & (cols < n))
        terms = (values[here] - workspace.arrays["values"][here]) * x[cols[here]]
        return np.bincount(rows[here], terms, n), np.bincount(rows[here], np.abs(terms), n)

    def force_noise(self) -> NDArray[np.float64]:
        """What rounding of the coordinates leaves in the forces (n,), N: in stiff bodies, coordinates that are nearly
        equal make large forces that cancel each other. That of the largest travels to all of them as waves."""
        scale = self.assembly.coordinate_scale
        largest = float(np.max(np.abs(self.workspace.arrays["q"][: self.assembly.n]) / scale, initial=0.0))
        noise = COORDINATE_NOISE * largest * scale
        return np.asarray(self.tangent_product(1.0, 0.0, noise)[1])

    def presses(self, k: int) -> bool:
        """True if the gap of contact k, with a force law, would close from rest (not just by rounding)."""
        self.solve_accelerations()
        return bool(self.workspace.arrays["phidd"][self.assembly.contacts[k].row] < 0.0)
