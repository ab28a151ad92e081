"""The run as one compiled function: steps, event location and what is settled at events, until it reaches its goal or
something comes up that Python has to do.

`run` makes steps; `drive` goes on where these end at events. What it leaves to Python it leaves untouched, with a code
of `records` that says what it is.
"""

import logging
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, twin
from ..compiled.jit import address_of, compiled, compiled_unlocked, internal, record_view
from ..compiled.records import ArrayRecord
from ..compiled.views import ivec, vec
from ..events import Event
from ..events.instant import Instant
from ..events.laws import code_of
from ..events.progress import Progress
from ..events.records import DECLINED, SETTLED, WANT_PIVOTS, call_part, instant_at
from ..events.report import MOST_EVENTS
from ..events.settle import begin_pending_forces, go_on_behind, settle
from ..events.unsettled import find_unsettled
from ..laws import ForceLaw, ImpactLaw, law_address
from ..laws.friction import LuGreFriction
from ..location.asleep import wake_all
from ..location.search import NEAREST, locate
from ..methods.history import history_time
from ..rounding import NO_STEP
from ..stage.accelerations import solve_accelerations
from ..state.method_records import METHOD_TYPE
from ..state.run_records import (
    ACCELERATIONS_SIGNATURE,
    ACCEPT_SIGNATURE,
    BREAK_TIME,
    BUDGET,
    CHUNK,
    CLOCK_SIZE,
    COUNTS_SIZE,
    DRIVE,
    DUE,
    EVENT,
    EVENT_KINDS,
    EVENT_ROWS,
    EVENT_SIZE,
    EVENTS,
    FAILED,
    FORCE_NUMBERS,
    FOUND_SIZE,
    FULL,
    GAINS,
    GOAL,
    GOALS_SIZE,
    HANDLED,
    HANDLED_AT,
    JAM,
    JUMPS,
    LAST_STOP,
    LOOP_TYPE,
    PASSED,
    REACHED,
    RUN_SIGNATURE,
    SAMPLE_SIGNATURE,
    SETTLE,
    SETTLE_SIGNATURE,
    STATUS,
    STOP_TIME,
    TARGET_TIME,
    TRIAL_SIGNATURE,
    UNLOCATED,
    WANTED,
    call_run,
    call_settle,
)
from ..state.workspace_records import COUNTERS_SIZE, OK, STEPS, WORKSPACE_TYPE
from ..tables.assembly import Assembly, ContactInfo
from .loop import accept, run, trial_step
from .sample import write_sample
from .sliding import any_slides, may_have_jammed

if TYPE_CHECKING:
    from ..run.engine import Engine

MANY = 6
"""Contacts from which on it pays to let those sleep that are far from touching."""

logger = logging.getLogger(__name__)
workspace_at, method_at, loop_at = map(record_view, (WORKSPACE_TYPE, METHOD_TYPE, LOOP_TYPE))


@internal
def _aim(dr: Any, ms: Any, lc: Any) -> int:
    """Set the clock of the loop for the way to the goal; REACHED or DUE where there is no way to go."""
    goals, clock = vec(dr.goals, GOALS_SIZE), vec(lc.clock, CLOCK_SIZE)
    breakpoints = vec(dr.breakpoints, dr.n_breakpoints)
    now, goal, ahead = history_time(ms, 0), goals[GOAL], np.inf
    if now >= goal:
        return REACHED
    for i in range(dr.n_breakpoints):
        if now < breakpoints[i] < ahead:
            ahead = breakpoints[i]
    # steps end just before a breakpoint, so that they see what holds to the left of it
    last, goals[PASSED] = np.nextafter(ahead, -np.inf), ahead
    if last - now <= NO_STEP * abs(now):
        return DUE
    if goal - now <= NO_STEP * abs(goal):
        return REACHED
    clock[BREAK_TIME], clock[STOP_TIME], clock[TARGET_TIME] = ahead, min(goals[LAST_STOP], last), goal
    return REACHED if clock[STOP_TIME] - now <= NO_STEP * abs(now) else OK


