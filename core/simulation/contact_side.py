"""What the handling of force contacts, and studies, may ask of a run and do with it, at the workspace's point."""

import logging
from collections.abc import Collection, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.evaluate import evaluate_power
from ..assembly.levels import rate_level
from ..assembly.partition import prepare
from ..assembly.redundancy import RedundantRow, choose_rows, describe
from ..assembly.scales import Scales
from ..assembly.workspace import Workspace
from ..errors import ConsistencyError
from ..events import Event
from ..events.records import SETTLED, WANT_MEMORY, WANTS_ROOM
from ..methods.registry import Formula
from ..rounding import RATE_ROUNDING
from ..stage.accelerations import solve_accelerations
from ..state.modes import ACTIVE, AT_LIMIT, CLOSED, OF_FIRST, OF_NORMAL, OF_SECOND, STICKS, contact_memories
from ..state.workspace_records import OK
from .drive_record import Drive
from .failures import failure_of
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
    clock: Any
    drive: Drive
    scales: Scales

    @property
    def memory(self) -> Any:
        """Contact memories, (contacts,) CONTACT_MEMORY."""
        return contact_memories(self.workspace.arrays["memory"])

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

    def inverse_masses(self, contacts: list[int]) -> NDArray[np.float64]:
        """Inverse effective masses (2 contacts, 2 contacts) of these contacts, 1/kg: how unit impulses along normals
        and, behind them, tangents move each other, with joints and other closed contacts intact.

        Raises
        ------
        SimulationError : where impulses cannot be computed.
        """
        kept, key = self.memory.copy(), self.workspace.key
        try:
            while (status := self.drive.open(contacts)) != SETTLED:
                self.memory[:] = kept
                if status > WANT_MEMORY:
                    raise failure_of(self, status)
                self.build_wanted(status)
            return self.drive.instant.inverse_masses
        finally:
            self.memory[:] = kept
            self.workspace.sync()
            self.workspace.engage(*key)

    def effective_mass(self, k: int) -> float:
        """Mass that contact k feels: normal impulse for a unit change of the gap's rate, joints included, kg."""
        try:
            return 1.0 / float(self.inverse_masses([k])[0, 0])
        finally:
            self.use_modes()

    def build_wanted(self, status: int) -> None:
        """What compiled code needs to settle pending events."""
        if status == WANTS_ROOM:
            self.drive.give_room()
        else:
            self.workspace.give_room()

    def add_event(self, event: Event) -> None:
        """Record an event."""
        logger.debug("%s", event)
        self.events.append(event)

    def use_modes(self, accelerations: bool = True) -> None:
        """Take the structure of the present modes; solve for (a, lam) unless told not to."""
        modes = self.memory.mode[: len(self.assembly.contacts)]
        closed = frozenset(int(k) for k in np.flatnonzero(modes == CLOSED))
        engaged = closed | {int(k) for k in np.flatnonzero(modes == ACTIVE)}
        sticking, implied = frozenset(self._sticking(closed)), frozenset(self._implied(closed))
        if self.workspace.key != (closed, engaged, sticking, implied):
            self.workspace.engage(closed, engaged, sticking, implied)
        if choose_rows(self.workspace):
            self.note_redundant()
        prepare(self.workspace)
        if accelerations:
            self.solve_accelerations()

    def _sticking(self, closed: Collection[int]) -> Iterator[int]:
        """Those that stick, as `tables/switch.codes_of` takes them."""
        for k in closed:
            contact, slide = self.assembly.contacts[k], self.memory.slide_mode[k]
            if contact.coulomb is not None and slide in (STICKS, AT_LIMIT):
                yield k
                if contact.tangents > 1 and slide == STICKS:
                    yield k + len(self.assembly.contacts)

    def _implied(self, closed: Collection[int]) -> Iterator[int]:
        """Their rows that others imply, as `tables/switch.codes_of` takes them."""
        for k in closed:
            for of, bit in enumerate((OF_NORMAL, OF_FIRST, OF_SECOND)):
                if int(self.memory.implied_rows[k]) & bit:
                    yield k + of * len(self.assembly.contacts)

    def note_redundant(self) -> None:
        """Other rows are left out than before: add them to what the result tells."""
        found = describe(self.workspace)
        logger.info("at t = %.9g s other redundant rows are left out of the equations: %s", self.t_internal, found)
        self.redundant += tuple(row for row in found if row not in self.redundant)

    def solve_accelerations(self) -> None:
        """Accelerations, multipliers and the rates of the work accounts at the workspace's point."""
        if solve_accelerations(self.workspace.record) != OK:
            raise self.no_accelerations()
        self.begin_rates()

    def no_accelerations(self) -> ConsistencyError:
        """The refusal of the workspace's point."""
        return ConsistencyError(
            f"no accelerations and multipliers at t = {self.workspace.arrays['t'][0]:.9g} s: the augmented system "
            "[M Phi_q^T; Phi_q 0] is singular or a force is not finite there"
        )

    def begin_rates(self) -> None:
        """Rates of the work accounts at the workspace's point, and what Newmark's formula starts from."""
        arrays = self.workspace.arrays
        evaluate_power(self.workspace.record)
        # with the rates of the work accounts: Newmark's formula integrates them from here
        arrays["aux"][:] = arrays["a"]

    def rate_size(self, contacts: Sequence[int]) -> NDArray[np.float64]:
        """The same of the rates of their gaps and sliding distances, (contacts,), m/s."""
        scale, rows = self.workspace.arrays["row_scale"], self.workspace.arrays["contact_slide_rows"][list(contacts)]
        along = np.where(rows >= 0, scale[rows], 0.0)
        return rate_level(self.workspace.record) * np.maximum(self._row_scale(contacts), along)

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
        return int(self.drive.counts.here)

    @property
    def events_handled(self) -> int:
        """Instants with events so far."""
        return int(self.drive.counts.handled)

    def unsettled(self) -> list[int]:
        """Closed contacts whose mode does not fit the forces at the workspace's point: they pull, or are held beyond
        their friction."""
        return self.drive.unsettled()
