"""What an impact of many contacts leaves of an approach: too little for another impact, but gaps that touch go on
closing by it, and each of the steps behind begins beyond the event that this makes."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from .rates import push
from .records import COUNT, NOW_N, RATE, clear, col, delassus, whole

SWEEPS, DONE = 200, 1e-6


@internal
def take_away_left(ev: Any, ws: Any) -> None:
    """Take the approaches of all touching contacts away, by the normal impulses that this needs: sweeps over single
    contacts (Jourdan, Alart, Jean 1998), until they change next to nothing. What they do to the energy is below
    rounding, as these rates are."""
    count, rate, p, a = whole(ev)[COUNT], col(ev, RATE), col(ev, NOW_N), delassus(ev, whole(ev)[COUNT])
    clear(p, count)
    largest = 0.0
    for i in range(count):
        largest = max(largest, -rate[i])
    for _ in range(SWEEPS):
        change = 0.0
        for i in range(count):
            motion = rate[i]
            for j in range(count):
                motion += a[i, j] * p[j]
            step = max(-motion / a[i, i], -p[i])
            p[i] += step
            change = max(change, abs(step) * a[i, i])
        if change <= DONE * largest:
            break
    all_three = vec(ev.space_p, 3 * count)
    clear(all_three, 3 * count)
    for i in range(count):
        all_three[i] = p[i]
    push(ev, ws, all_three)