@internal
def drive_on(dr: Any, ws: Any, ms: Any, lc: Any, hold: bool) -> int:
    """Steps and events up to the goal; `hold`: only up to where events are pending."""
    lc.may_sleep = 1 if ws.n_contacts >= MANY else 0
    code = _drive_on(dr, ws, ms, lc, hold)
    lc.may_sleep = 0
    # whoever builds what is wanted does not look at gaps, and comes back at once
    if code != WANTED:
        wake_all(ws, ms, lc)
    return code


@internal
def _drive_on(dr: Any, ws: Any, ms: Any, lc: Any, hold: bool) -> int:
    counts, steps = ivec(dr.counts, COUNTS_SIZE), ivec(ws.counters, COUNTERS_SIZE)
    last = steps[STEPS] + counts[HANDLED] + counts[BUDGET]
    while True:
        if _is_due(dr, ws):
            # which redundant rows are left out is for Python to look at, at every instant
            if hold or ws.n_redundant > 0 or history_time(ms, 0) > vec(dr.goals, GOALS_SIZE)[GOAL]:
                return SETTLE
            status = call_settle(dr.settle, dr)
            if status != SETTLED:
                counts[STATUS] = status
                return SETTLE if status == DECLINED else (WANTED if status <= WANT_PIVOTS else FAILED)
            continue
        code = _aim(dr, ms, lc)
        if code == DUE and ws.n_redundant == 0:
            if lc.capacity > 0 and ivec(lc.cursor, 1)[0] >= lc.capacity:
                return FULL
            status = call_settle(dr.pass_breakpoint, dr)
            if status != SETTLED:
                counts[STATUS] = status
                return WANTED if status <= WANT_PIVOTS else FAILED
            continue
        if code != OK:
            return code
        left = last - steps[STEPS] - counts[HANDLED]
        if left <= 0:
            return CHUNK
        # while a contact slides, each step is looked at
        sliding, before = any_slides(ws), history_time(ms, 0)
        code = call_run(dr.run, ws, ms, lc, 1 if sliding else left)
        if code == CHUNK and sliding:
            if history_time(ms, 0) > before and may_have_jammed(ws):
                return JAM
            continue
        if code == REACHED:
            continue
        if code != EVENT:
            return code
        if locate(dr, ws, ms, lc) != OK:
            return UNLOCATED


@internal
def _is_due(dr: Any, ws: Any) -> bool:
    """True if events are pending."""
    pending = ivec(dr.pending, ws.n_contacts)
    for k in range(ws.n_contacts):
        if pending[k] != 0:
            return True
    return False


@compiled_unlocked
def drive(dr: Any, hold: bool) -> int:
    """Go to the goal; a code of `records` or the status of a step that cannot be made."""
    return drive_on(dr, workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop), hold)


@compiled
def aim_now(dr: Any) -> int:
    """`_aim`, for Python."""
    return _aim(dr, method_at(dr.method), loop_at(dr.loop))


@compiled
def wake_now(dr: Any) -> None:
    """`wake_all`, for Python."""
    wake_all(workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop))


@compiled
def settle_pending(dr: Any) -> int:
    """Let the pending events happen at the newest row: a status of `events/records.py`."""
    ws, ms, lc = workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop)
    return settle(dr, instant_at(dr.instant), ws, ms, lc)


@compiled
def pass_breakpoint(dr: Any) -> int:
    """Go on behind the breakpoint `PASSED` of the goals: a status of `events/records.py`."""
    ws, ms, lc = workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop)
    return go_on_behind(dr, instant_at(dr.instant), ws, ms, lc)


@compiled
def begin_forces(dr: Any) -> int:
    """`begin_pending_forces`, for Python."""
    ws, ms, lc = workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop)
    return begin_pending_forces(dr, instant_at(dr.instant), ws, ms, lc)


