"""The record of `drive` for one run, and what Python asks of it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly, ContactInfo
from ..compiled.image import Take, twin
from ..compiled.jit import address_of
from ..compiled.records import ArrayRecord
from ..event_detection.roots import NEAREST
from ..events import Event
from ..events.instant import Instant
from ..events.progress import Progress
from ..events.report import MOST_EVENTS
from ..laws import ForceLaw, ImpactLaw, law_address
from ..laws.friction import LuGreFriction
from ..recovery.compiled_repartition import go_by_impulses, repair_now
from ..recovery.policy import recover
from ..stage.accelerations import solve_accelerations
from ..state.impact_law_codes import code_of
from ..state.pool_records import NO_PAIR
from ..state.run_records import (
    ACCELERATIONS_SIGNATURE,
    ACCEPT_SIGNATURE,
    COUNTS_SIZE,
    DRIVE,
    EVENT_KINDS,
    EVENT_ROWS,
    EVENT_SIZE,
    FORCE_NUMBERS,
    FOUND_SIZE,
    GAINS,
    GOALS_SIZE,
    JUMPS,
    LEFT_APPROACH,
    LOCATE_SIGNATURE,
    RECOVER_SIGNATURE,
    ROUNDS,
    RUN_SIGNATURE,
    SAMPLE_SIGNATURE,
    SETTLE_SIGNATURE,
    TRIAL_SIGNATURE,
    UNSHARED_LOAD,
    counts_of,
    goals_of,
)
from ..time_loop.drive import (
    aim_now,
    bind_now,
    drive,
    locate_now,
    open_now,
    pass_breakpoint,
    push_step,
    settle_pending,
    unsettled_now,
    wake_now,
    without_impulse_now,
)
from ..time_loop.sample import write_sample
from ..time_loop.time_loop import accept, run, trial_step
from .event_warnings import warn_of_gain, warn_of_jump, warn_of_left_approach, warn_of_rounds, warn_of_unshared_load

if TYPE_CHECKING:
    from .engine import Engine


def _numbers_of(assembly: Assembly) -> dict[str, NDArray[Any]]:
    """What the record takes from the model."""
    contacts = assembly.contacts
    impacts = [c.law if isinstance(c.law, ImpactLaw) else None for c in contacts]
    return {
        "breakpoints": np.array(assembly.breakpoints, dtype=np.float64),
        "law": np.array(
            [code_of(c.law, k in assembly.massless_contacts) for k, c in enumerate(contacts)], dtype=np.int64
        ),
        "restitution": np.array([law.restitution if law else 0.0 for law in impacts], dtype=np.float64),
        "rest_ratio": np.array([law.rest_ratio if law else 0.0 for law in impacts], dtype=np.float64),
        "friction": np.array([c.coulomb.coefficient if c.coulomb else 0.0 for c in contacts], dtype=np.float64),
        **_forces_of(contacts),
    }


def _bristles(contact: ContactInfo) -> tuple[int, int]:
    """Where the components of its bristles' deflection begin, and how many they are."""
    return (contact.bristles[0][0], len(contact.bristles)) if contact.bristles else (0, 0)


def _forces_of(contacts: Sequence[ContactInfo]) -> dict[str, NDArray[Any]]:
    """What the record takes from contacts that act as forces; zeros for the others."""
    laws = [c.law if isinstance(c.law, ForceLaw) else None for c in contacts]
    stiffness = [c.friction.bristle_stiffness if isinstance(c.friction, LuGreFriction) else 0.0 for c in contacts]
    least = [0.0 if law is None else -1.0 if law.minimum_approach_speed is None else law.minimum_approach_speed
             for law in laws]  # fmt: skip
    return {
        "force_law": np.array([law_address(law) if law else 0 for law in laws], dtype=np.int64),
        "force_numbers": np.array(
            [law.formula_parameters() if law else (0.0,) * FORCE_NUMBERS for law in laws], dtype=np.float64
        ).reshape(-1, FORCE_NUMBERS),
        "least_approach": np.array(least, dtype=np.float64),
        "ends_early": np.array([law is not None and law.never_pulls for law in laws], dtype=np.int64),
        "by_approach": np.array([law is not None and law.damps_by_approach for law in laws], dtype=np.int64),
        "impulse_account": np.array([c.impulse_account for c in contacts], dtype=np.int64),
        "dissipation_account": np.array([c.dissipation_account for c in contacts], dtype=np.int64),
        "bristles": np.array([_bristles(c) for c in contacts], dtype=np.int64).reshape(-1, 2),
        "bristle_stiffness": np.array(stiffness, dtype=np.float64),
    }


