"""Events go to a buffer that Python empties."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat
from ..state.run_records import COUNTS_SIZE, EVENT_SIZE, EVENTS, LEFT_APPROACH, UNSHARED_LOAD
from ..state.workspace_records import COUNTERS_SIZE, LEFT_APPROACHES, UNSHARED_LOADS
from .records import scalars

MOST_EVENTS = 10
"""Of a contact at one instant: a blow with what is to be said of it (GAINS, ROUNDS), three wedges, closing or opening,
sliding or sticking; and what has not been found."""


@internal
def room_for(drive: Any, count: int) -> bool:
    """True if there is room for `count` more events."""
    return bool(ivec(drive.counts, COUNTS_SIZE)[EVENTS] + count <= drive.event_rows)


@internal
def report(
    drive: Any, t: float, kind: int, k: int, impulse: float, loss: float, approach: float, separation: float,
    residual: float, friction: float,
) -> None:  # fmt: skip
    """An event of contact k at time t; numbers as in `Event`."""
    counts = ivec(drive.counts, COUNTS_SIZE)
    row = mat(drive.events, drive.event_rows, EVENT_SIZE)[counts[EVENTS]]
    counts[EVENTS] += 1
    row[0], row[1], row[2], row[3], row[4] = t, kind, k, impulse, loss
    row[5], row[6], row[7], row[8] = approach, separation, residual, friction


@internal
def report_not_found(instant: Any, drive: Any, workspace: Any, t: float) -> None:
    """Count an instant at which loads have not been shared, or an approach has been left, and say so."""
    for who, counter, kind in (
        (scalars(instant).unshared_contact, UNSHARED_LOADS, UNSHARED_LOAD),
        (scalars(instant).approaching_contact, LEFT_APPROACHES, LEFT_APPROACH),
    ):
        if who != 0:
            ivec(workspace.counters, COUNTERS_SIZE)[counter] += 1
            report(drive, t, kind, who - 1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
