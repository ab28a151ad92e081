"""Do events follow each other in next to no time?

Coulomb friction of several contacts can make them stick and slip in turns that become shorter by a thousandth each
time: as accumulating bounces do, but tens of thousands of them. Bounces end by the rest rule; so does this. While
instants crowd, a closed contact that slides more slowly than `rest_ratio` times the speeds there are counts as one that
does not slide: the forces say whether it sticks.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..state.run_records import CLOCK_SIZE, CROWDED, WINDOW_COUNT, WINDOW_START
from ..state.workspace_records import CONTROL_SIZE, RATE_SCALE

WINDOW = 64
"""Instants that are looked at together."""
NEXT_TO_NO_TIME = 1e-6
"""Of the model's own time."""


@internal
def count_instant(ws: Any, lc: Any, t: float) -> None:
    """One more instant, at time t."""
    clock = vec(lc.clock, CLOCK_SIZE)
    clock[WINDOW_COUNT] += 1.0
    if clock[WINDOW_COUNT] >= WINDOW:
        span = (t - clock[WINDOW_START]) * vec(ws.control, CONTROL_SIZE)[RATE_SCALE]
        clock[CROWDED] = 1.0 if abs(span) < NEXT_TO_NO_TIME else 0.0
        clock[WINDOW_START], clock[WINDOW_COUNT] = t, 0.0