_TOLD_ONCE = {UNSHARED_LOAD: warn_of_unshared_load, LEFT_APPROACH: warn_of_left_approach}


class Drive:
    """What `drive` of one run works with.

    Attributes
    ----------
    goals, counts : see `records`.
    """

    says_jumps = True
    """Whether jumps of drivers' rates are said in the log."""

    def __init__(self, sim: "Engine", guard: Progress) -> None:
        assembly = sim.assembly
        contacts, self._names = assembly.contacts, [c.name for c in assembly.contacts]
        self._pool = assembly.pool
        self._told: set[int] = set()
        self._laws = {c.name: type(c.law).__name__ for c in contacts}
        count = max(len(contacts), 1)
        goals, counts = np.zeros(GOALS_SIZE), np.zeros(COUNTS_SIZE, dtype=np.int64)
        self.goals, self.counts = goals_of(goals), counts_of(counts)
        self.goals.handled_at = np.nan
        self.pending = np.zeros(count, dtype=np.int64)
        rows = 2 * MOST_EVENTS * len(contacts) + assembly.m_joints
        self.events = np.zeros((max(EVENT_ROWS, rows) if contacts or assembly.breakpoints else 1, EVENT_SIZE))
        self._rows = assembly.row_names
        self.instant = Instant(assembly)
        self._record = ArrayRecord(
            DRIVE,
            {
                "goals": goals, "counts": counts, "guard": guard.numbers, "pending": self.pending,
                **_numbers_of(assembly),
                "found": np.zeros((count, FOUND_SIZE)), "events": self.events, "last_trial": np.zeros(1),
                "nearest": np.zeros(NEAREST),
            },
            {
                "workspace": sim.workspace.address, "method": sim._method.address, "loop": sim._loop.address,
                "instant": self.instant.address, "event_rows": len(self.events),
                "settle": address_of(settle_pending, SETTLE_SIGNATURE) if contacts else 0,
                "locate": address_of(locate_now, LOCATE_SIGNATURE) if contacts else 0,
                "push_step": address_of(push_step, SETTLE_SIGNATURE) if contacts else 0,
                "go_by_impulses": address_of(go_by_impulses, SETTLE_SIGNATURE) if contacts else 0,
                "recover": address_of(recover, RECOVER_SIGNATURE), "repair": address_of(repair_now, SETTLE_SIGNATURE),
                "n_breakpoints": len(assembly.breakpoints), "joint_rows": assembly.m_joints,
                "pass_breakpoint": address_of(pass_breakpoint, SETTLE_SIGNATURE) if assembly.breakpoints else 0,
                "run": address_of(run, RUN_SIGNATURE), "trial": address_of(trial_step, TRIAL_SIGNATURE),
                "accept": address_of(accept, ACCEPT_SIGNATURE),
                "write_sample": address_of(write_sample, SAMPLE_SIGNATURE),
                "accelerations": address_of(solve_accelerations, ACCELERATIONS_SIGNATURE),
                "most_sweeps": sim.formula.sweeps,
                "input_account": assembly.work_index("input") if "input" in assembly.work_names else -1,
            },
        )  # fmt: skip

    @property
    def address(self) -> int:
        """Address of the record."""
        return self._record.address

    @property
    def record(self) -> ArrayRecord:
        """The record and its arrays."""
        return self._record

    def moved(self, take: Take) -> "Drive":
        """The same in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        new._record, new.instant = self._record.moved(take), self.instant.moved(take)
        arrays = new._record.arrays
        new.goals, new.counts = goals_of(arrays["goals"]), counts_of(arrays["counts"])
        new.pending, new.events = arrays["pending"], arrays["events"]
        return new

    def take_numbers(self, assembly: Assembly) -> None:
        """Go on with another assembly of the same tables but for their numbers."""
        for name, numbers in _numbers_of(assembly).items():
            self._record.arrays[name][:] = numbers

    def go(self, t: float, stop: float, budget: int, hold: bool) -> int:
        """`drive` to `t` (s); no step goes beyond `stop`."""
        self.goals.goal, self.goals.last_stop, self.counts.budget = t, stop, budget
        return int(drive(self._record.record, hold))

    def aim(self, t: float, stop: float) -> None:
        """Set the clock of the loop for the way to `t` (s); no step goes beyond `stop`."""
        self.goals.goal, self.goals.last_stop = t, stop
        aim_now(self._record.record)

    def locate(self, trial: int) -> int:
        """End the step at the first event in it, as `event_search.locate` says, and leave that pending. `trial`:
        address of what has made the step and makes it again with other sizes."""
        own = int(self._record.table["trial"][0])
        self._record.set_size("trial", trial)
        try:
            return int(locate_now(self._record.record, False))
        finally:
            self._record.set_size("trial", own)

    def bind(self) -> None:
        """Tables for the pairs that have the slots of contact pools (`contact_pool.py`)."""
        bind_now(self._record.record)

    def wake(self) -> None:
        """Let no contact sleep any more (`contact_sleeping.py`)."""
        wake_now(self._record.record)

    def settle(self, pending: list[int]) -> int:
        """Let the events of the contacts `pending` happen at the newest row: a status of `events/records.py`. With any
        but SETTLED nothing has happened."""
        self.pending[:] = 0
        self.pending[pending] = 1
        return int(settle_pending(self._record.record))

    def pass_breakpoint(self, t: float) -> int:
        """Go on behind the breakpoint t (s), just after the newest row: a status, as `settle`."""
        self.goals.passed = t
        return int(pass_breakpoint(self._record.record))

    def answer(self, what: int) -> None:
        """Answer what the policy has asked for (`recovery/policy.py`): NOT_DONE, DONE or OTHER_ROWS."""
        self.counts.answer = what

    def end_recovery(self, clock: Any) -> None:
        """Nothing is asked for any more, and if the run goes on all the same it does so with whole steps."""
        counts = self.counts
        counts.cause = counts.remedy = counts.attempts = counts.answer = 0
        clock.fixed_step *= 2.0**clock.halvings
        clock.halvings = clock.failures = clock.divided_until = clock.parts_until = 0.0

    def without_impulse(self) -> str:
        """Name of the first contact that steps of impulses cannot pass; empty: there is none."""
        k = int(without_impulse_now(self._record.record))
        return self._names[k] if k >= 0 else ""

    def unsettled(self) -> list[int]:
        """Closed contacts whose mode does not fit the forces at the current point: they pull, or are held beyond their
        friction."""
        if not unsettled_now(self._record.record):
            return []
        return [int(k) for k in np.flatnonzero(self.instant.unsettled[: len(self._names)])]

    def open(self, contacts: list[int]) -> int:
        """Open these contacts at the current point, and find how impulses at them move each other: a status."""
        if len(contacts) > self.instant.decided:
            self._use_instant(self.instant.with_room(len(contacts), len(contacts)))
        self.instant.touching = contacts
        return int(open_now(self._record.record))

    @property
    def status(self) -> int:
        """Why pending events could not be settled: a status of `events/records.py`."""
        return int(self.counts.status)

    def give_room(self) -> None:
        """More room for the instants of this run."""
        self._use_instant(self.instant.grown())

    def _use_instant(self, instant: Instant) -> None:
        self.instant = instant
        self._record.set_size("instant", instant.address)

    def take_pending(self) -> list[int]:
        """The contacts with events that are left to settle."""
        found = [int(k) for k in np.flatnonzero(self.pending)]
        self.pending[:] = 0
        return found

    def take_events(self) -> list[Event]:
        """The events since the last call."""
        rows: NDArray[np.float64] = self.events[: self.counts.events]
        self.counts.events = 0
        found, gains, jumps, rounds = [], [], [], []
        for t, kind, k, *numbers, pair in rows.tolist():
            if kind == JUMPS:
                jumps.append((t, self._rows[int(k)], numbers[2]))
                continue
            name = self._names[int(k)] if pair == NO_PAIR or self._pool is None else self._pool.name_of(int(pair))
            if kind == ROUNDS:
                rounds.append((t, name))
            elif kind in _TOLD_ONCE:
                if kind not in self._told:
                    self._told.add(int(kind))
                    _TOLD_ONCE[int(kind)](t, name)
            elif kind == GAINS:
                gains.append((t, name, -numbers[1]))
            else:
                found.append(Event(t, EVENT_KINDS[int(kind)], name, *numbers))
        for t in dict.fromkeys(t for t, _, _ in gains):
            warn_of_gain(t, [(name, gain) for at, name, gain in gains if at == t], self._laws)
        for t in dict.fromkeys(t for t, _, _ in jumps if self.says_jumps):
            warn_of_jump(t, [(name, jump) for at, name, jump in jumps if at == t])
        if rounds and ROUNDS not in self._told:
            self._told.add(ROUNDS)
            warn_of_rounds(rounds[0][0], [name for t, name in rounds if t == rounds[0][0]])
        return found