@compiled
def unsettled_now(dr: Any) -> bool:
    """`find_unsettled` at the current point, for Python."""
    ws, ev = workspace_at(dr.workspace), instant_at(dr.instant)
    return find_unsettled(ev, ws, ivec(ev.unsettled, ws.n_contacts))


@compiled
def open_now(dr: Any) -> int:
    """`open_touching` at the current point, for Python."""
    ev = instant_at(dr.instant)
    return call_part(ev.open_touching, ev, dr, workspace_at(dr.workspace), method_at(dr.method))


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
        "ends_early": np.array([law is not None and law.release == "force" for law in laws], dtype=np.int64),
        "impulse_account": np.array([c.impulse_account for c in contacts], dtype=np.int64),
        "dissipation_account": np.array([c.dissipation_account for c in contacts], dtype=np.int64),
        "bristle": np.array([c.bristle for c in contacts], dtype=np.int64),
        "bristle_stiffness": np.array(stiffness, dtype=np.float64),
    }


def _warn_of_gain(t: float, gains: list[tuple[str, float]], laws: dict[str, str]) -> None:
    logger.warning(
        "at t = %.9g s an impact of %s raises the energy by %.3g J: Newton's law can with friction or several "
        "contacts; PoissonImpact does not with friction",
        t,
        ", ".join(f"'{name}' ({laws[name]})" for name, _ in gains),
        gains[0][1],
    )


def _warn_of_jump(t: float, jumps: list[tuple[str, float]]) -> None:
    """Say which drivers strike: an event is of a contact, and a jump of a Ramp's velocity is seldom meant."""
    logger.warning(
        "at t = %.9g s the velocity jumps (%s): an impact of the driver; its work is in energy.input_work. "
        "A Polynomial or a Table starts smoothly",
        t,
        ", ".join(f"driver '{name}' by {jump:.6g}" for name, jump in jumps),
    )


