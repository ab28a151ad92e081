"""What an impact of many contacts leaves of an approach: too little for another impact, but gaps that touch go on
closing by it, and each of the steps behind begins beyond the event that this makes."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from .rates import masses, push, solve_cone_problem
from .records import (
    BASE,
    COS_WAY,
    COUNT,
    KINETIC,
    KNOWN,
    MU,
    PART,
    RATE,
    ROUNDING,
    SIN_WAY,
    SLIDE_RATE,
    STATIC,
    STILL_APPROACHES,
    SWAY_RATE,
    col,
    whole,
)


@internal
def take_away_left(ev: Any, ws: Any) -> None:
    """Take the approaches of all touching contacts away, by an impact without restitution that leaves what sticks as
    it is. What it does to the energy is below rounding, as these rates are. Where no impulses are found they stay,
    which STILL_APPROACHES says."""
    count, part, base, mu, known = whole(ev)[COUNT], col(ev, PART), col(ev, BASE), col(ev, MU), col(ev, KNOWN)
    b, p = vec(ev.space_b, 3 * count), vec(ev.space_p, 3 * count)
    for i in range(count):
        x, y = col(ev, SLIDE_RATE)[i], col(ev, SWAY_RATE)[i]
        speed = math.hypot(x, y)
        slides = speed > col(ev, ROUNDING)[i]
        part[i], base[i], known[i] = 1.0, 0.0, 1.0 if slides else 0.0
        mu[i] = col(ev, KINETIC)[i] if slides else col(ev, STATIC)[i]
        col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = (x / speed, y / speed) if slides else (1.0, 0.0)
        b[i], b[count + i], b[2 * count + i] = col(ev, RATE)[i], x if slides else 0.0, y if slides else 0.0
    if solve_cone_problem(ev, masses(ev, count), count, part, b, mu, base, known, p):
        push(ev, ws, p)
    else:
        whole(ev)[STILL_APPROACHES] = 1 + ivec(ev.contacts, ev.most)[0]
