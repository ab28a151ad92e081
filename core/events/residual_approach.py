"""What an impact of many contacts leaves of an approach: too little for another impact, but gaps that touch go on
closing by it, and each of the steps behind begins beyond the event that this makes."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from .rates import masses, push, solve_cone_problem
from .records import scalars, touching


@internal
def take_away_left(instant: Any, workspace: Any) -> None:
    """Take the approaches of all touching contacts away, by an impact without restitution that leaves what sticks as
    it is. What it does to the energy is below rounding, as these rates are. Where no impulses are found they stay,
    which STILL_APPROACHES says."""
    contact = touching(instant)
    count, part, base, mu, known = (
        scalars(instant).count,
        vec(instant.part, instant.most),
        vec(instant.base, instant.most),
        vec(instant.mu, instant.most),
        vec(instant.known_direction, instant.most),
    )
    b, p = vec(instant.space_b, 3 * count), vec(instant.space_p, 3 * count)
    for i in range(count):
        x, y = contact[i].sliding_rate, contact[i].sliding_rate2
        speed = math.hypot(x, y)
        slides = speed > contact[i].rate_rounding
        part[i], base[i], known[i] = 1.0, 0.0, 1.0 if slides else 0.0
        mu[i] = contact[i].kinetic_friction if slides else contact[i].static_friction
        contact[i].direction_cos, contact[i].direction_sin = (x / speed, y / speed) if slides else (1.0, 0.0)
        b[i], b[count + i], b[2 * count + i] = contact[i].gap_rate, x if slides else 0.0, y if slides else 0.0
    if solve_cone_problem(instant, masses(instant, count), count, part, b, mu, base, known, p):
        push(instant, workspace, p)
    else:
        scalars(instant).approaching_contact = 1 + ivec(instant.contacts, instant.most)[0]
