"""The run as one compiled function: steps, event location and what is settled at events, until it reaches its goal or
something comes up that Python has to do.

`run` makes steps; `drive` goes on where these end at events. What it leaves to Python it leaves untouched, with a code
of `records` that says what it is.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, twin
from ..compiled.jit import address_of, compiled, compiled_unlocked, internal, record_view
from ..compiled.records import ArrayRecord
from ..compiled.views import ivec, vec
from ..contact.laws import ForceLaw, ImpactLaw, NewtonImpact, PoissonImpact
from ..contact.progress import Progress
from ..events import Event
from ..methods.history import history_time
from ..methods.records import METHOD_TYPE
from ..rounding import NO_STEP
from ..stage.accelerations import solve_accelerations
from ..system.assembly import Assembly, ContactInfo
from ..system.records import COUNTERS_SIZE, OK, STEPS, WORKSPACE_TYPE
from .instant import NEWTON, OTHER, POISSON, UNTOUCHED, settle
from .loop import accept, run, trial_step
from .records import (
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
    FOUND_SIZE,
    GOAL,
    GOALS_SIZE,
    HANDLED,
    HANDLED_AT,
    JAM,
    LAST_STOP,
    LOOP_TYPE,
    REACHED,
    RUN_SIGNATURE,
    SAMPLE_SIGNATURE,
    SETTLE,
    STOP_TIME,
    TARGET_TIME,
    TRIAL_SIGNATURE,
    UNLOCATED,
    call_run,
)
from .sample import write_sample
from .search import NEAREST, locate
from .sliding import any_slides, may_have_jammed

if TYPE_CHECKING:
    from .engine import Engine

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
    last = np.nextafter(ahead, -np.inf)
    if last - now <= NO_STEP * abs(now):
        return DUE
    if goal - now <= NO_STEP * abs(goal):
        return REACHED
    clock[BREAK_TIME], clock[STOP_TIME], clock[TARGET_TIME] = ahead, min(goals[LAST_STOP], last), goal
    return REACHED if clock[STOP_TIME] - now <= NO_STEP * abs(now) else OK


@internal
def drive_on(dr: Any, ws: Any, ms: Any, lc: Any, hold: bool) -> int:
    """Steps and events up to the goal; `hold`: only up to where events are pending."""
    counts, steps = ivec(dr.counts, COUNTS_SIZE), ivec(ws.counters, COUNTERS_SIZE)
    last = steps[STEPS] + counts[HANDLED] + counts[BUDGET]
    pending = ivec(dr.pending, ws.n_contacts)
    while True:
        code = _aim(dr, ms, lc)
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
        due = False
        for k in range(ws.n_contacts):
            due = due or pending[k] != 0
        if due and (hold or history_time(ms, 0) > vec(dr.goals, GOALS_SIZE)[GOAL] or not settle(dr, ws, ms, lc)):
            return SETTLE


@compiled_unlocked
def drive(dr: Any, hold: bool) -> int:
    """Go to the goal; a code of `records` or the status of a step that cannot be made."""
    return drive_on(dr, workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop), hold)


@compiled
def aim_now(dr: Any) -> int:
    """`_aim`, for Python."""
    return _aim(dr, method_at(dr.method), loop_at(dr.loop))


@compiled
def settle_now(dr: Any) -> bool:
    """`settle`, for Python."""
    return settle(dr, workspace_at(dr.workspace), method_at(dr.method), loop_at(dr.loop))


def _law(assembly: Assembly, k: int, contact: ContactInfo) -> int:
    """How impacts of contact k are solved (`instant.py`)."""
    if isinstance(contact.law, ForceLaw) or k in assembly.massless_contacts:
        return UNTOUCHED
    if isinstance(contact.law, NewtonImpact):
        return NEWTON if contact.law.propagation == "simultaneous" else OTHER
    return POISSON if isinstance(contact.law, PoissonImpact) else OTHER


def _numbers_of(assembly: Assembly) -> dict[str, NDArray[Any]]:
    """What the record takes from the model."""
    contacts = assembly.contacts
    impacts = [c.law if isinstance(c.law, ImpactLaw) else None for c in contacts]
    return {
        "breakpoints": np.array(assembly.breakpoints, dtype=np.float64),
        "law": np.array([_law(assembly, k, c) for k, c in enumerate(contacts)], dtype=np.int64),
        "restitution": np.array([law.restitution if law else 0.0 for law in impacts], dtype=np.float64),
        "rest_ratio": np.array([law.rest_ratio if law else 0.0 for law in impacts], dtype=np.float64),
        "friction": np.array([c.coulomb.coefficient if c.coulomb else 0.0 for c in contacts], dtype=np.float64),
    }


class Drive:
    """What `drive` of one run works with.

    Attributes
    ----------
    goals, counts : see `records`.
    """

    def __init__(self, sim: "Engine", guard: Progress) -> None:
        assembly = sim.assembly
        contacts, n_ext, self._names = assembly.contacts, assembly.n_extended, [c.name for c in assembly.contacts]
        count = max(len(contacts), 1)
        self.goals, self.counts = np.zeros(GOALS_SIZE), np.zeros(COUNTS_SIZE, dtype=np.int64)
        self.goals[HANDLED_AT] = np.nan
        self.pending = np.zeros(count, dtype=np.int64)
        self.events = np.zeros((EVENT_ROWS if contacts else 1, EVENT_SIZE))
        self._record = ArrayRecord(
            DRIVE,
            {
                "goals": self.goals, "counts": self.counts, "guard": guard.numbers, "pending": self.pending,
                **_numbers_of(assembly),
                "found": np.zeros((count, FOUND_SIZE)), "events": self.events, "last_trial": np.zeros(1),
                "nearest": np.zeros(NEAREST),
                **{name: np.zeros(n_ext) for name in ("velocities", "gradient", "response", "sideways")},
                "joint_rates": np.zeros(assembly.m + 1),
            },
            {
                "workspace": sim.workspace.address, "method": sim._method.address, "loop": sim._loop.address,
                "n_breakpoints": len(assembly.breakpoints),
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
        new._record = self._record.moved(take)
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

    def settle(self, pending: list[int]) -> bool:
        """Let the events of the contacts `pending` happen at the newest row, if they are of the kind that compiled code
        settles; else nothing has happened."""
        self.pending[:] = 0
        self.pending[pending] = 1
        return bool(settle_now(self._record.record))

    def take_pending(self) -> list[int]:
        """The contacts with events that are left to settle."""
        return [int(k) for k in np.flatnonzero(self.pending)]

    def take_events(self) -> list[Event]:
        """The events since the last call."""
        rows: NDArray[np.float64] = self.events[: self.counts[EVENTS]]
        self.counts[EVENTS] = 0
        return [
            Event(t, EVENT_KINDS[int(kind)], self._names[int(k)], *numbers) for t, kind, k, *numbers in rows.tolist()
        ]
