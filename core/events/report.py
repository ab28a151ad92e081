"""Events go to a buffer that Python empties."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat
from ..state.run_records import COUNTS_SIZE, EVENT_SIZE, EVENTS, LEFT_APPROACH, UNSHARED_LOAD
from ..state.workspace_records import COUNTERS_SIZE, LEFT_APPROACHES, UNSHARED_LOADS
from .records import STILL_APPROACHES, UNSHARED, whole

MOST_EVENTS = 10
"""Of a contact at one instant: a blow with what is to be said of it (GAINS, ROUNDS), three wedges, closing or opening,
sliding or sticking; and what has not been found."""


@internal
def room_for(dr: Any, count: int) -> bool:
    """True if there is room for `count` more events."""
    return bool(ivec(dr.counts, COUNTS_SIZE)[EVENTS] + count <= dr.event_rows)


@internal
def report(
    dr: Any, t: float, kind: int, k: int, impulse: float, loss: float, approach: float, separation: float,
    residual: float, friction: float,
) -> None:  # fmt: skip
    """An event of contact k at time t; numbers as in `Event`."""
    counts = ivec(dr.counts, COUNTS_SIZE)
    row = mat(dr.events, dr.event_rows, EVENT_SIZE)[counts[EVENTS]]
    counts[EVENTS] += 1
    row[0], row[1], row[2], row[3], row[4] = t, kind, k, impulse, loss
    row[5], row[6], row[7], row[8] = approach, separation, residual, friction


@internal
def report_not_found(ev: Any, dr: Any, ws: Any, t: float) -> None:
    """Count an instant at which loads have not been shared, or an approach has been left, and say so."""
    for what, counter, kind in (
        (UNSHARED, UNSHARED_LOADS, UNSHARED_LOAD), (STILL_APPROACHES, LEFT_APPROACHES, LEFT_APPROACH)
    ):  # fmt: skip
        if whole(ev)[what] != 0:
            ivec(ws.counters, COUNTERS_SIZE)[counter] += 1
            report(dr, t, kind, whole(ev)[what] - 1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
