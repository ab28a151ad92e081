"""Events go to a buffer that Python empties."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat
from ..state.pool_records import NO_PAIR
from ..state.run_records import EVENT_PAIR, EVENT_SIZE, JUMPS, LEFT_APPROACH, UNSHARED_LOAD, counts_at, loop_at
from ..state.workspace_records import counters_at
from .records import scalars

MOST_EVENTS = 10
"""Of a contact at one instant: a blow with what is to be said of it (GAINS, ROUNDS), three wedges, closing or opening,
sliding or sticking; and what has not been found."""


@internal
def room_for(drive: Any, count: int) -> bool:
    """True if there is room for `count` more events."""
    return bool(counts_at(drive.counts).events + count <= drive.event_rows)


@internal
def report(
    drive: Any, t: float, kind: int, k: int, impulse: float, loss: float, approach: float, separation: float,
    residual: float, friction: float,
) -> None:  # fmt: skip
    """An event of contact k at time t; numbers as in `Event`."""
    counts = counts_at(drive.counts)
    row = mat(drive.events, drive.event_rows, EVENT_SIZE)[counts.events]
    counts.events += 1
    row[0], row[1], row[2], row[3], row[4] = t, kind, k, impulse, loss
    row[5], row[6], row[7], row[8] = approach, separation, residual, friction
    row[EVENT_PAIR] = _pair_of(loop_at(drive.loop), k) if kind != JUMPS else NO_PAIR


@internal
def _pair_of(loop: Any, k: int) -> int:
    """The pair that has contact k; NO_PAIR: it is no slot of a pool."""
    if loop.n_slots == 0:
        return NO_PAIR
    slot = ivec(loop.contact_slot, k + 1)[k]
    return int(ivec(loop.slot_pair, loop.n_slots)[slot]) if slot >= 0 else NO_PAIR


@internal
def report_not_found(instant: Any, drive: Any, workspace: Any, t: float) -> None:
    """Count an instant at which loads have not been shared, or an approach has been left, and say so."""
    unshared, approaching = scalars(instant).unshared_contact, scalars(instant).approaching_contact
    counters = counters_at(workspace.counters)
    if unshared != 0:
        counters.unshared_loads += 1
        report(drive, t, UNSHARED_LOAD, unshared - 1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if approaching != 0:
        counters.left_approaches += 1
        report(drive, t, LEFT_APPROACH, approaching - 1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