class Drive:
    """What `drive` of one run works with.

    Attributes
    ----------
    goals, counts : see `records`.
    """

    def __init__(self, sim: "Engine", guard: Progress) -> None:
        assembly = sim.assembly
        contacts, self._names = assembly.contacts, [c.name for c in assembly.contacts]
        self._laws = {c.name: type(c.law).__name__ for c in contacts}
        count = max(len(contacts), 1)
        self.goals, self.counts = np.zeros(GOALS_SIZE), np.zeros(COUNTS_SIZE, dtype=np.int64)
        self.goals[HANDLED_AT] = np.nan
        self.pending = np.zeros(count, dtype=np.int64)
        rows = 2 * MOST_EVENTS * len(contacts) + assembly.m_joints
        self.events = np.zeros((max(EVENT_ROWS, rows) if contacts or assembly.breakpoints else 1, EVENT_SIZE))
        self._rows = assembly.row_names
        self.instant = Instant(assembly)
        self._record = ArrayRecord(
            DRIVE,
            {
                "goals": self.goals, "counts": self.counts, "guard": guard.numbers, "pending": self.pending,
                **_numbers_of(assembly),
                "found": np.zeros((count, FOUND_SIZE)), "events": self.events, "last_trial": np.zeros(1),
                "nearest": np.zeros(NEAREST),
            },
            {
                "workspace": sim.workspace.address, "method": sim._method.address, "loop": sim._loop.address,
                "instant": self.instant.address, "event_rows": len(self.events),
                "settle": address_of(settle_pending, SETTLE_SIGNATURE) if contacts else 0,
                "n_breakpoints": len(assembly.breakpoints), "joint_rows": assembly.m_joints,
                "pass_breakpoint": address_of(pass_breakpoint, SETTLE_SIGNATURE) if assembly.breakpoints else 0,
                "run": address_of(run, RUN_SIGNATURE), "trial": address_of(trial_step, TRIAL_SIGNATURE),
                "accept": address_of(accept, ACCEPT_SIGNATURE),
                "write_sample": address_of(write_sample, SAMPLE_SIGNATURE),
                "accelerations": address_of(solve_accelerations, ACCELERATIONS_SIGNATURE),
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
        new.goals, new.counts, new.pending, new.events = map(
            new._record.arrays.__getitem__, ("goals", "counts", "pending", "events")
        )
        return new

    def take_numbers(self, assembly: Assembly) -> None:
        """Go on with another assembly of the same tables but for their numbers."""
        for name, numbers in _numbers_of(assembly).items():
            self._record.arrays[name][:] = numbers

    def go(self, t: float, stop: float, budget: int, hold: bool) -> int:
        """`drive` to `t` (s); no step goes beyond `stop`."""
        self.goals[GOAL], self.goals[LAST_STOP], self.counts[BUDGET] = t, stop, budget
        return int(drive(self._record.record, hold))

    def aim(self, t: float, stop: float) -> None:
        """Set the clock of the loop for the way to `t` (s); no step goes beyond `stop`."""
        self.goals[GOAL], self.goals[LAST_STOP] = t, stop
        aim_now(self._record.record)

    def wake(self) -> None:
        """Let no contact sleep any more (`asleep.py`)."""
        wake_now(self._record.record)

    def settle(self, pending: list[int]) -> int:
        """Let the events of the contacts `pending` happen at the newest row: a status of `events/records.py`. With any
        but SETTLED nothing has happened."""
        self.pending[:] = 0
        self.pending[pending] = 1
        return int(settle_pending(self._record.record))

    def pass_breakpoint(self, t: float) -> int:
        """Go on behind the breakpoint t (s), just after the newest row: a status, as `settle`."""
        self.goals[PASSED] = t
        return int(pass_breakpoint(self._record.record))

    def begin_forces(self, contacts: list[int]) -> int:
        """Let the force laws of these contacts act from the current point on: a status, as `settle`."""
        self.pending[:] = 0
        self.pending[contacts] = 1
        try:
            return int(begin_forces(self._record.record))
        finally:
            self.pending[:] = 0

    def unsettled(self) -> list[int]:
        """Closed contacts whose mode does not fit the forces at the current point: they pull, or are held beyond their
        friction."""
        if not unsettled_now(self._record.record):
            return []
        return [int(k) for k in np.flatnonzero(self.instant.unsettled[: len(self._names)])]

    def open(self, contacts: list[int]) -> int:
        """Open these contacts at the current point, and find how impulses at them move each other: a status."""
        while len(contacts) > self.instant.most:
            self.give_room()
        self.instant.touching = contacts
        return int(open_now(self._record.record))

    @property
    def status(self) -> int:
        """Why pending events could not be settled: a status of `events/records.py`."""
        return int(self.counts[STATUS])

    def give_room(self) -> None:
        """More room for the instants of this run."""
        self.instant = self.instant.grown()
        self._record.set_size("instant", self.instant.address)

    def take_pending(self) -> list[int]:
        """The contacts with events that are left to settle."""
        found = [int(k) for k in np.flatnonzero(self.pending)]
        self.pending[:] = 0
        return found

    def take_events(self) -> list[Event]:
        """The events since the last call."""
        rows: NDArray[np.float64] = self.events[: self.counts[EVENTS]]
        self.counts[EVENTS] = 0
        found, gains, jumps = [], [], []
        for t, kind, k, *numbers in rows.tolist():
            if kind == JUMPS:
                jumps.append((t, self._rows[int(k)], numbers[2]))
                continue
            name = self._names[int(k)]
            if kind == GAINS:
                gains.append((t, name, -numbers[1]))
            else:
                found.append(Event(t, EVENT_KINDS[int(kind)], name, *numbers))
        for t in dict.fromkeys(t for t, _, _ in gains):
            _warn_of_gain(t, [(name, gain) for at, name, gain in gains if at == t], self._laws)
        for t in dict.fromkeys(t for t, _, _ in jumps):
            _warn_of_jump(t, [(name, jump) for at, name, jump in jumps if at == t])
        return found
